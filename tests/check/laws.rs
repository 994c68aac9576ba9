//! Samplers against the laws claimed for them.

use proptest::prelude::*;
use rand::distr::Distribution;
use unbiased::check::{Agreement, distributed_as};
use unbiased::inversion::Exponential;
use unbiased::lambertian::hemisphere::{Direction, Hemisphere};
use unbiased::roulette::Roulette;
use unbiased::{Estimator, Stream, from_fn};

use crate::common;

/// Compares draws with a claimed law. A deviation of more than twice that allowed is missed with far less.
fn compared(draw: &dyn Estimator, cdf: impl Fn(f64) -> f64, deviation: f64, seed: u64) -> Agreement {
    common::alarm(ALPHA);
    distributed_as(draw, cdf, deviation, ALPHA, common::seed(seed)).unwrap()
}

/// The probability that one comparison calls a right sampler wrong.
const ALPHA: f64 = 1e-14;

#[test]
fn samplers_with_another_law_are_refused() {
    let exponential = Exponential::new(0.37).unwrap();
    let cdf = |x: f64| exponential.cdf(x);
    let end = exponential.inverse_cdf(0.98).unwrap();
    let roulette = Roulette::new(0.83).unwrap();
    let steps = |x: f64| if x < 0.0 { 0.0 } else { roulette.bounces().cdf(x as u64) };
    let bounces = roulette.bounces().by_inversion().unwrap();
    type Case<'a> = (&'a dyn Estimator, &'a dyn Fn(f64) -> f64, bool);
    let cases: [Case<'_>; 6] = [
        (&exponential, &cdf, true),
        // right mean, wrong law
        (&from_fn(|rng| 2.0 * rng.uniform() / 0.37), &cdf, false),
        // a tail cut where 2 % of the law is
        (&from_fn(move |rng| exponential.draw(rng).min(end)), &cdf, false),
        // jumps are compared at both sides of each
        (&bounces, &steps, true),
        (&from_fn(|rng| bounces.draw(rng) + 1.0), &steps, false),
        // spread between the integers: the left limits differ
        (&from_fn(|rng| bounces.draw(rng) + 0.999 * rng.uniform()), &steps, false),
    ];
    for (seed, (sampler, cdf, agrees)) in (100..).zip(cases) {
        let found = compared(sampler, cdf, 0.01, seed);
        assert_eq!(found.agrees, agrees, "{seed}: {found}");
    }
    // a NaN is no draw
    assert!(distributed_as(&from_fn(|_| f64::NAN), cdf, 0.1, 1e-12, 1).is_err());
}

/// As many draws as it takes, and none more, for a deviation to lie beyond the band of α and that of 1e-6
/// together; the strain is the deviation in bands.
#[test]
fn a_comparison_of_laws_takes_the_draws_that_its_deviation_needs() {
    let middle = from_fn(|_| 0.5);
    for (deviation, alpha) in [(0.01, 1e-12), (0.05, 1e-6), (0.3, 0.1)] {
        let found = distributed_as(&middle, |x| x.clamp(0.0, 1.0), deviation, alpha, 1).unwrap();
        let band = |n: usize, alpha: f64| ((2.0 / alpha).ln() / (2 * n) as f64).sqrt();
        let reach = |n: usize| band(n, alpha) + band(n, 2e-6);
        assert!(reach(found.draws) <= deviation && reach(found.draws - 1) > deviation, "{found:?}");
        let strain = 0.5 / band(found.draws, alpha);
        assert!((found.strain - strain).abs() <= 1e-12 * strain, "{found:?}");
    }
}

