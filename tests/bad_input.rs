//! Bad input is a sentence: of every parameter, what is allowed up to its very ends, and what is said of all
//! else.

use std::fmt::Debug;
use std::str::FromStr;

use unbiased::inversion::{Exponential, Inversion};
use unbiased::lambertian::hemisphere::{Direction, Hemisphere};
use unbiased::lambertian::{CosinePower, Lambertian, RingLight};
use unbiased::paths::room::{BoxRoom, Scene, Vertex};
use unbiased::paths::{Bounces, FindLight, Paths};
use unbiased::placement::{jittered, sobol};
use unbiased::rectangle::Rectangle;
use unbiased::roulette::{LightModel, Roulette};
use unbiased::{Budget, Density, Error, Estimator, Result, Stream, estimate, f_over_p, from_fn};

const INF: f64 = f64::INFINITY;
const NAN: f64 = f64::NAN;
/// The neighbours of 1.
const ABOVE_1: f64 = 1.0 + f64::EPSILON;
const BELOW_1: f64 = 1.0 - f64::EPSILON / 2.0;

/// Every number of `good` is taken, and of every one of `bad` an error says this sentence, and the number.
fn domain<N, T>(sentence: &str, good: &[N], bad: &[N], call: impl Fn(N) -> Result<T>)
where
    N: Copy + Debug + PartialEq + FromStr,
{
    for x in good {
        assert!(call(*x).is_ok(), "{sentence}: {x:?} is refused");
    }
    for x in bad {
        let Err(error) = call(*x) else { panic!("{sentence}: {x:?} is taken") };
        let said = error.to_string();
        let number = said.strip_prefix(sentence).and_then(|rest| rest.strip_prefix(", not "));
        let number = number.and_then(|number| number.parse::<N>().ok());
        let same = number.is_some_and(|number| number == *x || format!("{number:?}{x:?}") == "NaNNaN");
        assert!(same, "{said:?} is said of {x:?}, for {sentence:?}");
    }
}

fn says<T>(result: Result<T>) -> String {
    result.err().map_or_else(|| "nothing".to_owned(), |error| error.to_string())
}

#[test]
fn of_laws_and_probabilities() {
    let (law, half) = (Exponential::new(1.0).unwrap(), Roulette::new(0.5).unwrap());
    let model = |albedo, visibility| LightModel::new(albedo, visibility);
    let lit = model(0.8, 0.5).unwrap();
    let rates = [0.0, -1.0, NAN, INF, -INF];
    domain("the rate λ must be positive and finite", &[5e-324, f64::MAX], &rates, Exponential::new);
    let bad = [-5e-324, ABOVE_1, NAN, INF];
    let inversion = Inversion::new(|x: f64| x.clamp(0.0, 1.0), [0.0, 1.0]).unwrap();
    domain("the probability u must be in [0, 1]", &[0.0, 1.0], &bad, |u| law.inverse_cdf(u));
    domain("the probability u must be in [0, 1]", &[0.0, 1.0], &bad, |u| inversion.inverse_cdf(u));
    domain("the probability u must be in [0, 1]", &[0.0, 1.0], &bad, |u| half.bounces().quantile(u));
    let step = |support| Inversion::new(|x: f64| if x < 0.0 { 0.0 } else { 1.0 }, support);
    let lower = "the support's lower end must be a number below +∞";
    domain(lower, &[-INF, -5e-324], &[INF, NAN], |low| step([low, 0.0]));
    let upper = "the support's upper end must be above the lower end";
    domain(upper, &[0.0, INF], &[-1.0, -INF, NAN], |high| step([-1.0, high]));
    let sentence = "the continuation probability p_rr must be in (0, 1] (0 is biased unless E[X] = 0)";
    domain(sentence, &[5e-324, 1.0], &[0.0, -0.1, ABOVE_1, NAN, INF, -INF], Roulette::new);
    let endless = "the continuation probability p_rr must be below 1 (at 1 the bounces never end)";
    let bounces = |p: f64| Roulette::new(p).map(|roulette| roulette.bounces());
    domain(endless, &[BELOW_1], &[1.0], |p| bounces(p)?.by_simulation());
    domain(endless, &[BELOW_1], &[1.0], |p| bounces(p)?.by_inversion());
    domain("the albedo ρ must be in [0, 1)", &[0.0, BELOW_1], &[1.0, -0.1, NAN, INF], |a| model(a, 0.5));
    domain("the visibility v must be in [0, 1]", &[0.0, 1.0], &bad, |v| model(0.8, v));
    let sentence = "the continuation probability q must be in (0, 1) (0 is biased unless ρ v = 0)";
    domain(sentence, &[5e-324, BELOW_1], &[0.0, 1.0, -0.1, NAN, INF], |q| lit.roulette(q));
    domain(sentence, &[5e-324, BELOW_1], &[0.0, 1.0, -0.1, NAN, INF], |q| lit.crossing(q, 8));
    for dark in [model(0.0, 0.5).unwrap(), model(0.8, 0.0).unwrap()] {
        domain(sentence, &[0.0, BELOW_1], &[1.0, -0.1], |q| dark.roulette(q));
    }
    let last = [1_000_000_001, u64::MAX];
    domain("the last vertex of a path must be at most 10⁹", &[0, 1_000_000_000], &last, |k| {
        lit.truncated(k)
    });
    let vertices = [0.0, -1.0, NAN, INF];
    let sentence = "the number of vertices must be positive and finite";
    let (rr, cut) = (lit.roulette(0.8).unwrap(), lit.truncated(8).unwrap());
    domain(sentence, &[5e-324, f64::MAX], &vertices, |c| rr.mean_square_error(c));
    domain(sentence, &[5e-324, f64::MAX], &vertices, |c| cut.mean_square_error(c));
}

