//! One table of all samplers and estimators of the crate, with the closed forms that hold for each.
//!
//! [`all`] gives it with the sheet's parameters and the extreme ones, or with parameters that are drawn.

use std::f64::consts::{LN_2, PI, TAU};

use rand::distr::Distribution;
use statrs::distribution::{Beta, Binomial, ContinuousCDF, DiscreteCDF, Gamma, Normal, Poisson, Weibull};
use unbiased::inversion::{Exponential, Inversion};
use unbiased::lambertian::hemisphere::{Direction, Hemisphere};
use unbiased::lambertian::{CosinePower, Lambertian, Light, RingLight};
use unbiased::paths::room::{BoxRoom, Scene, Vertex};
use unbiased::paths::{Bounces, FindLight, Paths, reflected};
use unbiased::placement::{jittered, sobol};
use unbiased::rectangle::{Integrand, Rectangle};
use unbiased::roulette::{LightModel, Roulette};
use unbiased::{Density, Estimator, Stream, f_over_p, from_fn, from_uniforms};

use crate::common::{self, NEARLY_ONE, furnace, net_variance_of_xy, part_of_the_sky};

mod ends;
mod inversions;
mod paths;
mod rectangles;
mod roulettes;
mod surfaces;

/// An estimator, and what is known of its draws.
pub struct Row {
    pub name: String,
    pub estimator: Box<dyn Estimator>,
    /// NaN where no number of draws can tell it.
    pub mean: f64,
    pub variance: Option<f64>,
    /// Every draw lies in it; or all but one in 10²⁴, where a draw has no end.
    pub range: [f64; 2],
    pub cdf: Option<Box<dyn Fn(f64) -> f64 + Sync>>,
    /// Nanoseconds of a draw, roughly.
    pub cost: f64,
    /// Random numbers and evaluations of a draw, where every draw takes as many.
    pub takes: Option<[u64; 2]>,
    /// How many numbers it is a function of, where `check::exactly` can integrate it.
    pub smooth: Option<usize>,
    /// How far a filled draw may be from one that is drawn alone, relative to it.
    pub rounding: f64,
}

impl Row {
    fn variance(self, variance: f64) -> Self {
        Self { variance: Some(variance), ..self }
    }

    fn cdf(self, cdf: impl Fn(f64) -> f64 + Sync + 'static) -> Self {
        Self { cdf: Some(Box::new(cdf)), ..self }
    }

    fn takes(self, random_numbers: u64, evaluations: u64) -> Self {
        Self { takes: Some([random_numbers, evaluations]), ..self }
    }

    fn smooth(self, numbers: usize) -> Self {
        Self { smooth: Some(numbers), ..self }
    }

    /// How far a draw may lie from the mean.
    pub fn reach(&self) -> f64 {
        (self.mean - self.range[0]).max(self.range[1] - self.mean)
    }
}

/// Where the parameters come from: as given, or from a stream.
pub struct Pick(Option<Stream>);

impl Pick {
    fn is_given(&self) -> bool {
        self.0.is_none()
    }

    fn between(&mut self, given: f64, [low, high]: [f64; 2]) -> f64 {
        self.0.as_mut().map_or(given, |rng| low + (high - low) * rng.uniform())
    }

    /// Evenly in the logarithm.
    fn log(&mut self, given: f64, [low, high]: [f64; 2]) -> f64 {
        self.between(given.ln(), [low.ln(), high.ln()]).exp()
    }

    /// Up to `high` itself.
    fn count(&mut self, given: u64, [low, high]: [u64; 2]) -> u64 {
        self.between(given as f64, [low as f64, (high + 1) as f64]).floor() as u64
    }

    fn one_of<T: Copy>(&mut self, given: T, all: &[T]) -> T {
        let last = all.len() as u64 - 1;
        if self.is_given() { given } else { all[self.count(0, [0, last]) as usize] }
    }

    fn rectangle(&mut self, given: Rectangle) -> Rectangle {
        let mut side = || {
            let low = self.between(0.0, [-5.0, 5.0]);
            [low, low + self.log(1.0, [1e-2, 1e2])]
        };
        let (x, y) = (side(), side());
        if self.is_given() { given } else { Rectangle::new(x, y).unwrap() }
    }
}

/// What is made of the draws of an estimator, also of those that are filled.
struct Through<E, F>(E, F);

impl<E: Estimator, F: Fn(f64) -> f64 + Sync> Estimator for Through<E, F> {
    fn draw(&self, rng: &mut Stream) -> f64 {
        (self.1)(self.0.draw(rng))
    }

    fn fill(&self, rng: &mut Stream, draws: &mut [f64]) {
        self.0.fill(rng, draws);
        draws.iter_mut().for_each(|draw| *draw = (self.1)(*draw));
    }
}

fn row(
    name: impl Into<String>,
    estimator: impl Estimator + 'static,
    mean: f64,
    range: [f64; 2],
    cost: f64,
) -> Row {
    Row {
        name: name.into(),
        estimator: Box::new(estimator),
        mean,
        variance: None,
        range,
        cdf: None,
        cost,
        takes: None,
        smooth: None,
        rounding: 0.0,
    }
}

/// Every estimator of the crate: as given for the variant 0, extremes among them, and with drawn parameters
/// for every other one.
pub fn all(variant: u64) -> Vec<Row> {
    let stream = (variant > 0).then(|| Stream::new(common::seed(7000 + variant), 0));
    let mut pick = Pick(stream);
    let mut all = from_numbers();
    for rows in [inversions::rows, rectangles::rows, surfaces::rows, paths::rows, roulettes::rows] {
        all.extend(rows(&mut pick));
    }
    if pick.is_given() {
        all.extend(ends::rows());
        all.extend(paths::of_the_sheet());
    }
    all
}

fn from_numbers() -> Vec<Row> {
    let sum = from_uniforms(|u: [f64; 5]| u.iter().sum());
    vec![
        row("no number", from_uniforms(|[]| 1.0), 1.0, [0.0, 2.0], 2.0).variance(0.0).takes(0, 1),
        row("five numbers", sum, 2.5, [0.0, 5.0], 10.0).variance(5.0 / 12.0).takes(5, 1),
    ]
}

/// −ln 2⁻⁵³, of the largest number below 1.
const LONGEST: f64 = 53.0 * LN_2;
