//! The result of a comparison, and the ranking of its rivals.

use super::REAL;
use super::measured::{Measured, Nature};

/// The result of a comparison.
///
/// `{}` formats it as a table for people; [`csv`](Self::csv) gives the same for programs, and
/// `trade::figures::comparison` draws it.
#[derive(Debug, Clone, PartialEq)]
pub struct Comparison {
    /// The seed of all draws.
    pub seed: u64,
    /// The truth.
    pub truth: f64,
    /// The std error of the truth; 0 if it is exact.
    pub truth_error: f64,
    /// The rivals, in the order given.
    pub rivals: Vec<Measured>,
}

/// A rival's place in the ranking, which has no biased ones.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ranked<'a> {
    /// The rival.
    pub rival: &'a Measured,
    /// 1 + the number of rivals that are really better. Rivals of rank 1 cannot be distinguished from the
    /// best.
    pub rank: usize,
    /// Its efficiency divided by the best one's; if both have no variance, the best one's time divided by its
    /// own.
    pub of_the_best: f64,
    /// Whether the previous one is really better; true for the first.
    pub set_apart: bool,
}

impl Comparison {
    /// The unbiased rivals by efficiency 1/(σ² t), the best first: first those without variance by their
    /// time, last those of infinite variance.
    ///
    /// One is *really better* than another if its ln(efficiency) is larger by more than three std errors of
    /// the difference. These follow from the relative std errors of variances (from the spread over batches)
    /// and times (of a median, from the quartiles). A rival with a heavy tail is never really better, since
    /// its variance may be larger than measured.
    pub fn ranking(&self) -> Vec<Ranked<'_>> {
        let mut order: Vec<&Measured> =
            self.rivals.iter().filter(|rival| rival.nature != Nature::Biased).collect();
        order.sort_by(|a, b| {
            let by_time =
                || if a.varies() { std::cmp::Ordering::Equal } else { a.seconds.total_cmp(&b.seconds) };
            b.efficiency().total_cmp(&a.efficiency()).then_with(by_time)
        });
        let mut places: Vec<Ranked<'_>> = Vec::new();
        for &rival in &order {
            let better = order.iter().filter(|other| is_really_better(other, rival)).count();
            let set_apart = places.last().is_none_or(|before| is_really_better(before.rival, rival));
            let best = order.first().copied().unwrap_or(rival);
            let of_the_best = match (best.varies(), rival.varies()) {
                (true, true) if best.efficiency() > 0.0 => rival.efficiency() / best.efficiency(),
                (false, false) => best.seconds / rival.seconds,
                _ => 0.0,
            };
            places.push(Ranked { rival, rank: 1 + better, of_the_best, set_apart });
        }
        places
    }

    /// The slope of a rival's error against its number of points, ½ Δln σ²/Δln points, measured from the
    /// rival of its series with the fewest points: −½ for independent points. None for that rival itself, for
    /// one in no series, and if a variance is infinite or only rounding.
    pub fn slope(&self, rival: &Measured) -> Option<f64> {
        let ok = |one: &Measured| one.varies() && one.variance().is_finite() && one.evaluations > 0.0;
        let siblings = self.rivals.iter().filter(|other| other.series == rival.series && ok(other));
        let first = siblings.min_by(|a, b| a.evaluations.total_cmp(&b.evaluations))?;
        let apart = rival.series.is_some() && ok(rival) && rival.evaluations > first.evaluations;
        apart.then(|| {
            0.5 * (rival.variance() / first.variance()).ln() / (rival.evaluations / first.evaluations).ln()
        })
    }

    /// When the most efficient unbiased rival overtakes a biased one, after T = (σ_r² t_r − σ² t)/β² seconds;
    /// `None` if this rival is not biased, or none is unbiased.
    pub(super) fn crossing(&self, rival: &Measured) -> Option<Crossing> {
        let ranking = self.ranking();
        let best = ranking.iter().map(|place| place.rival).find(|best| best.nature == Nature::Unbiased)?;
        let lead = best.variance() * best.seconds - rival.variance() * rival.seconds;
        (rival.nature == Nature::Biased).then(|| {
            if lead <= 0.0 {
                Crossing::FromTheStart
            } else if rival.bias_seen() {
                let seconds = lead / rival.bias().powi(2);
                Crossing::At { seconds, rmse: best.rmse(seconds) }
            } else {
                Crossing::Unknown
            }
        })
    }
}

/// When an unbiased rival becomes better than a biased one.
pub(super) enum Crossing {
    /// It is as good or better from the start.
    FromTheStart,
    /// It is worse at first and better from here on, where both have this root mean square error in the
    /// truth's unit.
    At { seconds: f64, rmse: f64 },
    /// That depends on a bias that is not seen.
    Unknown,
}

/// Whether `a` is more efficient than `b` by more than the noise.
fn is_really_better(a: &Measured, b: &Measured) -> bool {
    let infinite = |one: &Measured| one.nature == Nature::InfiniteVariance;
    if infinite(a) || infinite(b) {
        return !infinite(a);
    }
    match (a.varies(), b.varies()) {
        _ if a.heavy_tail && a.varies() => false,
        (true, true) => {
            let lead = (a.efficiency() / b.efficiency()).ln();
            lead > REAL * a.efficiency_error().hypot(b.efficiency_error())
        }
        (false, false) => {
            let lead = (b.seconds / a.seconds).ln();
            lead > REAL * a.time_error().hypot(b.time_error())
        }
        (a_varies, _) => !a_varies,
    }
}