/// −0 and 0 are one value, and so are all draws that are infinite: whichever way they come, the law is the
/// same.
#[test]
fn draws_are_compared_as_numbers() {
    // (2u − 1).round() is −1, −0, 0 or 1; its law has jumps at −1, 0 and 1
    let rounded = from_fn(|rng| (2.0 * rng.uniform() - 1.0).round());
    let claimed = |x: f64| match x {
        x if x < -1.0 => 0.0,
        x if x < 0.0 => 0.25,
        x if x < 1.0 => 0.75,
        _ => 1.0,
    };
    let found = compared(&rounded, claimed, 0.01, 114);
    assert!(found.agrees, "{found}");
    let shifted = compared(&rounded, |x| claimed(x - 0.1), 0.01, 114);
    assert!(!shifted.agrees && shifted.place == "the cdf at 0.000000", "{shifted}");
    // an atom at 0 of either sign agrees without any deviation, and the place is a number
    for zero in [0.0, -0.0] {
        let found = compared(&from_fn(move |_| zero), |x| if x < 0.0 { 0.0 } else { 1.0 }, 0.1, 1);
        assert!(found.agrees && found.strain == 0.0 && found.place == "the cdf at 0.000000", "{found:?}");
    }
    // a quarter of the mass at each infinity, and a cdf that says so, or is NaN at +∞
    let far = from_fn(|rng| match rng.uniform() {
        u if u < 0.25 => f64::NEG_INFINITY,
        u if u < 0.75 => rng.uniform(),
        _ => f64::INFINITY,
    });
    let claimed = |x: f64| 0.25 + 0.5 * x.clamp(0.0, 1.0) + 0.0 * x.max(0.0);
    let found = compared(&far, claimed, 0.01, 115);
    assert!(found.agrees, "{found}");
    // without mass at infinity draws there are refused, though the cdf be NaN at −∞
    let never = |x: f64| x.clamp(0.0, 1.0) + 0.0 * x;
    let found = compared(&far, never, 0.01, 115);
    assert!(!found.agrees, "{found}");
    // all draws at +∞, all mass there
    let found = compared(&from_fn(|_| f64::INFINITY), |_| 0.0, 0.1, 1);
    assert!(found.agrees && found.strain == 0.0 && found.place == "the cdf at inf", "{found:?}");
    let found = compared(&from_fn(|_| f64::NEG_INFINITY), |_| 1.0, 0.1, 1);
    assert!(found.agrees && found.strain == 0.0 && found.place == "the cdf at -inf", "{found:?}");
}

proptest! {
    #![proptest_config(common::config(200))]

    /// Of any discrete law, a sampler that signs its zeros as it likes agrees, and one with 0.2 of the mass
    /// elsewhere does not: 0.1 is seen with probability 1 − 1e-6.
    #[test]
    fn any_law_on_integers_agrees_with_its_draws(weights in prop::collection::vec(0.1..1.0f64, 1..12),
        least in -12i32..1) {
        let total: f64 = weights.iter().sum();
        let value = |k: usize| f64::from(least) + k as f64;
        let sampler = from_fn(|rng| {
            let (mut left, sign) = (rng.uniform() * total, if rng.uniform() < 0.5 { -1.0 } else { 1.0 });
            let k = weights.iter().take_while(|w| { left -= **w; left >= 0.0 }).count();
            let x = value(k.min(weights.len() - 1));
            if x == 0.0 { 0.0 * sign } else { x }
        });
        let cdf = |x: f64| (0..weights.len()).filter(|k| value(*k) <= x).map(|k|
            weights[k] / total).sum::<f64>();
        let found = compared(&sampler, cdf, 0.1, 116);
        prop_assert!(found.agrees, "{}", found);
        let other = |x: f64| 0.8 * cdf(x) + if x < 20.0 { 0.0 } else { 0.2 };
        let found = compared(&sampler, other, 0.1, 116);
        prop_assert!(!found.agrees, "{}", found);
    }
}

