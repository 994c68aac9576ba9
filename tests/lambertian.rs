//! Section 3: directions, a diffuse surface and lights, at the ends of what they take. Closed forms of every
//! size are those of tests/vectors.rs, means, variances and laws those of tests/estimators.rs.

mod common;

use std::f64::consts::{FRAC_1_PI, PI, TAU};

use approx::assert_relative_eq;
use unbiased::lambertian::hemisphere::{Direction, Hemisphere};
use unbiased::lambertian::{CosinePower, Lambertian, Light, RingLight};
use unbiased::{Density, Estimator, Stream};

#[test]
fn directions_say_what_they_are() {
    let direction = Direction::new(0.0, -3.0, -4.0).unwrap();
    assert_eq!(direction.vector().to_array(), [0.0, -0.6, -0.8]);
    assert_eq!(glam::DVec3::from(direction), direction.vector());
    assert_eq!(direction.phi(), 1.5 * PI);
    assert_relative_eq!(direction.theta(), PI - 0.75f64.atan(), epsilon = 0.0, max_relative = f64::EPSILON);
    // −0 is no angle of its own, and an angle just below a turn stays below it
    assert_eq!(Direction::new(1.0, -0.0, 0.0).unwrap().phi().to_bits(), 0);
    assert!(Direction::new(1.0, -1e-300, 0.0).unwrap().phi() < TAU);
    // near the normal 1 − cos² θ has half its digits; and squares below the smallest number
    let cos: f64 = 1.0 - 1.1e-8;
    let exact = ((1.0 - cos) * (2.0 - (1.0 - cos))).sqrt();
    let near = Direction::polar(cos, 0.0).unwrap();
    assert_relative_eq!(near.sin_theta(), exact, epsilon = 0.0, max_relative = 2.0 * f64::EPSILON);
    assert_eq!(Direction::new(3e-200, 4e-200, 1.0).unwrap().sin_theta(), 5e-200);
    // any length, from the smallest number to the largest
    for length in [5e-324, 1e-320, 1e-300, 1e-150, 1.0, 1e150, 1e300, f64::MAX] {
        let diagonal = Direction::new(length, -length, length).unwrap().vector();
        for component in diagonal.abs().to_array() {
            assert_relative_eq!(component, 1.0 / 3f64.sqrt(), epsilon = 0.0, max_relative = f64::EPSILON);
        }
    }
}

/// The ends of u: the normal, the last number that a stream gives, and the horizon.
#[test]
fn no_drawn_direction_lies_on_the_horizon() {
    let last = common::NEARLY_ONE;
    for (hemisphere, up, least) in
        [(Hemisphere::Uniform, 1.0 / TAU, 2f64.powi(-53)), (Hemisphere::Cosine, FRAC_1_PI, 2f64.powf(-26.5))]
    {
        let at = |u| hemisphere.direction_of(u, 0.3).unwrap();
        for (u, sin, cos) in [(0.0, 0.0, 1.0), (last, 1.0, least), (1.0, 1.0, 0.0)] {
            assert_relative_eq!(at(u).cos_theta(), cos, epsilon = 0.0, max_relative = f64::EPSILON);
            assert_relative_eq!(at(u).sin_theta(), sin, epsilon = 0.0, max_relative = 3.0 * f64::EPSILON);
        }
        assert_eq!(hemisphere.pdf(&at(0.0)), up);
        assert!(hemisphere.pdf(&at(last)) > 0.0);
        assert_eq!(hemisphere.pdf(&Direction::polar(-0.2, 1.0).unwrap()), 0.0);
    }
}

#[test]
fn surfaces_and_lights_say_what_they_are() {
    let surface = Lambertian::new(0.61).unwrap();
    assert_eq!((surface.albedo(), surface.emitted(), surface.reflected(2.0)), (0.61, 0.0, 1.22));
    let (power, ring) = (CosinePower::new(-1.3).unwrap(), RingLight::new(0.1).unwrap());
    assert_eq!((power.a(), ring.width()), (-1.3, 0.1));
    // nothing from below, and along the horizon from above it; the ring has its edge
    let at = |cos| Direction::polar(cos, 0.0).unwrap();
    for light in [&power as &dyn Light, &ring] {
        assert_eq!((light.incoming(&at(-0.1)), light.incoming(&at(0.0))), (0.0, 0.0));
    }
    assert_eq!([0.05, 0.1, 0.11].map(|cos| ring.incoming(&at(cos))), [1.0, 1.0, 0.0]);
    assert_eq!(RingLight::new(1.0).unwrap().incoming(&at(1.0)), 1.0);
}

