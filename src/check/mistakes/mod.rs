//! The gallery of classic mistakes, and the probes that tell them apart.
//!
//! A [`Topic`] is a kind of estimator; its [`Probe`]s are problems of known truth for it. Each [`Mistake`] comes with the wrong estimator itself
//! and with what its draws average to on any probe, in closed form or by quadrature. One's own estimator is an [`Attempt`].

use std::fmt;
use std::sync::{LazyLock, OnceLock};

use super::exactly::{Exact, exactly};
use crate::error::{Error, Result, require, require_count};
use crate::hemisphere::Direction;
use crate::inversion::Exponential;
use crate::lambertian::Lambertian;
use crate::rectangle::Rectangle;
use crate::roulette::Roulette;
use crate::run::{Estimator, from_fn};
use crate::stream::Stream;

mod by_hand;
mod exponential;
mod furnace;
mod hemisphere;
mod rectangle;
mod roulette;

pub use by_hand::{HandAnswer, Judgement, Slip, answers, judge_answer};
pub use exponential::Statistic;
pub use hemisphere::Sky;
pub use rectangle::Surface;

/// A kind of estimator, with its probes and its classic mistakes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Topic {
    /// Sampling the exponential distribution (worksheet 1.1, 1.2).
    Exponential,
    /// An integral over a rectangle (2.1).
    Rectangle,
    /// Light reflected by a diffuse surface (3.2, 3.4, 3.5).
    Hemisphere,
    /// Russian roulette around another estimator (5).
    Roulette,
    /// The number of bounces that roulette allows (5.1 to 5.3).
    Bounces,
    /// Light after several bounces where every face emits and reflects alike.
    Furnace,
}

impl Topic {
    /// All of them.
    pub const ALL: [Self; 6] =
        [Self::Exponential, Self::Rectangle, Self::Hemisphere, Self::Roulette, Self::Bounces, Self::Furnace];

    /// What it is called.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Exponential => "exponential samples",
            Self::Rectangle => "integral over a rectangle",
            Self::Hemisphere => "reflected light",
            Self::Roulette => "Russian roulette",
            Self::Bounces => "number of bounces",
            Self::Furnace => "light in a furnace",
        }
    }

    /// The topic of a worksheet question ("3.5"), if that question asks for an estimator.
    ///
    /// ```
    /// use unbiased::check::Topic;
    ///
    /// assert_eq!(Topic::of_question("3.5"), Some(Topic::Hemisphere));
    /// assert_eq!(Topic::of_question("1.3"), None);
    /// ```
    pub fn of_question(question: &str) -> Option<Self> {
        match question {
            "1.1" | "1.2" => Some(Self::Exponential),
            "2.1" => Some(Self::Rectangle),
            "3.2" | "3.4" | "3.5" => Some(Self::Hemisphere),
            "5" => Some(Self::Roulette),
            "5.1" | "5.1(iii)" | "5.2" => Some(Self::Bounces),
            _ => None,
        }
    }

    /// Its probes. No parameter that hides a mistake (λ = 1, p = ½, a square, L = 1) stands alone.
    pub fn probes(self) -> &'static [Probe] {
        static PROBES: LazyLock<[Vec<Probe>; 6]> = LazyLock::new(|| {
            [
                exponential::probes(),
                rectangle::probes(),
                hemisphere::probes(),
                roulette::wrapper_probes(),
                roulette::bounce_probes(),
                furnace::probes(),
            ]
        });
        PROBES.get(self as usize).map_or(&[], Vec::as_slice)
    }

    /// Its classic mistakes.
    pub fn mistakes(self) -> &'static [Mistake] {
        static MISTAKES: LazyLock<[Vec<Mistake>; 6]> = LazyLock::new(|| {
            [
                exponential::mistakes(),
                rectangle::mistakes(),
                hemisphere::mistakes(),
                roulette::wrapper_mistakes(),
                roulette::bounce_mistakes(),
                furnace::mistakes(),
            ]
        });
        MISTAKES.get(self as usize).map_or(&[], Vec::as_slice)
    }
}

impl fmt::Display for Topic {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// A problem of known truth, on which an [`Attempt`] is tried.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Probe {
    setup: Setup,
    truth: f64,
    unit: f64,
}