/// Sums of weights 1/n, which end an ulp or a few from 1; with a thousandth more they are no cdf.
#[test]
fn a_cdf_may_leave_the_unit_interval_by_rounding() {
    let mut beyond = 0;
    for n in 2..100 {
        let mut sums = vec![1.0 / n as f64; n];
        for i in 1..n {
            sums[i] += sums[i - 1];
        }
        beyond += i32::from(sums[n - 1] > 1.0);
        let cdf = |x: f64| if x < 1.0 { -1e-16 } else { sums[(x as usize).min(n) - 1] };
        let die = from_fn(|rng| (n as f64 * rng.uniform()).floor() + 1.0);
        let found = compared(&die, cdf, 0.1, 113);
        assert!(found.agrees, "{n}: {found}");
        for cdf in [&|x: f64| 1.001 * cdf(x), &|x: f64| cdf(x) - 0.001] as [&dyn Fn(f64) -> f64; 2] {
            let error = distributed_as(&die, cdf, 0.1, 1e-12, 1).unwrap_err().to_string();
            assert!(error.starts_with("the claimed cdf must be in [0, 1], not "), "{error}");
        }
    }
    assert!(beyond > 0);
}

/// A sampler of directions that is wrong in a way.
struct Wrong(Draw);

type Draw = fn(&mut Stream) -> Direction;

impl Distribution<Direction> for Wrong {
    fn sample<R: rand::Rng + ?Sized>(&self, rng: &mut R) -> Direction {
        (self.0)(&mut Stream::new(rng.next_u64(), rng.next_u64()))
    }
}

#[test]
fn directions_of_another_density_are_refused() {
    use Hemisphere::{Cosine, Uniform};
    fn toward(u: f64, turn: f64) -> Direction {
        Direction::polar((1.0 - u).sqrt(), std::f64::consts::TAU * turn).unwrap()
    }
    let cases: [(Draw, Hemisphere, bool); 7] = [
        (|rng| Uniform.sample(rng), Uniform, true),
        (|rng| Cosine.sample(rng), Cosine, true),
        (|rng| Uniform.sample(rng), Cosine, false),
        (|rng| Cosine.sample(rng), Uniform, false),
        // half of the azimuths
        (|rng| toward(rng.uniform(), 0.5 * rng.uniform()), Cosine, false),
        // one uniform number for both, in all draws or in one of two: only the cells see it
        (|rng| toward(rng.clone().uniform(), rng.uniform()), Cosine, false),
        (
            |rng| {
                let (u, v) = (rng.uniform(), rng.uniform());
                toward(u, if rng.uniform() < 0.5 { u } else { v })
            },
            Cosine,
            false,
        ),
    ];
    for (seed, (draw, claimed, agrees)) in (120..).zip(cases) {
        common::alarm(ALPHA);
        let found = common::directions(&Wrong(draw), claimed, 0.02, ALPHA, common::seed(seed)).unwrap();
        assert_eq!(found.agrees, agrees, "{seed}: {found}");
        let diagonal = (0..8).any(|row| found.place.starts_with(&format!("the cell ({row}, {})", 7 - row)));
        assert!(seed < 125 || diagonal, "{seed}: {found}");
    }
}

/// The band of DKW and the cells together: 300 right samplers at α = 0.3 and pinned seeds.
#[test]
fn right_samplers_are_refused_no_more_often_than_claimed() {
    let exponential = Exponential::new(0.37).unwrap();
    let mut refused = [0, 0];
    for seed in 0..300 {
        let seed = 5000 + seed;
        refused[0] +=
            i32::from(!distributed_as(&exponential, |x| exponential.cdf(x), 0.1, 0.3, seed).unwrap().agrees);
        refused[1] += i32::from(
            !common::directions(&Hemisphere::Cosine, Hemisphere::Cosine, 0.1, 0.3, seed).unwrap().agrees,
        );
    }
    println!("refused at α = 0.3: {refused:?} of 300");
    assert!(refused.iter().all(|&count| count <= 90), "{refused:?}");
    assert!(refused[0] >= 10, "the band is never reached: {refused:?}");
}

#[test]
fn an_agreement_is_a_sentence() {
    let found =
        common::directions(&Hemisphere::Uniform, Hemisphere::Cosine, 0.1, 1e-6, 1).unwrap().to_string();
    assert!(found.starts_with("distributed not as claimed") && found.contains("not seen:"), "{found}");
}
