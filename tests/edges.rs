//! Every domain edge: any bits give a result or a typed error, never NaN out of valid input; monotone where
//! the mathematics is, in range where it is, and back again where it leads back. And samplers on generators
//! that are stuck at one word.

mod common;

use std::f64::consts::{FRAC_1_PI, PI, TAU};

use common::{NEARLY_ONE, Stuck, any_number, config, probability, ulps, ulps_off_unit};
use proptest::prelude::*;
use rand::distr::Distribution;
use unbiased::inversion::{Exponential, Inversion};
use unbiased::lambertian::hemisphere::{Direction, Hemisphere};
use unbiased::lambertian::{CosinePower, Lambertian, Light, RingLight};
use unbiased::rectangle::Rectangle;
use unbiased::roulette::{LightModel, Roulette};
use unbiased::{Budget, Density, Error, Estimate, Run, Stream, estimate, f_over_p, from_fn};

proptest! {
    #![proptest_config(config(20_000))]

    #[test]
    fn the_exponential_rises_and_comes_back(
        rate in any_number(), x in any_number(), y in any_number(), u in probability(), v in probability()
    ) {
        let Ok(law) = Exponential::new(rate) else { return Ok(()) };
        prop_assert!(law.mean() > 0.0 && law.variance() >= 0.0);
        let pairs = [(x, y), (y, x), (x, x.next_up()), (y.next_down(), y)];
        for (x, y) in pairs.into_iter().filter(|(x, y)| x <= y) {
            prop_assert!((0.0..=1.0).contains(&law.cdf(x)) && (0.0..=1.0).contains(&law.survival(x)));
            prop_assert!((0.0..=rate).contains(&law.pdf(x)));
            prop_assert!(law.cdf(x) <= law.cdf(y), "F({x:?}) > F({y:?})");
            // both are made of e^(−λx) and a correction for the rounding of λx, so neighbours may lie an ulp
            // the wrong way
            let falls = |from: f64, to: f64| from >= to || ulps(from, to) <= 1;
            prop_assert!(falls(law.survival(x), law.survival(y)), "S({x:?}) < S({y:?})");
            prop_assert!(x < 0.0 || falls(law.pdf(x), law.pdf(y)), "p({x:?}) < p({y:?})");
        }
        for (u, v) in [(u, v), (v, u), (u, u.next_up().min(1.0))].into_iter().filter(|(u, v)| u <= v) {
            prop_assert!(law.inverse_cdf(u)? <= law.inverse_cdf(v)?);
        }
        // dF/F = λx e^(−λx)/(1 − e^(−λx)) · dx/x: the condition number is at most 1, and only a subnormal or
        // infinite x has not the digits
        let x = law.inverse_cdf(u)?;
        if x.is_normal() {
            prop_assert!(ulps(law.cdf(x), u) <= 2, "F(F⁻¹({u:?})) = {:?}", law.cdf(x));
        }
    }

    /// In f32: 1 − u is exact on the grid k·2⁻²⁴, so the sample is the inverse at u, rounded; never NaN, and
    /// infinite only beyond f32.
    #[test]
    fn f32_samples_are_the_inverse(rate in any_number(), word in any::<u64>(), other in any::<u64>()) {
        let Ok(law) = Exponential::new(rate) else { return Ok(()) };
        let sample = |word: u64| -> f32 { law.sample(&mut Stuck(word)) };
        let u = |word: u64| (word >> 40) as f64 / f64::from(1 << 24);
        for word in [word, word & 0xff << 40, word | !0 << 44] {
            let truth = law.inverse_cdf(u(word))?;
            let found = f64::from(sample(word));
            // ln in f32 is off by an ulp at most, and the quotient rounds once more
            let close = (found - truth).abs() <=
                2.0 * f64::from(f32::EPSILON) * truth + f64::from(f32::from_bits(1));
            prop_assert!(close || found.is_infinite() && truth * (1.0 + 1e-6) > f64::from(f32::MAX),
                "{found:?}, not {truth:?}");
            prop_assert!(u(word) > u(other) || found <= f64::from(sample(other)));
        }
    }

    #[test]
    fn bounces_rise_and_stay_in_range(p in probability(), k in any::<u64>(), small in 0u64..100,
        u in probability(), v in probability()) {
        let Ok(law) = Roulette::new(p).map(|roulette| roulette.bounces()) else { return Ok(()) };
        prop_assert!(law.mean() >= 0.0 && law.variance() >= 0.0);
        for k in [k, k >> 11, small, 1 << 53, u64::MAX - 1] {
            for next in [k + 1, k.saturating_add(small)] {
                prop_assert!(law.cdf(k) <= law.cdf(next), "cdf({k}), cdf({next})");
                prop_assert!(law.survival(k) >= law.survival(next), "survival({k}), survival({next})");
                prop_assert!(law.pmf(k) >= law.pmf(next), "pmf({k}), pmf({next})");
            }
            for value in [law.pmf(k), law.cdf(k), law.survival(k)] {
                prop_assert!((0.0..=1.0).contains(&value));
            }
            prop_assert!((law.cdf(k) + law.survival(k) - 1.0).abs() <= 2.0 * f64::EPSILON);
        }
        for (u, v) in [(u, v), (v, u)].into_iter().filter(|(u, v)| u <= v) {
            prop_assert!(law.quantile(u)? <= law.quantile(v)?);
        }
        // the smallest k whose cdf reaches u, and back again wherever the cdf still rises
        let quantile = law.quantile(u)?;
        if u < 1.0 && p < 1.0 {
            prop_assert!(law.cdf(quantile) >= u && (quantile == 0 || law.cdf(quantile - 1) < u));
        }
        let reached = law.cdf(small);
        if reached < 1.0 && (small == 0 || law.cdf(small - 1) < reached) {
            prop_assert_eq!(law.quantile(reached)?, small);
        }
    }

    #[test]
    fn directions_are_units_above_the_horizon(u in probability(), v in probability(), w in probability()) {
        for hemisphere in Hemisphere::ALL {
            let direction = hemisphere.direction_of(u, v)?;
            prop_assert!(ulps_off_unit(&direction) <= 2.0, "{}", ulps_off_unit(&direction));
            let cos = direction.cos_theta();
            prop_assert!((0.0..=1.0).contains(&cos) && (cos > 0.0 || u == 1.0));
            prop_assert!((0.0..=1.0 + f64::EPSILON).contains(&direction.sin_theta()));
            prop_assert!((0.0..=PI / 2.0).contains(&direction.theta())
                && (0.0..TAU).contains(&direction.phi()));
            prop_assert!((u > w) || cos >= hemisphere.direction_of(w, v)?.cos_theta());
        }
    }

    #[test]
    fn any_bits_make_a_direction_or_an_error(x in any_number(), y in any_number(), z in any_number()) {
        if let Ok(direction) = Direction::new(x, y, z) {
            prop_assert!(ulps_off_unit(&direction) <= 2.0);
            prop_assert_eq!(direction.cos_theta().is_sign_negative(), z.is_sign_negative());
            prop_assert!((0.0..TAU).contains(&direction.phi()) && (0.0..=PI).contains(&direction.theta()));
            for hemisphere in Hemisphere::ALL {
                prop_assert!((0.0..=FRAC_1_PI).contains(&hemisphere.pdf(&direction)));
            }
        } else {
            prop_assert!(![x, y, z].iter().all(|x| x.is_finite()) || [x, y, z] == [0.0; 3]);
        }
    }

    #[test]
    fn any_angles_make_a_unit_or_an_error(cos in any_number(), phi in any_number()) {
        let Ok(direction) = Direction::polar(cos, phi) else {
            prop_assert!(!((-1.0..=1.0).contains(&cos) && phi.is_finite()));
            return Ok(());
        };
        prop_assert!(ulps_off_unit(&direction) <= 2.0);
        prop_assert_eq!(direction.cos_theta(), cos);
        prop_assert!((0.0..=PI).contains(&direction.theta()) && (0.0..TAU).contains(&direction.phi()));
    }

    /// Points rise with u and v and stay inside, whatever the ends, and a point is drawn with the density
    /// that it has.
    #[test]
    fn points_rise_and_stay_inside(a in any_number(), b in any_number(), u in probability(),
        v in probability()) {
        let (low, high) = (a.min(b), a.max(b));
        let Ok(rectangle) = Rectangle::new([low, high], [0.0, 1.0 / (high - low)]) else { return Ok(()) };
        let at = |u: f64, v: f64| rectangle.sample(&mut Stream::scripted(&[u, v]));
        let ([x, y], [to_x, to_y]) = (at(u, v), at(v, u));
        prop_assert!((low..=high).contains(&x) && (low..=high).contains(&to_x));
        prop_assert!((u > v || x <= to_x) && (v > u || to_x <= x) && (v > u || y <= to_y));
        prop_assert_eq!(at(0.0, 0.0), [low, 0.0]);
        prop_assert_eq!(rectangle.pdf(&[x, y]), 1.0 / rectangle.area());
    }

    #[test]
    fn light_grows_with_albedo_and_with_vertices(
        rho in probability(), more in probability(), v in probability(), k in 0u64..=1_000_000_000,
        a in any_number(), w in probability(), q in probability(),
    ) {
        let (rho, more) = (rho.min(more), rho.max(more));
        if let (Ok(dark), Ok(bright)) = (LightModel::new(rho, v), LightModel::new(more, v)) {
            prop_assert!(0.0 <= dark.mean() && dark.mean() <= bright.mean());
            prop_assert!((rho..=1.0).contains(&dark.optimum()));
            let [short, long] = [k / 2, k].map(|k| dark.truncated(k));
            let (short, long) = (short?, long?);
            prop_assert!(short.mean() <= long.mean() && long.mean() <= dark.mean());
            prop_assert!(short.bias() <= long.bias() && long.bias() <= 0.0);
            prop_assert!(0.0 <= short.variance() && short.variance() <= long.variance());
            prop_assert!(long.mean() <= bright.truncated(k)?.mean() && short.cost() >= 1.0);
            if let Ok(paths) = dark.roulette(q) {
                prop_assert!(paths.variance() >= 0.0 && paths.cost() >= 1.0 && dark.crossing(q, k)? >= 0.0);
                if a > 0.0 && a.is_finite() {
                    prop_assert!(paths.mean_square_error(a)? >= 0.0 && long.mean_square_error(a)? >= 0.0);
                }
            }
        }
        let (dark, bright) = (Lambertian::new(rho)?, Lambertian::new(more)?);
        prop_assert!(0.0 <= dark.brdf() && dark.brdf() <= bright.brdf());
        prop_assert!(dark.reflected(w) <= bright.reflected(w));
        let mut lights: Vec<Box<dyn Light>> = vec![];
        lights.extend(CosinePower::new(a).map(|light| Box::new(light) as Box<dyn Light>));
        lights.extend(RingLight::new(w).map(|light| Box::new(light) as Box<dyn Light>));
        for light in lights {
            prop_assert!(0.0 <= light.reflected(dark) && light.reflected(dark) <= light.reflected(bright));
            prop_assert!(light.reflected(bright) < f64::INFINITY);
            prop_assert!(light.incoming(&Direction::polar(w, v)?) >= 0.0);
            for hemisphere in Hemisphere::ALL {
                let [dark, bright] = [dark, bright].map(|surface| light.variance(surface, hemisphere));
                prop_assert!(0.0 <= dark && dark <= bright);
            }
        }
    }
}