/// What the attempt is given.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Setup {
    Exponential { rate: f64, statistic: Statistic },
    Rectangle { rectangle: Rectangle, surface: Surface },
    Hemisphere { sky: Sky, albedo: f64 },
    Roulette { p_rr: f64 },
    Bounces { p_rr: f64 },
    Furnace { albedo: f64, emission: f64, bounces: Option<u32> },
}

impl Probe {
    /// The mean of `statistic` of exponential samples with rate λ.
    ///
    /// # Errors
    /// If λ is not positive and finite.
    pub fn exponential(rate: f64, statistic: Statistic) -> Result<Self> {
        let truth = statistic.mean(Exponential::new(rate)?);
        Ok(Self { setup: Setup::Exponential { rate, statistic }, truth, unit: truth })
    }

    /// ∫∫ `surface` over the rectangle.
    pub fn rectangle(rectangle: Rectangle, surface: Surface) -> Self {
        let truth = surface.integral(&rectangle);
        // about the origin xy and x + 2y integrate to 0: there errors are measured against ∫∫ |f|
        let unit = if truth == 0.0 { surface.absolute_integral(&rectangle) } else { truth };
        Self { setup: Setup::Rectangle { rectangle, surface }, truth, unit }
    }

    /// The radiance that a surface of this albedo reflects under `sky`.
    ///
    /// # Errors
    /// If ρ is not above 0 and at most 1.
    pub fn hemisphere(sky: Sky, albedo: f64) -> Result<Self> {
        require("the albedo ρ of a probe", albedo, albedo > 0.0, "above 0 and at most 1")?;
        let truth = sky.reflected(Lambertian::new(albedo)?);
        Ok(Self { setup: Setup::Hemisphere { sky, albedo }, truth, unit: truth })
    }

    /// Roulette around X = ½ + U, whose mean is 1.
    ///
    /// # Errors
    /// If p_rr is not strictly between 0 and 1.
    pub fn roulette(p_rr: f64) -> Result<Self> {
        require_chance(p_rr)?;
        Ok(Self { setup: Setup::Roulette { p_rr }, truth: 1.0, unit: 1.0 })
    }

    /// The mean number of bounces.
    ///
    /// # Errors
    /// If p_rr is not strictly between 0 and 1.
    pub fn bounces(p_rr: f64) -> Result<Self> {
        require_chance(p_rr)?;
        let truth = Roulette::new(p_rr)?.mean();
        Ok(Self { setup: Setup::Bounces { p_rr }, truth, unit: truth })
    }

    /// Light in a furnace whose faces all emit L and reflect ρ, after at most `bounces`, or all (`None`): Σ ρᵏ L.
    ///
    /// # Errors
    /// If ρ is not strictly between 0 and 1, L not positive and finite, or there are more than 1000 bounces.
    pub fn furnace(albedo: f64, emission: f64, bounces: Option<u32>) -> Result<Self> {
        require(
            "the albedo ρ of a furnace",
            albedo,
            albedo > 0.0 && albedo < 1.0,
            "strictly between 0 and 1",
        )?;
        let ok = emission > 0.0 && emission.is_finite();
        require("the emission L", emission, ok, "positive and finite")?;
        let count = u64::from(bounces.unwrap_or(0));
        require_count("the number of bounces", count, count <= 1000, "at most 1000")?;
        let truth = emission * furnace::sum(albedo, bounces);
        Ok(Self { setup: Setup::Furnace { albedo, emission, bounces }, truth, unit: truth })
    }

    /// What a right estimator's draws average to.
    pub fn truth(&self) -> f64 {
        self.truth
    }

    /// What ratios are taken to: the truth, or where that is 0 the integral of |f|.
    pub fn unit(&self) -> f64 {
        self.unit
    }

    /// What a right estimator's ratio is: 1, or 0 where the truth is 0.
    pub fn right_ratio(&self) -> f64 {
        self.truth / self.unit
    }

    /// The topic it belongs to.
    pub fn topic(&self) -> Topic {
        match self.setup {
            Setup::Exponential { .. } => Topic::Exponential,
            Setup::Rectangle { .. } => Topic::Rectangle,
            Setup::Hemisphere { .. } => Topic::Hemisphere,
            Setup::Roulette { .. } => Topic::Roulette,
            Setup::Bounces { .. } => Topic::Bounces,
            Setup::Furnace { .. } => Topic::Furnace,
        }
    }
}