#[test]
fn of_rectangles_and_sets_of_points() {
    let (unit, r) = ([0.0, 1.0], Rectangle::WORKSHEET);
    let (ends, off) = ([NAN, INF, -INF], [NAN, INF, -INF, 0.0, -1.0]);
    domain("the end a of [a, b] must be finite", &[-1.0], &ends, |a| Rectangle::new([a, 1.0], unit));
    domain("the end b of [a, b] must be finite and above a", &[1.0], &off, |b| {
        Rectangle::new([0.0, b], unit)
    });
    domain("the end c of [c, d] must be finite", &[-1.0], &ends, |c| Rectangle::new(unit, [c, 1.0]));
    domain("the end d of [c, d] must be finite and above c", &[1.0], &off, |d| {
        Rectangle::new(unit, [0.0, d])
    });
    let normal = "must be in f64's normal range, from 2.3e-308 to 1.7e308";
    let width = |w: f64| Rectangle::new([0.0, w], [0.0, 1.0 / w.clamp(1e-300, 1e300)]);
    let height = |h: f64| Rectangle::new([0.0, 1.0 / h.clamp(1e-300, 1e300)], [0.0, h]);
    let lengths = [f64::MIN_POSITIVE, 1e-300, 1e300, f64::MAX];
    domain(&format!("the width b − a {normal}"), &lengths, &[1e-310], width);
    domain(&format!("the height d − c {normal}"), &lengths, &[1e-310], height);
    let wide = Rectangle::new([-1.7e308, 1.7e308], [0.0, 1e-300]);
    assert_eq!(says(wide), format!("the width b − a {normal}, not inf"));
    // the area under- and overflows, or its inverse does
    let square = |area: f64| Rectangle::new([0.0, area.sqrt()], [0.0, area / area.sqrt()]);
    let areas = "the area must be from 2.3e-308 to 4.4e307, not ";
    for [w, h] in [[1e-300, 1e-300], [1e300, 1e300], [1e-155, 1e-154], [1e154, 1e154]] {
        assert!(says(Rectangle::new([0.0, w], [0.0, h])).starts_with(areas), "{w:e} × {h:e}");
    }
    assert!(square(2.3e-308).is_ok() && square(4.4e307).is_ok());

    let (one, number) = (|_: f64, _: f64| 1.0, from_fn(|rng| rng.uniform()));
    let (most, beyond) = ([1, 65_536], [0, 65_537, 1 << 32, (1 << 32) + 1, u64::MAX]);
    domain("the number n of values must be from 1 to 65536", &most, &beyond, |n| r.all_pairs(one, n));
    domain("the number of Sobol points must be from 1 to 65536", &most, &beyond, |n| r.sobol(one, n));
    domain("the number of Sobol points must be from 1 to 65536", &most, &beyond, |n| sobol(&number, n));
    let (sides, beyond) = ([1, 256], [0, 257, 1 << 32, (1 << 32) + 1, u64::MAX]);
    domain("the side of the grid must be from 1 to 256", &sides, &beyond, |side| r.jittered(one, side));
    domain("the side of the grid must be from 1 to 256", &sides, &beyond, |side| jittered(&number, side));
}

