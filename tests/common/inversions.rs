//! Section 1: inversion, of an exponential and of other libraries' laws.

use super::*;

/// Another library's law: its cdf, support, mean and variance.
type Law = (Box<dyn Fn(f64) -> f64 + Sync>, [f64; 2], f64, f64);

const POSITIVE: [f64; 2] = [0.0, f64::INFINITY];

fn law(which: usize, a: f64, b: f64) -> Law {
    let discrete = |cdf: Box<dyn Fn(u64) -> f64 + Sync>| {
        Box::new(move |x: f64| if x < 0.0 { 0.0 } else { cdf(x as u64) })
    };
    match which {
        0 => {
            let law = Normal::new(a - 2.0, b).unwrap();
            (Box::new(move |x| law.cdf(x)), [f64::NEG_INFINITY, f64::INFINITY], a - 2.0, b * b)
        }
        1 => {
            let law = Gamma::new(a, b).unwrap();
            (Box::new(move |x| law.cdf(x)), POSITIVE, a / b, a / b / b)
        }
        2 => {
            let (law, sum) = (Beta::new(a, b).unwrap(), a + b);
            (Box::new(move |x| law.cdf(x)), [0.0, 1.0], a / sum, a * b / (sum * sum * (sum + 1.0)))
        }
        3 => {
            let moment = |k: f64| statrs::function::gamma::gamma(1.0 + k / a);
            let (law, first) = (Weibull::new(a, b).unwrap(), moment(1.0));
            (Box::new(move |x| law.cdf(x)), POSITIVE, b * first, b * b * (moment(2.0) - first * first))
        }
        4 => {
            let law = Poisson::new(a).unwrap();
            (discrete(Box::new(move |k| law.cdf(k))), POSITIVE, a, a)
        }
        _ => {
            let (p, n) = (b / 3.0, (5.0 * a).floor());
            let law = Binomial::new(p, n as u64).unwrap();
            (discrete(Box::new(move |k| law.cdf(k))), [0.0, n], n * p, n * p * (1.0 - p))
        }
    }
}

pub fn rows(pick: &mut Pick) -> Vec<Row> {
    let rate = pick.log(0.37, [1e-3, 1e3]);
    let exponential = Exponential::new(rate).unwrap();
    let cdf = move |x: f64| if x < 0.0 { 0.0 } else { -(-rate * x).exp_m1() };
    let single = from_fn(move |rng| f64::from(Distribution::<f32>::sample(&exponential, rng)));
    let ratio = f_over_p(move |x: &f64| exponential.pdf(*x).powi(2), exponential);
    let variance = 1.0 / (rate * rate);
    let mut rows = vec![
        row(format!("exponential, λ = {rate}"), exponential, 1.0 / rate, [0.0, LONGEST / rate], 4.0)
            .variance(variance)
            .takes(1, 1)
            .cdf(cdf)
            .smooth(1),
        row(format!("exponential in f32, λ = {rate}"), single, 1.0 / rate, [0.0, 16.7 / rate], 8.0)
            .variance(variance)
            .takes(1, 0)
            .cdf(cdf),
        // p(X) is uniform up to λ
        row(format!("p²/p, λ = {rate}"), ratio, rate / 2.0, [0.0, rate], 15.0)
            .variance(rate * rate / 12.0)
            .takes(1, 1)
            .cdf(move |x| (x / rate).clamp(0.0, 1.0))
            .smooth(1),
    ];
    // Lomax: an infinite support with a scale, and for k = 1 not even a mean
    let (scale, k) = (pick.log(1.0, [1e-3, 1e3]), pick.count(1, [1, 3]) as i32);
    let lomax = move |x: f64| 1.0 - (1.0 + x / scale).powi(-k);
    let inversion = Inversion::new(lomax, POSITIVE).unwrap();
    let lomax = from_fn(move |rng| lomax(inversion.sample(rng)));
    rows.push(
        row(format!("F of Lomax's law {k}, {scale}"), lomax, 0.5, [0.0, 1.0], 600.0)
            .variance(1.0 / 12.0)
            .takes(1, 0)
            .cdf(|u| u.clamp(0.0, 1.0)),
    );
    for (which, name, cost) in [
        (0, "normal", 2500.0),
        (1, "Gamma", 12_000.0),
        (2, "Beta", 20_000.0),
        (3, "Weibull", 3000.0),
        (4, "Poisson", 5000.0),
        (5, "binomial", 8000.0),
    ] {
        let (a, b) = (pick.between(1.7, [1.0, 4.0]), pick.between(2.1, [0.5, 3.0]));
        let (cdf, support, mean, variance) = law(which, a, b);
        let inversion = Inversion::new(cdf, support).unwrap();
        // as far as the grid of uniform numbers goes
        let range = [0.5f64.powi(54), NEARLY_ONE].map(|u| inversion.inverse_cdf(u).unwrap());
        let range = [range[0].min(0.0), range[1]];
        let sampler = from_fn(move |rng| inversion.sample(rng));
        let known = row(format!("{name} {a}, {b} by inversion"), sampler, mean, range, cost)
            .variance(variance)
            .takes(1, 0)
            .cdf(law(which, a, b).0);
        rows.push(if which < 4 { known.smooth(1) } else { known });
    }
    rows
}
