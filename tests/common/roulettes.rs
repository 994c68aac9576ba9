//! Section 5: bounces, roulette and light paths.

use super::rectangles::Polynomial;
use super::*;

pub fn rows(pick: &mut Pick) -> Vec<Row> {
    let mut rows = Vec::new();
    // beyond this many bounces once in 10²⁴
    let last = |p: f64| 2.0 + 24.0 * 10f64.ln() / -p.ln();
    for p in [pick.between(0.8, [0.05, 0.9]), pick.between(0.2, [0.05, 0.9])] {
        let bounces = Roulette::new(p).unwrap().bounces();
        let (mean, variance) = (p / (1.0 - p), p / (1.0 - p).powi(2));
        let cdf = move |n: f64| if n < 0.0 { 0.0 } else { 1.0 - p.powf(n.floor() + 1.0) };
        let by_inversion = bounces.by_inversion().unwrap();
        rows.push(
            row(format!("bounces by inversion, p = {p}"), by_inversion, mean, [0.0, last(p)], 5.0)
                .variance(variance)
                .takes(1, 1)
                .cdf(cdf),
        );
        let by_simulation = bounces.by_simulation().unwrap();
        let cost = 10.0 / (1.0 - p);
        rows.push(
            row(format!("bounces by simulation, p = {p}"), by_simulation, mean, [0.0, last(p)], cost)
                .variance(variance)
                .cdf(cdf),
        );
    }
    // a staircase of one number: E min(N, c)² = Σ (2j − 1) P(N ≥ j)
    let (p, cut) = (0.5f64.powi(pick.count(1, [1, 3]) as i32), pick.count(6, [1, 7]) as i32);
    let mean: f64 = (1..=cut).map(|j| p.powi(j)).sum();
    let square: f64 = (1..=cut).map(|j| f64::from(2 * j - 1) * p.powi(j)).sum();
    let inverted = Roulette::new(p).unwrap().bounces().by_inversion().unwrap();
    let cut_off = Through(inverted, move |n: f64| n.min(cut.into()));
    rows.push(
        row(format!("min(N, {cut}), p = {p}"), cut_off, mean, [0.0, cut.into()], 6.0)
            .variance(square - mean * mean)
            .takes(1, 1)
            .smooth(1),
    );
    // the coin is one number and X another
    let p = pick.count(50, [1, 64]) as f64 / 64.0;
    let x = from_uniforms(|[u]| 3.0 * u * u);
    rows.push(
        row(format!("X_rr of 3U², p = {p}"), Roulette::new(p).unwrap().wrap(x), 1.0, [0.0, 3.0 / p], 15.0)
            .variance(9.0 / 5.0 / p - 1.0)
            .smooth(2),
    );
    let exponential = Exponential::new(pick.log(0.37, [1e-3, 1e3])).unwrap();
    let signed = || from_uniforms(|[u]| 3.0 * u - 1.0);
    let f = Polynomial::new(pick);
    for (given, least) in [(0.83, 0.5), (0.2, 0.1)] {
        let roulette = Roulette::new(pick.between(given, [least, 1.0])).unwrap();
        let p = roulette.p_rr();
        let of = |mean: f64, variance: f64| (variance + mean * mean * (1.0 - p)) / p;
        let (mean, most) = (exponential.mean(), LONGEST * exponential.mean() / p);
        rows.push(
            row(
                format!("X_rr of an exponential, p = {p}"),
                roulette.wrap(exponential),
                mean,
                [0.0, most],
                20.0,
            )
            .variance(of(mean, exponential.variance()))
            .cdf(move |x| if x < 0.0 { 0.0 } else { 1.0 - p * exponential.survival(p * x) }),
        );
        rows.push(
            row(format!("X_rr of 3U − 1, p = {p}"), roulette.wrap(signed()), 0.5, [-1.0 / p, 2.0 / p], 15.0)
                .variance(of(0.5, 0.75)),
        );
        let x = f.rectangle.independent(move |x, y| f.at(x, y));
        rows.push(
            row(
                format!("X_rr of a polynomial, p = {p}"),
                roulette.wrap(x),
                f.mean(),
                f.range().map(|y| y / p),
                25.0,
            )
            .variance(of(f.mean(), f.variance())),
        );
    }
    // the weights fall, stay, and grow
    let visibility = pick.between(0.5, [0.3, 1.0]);
    let albedo = pick.between(0.8, [0.1, 0.85]);
    let model = LightModel::new(albedo, visibility).unwrap();
    let falling = albedo + pick.between(0.4, [0.15, 0.85]) * (1.0 - albedo);
    let growing = albedo * (1.0 - pick.between(0.1, [0.02, 0.1]) * (1.0 - albedo));
    for q in [falling, albedo, growing] {
        let x = model.roulette(q).unwrap();
        let name = format!("ρ = {albedo}, v = {visibility}, q = {q}");
        let most = match q {
            _ if q > albedo => q / (q - albedo),
            _ => (0..last(q) as i32).map(|k| (albedo / q).powi(k)).sum(),
        };
        rows.push(row(name, x, model.mean(), [0.0, most], 15.0 / (1.0 - q)).variance(x.variance()));
    }
    // far below ρ draws have no variance: \[X > 0\], since every weight is 1 or more
    let seldom = albedo * pick.between(0.25, [0.1, 0.6]);
    let sees = visibility / (1.0 - seldom * (1.0 - visibility));
    let hit = Through(model.roulette(seldom).unwrap(), |x: f64| x.min(1.0));
    rows.push(
        row(format!("light seen, ρ = {albedo}, q = {seldom}"), hit, sees, [0.0, 1.0], 20.0)
            .variance(sees * (1.0 - sees)),
    );
    let last = pick.count(8, [0, 20]);
    let x = model.truncated(last).unwrap();
    let most = (0..=last as i32).map(|k| albedo.powi(k)).sum::<f64>();
    rows.push(
        row(
            format!("truncated at {last}"),
            x,
            x.mean(),
            [0.0, most * (1.0 + 1e-12)],
            10.0 + 4.0 * last as f64,
        )
        .variance(x.variance()),
    );
    rows
}