#[test]
fn of_directions_and_surfaces() {
    let component = "a direction's component must be finite";
    for direction in [|x| Direction::new(x, 0.0, 1.0), |y| Direction::new(0.0, y, 1.0)] {
        domain(component, &[0.0, f64::MAX], &[NAN, INF, -INF], direction);
    }
    domain(component, &[5e-324, -f64::MAX], &[NAN, INF, -INF], |z| Direction::new(0.0, 0.0, z));
    let largest = "a direction's largest component must be other than 0";
    domain(largest, &[5e-324], &[0.0], |x| Direction::new(x, 0.0, 0.0));
    let cos = [-ABOVE_1, ABOVE_1, NAN];
    domain("cos θ must be in [-1, 1]", &[-1.0, 1.0], &cos, |cos| Direction::polar(cos, 0.0));
    domain("the angle φ must be finite", &[f64::MAX], &[NAN, INF, -INF], |phi| Direction::polar(0.5, phi));
    for hemisphere in Hemisphere::ALL {
        let bad = [-5e-324, ABOVE_1, NAN];
        domain("the uniform number u must be in [0, 1]", &[0.0, 1.0], &bad, |u| {
            hemisphere.direction_of(u, 0.5)
        });
        domain("the uniform number v must be in [0, 1]", &[0.0, 1.0], &bad, |v| {
            hemisphere.direction_of(0.5, v)
        });
    }
    let sentence = "the albedo ρ must be between 0 and 1 (above 1 it would create energy)";
    domain(sentence, &[0.0, 1.0], &[-0.1, ABOVE_1, NAN, INF], Lambertian::new);
    let exponents = [-2.0, -3.0, INF, NAN];
    domain("the exponent a must be above -2 and finite", &[-2f64.next_down(), f64::MAX], &exponents, |a| {
        CosinePower::new(a)
    });
    let widths = [0.0, -0.5, ABOVE_1, NAN];
    domain("the ring's width ε must be above 0 and at most 1", &[5e-324, 1.0], &widths, RingLight::new);
}

