//! At the ends of what `f64` holds, and sets within sets.

use super::rectangles::offset;
use super::surfaces::both;
use super::*;

pub fn rows() -> Vec<Row> {
    let mut rows = Vec::new();
    for rate in [1e-300, 1e300] {
        let x = Exponential::new(rate).unwrap();
        rows.push(
            row(format!("exponential, λ = {rate:e}"), x, 1.0 / rate, [0.0, LONGEST / rate], 4.0)
                .takes(1, 1)
                .cdf(move |x| if x < 0.0 { 0.0 } else { -(-rate * x).exp_m1() }),
        );
    }
    // 53 ln 2/−ln p steps at most, between f64 that lie 64 apart
    let bounces = Roulette::new(NEARLY_ONE).unwrap().bounces();
    let longest = 330_895_682_712_764_032.0;
    rows.push(
        row(
            "bounces by inversion, p = 1 − 2⁻⁵³",
            bounces.by_inversion().unwrap(),
            bounces.mean(),
            [0.0, longest],
            5.0,
        )
        .variance(bounces.variance())
        .takes(1, 1)
        .cdf(move |n| if n < 0.0 { 0.0 } else { bounces.cdf(n as u64) }),
    );
    rows.push(
        row(
            "X_rr of 1, p = 1",
            Roulette::new(1.0).unwrap().wrap(from_uniforms(|[]| 1.7)),
            1.7,
            [0.0, 2.0],
            5.0,
        )
        .variance(0.0),
    );
    rows.push(row(
        "X_rr of U, p = 1e-300",
        Roulette::new(1e-300).unwrap().wrap(from_uniforms(|[u]| u)),
        f64::NAN,
        [0.0, 1e300],
        5.0,
    ));
    let tall = Rectangle::new([-1e300, 1e300], [1e-300, 3e-300]).unwrap();
    rows.push(
        row("xy on 2e300 × 2e-300", tall.independent(|x, y| x * y), 0.0, [-12.1, 12.1], 10.0)
            .variance(16.0 * 13.0 / 9.0)
            .takes(2, 1),
    );
    let surface = Lambertian::new(0.61).unwrap();
    for (directions, a) in [
        (Hemisphere::Uniform, 300.0),
        (Hemisphere::Cosine, 300.0),
        (Hemisphere::Uniform, -1.99),
        (Hemisphere::Cosine, -0.5),
    ] {
        let power = CosinePower::new(a).unwrap();
        let (k, b, root) = match directions {
            Hemisphere::Uniform => (1.22, a + 1.0, 1.0 / (a + 1.0)),
            Hemisphere::Cosine => (0.61, a, 2.0 / a),
        };
        let most = if b > 0.0 { k } else { k * 2f64.powi(-53).powf(b) };
        for (way, estimator) in both(surface, directions, move |w| power.incoming(w)) {
            let mean = if a < -1.0 { f64::NAN } else { power.reflected(surface) };
            let name = format!("cos^{a} θ, {way}, {directions:?}");
            let one = row(name, estimator, mean, [0.0, most * (1.0 + 1e-9)], 45.0)
                .variance(power.variance(surface, directions))
                .takes(2, 1);
            // cos^300 θ is 0 in f64 for many directions
            let law = move |x: f64| 1.0 - (x / k).max(0.0).powf(root).clamp(0.0, 1.0);
            rows.push(if b < 0.0 { one.cdf(law) } else { one });
        }
    }
    // once in a hundred draws, and never any variance
    let ring = RingLight::new(0.1).unwrap();
    rows.push(
        row(
            "ring 0.1, cosine",
            surface.cosine_estimator(move |w| ring.incoming(w)),
            0.0061,
            [0.0, 0.611],
            10.0,
        )
        .variance(ring.variance(surface, Hemisphere::Cosine))
        .takes(2, 1),
    );
    rows.push(
        row("7, cosine", surface.cosine_estimator(|_| 7.0), 4.27, [0.0, 8.0], 8.0).variance(0.0).takes(2, 1),
    );
    let offset = offset();
    rows.push(
        row("constant on a rectangle", offset.independent(|_, _| 1.0), 6.97, [0.0, 8.0], 8.0).takes(2, 1),
    );
    rows.push(
        row("1024 cells of 1", offset.jittered(|_, _| 1.0, 32).unwrap(), 6.97, [0.0, 8.0], 20_000.0)
            .takes(2049, 1024),
    );
    // sets within sets
    let exponential = Exponential::new(0.37).unwrap();
    let x = || Roulette::new(0.8).unwrap().wrap(exponential);
    let range = [0.0, LONGEST / 0.37 / 0.8];
    rows.push(row("jittered X_rr", jittered(x(), 3).unwrap(), 1.0 / 0.37, range, 600.0));
    rows.push(row("64 Sobol points of X_rr", sobol(x(), 64).unwrap(), 1.0 / 0.37, range, 3000.0));
    rows
}