/// The probe in a few words: `mean, λ = 0.37`.
impl fmt::Display for Probe {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.setup {
            Setup::Exponential { rate, statistic } => write!(f, "{}, λ = {rate}", statistic.name()),
            Setup::Rectangle { rectangle, surface } => {
                let ([a, b], [c, d]) = (rectangle.x_range(), rectangle.y_range());
                write!(f, "f = {} on [{a}, {b}]×[{c}, {d}]", surface.formula())
            }
            Setup::Hemisphere { sky, albedo } => write!(f, "{}, ρ = {albedo}", sky.name()),
            Setup::Roulette { p_rr } => write!(f, "X = ½ + U, p_rr = {p_rr}"),
            Setup::Bounces { p_rr } => write!(f, "p_rr = {p_rr}"),
            Setup::Furnace { albedo, emission, bounces: Some(bounces) } => {
                write!(f, "ρ = {albedo}, L = {emission}, {bounces} bounces")
            }
            Setup::Furnace { albedo, emission, bounces: None } => {
                write!(f, "ρ = {albedo}, L = {emission}, all bounces")
            }
        }
    }
}

fn require_chance(p_rr: f64) -> Result<f64> {
    let ok = p_rr > 0.0 && p_rr < 1.0;
    require("the continuation probability p_rr", p_rr, ok, "strictly between 0 and 1")
}

/// Someone's estimator, right or wrong, of a given topic.
///
/// ```
/// use unbiased::{Budget, check::{Attempt, Topic}, estimate};
///
/// let attempt = Attempt::exponential(|rate, rng| -(1.0 - rng.uniform()).ln() / rate);
/// for probe in Topic::Exponential.probes() {
///     let estimate = estimate(&attempt.at(probe)?, Budget::Draws(10_000), 1)?;
///     assert!(estimate.z(probe.truth()).unwrap().abs() < 5.0);
/// }
/// # Ok::<(), unbiased::Error>(())
/// ```
pub struct Attempt<'a>(Kind<'a>);

type Sampler<'a> = dyn Fn(f64, &mut Stream) -> f64 + Send + Sync + 'a;
type Integrator<'a> = dyn Fn(&dyn Fn(f64, f64) -> f64, &Rectangle, &mut Stream) -> f64 + Send + Sync + 'a;
type Reflector<'a> = dyn Fn(&dyn Fn(&Direction) -> f64, f64, &mut Stream) -> f64 + Send + Sync + 'a;
type Wrapper<'a> = dyn Fn(&mut dyn FnMut(&mut Stream) -> f64, f64, &mut Stream) -> f64 + Send + Sync + 'a;
type Walker<'a> = dyn Fn(f64, f64, Option<u32>, &mut Stream) -> f64 + Send + Sync + 'a;