#[test]
fn of_the_room() {
    let scene = Scene::default();
    let albedo = "albedo must be between 0 and 1 (above 1 it would create energy)";
    let bad = [-0.1, ABOVE_1, NAN];
    domain(&format!("the walls' {albedo}"), &[0.0, 1.0], &bad, |x| {
        BoxRoom::new(Scene { wall_albedo: x, ..scene })
    });
    domain(&format!("the cube's {albedo}"), &[0.0, 1.0], &bad, |x| {
        BoxRoom::new(Scene { cube_albedo: x, ..scene })
    });
    let range = "must be 0, or from 1e-100 to 1e100";
    let (good, bad) =
        ([0.0, -0.0, 1e-100, 1e100], [-1.0, INF, NAN, 1e100f64.next_up(), 1e-100f64.next_down()]);
    domain(&format!("the light's radiance {range}"), &good, &bad, |x| {
        BoxRoom::new(Scene { radiance: x, ..scene })
    });
    domain(&format!("the faces' emission {range}"), &good, &bad, |x| {
        BoxRoom::new(Scene { emission: x, ..scene })
    });
    let sentence = "the light's half-width must be 0 (no light), or from 1e-50 to 2 (all of the ceiling)";
    domain(sentence, &[0.0, 1e-50, 2.0], &[2f64.next_up(), -0.5, NAN, 1e-50f64.next_down()], |x| {
        BoxRoom::new(Scene { light_half_width: x, ..scene })
    });
    let no_face = "lies on no face: it must lie on the room's (|x| = 2, |y| = 2, z = 0 or z = 4) or on the \
                   cube's (|x| = 0.5 or |y| = 0.5 up to z = 1, or z = 1 within)";
    let under = "lies under the cube: on the floor, |x| or |y| must be at least 0.5";
    let light = "lies on the light, which reflects nothing: on the ceiling, |x| or |y| must be above the \
                 light's half-width";
    for (point, at, reason) in [
        ([0.0, 0.0, 1.5], "(0, 0, 1.5)", no_face),
        ([0.0, 0.0, 0.5], "(0, 0, 0.5)", no_face),
        ([2.5, 0.0, 0.0], "(2.5, 0, 0)", no_face),
        ([0.0, NAN, 1.0], "(0, NaN, 1)", no_face),
        ([0.0, INF, 1.0], "(0, inf, 1)", no_face),
        ([0.0, 0.25, 0.0], "(0, 0.25, 0)", under),
        ([0.0, 0.25, 4.0], "(0, 0.25, 4)", light),
        ([0.5, 0.5, 4.0], "(0.5, 0.5, 4)", light),
    ] {
        let said = says(BoxRoom::new(Scene { point, ..scene }));
        assert_eq!(said, format!("the point {at} {reason}"));
        // the light is a face as any other
        assert_eq!(Vertex::at(point).is_ok(), reason == light);
    }
}

fn paths(scene: Scene, bounces: Bounces) -> Result<Paths> {
    Paths::new(BoxRoom::new(scene).unwrap(), bounces, Hemisphere::Cosine, FindLight::BySampling)
}

#[test]
fn of_paths() {
    let scene = Scene::default();
    let most = "the number of bounces must be at most 64 (without a limit, roulette ends the paths)";
    domain(most, &[0, 64], &[65, u32::MAX], |k| paths(scene, Bounces::Exactly(k)));
    domain(most, &[0, 64], &[65, u32::MAX], |k| paths(scene, Bounces::UpTo(k)));
    let sentence = "the continuation probability q must be above 0 and at most 0.9999, where a path has ten \
                    thousand bounces";
    domain(sentence, &[5e-324, 0.9999], &[0.0, -0.5, 1.0, 0.9999f64.next_up(), NAN], |q| {
        paths(scene, Bounces::All(q))
    });
    let sentence = "the largest albedo must be at most 0.999 where nothing but absorption ends a path (or \
                    choose a q or a number of bounces)";
    let albedos = [0.999f64.next_up(), 1.0];
    domain(sentence, &[0.0, 0.999], &albedos, |albedo| {
        paths(Scene { wall_albedo: albedo, ..scene }, Bounces::AllByThroughput)
    });
    domain(sentence, &[0.0, 0.999], &albedos, |albedo| {
        paths(Scene { cube_albedo: albedo, ..scene }, Bounces::AllByThroughput)
    });
    let white = Scene { wall_albedo: 1.0, cube_albedo: 1.0, ..scene };
    assert!(paths(white, Bounces::All(0.9999)).is_ok() && paths(white, Bounces::UpTo(64)).is_ok());
}

