//! Speed against accuracy: what a second buys.
//!
//! Rival estimators of one quantity differ in the variance of a draw and in the time that it takes. What counts is the product: after T seconds the std error of an estimator whose draws have
//! variance σ² and take t seconds is √(σ² t/T), so its *efficiency* is 1/(σ² t) (Hammersley & Handscomb 1964, section 5.1; *Physically Based Rendering*, 4th ed., section 2.2), and the
//! time to a given error is proportional to σ² t. [`Trade`] measures both for any set of rivals, side by side.
//!
//! Draws that are not independent of each other, such as jittered or Sobol points, come in replicates: there a draw is a whole replicate, and its work is counted. A biased rival has a
//! root mean square error √(β² + σ² t/T), which stops at its bias β: [`Measured::overtaken_at`] says when an unbiased one is better. An infinite variance is never averaged away: an
//! estimator that declares it has no efficiency, and one whose variance hangs on a few draws is marked.

use std::time::{Duration, Instant};

use crate::error::{Result, require};
use crate::estimate::Estimate;
use crate::run::{Cost, Estimator, walk_block};

/// One of the estimators that are compared.
pub struct Rival<'a> {
    name: String,
    estimator: Box<dyn Estimator + 'a>,
    nature: Nature,
}

/// What is known of an estimator beforehand.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Nature {
    /// Its mean is the quantity.
    Unbiased,
    /// Its mean is something else.
    Biased,
    /// Its mean is the quantity, and its variance is infinite: no number of draws has an error bar to trust.
    InfiniteVariance,
}

impl<'a> Rival<'a> {
    /// An unbiased estimator.
    pub fn new(name: impl Into<String>, estimator: impl Estimator + 'a) -> Self {
        Self { name: name.into(), estimator: Box::new(estimator), nature: Nature::Unbiased }
    }

    /// The same, of which this is known.
    pub fn nature(self, nature: Nature) -> Self {
        Self { nature, ..self }
    }
}

/// A comparison to be made.
///
/// ```
/// use unbiased::hemisphere::Hemisphere::{Cosine, Uniform};
/// use unbiased::lambertian::Lambertian;
/// use unbiased::trade::{Rival, Trade};
///
/// let surface = Lambertian::new(0.8)?;
/// let light = |w: &unbiased::hemisphere::Direction| w.cos_theta();
/// let rivals = [Uniform, Cosine].map(|p| Rival::new(format!("{p:?}"), surface.estimator(light, p)));
/// let trade = Trade::new(1, 1.6 / 3.0)?.seconds_each(0.02)?.compare(&rivals)?;
/// let [uniform, cosine] = &trade.rivals[..] else { panic!() };
/// assert!(cosine.variance() < uniform.variance());
/// println!("{}", trade.csv());
/// # Ok::<(), unbiased::Error>(())
/// ```
#[derive(Debug, Clone, Copy)]
pub struct Trade {
    seed: u64,
    truth: f64,
    seconds: f64,
}

/// Batches a rival: their spread is the error of its variance and time.
const BATCHES: u64 = 16;

/// A single draw that holds this share of a thousand draws' squares or more: their variance is not known, and may be infinite.
const HEAVY: f64 = 0.02;

impl Trade {
    /// A comparison of estimators of `truth`, a quarter of a second each.
    ///
    /// # Errors
    /// If the truth is not finite.
    pub fn new(seed: u64, truth: f64) -> Result<Self> {
        require("the truth", truth, truth.is_finite(), "finite")?;
        Ok(Self { seed, truth, seconds: 0.25 })
    }

    /// Takes this many seconds for each rival.
    ///
    /// # Errors
    /// If they are not positive and finite.
    pub fn seconds_each(self, seconds: f64) -> Result<Self> {
        let ok = seconds > 0.0 && seconds.is_finite();
        Ok(Self { seconds: require("the time in seconds", seconds, ok, "positive and finite")?, ..self })
    }

