//! Every domain edge: any bits give a result or a typed error, never NaN out of valid input; monotone where
//! the mathematics is, in range where it is, and back again where it leads back. And samplers on generators
//! that are stuck at one word.
//!
//! What the tests of a module hold already is not repeated here.

mod common;

use std::f64::consts::{PI, TAU};

use common::{NEARLY_ONE, Stuck, config, probability, ulps, ulps_off_unit};
use glam::DVec3;
use proptest::prelude::*;
use proptest::sample::select;
use rand::distr::Distribution;
use unbiased::inversion::{Exponential, Inversion};
use unbiased::lambertian::hemisphere::{Direction, Hemisphere};
use unbiased::lambertian::{CosinePower, Lambertian, Light, RingLight};
use unbiased::paths::room::{BoxRoom, Face, Scene, Vertex, form_factor, nearest_hit, visible};
use unbiased::paths::{Bounces, FindLight, Paths};
use unbiased::rectangle::Rectangle;
use unbiased::roulette::{LightModel, Roulette};
use unbiased::{Budget, Density, Error, Estimate, Estimator, Run, Stream, estimate, f_over_p, from_fn};

/// Any bits, numbers of every size, and the edges themselves with their neighbours.
fn any_number() -> impl Strategy<Value = f64> {
    let edges = [0.0, -0.0, 0.25, 0.5, 1.0, 2.0, f64::MIN_POSITIVE, f64::MAX, f64::INFINITY, f64::NAN];
    let neighbours = edges.into_iter().flat_map(|x: f64| [x, x.next_up(), x.next_down(), -x]);
    prop_oneof![
        any::<u64>().prop_map(f64::from_bits),
        (-320.0..308.0f64).prop_map(|power| 10f64.powf(power)),
        -3.0..3.0f64,
        select(neighbours.collect::<Vec<f64>>()),
    ]
}