#[test]
fn of_single_precision() {
    let of = |scene: Scene, bounces| paths(scene, bounces).unwrap().in_f32();
    let dark = |wall_albedo| Scene { wall_albedo, ..Scene::default() };
    let (least, rest) =
        ("the least albedo, to the power of the bounces, must be", "at least 1e-25 in single precision");
    let said = says(of(dark(0.25), Bounces::Exactly(64)));
    assert_eq!(said, format!("{least} {rest}, not {:?}", 0.25f64.powi(64)));
    for (albedo, bounces, ok) in [
        (0.5, Bounces::Exactly(64), true),
        (0.0, Bounces::Exactly(64), true),
        (1e-9, Bounces::UpTo(64), true),
        (1e-13, Bounces::UpTo(1), true),
        (1e-13, Bounces::UpTo(2), false),
        (1e-13, Bounces::AllByThroughput, false),
        (1e-13, Bounces::All(0.5), false),
        (1e-13, Bounces::Exactly(2), false),
    ] {
        assert_eq!(of(dark(albedo), bounces).is_ok(), ok, "{albedo}, {bounces:?}");
    }
    let faint = Scene { emission: 1e-10, ..Scene::default() };
    let said = says(of(faint, Bounces::UpTo(2)));
    let sentence = "the faces' emission, in parts of the light's, must be 0 or at least 1e-10 in single \
                    precision, not 3.14";
    assert!(said.starts_with(sentence), "{said}");
    for scene in [
        Scene { light_half_width: 0.0, ..faint },
        Scene { radiance: 0.0, ..faint },
        Scene { radiance: 0.0, ..Scene::default() },
    ] {
        assert!(of(scene, Bounces::UpTo(2)).is_ok());
    }
}

/// A density whose `warp` leaves its support.
struct Outside;

impl Density<1> for Outside {
    type Point = f64;

    fn warp(&self, [u]: [f64; 1]) -> f64 {
        2.0 * u
    }

    fn pdf(&self, x: &f64) -> f64 {
        if *x < 1.0 { 1.0 } else { 0.0 }
    }
}

/// One draw that is not finite ends a run, and the error names its value: the one that f returned.
#[test]
fn of_one_draw_that_is_not_finite() {
    for bad in [INF, -INF, NAN] {
        let f = move |x: f64, y: f64| if x > 1.9 && y > 1.9 { bad } else { 1.0 };
        let r = Rectangle::WORKSHEET;
        let surface = Lambertian::new(0.5).unwrap();
        let seldom = Roulette::new(0.5).unwrap().wrap(from_fn(move |_| bad));
        let rows: [(&str, Box<dyn Estimator>); 8] = [
            ("independent", Box::new(r.independent(f))),
            ("f/p", Box::new(f_over_p(move |&[x, y]: &[f64; 2]| f(x, y), r))),
            ("all pairs", Box::new(r.all_pairs(f, 8).unwrap())),
            ("jittered", Box::new(r.jittered(f, 8).unwrap())),
            ("Sobol", Box::new(r.sobol(f, 64).unwrap())),
            ("a surface", Box::new(surface.cosine_estimator(move |_| bad))),
            ("roulette", Box::new(seldom)),
            (
                "jittered roulette",
                Box::new(jittered(Roulette::new(1.0).unwrap().wrap(from_fn(move |_| bad)), 2).unwrap()),
            ),
        ];
        for (name, estimator) in rows {
            let found = estimate(&estimator, Budget::Draws(100_000), 7);
            let Err(Error::Draw { seed: 7, value, .. }) = found else { panic!("{name}: {found:?}") };
            assert!(value == bad || value.is_nan() && bad.is_nan(), "{name}: {value} for {bad}");
        }
    }
    for outside in [
        estimate(&f_over_p(|x| *x, Outside), Budget::Draws(1000), 1),
        estimate(&sobol(f_over_p(|x| *x, Outside), 64).unwrap(), Budget::Draws(1000), 1),
        // X/p beyond f64
        estimate(&Roulette::new(0.5).unwrap().wrap(from_fn(|_| f64::MAX)), Budget::Draws(200), 1),
    ] {
        assert!(matches!(outside, Err(Error::Draw { value: INF, .. })), "{outside:?}");
    }
    // where it shows only when drawing that a function is no cdf, the draw is NaN
    let never = Inversion::new(|x: f64| 0.05 * x, [0.0, 10.0]).unwrap();
    let drawn = from_fn(|rng: &mut Stream| rand::distr::Distribution::sample(&never, rng));
    let error = estimate(&drawn, Budget::Draws(1000), 1).unwrap_err();
    assert!(matches!(error, Error::Draw { value, .. } if value.is_nan()));
}