proptest! {
    #![proptest_config(config(4_000))]

    /// The bisection's answer is the least number that reaches u, for any rate and any bits of u.
    #[test]
    fn any_cdf_is_inverted_to_the_last_bit(rate in any_number(), u in probability(), v in probability()) {
        let Ok(law) = Exponential::new(rate) else { return Ok(()) };
        let inversion = Inversion::new(|x| law.cdf(x), [f64::NEG_INFINITY, f64::INFINITY])?;
        let (x, y) = (inversion.inverse_cdf(u)?, inversion.inverse_cdf(v)?);
        prop_assert!(u == 0.0 || law.cdf(x) >= u && law.cdf(x.next_down()) < u, "F⁻({u:?}) = {x:?}");
        prop_assert!((u > v || x <= y) && (v > u || y <= x));
    }

    /// The mean of finite draws lies between the least and the greatest, exactly, however they are merged;
    /// intervals hold the mean.
    #[test]
    fn estimates_stay_in_range(draws in prop::collection::vec(any_number(), 1..700), split in 0usize..700,
        level in probability()) {
        let (left, right) = draws.split_at(split.min(draws.len()));
        let mut merged = Estimate::from_draws(left);
        merged.merge(&Estimate::from_draws(right));
        if draws.iter().any(|draw| !draw.is_finite()) {
            prop_assert!(!merged.mean().is_finite());
        }
        let finite: Vec<f64> = draws.into_iter().filter(|draw| draw.is_finite()).collect();
        let (left, right) = finite.split_at(split.min(finite.len()));
        let mut merged = Estimate::from_draws(right);
        merged.merge(&Estimate::from_draws(left));
        let least = finite.iter().copied().fold(f64::INFINITY, f64::min);
        let greatest = finite.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        prop_assume!(!finite.is_empty());
        for estimate in [merged, Estimate::from_draws(&finite)] {
            let mean = estimate.mean();
            prop_assert!(least <= mean && mean <= greatest, "{mean:?}");
            if finite.len() == 1 {
                prop_assert!(estimate.variance().is_none() && estimate.std_error().is_none()
                    && estimate.z(mean).is_none());
                continue;
            }
            // s² ≤ (range)²/4 · n/(n − 1)
            let half = greatest / 2.0 - least / 2.0;
            let most = half / ((finite.len() - 1) as f64).sqrt() * (1.0 + 1e-15);
            prop_assert!((0.0..=most).contains(&estimate.std_error().unwrap_or(f64::NAN)), "{estimate:?}");
            prop_assert!(estimate.variance().unwrap_or(f64::NAN) >= 0.0);
            match estimate.confidence_interval(level) {
                Ok([low, high]) => prop_assert!(low <= mean && mean <= high, "{low:?} {mean:?} {high:?} at \
                    {level:?}"),
                Err(_) => prop_assert!(level == 0.0 || level == 1.0),
            }
        }
    }

    #[test]
    fn a_scripted_stream_stays_on_the_grid(uniforms in prop::collection::vec(any_number(), 0..9)) {
        let mut rng = Stream::scripted(&uniforms);
        let mut filled = vec![0.5; 12];
        common::fill_uniform(&mut Stream::scripted(&uniforms), &mut filled);
        for (i, filled) in filled.into_iter().enumerate() {
            let u = rng.uniform();
            prop_assert_eq!(u, filled);
            prop_assert!((0.0..1.0).contains(&u) && (u * 2f64.powi(53)).fract() == 0.0);
            let given = uniforms.get(i).copied().unwrap_or(0.0);
            if (0.0..1.0).contains(&given) {
                prop_assert!(u <= given && given - u < 2f64.powi(-53));
            }
        }
        prop_assert_eq!(rng.random_numbers(), 12);
    }
}