    /// Measures the rivals on one core, in turns, so that what disturbs the machine disturbs all alike.
    ///
    /// # Errors
    /// If a draw is NaN or infinite.
    pub fn compare(&self, rivals: &[Rival<'_>]) -> Result<Comparison> {
        let mut runs = Vec::new();
        for rival in rivals {
            runs.push(Batches { draws: self.warm_up(rival)?, results: Vec::new() });
        }
        for batch in 0..BATCHES {
            for (rival, run) in rivals.iter().zip(&mut runs) {
                run.results.push(Batch::take(&*rival.estimator, self.seed, batch, run.draws)?);
            }
        }
        let measured = rivals.iter().zip(&runs).map(|(rival, run)| run.measured(rival, self.truth));
        Ok(Comparison { seed: self.seed, truth: self.truth, rivals: measured.collect() })
    }

    /// Draws to warm up, until it is known how many fill a batch.
    fn warm_up(&self, rival: &Rival<'_>) -> Result<u64> {
        let aim = self.seconds / BATCHES as f64;
        let mut draws = 64;
        loop {
            // blocks that no batch uses
            let batch = Batch::take(&*rival.estimator, self.seed, u64::MAX, draws)?;
            let taken = batch.elapsed.as_secs_f64();
            if taken >= 0.5 * aim || draws >= 1 << 40 {
                let scaled = draws as f64 * aim / taken.max(1e-9);
                return Ok((scaled as u64).clamp(64, 1 << 40));
            }
            draws *= 2;
        }
    }
}

/// What one batch of draws gave and took.
struct Batch {
    estimate: Estimate,
    least: f64,
    most: f64,
    cost: Cost,
    elapsed: Duration,
}

impl Batch {
    fn take(estimator: &dyn Estimator, seed: u64, block: u64, draws: u64) -> Result<Self> {
        let (mut estimate, mut least, mut most) = (Estimate::new(), f64::INFINITY, f64::NEG_INFINITY);
        let start = Instant::now();
        let cost = walk_block(estimator, seed, block, draws, |slice| {
            estimate.extend_from_slice(slice);
            least = slice.iter().copied().fold(least, f64::min);
            most = slice.iter().copied().fold(most, f64::max);
            Ok(())
        })?;
        Ok(Self { estimate, least, most, cost, elapsed: start.elapsed() })
    }
}

struct Batches {
    draws: u64,
    results: Vec<Batch>,
}

impl Batches {
    fn measured(&self, rival: &Rival<'_>, truth: f64) -> Measured {
        let mut all = Estimate::new();
        let (mut variances, mut cost) = (Estimate::new(), Cost::default());
        let (mut least, mut most) = (f64::INFINITY, f64::NEG_INFINITY);
        for batch in &self.results {
            all.merge(&batch.estimate);
            variances.push(batch.estimate.variance().unwrap_or(0.0));
            least = least.min(batch.least);
            most = most.max(batch.most);
            cost.evaluations += batch.cost.evaluations;
            cost.random_numbers += batch.cost.random_numbers;
        }
        let draws = all.draws() as f64;
        let variance = all.variance().unwrap_or(0.0);
        let furthest = (most - all.mean()).abs().max((all.mean() - least).abs());
        let share = if variance > 0.0 { furthest * furthest / (variance * draws) } else { 0.0 };
        let mut times: Vec<f64> =
            self.results.iter().map(|batch| batch.elapsed.as_secs_f64() / self.draws as f64).collect();
        times.sort_by(f64::total_cmp);
        let quantile =
            |part: f64| times.get((part * times.len() as f64) as usize).copied().unwrap_or(f64::NAN);
        Measured {
            name: rival.name.clone(),
            nature: rival.nature,
            estimate: all,
            truth,
            variance_error: variances.std_error().unwrap_or(f64::NAN),
            heavy_tail: share > HEAVY,
            evaluations: cost.evaluations as f64 / draws,
            random_numbers: cost.random_numbers as f64 / draws,
            seconds: quantile(0.5),
            seconds_range: [quantile(0.25), quantile(0.75)],
        }
    }
}

/// What was measured of one rival; variance, work and time are those of one draw.
#[derive(Debug, Clone, PartialEq)]
pub struct Measured {
    /// Its name.
    pub name: String,
    /// What it was declared to be.
    pub nature: Nature,
    /// What its draws gave.
    pub estimate: Estimate,
    /// What is estimated.
    pub truth: f64,
    /// The standard error of the variance, from batches.
    pub variance_error: f64,
    /// Whether a single draw holds 2 % of the sum of squares or more: the variance is not to be trusted, and may be infinite.
    pub heavy_tail: bool,
    /// Evaluations of the integrand (or rays, or vertices) that a draw takes.
    pub evaluations: f64,
    /// Random numbers that a draw takes.
    pub random_numbers: f64,
    /// Seconds that a draw takes: the median of the batches.
    pub seconds: f64,
    /// The quartiles of that.
    pub seconds_range: [f64; 2],
}

impl Measured {
    /// The variance of a draw.
    pub fn variance(&self) -> f64 {
        self.estimate.variance().unwrap_or(f64::NAN)
    }

    /// The bias: mean − truth of a biased rival, 0 of an unbiased one.
    pub fn bias(&self) -> f64 {
        if self.nature == Nature::Biased { self.estimate.mean() - self.truth } else { 0.0 }
    }

    /// 1/(variance × seconds); infinite where nothing varies, 0 where the variance is infinite.
    pub fn efficiency(&self) -> f64 {
        match self.nature {
            Nature::InfiniteVariance => 0.0,
            _ if !self.varies() => f64::INFINITY,
            _ => (self.variance() * self.seconds).recip(),
        }
    }

    /// Whether the draws differ by more than rounding.
    pub fn varies(&self) -> bool {
        self.variance().sqrt() > 8.0 * f64::EPSILON * self.estimate.mean().abs()
    }