/// ρ and x, then \[L_r, variance of uniform, variance of cosine\], from exact rational arithmetic.
type Row = (f64, f64, [f64; 3]);

const INF: f64 = f64::INFINITY;

/// Where a variance is 0, becomes infinite, or leaves `f64`.
const POWERS: [Row; 13] = [
    (0.0, 1.0, [1.0, 0.3333333333333333, 0.0]),
    (5e-324, 1.0, [1.0, 0.3333333333333333, 0.0]),
    (-0.5, 0.61, [0.8133333333333334, 0.08268888888888888, 0.08268888888888888]),
    (-1.0, 0.61, [1.22, 0.0, INF]),
    (-0.9999999999999998, 0.61, [1.2199999999999998, 7.338378570818455e-32, 1675789421344560.0]),
    (-1.0000000000000002, 0.61, [1.2200000000000002, 7.338378570818469e-32, INF]),
    (-1.5, 0.61, [2.44, INF, INF]),
    (-1.4999999999999996, 0.61, [2.4399999999999977, 1675789421344555.5, INF]),
    (-1.9999999999999996, 0.61, [2747195772696002.5, INF, INF]),
    (f64::MAX, 1.0, [1.1125369292536007e-308, 1.1125369292536007e-308, 5.562684646268003e-309]),
    (0.37, 1e-150, [8.438818565400844e-151, 3.5738212878000052e-301, 1.7790419501730504e-302]),
    (2.5, 1e-300, [4.4444444444444446e-301, 0.0, 0.0]),
    // black, also where the formula is infinite
    (-1.7, 0.0, [0.0, 0.0, 0.0]),
];

const RINGS: [Row; 7] = [
    (1.0, 1.0, [1.0, 0.3333333333333333, 0.0]),
    (0.9999999999999999, 0.61, [0.6099999999999999, 0.12403333333333333, 8.262279749260412e-17]),
    (0.75, 1.0, [0.5625, 0.24609375, 0.24609375]),
    (1e-100, 1.0, [1e-200, 1.3333333333333334e-300, 1e-200]),
    (1e-160, 1.0, [1e-320, 0.0, 1e-320]),
    (5e-324, 1.0, [0.0, 0.0, 0.0]),
    (0.5, 0.0, [0.0, 0.0, 0.0]),
];

#[test]
fn closed_forms_keep_their_digits_at_the_ends() {
    let boxed = |light: Box<dyn Light>, row| (light, row);
    let powers = POWERS.map(|row| boxed(Box::new(CosinePower::new(row.0).unwrap()), row));
    let rings = RINGS.map(|row| boxed(Box::new(RingLight::new(row.0).unwrap()), row));
    for (light, (x, albedo, exact)) in powers.into_iter().chain(rings) {
        let surface = Lambertian::new(albedo).unwrap();
        let [uniform, cosine] = Hemisphere::ALL.map(|hemisphere| light.variance(surface, hemisphere));
        for (given, exact) in [light.reflected(surface), uniform, cosine].into_iter().zip(exact) {
            // at most 11 roundings of half an ulp each, and the least number there is
            let close = (given - exact).abs() <= 5.5 * f64::EPSILON * exact + 5e-324;
            assert!(given == exact || close, "{given} for {exact} at {x}, ρ = {albedo}");
        }
    }
}

/// A direction along the surface carries no light to it, not even where the light grows beyond all bounds
/// there.
#[test]
fn along_the_surface_nothing_arrives() {
    struct Along;
    impl Density<0> for Along {
        type Point = Direction;
        fn warp(&self, []: [f64; 0]) -> Direction {
            Direction::polar(0.0, 0.3).unwrap()
        }
        fn pdf(&self, _: &Direction) -> f64 {
            1.0
        }
    }
    let surface = Lambertian::new(0.61).unwrap();
    let estimator = surface.estimator(|direction| direction.cos_theta().powf(-0.5), Along);
    assert_eq!(estimator.draw(&mut Stream::new(1, 0)), 0.0);
}