enum Kind<'a> {
    Exponential(Box<Sampler<'a>>),
    Rectangle(Box<Integrator<'a>>),
    Hemisphere(Box<Reflector<'a>>),
    Roulette(Box<Wrapper<'a>>),
    Bounces(Box<Sampler<'a>>),
    Furnace(Box<Walker<'a>>),
}

impl<'a> Attempt<'a> {
    /// (λ, random numbers) → one sample of the exponential distribution.
    pub fn exponential(draw: impl Fn(f64, &mut Stream) -> f64 + Send + Sync + 'a) -> Self {
        Self(Kind::Exponential(Box::new(draw)))
    }

    /// (f, rectangle, random numbers) → one draw of an estimate of ∫∫ f.
    pub fn rectangle(
        draw: impl Fn(&dyn Fn(f64, f64) -> f64, &Rectangle, &mut Stream) -> f64 + Send + Sync + 'a,
    ) -> Self {
        Self(Kind::Rectangle(Box::new(draw)))
    }

    /// (incoming radiance, ρ, random numbers) → one draw of an estimate of the reflected radiance.
    pub fn hemisphere(
        draw: impl Fn(&dyn Fn(&Direction) -> f64, f64, &mut Stream) -> f64 + Send + Sync + 'a,
    ) -> Self {
        Self(Kind::Hemisphere(Box::new(draw)))
    }

    /// (X, p_rr, random numbers) → one draw of X_rr, where `X(random numbers)` draws X.
    pub fn roulette(
        draw: impl Fn(&mut dyn FnMut(&mut Stream) -> f64, f64, &mut Stream) -> f64 + Send + Sync + 'a,
    ) -> Self {
        Self(Kind::Roulette(Box::new(draw)))
    }

    /// (p_rr, random numbers) → one draw of the number of bounces N.
    pub fn bounces(draw: impl Fn(f64, &mut Stream) -> f64 + Send + Sync + 'a) -> Self {
        Self(Kind::Bounces(Box::new(draw)))
    }

    /// (ρ, L, bounces, random numbers) → one draw of an estimate of the light after that many bounces, or all of them (`None`).
    pub fn furnace(draw: impl Fn(f64, f64, Option<u32>, &mut Stream) -> f64 + Send + Sync + 'a) -> Self {
        Self(Kind::Furnace(Box::new(draw)))
    }

    /// The topic it belongs to.
    pub fn topic(&self) -> Topic {
        match self.0 {
            Kind::Exponential(_) => Topic::Exponential,
            Kind::Rectangle(_) => Topic::Rectangle,
            Kind::Hemisphere(_) => Topic::Hemisphere,
            Kind::Roulette(_) => Topic::Roulette,
            Kind::Bounces(_) => Topic::Bounces,
            Kind::Furnace(_) => Topic::Furnace,
        }
    }

    /// The attempt on a probe, as an estimator of [`Probe::truth`].
    ///
    /// # Errors
    /// If the probe belongs to another topic.
    pub fn at<'p>(&'p self, probe: &'p Probe) -> Result<impl Estimator + 'p> {
        if self.topic() == probe.topic() {
            Ok(from_fn(|rng| self.draw(probe, rng)))
        } else {
            let (attempt, probe) = (self.topic(), probe.topic());
            Err(Error::Usage(format!("an attempt at “{attempt}” cannot be tried on a probe of “{probe}”")))
        }
    }

    fn draw(&self, probe: &Probe, rng: &mut Stream) -> f64 {
        match (&self.0, probe.setup) {
            (Kind::Exponential(draw), Setup::Exponential { rate, statistic }) => {
                statistic.of(draw(rate, rng), rate)
            }
            (Kind::Rectangle(draw), Setup::Rectangle { rectangle, surface }) => {
                draw(&|x, y| surface.at(x, y), &rectangle, rng)
            }
            (Kind::Hemisphere(draw), Setup::Hemisphere { sky, albedo }) => {
                draw(&|direction| sky.radiance(direction), albedo, rng)
            }
            (Kind::Roulette(draw), Setup::Roulette { p_rr }) => draw(&mut roulette::x, p_rr, rng),
            (Kind::Bounces(draw), Setup::Bounces { p_rr }) => draw(p_rr, rng),
            (Kind::Furnace(draw), Setup::Furnace { albedo, emission, bounces }) => {
                draw(albedo, emission, bounces, rng)
            }
            _ => f64::NAN,
        }
    }
}

impl fmt::Debug for Attempt<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_tuple("Attempt").field(&self.topic()).finish()
    }
}

/// A classic mistake: what it is, how to mend it, and the estimator that commits it.
#[derive(Debug)]
pub struct Mistake {
    words: Words,
    wrong: Attempt<'static>,
    expected: Expected,
    random_numbers: usize,
    spreads: OnceLock<Vec<Option<f64>>>,
}

/// What a mistake is, in words.
#[derive(Debug, Clone, Copy)]
struct Words {
    question: &'static str,
    name: &'static str,
    formula: &'static str,
    fix: &'static str,
}

const fn words(
    question: &'static str,
    name: &'static str,
    formula: &'static str,
    fix: &'static str,
) -> Words {
    Words { question, name, formula, fix }
}

/// What the mistake's draws average to.
enum Expected {
    Closed(Box<dyn Fn(&Setup) -> f64 + Send + Sync>),
    /// By quadrature of the wrong estimator.
    Quadrature,
}

impl fmt::Debug for Expected {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Closed(_) => "Closed",
            Self::Quadrature => "Quadrature",
        })
    }
}