    /// The standard error of ln efficiency, by those of variance and time.
    fn efficiency_error(&self) -> f64 {
        let [low, high] = self.seconds_range;
        // of a median of normal values, by their quartiles
        let of_time = 1.253 * (high - low) / 1.349 / (BATCHES as f64).sqrt() / self.seconds;
        let of_variance = if self.variance() > 0.0 { self.variance_error / self.variance() } else { 0.0 };
        of_time.hypot(of_variance)
    }

    /// The root mean square error after `seconds` on one core.
    pub fn rmse(&self, seconds: f64) -> f64 {
        if self.nature == Nature::InfiniteVariance {
            return f64::INFINITY;
        }
        (self.variance() * self.seconds / seconds).sqrt().hypot(self.bias())
    }

    /// The seconds to this root mean square error relative to the truth; None if it is out of reach, because of the bias, an infinite variance, or a truth of 0.
    pub fn seconds_to(&self, relative: f64) -> Option<f64> {
        let (aim, bias) = ((relative * self.truth).abs(), self.bias().abs());
        let reachable = aim > bias && self.nature != Nature::InfiniteVariance;
        reachable.then(|| (self.variance() * self.seconds / ((aim - bias) * (aim + bias))).max(self.seconds))
    }

    /// After how many seconds, and at which root mean square error, an unbiased `rival` overtakes this biased one. None if it never does, or is ahead from the start.
    pub fn overtaken_at(&self, rival: &Self) -> Option<[f64; 2]> {
        let lead = rival.variance() * rival.seconds - self.variance() * self.seconds;
        let both = self.nature == Nature::Biased && rival.nature == Nature::Unbiased;
        if !both || lead <= 0.0 || self.bias() == 0.0 {
            return None;
        }
        let seconds = lead / self.bias().powi(2);
        Some([seconds, rival.rmse(seconds)])
    }
}

/// What a comparison found.
#[derive(Debug, Clone, PartialEq)]
pub struct Comparison {
    /// The seed of all draws.
    pub seed: u64,
    /// What was estimated.
    pub truth: f64,
    /// The rivals, in the order in which they were given.
    pub rivals: Vec<Measured>,
}

/// A rival's place.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Place<'a> {
    /// The rival.
    pub rival: &'a Measured,
    /// Its efficiency as a part of the best one's.
    pub of_the_best: f64,
    /// Whether it is worse than the one before by more than three standard errors; true of the first.
    pub set_apart: bool,
}

impl Comparison {
    /// The rivals without bias by their efficiency, the best first.
    pub fn ranking(&self) -> Vec<Place<'_>> {
        let mut order: Vec<&Measured> =
            self.rivals.iter().filter(|rival| rival.nature != Nature::Biased).collect();
        order.sort_by(|a, b| b.efficiency().total_cmp(&a.efficiency()));
        let best = order.first().map_or(f64::NAN, |best| best.efficiency());
        let mut places: Vec<Place<'_>> = Vec::new();
        for rival in order {
            let set_apart = places.last().is_none_or(|before| {
                let lead = (before.rival.efficiency() / rival.efficiency()).ln();
                // NaN of two that do not vary: neither leads
                lead > 3.0 * before.rival.efficiency_error().hypot(rival.efficiency_error())
            });
            let of_the_best = if rival.efficiency() == best { 1.0 } else { rival.efficiency() / best };
            places.push(Place { rival, of_the_best, set_apart });
        }
        places
    }

    /// A line a rival, with the columns' names first, for other programs.
    pub fn csv(&self) -> String {
        let mut csv = String::from(
            "name,nature,draws,mean,std_error,truth,variance,variance_error,heavy_tail,evaluations,random_numbers,seconds,seconds_low,seconds_high,efficiency,seconds_to_1e-2,seconds_to_1e-3,seconds_to_1e-4,seconds_to_1e-5\n",
        );
        for rival in &self.rivals {
            let nature = match rival.nature {
                Nature::Unbiased => "unbiased",
                Nature::Biased => "biased",
                Nature::InfiniteVariance => "infinite_variance",
            };
            let [low, high] = rival.seconds_range;
            let Measured { truth, variance_error, heavy_tail, evaluations, random_numbers, seconds, .. } =
                rival;
            let (draws, mean, variance) = (rival.estimate.draws(), rival.estimate.mean(), rival.variance());
            let std_error = rival.estimate.std_error().unwrap_or(f64::NAN);
            let to = [1e-2, 1e-3, 1e-4, 1e-5]
                .map(|error| rival.seconds_to(error).map_or(String::new(), |seconds| seconds.to_string()));
            csv += &format!(
                "\"{}\",{nature},{draws},{mean},{std_error},{truth},{variance},{variance_error},{heavy_tail},{evaluations},{random_numbers},{seconds},{low},{high},{},{}\n",
                rival.name.replace('"', "\"\""),
                rival.efficiency(),
                to.join(",")
            );
        }
        csv
    }
}