proptest! {
    #![proptest_config(config(400))]

    /// A budget of any bits ends soon, with an estimate or an error.
    #[test]
    fn any_budget_ends(target in any_number(), max_draws in prop_oneof![0u64..100_000, 0..3u64],
        draws in 0u64..3, seed in any::<u64>()) {
        let uniform = from_fn(|rng| rng.uniform());
        let run = Run::new(seed).max_draws(max_draws);
        for budget in [Budget::StdError(target), Budget::RelativeError(target), Budget::Draws(draws)] {
            match run.estimate(&uniform, budget) {
                Ok(outcome) => {
                    let mean = outcome.estimate.mean();
                    prop_assert!((0.0..1.0).contains(&mean) && outcome.estimate.draws() <= max_draws.max(2));
                }
                Err(Error::Count { value, .. }) => prop_assert_eq!(value, 0),
                Err(Error::Parameter { .. }) => prop_assert!(target.is_nan() || target <= 0.0),
                Err(Error::Budget { needed, limit, .. }) => prop_assert!(needed > limit as f64),
                Err(other) => prop_assert!(false, "{other}"),
            }
        }
    }

    /// f(X)/p(X) of any bits is that, and what is not finite ends a run with an error.
    #[test]
    fn a_ratio_of_any_bits_is_a_number_or_an_error(f in any_number(), seed in any::<u64>()) {
        let constant = f_over_p(|_| f, Rectangle::WORKSHEET);
        let value = f / (1.0 / 16.0);
        match estimate(&constant, Budget::Draws(600), seed) {
            Ok(estimate) => prop_assert!(value.is_finite() && estimate.mean() == value),
            Err(Error::Draw { value: draw, draw: 0, block: 0,
                .. }) => prop_assert!(!value.is_finite() && !draw.is_finite()),
            Err(other) => prop_assert!(false, "{other}"),
        }
    }
}