impl Mistake {
    fn new(
        words: Words,
        random_numbers: usize,
        wrong: Attempt<'static>,
        expected: impl Fn(&Setup) -> f64 + Send + Sync + 'static,
    ) -> Self {
        let expected = Expected::Closed(Box::new(expected));
        Self { words, wrong, expected, random_numbers, spreads: OnceLock::new() }
    }

    fn by_quadrature(words: Words, random_numbers: usize, wrong: Attempt<'static>) -> Self {
        Self { words, wrong, expected: Expected::Quadrature, random_numbers, spreads: OnceLock::new() }
    }

    /// What it is called.
    pub fn name(&self) -> &'static str {
        self.words.name
    }

    /// The worksheet's question in which it is made.
    pub fn question(&self) -> &'static str {
        self.words.question
    }

    /// The formula that commits it.
    pub fn formula(&self) -> &'static str {
        self.words.formula
    }

    /// How to mend it.
    pub fn fix(&self) -> &'static str {
        self.words.fix
    }

    /// The topic it belongs to.
    pub fn topic(&self) -> Topic {
        self.wrong.topic()
    }

    /// The wrong estimator itself.
    pub fn wrong(&self) -> &Attempt<'static> {
        &self.wrong
    }

    /// How many random numbers a draw takes at most, where that is fixed.
    pub fn random_numbers(&self) -> Option<usize> {
        (self.random_numbers > 0).then_some(self.random_numbers)
    }

    /// What its draws average to on a probe; infinite where they have no mean, NaN on a probe of another topic.
    pub fn expected(&self, probe: &Probe) -> f64 {
        match &self.expected {
            _ if probe.topic() != self.topic() => f64::NAN,
            Expected::Closed(expected) => expected(&probe.setup),
            Expected::Quadrature => self.exactly(probe).map_or(f64::NAN, |exact| exact.mean),
        }
    }

    /// The same divided by [`Probe::unit`]: the truth, where that is not 0.
    pub fn ratio(&self, probe: &Probe) -> f64 {
        self.expected(probe) / probe.unit()
    }

    /// The std deviation of its draws on a probe by quadrature, where a draw takes at most 3 random numbers.
    ///
    /// Mistakes with equal means are told apart by it. Where the variance is infinite a large number comes out.
    pub fn spread(&self, probe: &Probe) -> Option<f64> {
        let spread = |probe: &Probe| self.exactly(probe).map(|exact| exact.variance.sqrt());
        let probes = self.topic().probes();
        match probes.iter().position(|other| other == probe) {
            Some(index) => *self.spreads.get_or_init(|| probes.iter().map(spread).collect()).get(index)?,
            None => spread(probe),
        }
    }

    /// Whether the probes tell it from `other` by their means: some ratio differs.
    pub fn told_apart<'p>(&self, other: &Self, probes: impl IntoIterator<Item = &'p Probe>) -> bool {
        probes.into_iter().any(|probe| {
            let (here, there) = (self.ratio(probe), other.ratio(probe));
            // equality covers infinite ratios
            let same = here == there || (here - there).abs() <= SAME * here.abs().min(there.abs()).max(1.0);
            !same
        })
    }

    /// Whether the probes see it at all, given unlimited draws: some ratio is not a right estimator's.
    pub fn is_seen_by(&self, probe: &Probe) -> bool {
        let invisible = (self.ratio(probe) - probe.right_ratio()).abs() <= SAME;
        !invisible
    }

    /// Whether the probes tell it from `other` by the std deviation of the draws, to one part in ten.
    pub fn told_apart_by_spread<'p>(
        &self,
        other: &Self,
        probes: impl IntoIterator<Item = &'p Probe>,
    ) -> bool {
        probes.into_iter().any(|probe| match (self.spread(probe), other.spread(probe)) {
            (Some(here), Some(there)) => (here - there).abs() > 0.1 * here.max(there),
            _ => false,
        })
    }

    /// The mean and variance of its draws on a probe by quadrature of the wrong estimator itself, where a draw takes at most 3 random numbers.
    pub fn exactly(&self, probe: &Probe) -> Option<Exact> {
        let estimator = self.wrong.at(probe).ok()?;
        exactly(&estimator, self.random_numbers()?).ok()
    }
}

/// Ratios closer than this are the same but for rounding.
const SAME: f64 = 1e-8;