proptest! {
    #![proptest_config(config(20_000))]

    #[test]
    fn the_exponential_rises_and_comes_back(
        rate in any_number(), x in any_number(), y in any_number(), u in probability(), v in probability()
    ) {
        let Ok(law) = Exponential::new(rate) else { return Ok(()) };
        let pairs = [(x, y), (y, x), (x, x.next_up()), (y.next_down(), y)];
        for (x, y) in pairs.into_iter().filter(|(x, y)| x <= y) {
            prop_assert!(law.cdf(x) <= law.cdf(y), "F({x:?}) > F({y:?})");
            // both are made of e^(−λx) and a correction for the rounding of λx, so neighbours may lie an ulp
            // the wrong way
            let falls = |from: f64, to: f64| from >= to || ulps(from, to) <= 1;
            prop_assert!(falls(law.survival(x), law.survival(y)), "S({x:?}) < S({y:?})");
            prop_assert!(x < 0.0 || falls(law.pdf(x), law.pdf(y)), "p({x:?}) < p({y:?})");
        }
        for (u, v) in [(u, v), (v, u), (u, u.next_up().min(1.0))].into_iter().filter(|(u, v)| u <= v) {
            prop_assert!(law.inverse_cdf(u)? <= law.inverse_cdf(v)?);
            prop_assert!(law.inverse_survival(u)? >= law.inverse_survival(v)?);
        }
        // dF/F = λx e^(−λx)/(1 − e^(−λx)) · dx/x: the condition number is at most 1, and only a subnormal or
        // infinite x has not the digits
        let x = law.inverse_cdf(u)?;
        if x.is_normal() {
            prop_assert!(ulps(law.cdf(x), u) <= 2, "F(F⁻¹({u:?})) = {:?}", law.cdf(x));
        }
        // dS/S = −λx · dx/x, so every ulp of x costs |ln u| ulp of u: 2 ulp where u ≥ 1/e, and as many more
        // elsewhere
        let x = law.inverse_survival(u)?;
        if x.is_normal() {
            prop_assert!(ulps(law.survival(x), u) as f64 <= 2.0 + 2.0 * u.ln().abs(), "S(S⁻¹({u:?})) = \
                {:?}", law.survival(x));
        }
        prop_assert_eq!(law.inverse_survival(rate).is_ok(), (0.0..=1.0).contains(&rate));
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
        let Ok(law) = Roulette::new(p) else { return Ok(()) };
        for k in [k, k >> 11, small, 1 << 53, u64::MAX - 1] {
            for next in [k + 1, k.saturating_add(small)] {
                prop_assert!(law.bounces().cdf(k) <= law.bounces().cdf(next), "cdf({k}), cdf({next})");
                prop_assert!(law.bounces().survival(k) >= law.bounces().survival(next), "survival({k}), \
                    survival({next})");
                prop_assert!(law.bounces().pmf(k) >= law.bounces().pmf(next), "pmf({k}), pmf({next})");
            }
            for value in [law.bounces().pmf(k), law.bounces().cdf(k), law.bounces().survival(k)] {
                prop_assert!((0.0..=1.0).contains(&value));
            }
            prop_assert!((law.bounces().cdf(k) + law.bounces().survival(k) - 1.0).abs() <=
                2.0 * f64::EPSILON);
        }
        for (u, v) in [(u, v), (v, u)].into_iter().filter(|(u, v)| u <= v) {
            prop_assert!(law.bounces().quantile(u)? <= law.bounces().quantile(v)?);
        }
        // the quantile leads back to u up to a step, 2 ulp being the cdf's own
        let k = law.bounces().quantile(u)?;
        if k > 0 && k < u64::MAX {
            prop_assert!(law.bounces().cdf(k) >= u && law.bounces().cdf(k - 1) < u);
        }
        prop_assert_eq!(law.bounces().quantile(p + u).is_ok(), (0.0..=1.0).contains(&(p + u)));
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
            let other = hemisphere.direction_of(w, v)?;
            prop_assert!((u > w) || cos >= other.cos_theta());
            // P(cos θ ≤ c) of the cos θ drawn from u is 1 − u, to the rounding of 1 − u and of the root
            let back = hemisphere.cdf_of_cos_theta(cos);
            prop_assert!(ulps(back, 1.0 - u) <= 2, "{back:?} {u:?}");
            // u comes back from sin θ or from cos θ, wherever those have digits: sin θ is good to 2 ulp and
            // its square is good to 5, and beyond the middle to the last place of 1
            let [u_back, _] = hemisphere.uniforms_of(&direction)?;
            prop_assert!(ulps(u_back, u) <= 6 || (u_back - u).abs() <= 4.0 * f64::EPSILON * cos, "{u_back:?} \
                {u:?}");
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
            a in any_number(), w in probability()
    ) {
        let (rho, more) = (rho.min(more), rho.max(more));
        if let (Ok(dark), Ok(bright)) = (LightModel::new(rho, v), LightModel::new(more, v)) {
            prop_assert!(dark.mean() <= bright.mean());
            let [short, long] = [k / 2, k].map(|k| dark.truncated(k));
            let (short, long) = (short?, long?);
            prop_assert!(short.mean() <= long.mean() && long.mean() <= dark.mean());
            prop_assert!(short.bias() <= long.bias() && short.variance() <= long.variance());
            prop_assert!(long.mean() <= bright.truncated(k)?.mean());
        }
        let (dark, bright) = (Lambertian::new(rho)?, Lambertian::new(more)?);
        prop_assert!(dark.brdf() <= bright.brdf() && dark.reflected(w) <= bright.reflected(w));
        let mut lights: Vec<Box<dyn Light>> = vec![];
        lights.extend(CosinePower::new(a).map(|light| Box::new(light) as Box<dyn Light>));
        lights.extend(RingLight::new(w).map(|light| Box::new(light) as Box<dyn Light>));
        for light in lights {
            prop_assert!(light.reflected(dark) <= light.reflected(bright));
            for hemisphere in Hemisphere::ALL {
                prop_assert!(light.variance(dark, hemisphere) <= light.variance(bright, hemisphere));
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

// ---- the box room ----

fn any_point() -> impl Strategy<Value = [f64; 3]> {
    let on_a_face = (select(Face::ALL.to_vec()), probability(), probability(), probability());
    let on_a_face = on_a_face.prop_map(|(face, u, v, w)| {
        let [low, high] = face.bounds();
        // the far end as it is, not to rounding
        (low + (high - low) * DVec3::new(u, v, w)).min(high).to_array()
    });
    prop_oneof![4 => on_a_face, 1 => prop::array::uniform3(any_number())]
}

/// Any bits, or a number that is allowed.
fn mostly(allowed: impl Strategy<Value = f64> + 'static) -> impl Strategy<Value = f64> {
    prop_oneof![9 => allowed, 1 => any_number()]
}

/// 0, or anything from 1e-100 to 1e100.
fn radiance() -> impl Strategy<Value = f64> {
    mostly(prop_oneof![
        1 => select(vec![0.0, -0.0, 1e-100, 1e100]),
        3 => (-100.0..100.0f64).prop_map(|power| 10f64.powf(power)),
    ])
}

fn any_scene() -> impl Strategy<Value = Scene> {
    let half_width = mostly(prop_oneof![
        0.0..=2.0f64,
        (-50.0..0.3f64).prop_map(|power| 10f64.powf(power)),
        select(vec![0.0, 1e-50, 2.0, 2f64.next_down()]),
    ]);
    let numbers = (mostly(probability()), mostly(probability()), radiance(), half_width, radiance());
    (numbers, any_point()).prop_map(|(numbers, point)| {
        let (wall_albedo, cube_albedo, radiance, light_half_width, emission) = numbers;
        Scene { wall_albedo, cube_albedo, radiance, light_half_width, emission, point }
    })
}

fn any_bounces() -> impl Strategy<Value = Bounces> {
    let q = prop_oneof![probability(), any_number(), 0.0..1.0f64];
    prop_oneof![
        (0..70u32).prop_map(Bounces::Exactly),
        (0..70u32).prop_map(Bounces::UpTo),
        q.prop_map(Bounces::All),
        Just(Bounces::AllByThroughput),
        any::<u32>().prop_map(Bounces::UpTo),
    ]
}

fn is_a_radiance(value: f64) -> bool {
    value == 0.0 || (1e-100..=1e100).contains(&value)
}

proptest! {
    #![proptest_config(config(1_500))]

    /// A scene of any bits is an error that is true, or a room in which every draw of every way is a number,
    /// in `f32` too.
    #[test]
    fn any_scene_is_lit_or_an_error(
        scene in any_scene(), bounces in any_bounces(), seed in any::<u64>(),
        directions in select(Hemisphere::ALL.to_vec()), light in select(FindLight::ALL.to_vec())
    ) {
        let sound = [scene.wall_albedo, scene.cube_albedo].iter().all(|albedo| (0.0..=1.0).contains(albedo))
            && is_a_radiance(scene.radiance)
            && is_a_radiance(scene.emission)
            && (scene.light_half_width == 0.0 || (1e-50..=2.0).contains(&scene.light_half_width));
        let room = match BoxRoom::new(scene) {
            Ok(room) => room,
            Err(Error::Parameter { .. }) => {
                prop_assert!(!sound);
                return Ok(());
            }
            Err(Error::Point { .. }) => {
                // a face's own points are its own, but for the light's and those under the cube
                let [x, y, z] = scene.point;
                let faces = Face::ALL.iter().filter(|face| {
                    let [low, high] = face.bounds();
                    DVec3::from_array(scene.point).cmpge(low).all()
                        && DVec3::from_array(scene.point).cmple(high).all()
                });
                let hole = if z == 0.0 { 0.5 } else { scene.light_half_width };
                prop_assert!(sound && (faces.count() == 0 || x.abs().max(y.abs()) <= hole));
                return Ok(());
            }
            Err(other) => return Err(TestCaseError::fail(format!("{other}"))),
        };
        prop_assert!(sound);
        let p = room.point();
        let most = scene.radiance * room.albedo(&p);
        for known in [room.direct(&p), room.one_bounce()] {
            prop_assert!((0.0..=most).contains(&known), "{known:?} of {scene:?}");
        }
        prop_assert!(room.one_bounce() <= room.direct(&p));
        // where the rule's cells shrink it takes its time
        if scene.light_half_width < 1.0 {
            let two = room.two_bounces();
            prop_assert_eq!(two.is_some(), p.face() == Face::CubeTop);
            prop_assert!(two.is_none_or(|two| (0.0..=most * scene.wall_albedo).contains(&two)), "{two:?} of \
                {scene:?}");
        }
        let paths = match Paths::new(room, bounces, directions, light) {
            Ok(paths) => paths,
            Err(Error::Count { value, .. }) => {
                prop_assert!(value > 64);
                return Ok(());
            }
            Err(Error::Parameter { value, .. }) => {
                match bounces {
                    Bounces::All(q) => prop_assert!(!(q > 0.0 && q <= 0.9999)),
                    Bounces::AllByThroughput => prop_assert!(value > 0.999),
                    other => prop_assert!(false, "{other:?}"),
                }
                return Ok(());
            }
            Err(other) => return Err(TestCaseError::fail(format!("{other}"))),
        };
        prop_assert!(paths.doubt().map(|doubt| doubt.to_string()).is_none_or(|caution|
            !caution.contains("NaN")
            && !caution.contains("inf ")), "{:?}", paths.doubt());
        let mut rng = Stream::new(seed, 0);
        let mut draws = [f64::NAN; 40];
        paths.fill(&mut rng, &mut draws);
        let drawn: Vec<f64> = (0..4).map(|_| paths.draw(&mut rng)).collect();
        prop_assert!(draws.iter().chain(&drawn).all(|draw| *draw >= 0.0 && draw.is_finite()), "{draws:?} \
            {drawn:?} of \
            {paths:?}");
        match paths.in_f32() {
            Ok(single) => {
                let mut in_f32 = [f64::NAN; 40];
                single.fill(&mut rng, &mut in_f32);
                prop_assert!(in_f32.iter().all(|draw| *draw >= 0.0 && draw.is_finite()), "{in_f32:?} of \
                    {single:?}");
                // where every draw finds something, it does in f32
                let always = |draws: &[f64]| draws.iter().all(|draw| *draw > 0.0);
                prop_assert!(!always(&draws) || in_f32.iter().any(|draw| *draw > 0.0), "{in_f32:?} of \
                    {single:?}");
            }
            Err(Error::Parameter { .. }) => {}
            Err(other) => return Err(TestCaseError::fail(format!("{other}"))),
        }
    }
}

proptest! {
    #![proptest_config(config(20_000))]

    /// From a point of any bits to a point of any bits, and through a polygon of any bits.
    #[test]
    fn any_ray_ends_on_a_face_or_has_no_direction(
        point in any_point(), way in prop::array::uniform3(any_number()), to in any_point(),
        corners in prop::collection::vec(prop::array::uniform3(any_number()), 0..6)
    ) {
        let Ok(from) = Vertex::at(point) else { return Ok(()) };
        let direction = DVec3::from_array(way);
        match nearest_hit(&from, direction) {
            Some(hit) => {
                prop_assert!(direction.is_finite() && from.normal().dot(direction) >= 0.0);
                let [low, high] = hit.face().bounds();
                prop_assert!(hit.position().cmpge(low).all() && hit.position().cmple(high).all(), "{hit:?}");
            }
            None => prop_assert!(!direction.is_finite() || direction == DVec3::ZERO
                || from.normal().dot(direction) < 0.0),
        }
        let to = DVec3::from_array(to);
        prop_assert!(to.is_finite() || !visible(&from, to));
        let corners: Vec<DVec3> = corners.into_iter().map(DVec3::from_array).collect();
        for (corners, normal) in [(&corners[..], from.normal()), (&corners[..], direction), (&[][..],
            direction)] {
            let p = form_factor(corners, from.position(), normal);
            let sound = corners.iter().all(|corner| corner.is_finite()) && normal.is_finite()
                && normal != DVec3::ZERO;
            prop_assert!(if sound { (0.0..=1.0).contains(&p) } else { p.is_nan() }, "{p:?} of {corners:?}");
        }
    }
}

// ---- generators that are stuck ----

/// All zeros, all ones, every single bit, and all but one.
fn words() -> impl Iterator<Item = u64> {
    (0..64).flat_map(|bit| [1 << bit, !(1 << bit)]).chain([0, u64::MAX])
}

/// 53 ln 2/−ln(1 − 2⁻⁵³) = 330895682712764019.7, where `f64` lie 64 apart.
const LONGEST: u64 = 330_895_682_712_764_032;

/// The rates at which 53 ln 2/λ just fits into f64, and into f32.
const LOWEST_RATES: [f64; 2] = [2.0436e-307, 4.889e-38];

#[test]
fn stuck_generators_give_finite_samples() {
    let weibull =
        Inversion::new(|x: f64| -(-x.max(0.0).sqrt()).exp_m1(), [f64::NEG_INFINITY, f64::INFINITY]).unwrap();
    let cauchy =
        Inversion::new(|x: f64| (0.5 + x.atan() / PI).clamp(0.0, 1.0), [f64::NEG_INFINITY, f64::INFINITY])
            .unwrap();
    let tall = Rectangle::new([-1e300, 1e300], [1e-300, 3e-300]).unwrap();
    let longest = Roulette::new(NEARLY_ONE).unwrap().bounces().by_inversion().unwrap();
    for word in words() {
        let mut rng = Stuck(word);
        for rate in [LOWEST_RATES[0], 0.37, f64::MAX] {
            let x: f64 = Exponential::new(rate).unwrap().sample(&mut rng);
            assert!(x.is_finite() && x >= 0.0, "{x:?} of {word:#x} at λ = {rate:?}");
        }
        for rate in [LOWEST_RATES[1], 0.37, f64::MAX] {
            let x: f32 = Exponential::new(rate).unwrap().sample(&mut rng);
            assert!(x.is_finite() && x >= 0.0, "{x:?} of {word:#x} at λ = {rate:?}");
        }
        // a support without ends, whose F⁻(0) is −∞: the least is drawn with 2⁻⁵³
        for x in [weibull.sample(&mut rng), cauchy.sample(&mut rng)] {
            assert!(x.is_finite(), "{x:?} of {word:#x}");
        }
        for rectangle in [Rectangle::WORKSHEET, tall] {
            let [x, y] = rectangle.sample(&mut rng);
            let ([a, b], [c, d]) = (rectangle.x_range(), rectangle.y_range());
            assert!((a..=b).contains(&x) && (c..=d).contains(&y) && rectangle.pdf(&[x, y]) > 0.0);
        }
        for (hemisphere, least) in [(Hemisphere::Uniform, 2f64.powi(-53)), (Hemisphere::Cosine, 1.05e-8)] {
            let direction = hemisphere.sample(&mut rng);
            assert!(
                ulps_off_unit(&direction) <= 2.0 && direction.cos_theta() >= least,
                "{direction:?} of {word:#x}"
            );
            assert!(hemisphere.pdf(&direction) > 0.0);
        }
        // at most 53 ln 2·2⁵³ bounces, in one step
        let bounces: u64 = longest.sample(&mut rng);
        assert!(bounces <= LONGEST, "{bounces} of {word:#x}");
        // a coin asks on only where U is the last point of the grid below p, 1074/53 times at most
        for p in [f64::from_bits(1), 1e-300, 0.1, 0.5, NEARLY_ONE] {
            let _ = Roulette::new(p).unwrap().continues(&mut rng);
        }
    }
    // all ones end a path of any p below 1, all zeros never do: n bounces have probability pⁿ
    assert!(!Roulette::new(NEARLY_ONE).unwrap().continues(&mut Stuck(u64::MAX)));
    assert_eq!(
        Roulette::new(NEARLY_ONE).unwrap().bounces().by_simulation().unwrap().sample(&mut Stuck(u64::MAX)),
        0
    );
    assert!(Roulette::new(f64::from_bits(1)).unwrap().continues(&mut Stuck(0)));
}