// ---- generators that are stuck ----

/// The rates at which 53 ln 2/λ just fits into f64, and into f32.
const LOWEST_RATES: [f64; 2] = [2.0436e-307, 4.889e-38];

/// At the ends of what a sampler takes: all zeros, all ones, every single bit, and all but one. Others are in
/// the table of tests/estimators.rs.
#[test]
fn stuck_generators_give_finite_samples() {
    let everywhere = [f64::NEG_INFINITY, f64::INFINITY];
    let weibull = Inversion::new(|x: f64| -(-x.max(0.0).sqrt()).exp_m1(), everywhere).unwrap();
    let cauchy = Inversion::new(|x: f64| (0.5 + x.atan() / PI).clamp(0.0, 1.0), everywhere).unwrap();
    let coin = |p: f64, rng: &mut Stuck| Roulette::new(p).unwrap().continues(rng);
    for word in (0..64).flat_map(|bit| [1 << bit, !(1 << bit)]).chain([0, u64::MAX]) {
        let mut rng = Stuck(word);
        for rate in [LOWEST_RATES[0], f64::MAX] {
            let x: f64 = Exponential::new(rate).unwrap().sample(&mut rng);
            assert!(x.is_finite() && x >= 0.0, "{x:?} of {word:#x} at λ = {rate:?}");
        }
        for rate in [LOWEST_RATES[1], f64::MAX] {
            let x: f32 = Exponential::new(rate).unwrap().sample(&mut rng);
            assert!(x.is_finite() && x >= 0.0, "{x:?} of {word:#x} at λ = {rate:?}");
        }
        // a support without ends, whose F⁻(0) is −∞: the least is drawn with 2⁻⁵³
        for x in [weibull.sample(&mut rng), cauchy.sample(&mut rng)] {
            assert!(x.is_finite(), "{x:?} of {word:#x}");
        }
        // a coin asks on only where U is the last point of the grid below p, 1074/53 times at most
        for p in [f64::from_bits(1), 1e-300, 0.1, 0.5, NEARLY_ONE] {
            coin(p, &mut rng);
        }
    }
    // all ones end a path of any p below 1, all zeros never do: n bounces have probability pⁿ
    assert!(!coin(NEARLY_ONE, &mut Stuck(u64::MAX)) && coin(f64::from_bits(1), &mut Stuck(0)));
    let simulated = Roulette::new(NEARLY_ONE).unwrap().bounces().by_simulation().unwrap();
    assert_eq!(simulated.sample(&mut Stuck(u64::MAX)), 0);
}
