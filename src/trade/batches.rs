//! Draws and times of one rival in batches, whose spread gives the errors of its variance and time.

use std::time::{Duration, Instant};

use super::{COUNT, Measured, Rival, Trade};
use crate::error::Result;
use crate::estimate::{Estimate, SLICE};
use crate::estimator::Estimator;
use crate::run::{Cost, walk_block};

/// Warming up takes the time of this many batches: 1 + ½ + ¼ + … < 2 to find the number of draws, and two
/// more to repeat the last one.
const WARM: u64 = 4;

/// The fewest and the most draws in a batch: a variance needs two.
const FEWEST: u64 = 2;
const MOST: u64 = 1 << 40;

/// The results and the time of one batch of draws.
struct Batch {
    estimate: Estimate,
    least: f64,
    most: f64,
    cost: Cost,
    /// of the whole batch
    elapsed: Duration,
    /// seconds that a draw takes
    seconds: f64,
}

/// Times the clock is read per batch.
const LOOKS: u64 = 256;

impl Batch {
    /// The time of a draw is the median over up to 256 pieces of the batch, each so short that few are
    /// interrupted by other processes.
    fn take(estimator: &dyn Estimator, seed: u64, block: u64, draws: u64) -> Result<Self> {
        let (mut estimate, mut least, mut most) = (Estimate::new(), f64::INFINITY, f64::NEG_INFINITY);
        let piece = draws.div_ceil(SLICE as u64).div_ceil(LOOKS) * SLICE as u64;
        let (start, mut pieces, mut since) = (Instant::now(), Vec::new(), 0);
        let mut looked = start;
        let cost = walk_block(estimator, seed, block, draws, |slice| {
            estimate.extend_from_slice(slice);
            least = slice.iter().copied().fold(least, f64::min);
            most = slice.iter().copied().fold(most, f64::max);
            since += slice.len() as u64;
            if since == piece {
                let now = Instant::now();
                pieces.push((now - looked).as_secs_f64() / since as f64);
                (looked, since) = (now, 0);
            }
            Ok(())
        })?;
        let elapsed = start.elapsed();
        pieces.sort_by(f64::total_cmp);
        // if there is no whole piece: the mean over the batch
        let median = pieces.get(pieces.len().saturating_sub(1) / 2).copied();
        let seconds = median.unwrap_or(elapsed.as_secs_f64() / draws as f64);
        Ok(Self { estimate, least, most, cost, elapsed, seconds })
    }
}

/// The batches of one rival.
pub(super) struct Batches {
    draws: u64,
    taken: Vec<Batch>,
}

impl Batches {
    /// Warms up, and finds how many draws make a batch of the right length.
    pub fn warm_up(estimator: &dyn Estimator, seed: u64, seconds: f64) -> Result<Self> {
        // a block that no batch uses
        let time = |draws| Ok(Batch::take(estimator, seed, u64::MAX, draws)?.elapsed.as_secs_f64());
        let draws = draws_that_take(seconds / (COUNT + WARM) as f64, time)?;
        Ok(Self { draws, taken: Vec::new() })
    }

    pub fn take(&mut self, estimator: &dyn Estimator, seed: u64, batch: u64) -> Result<()> {
        self.taken.push(Batch::take(estimator, seed, batch, self.draws)?);
        Ok(())
    }

    pub fn measured(&self, rival: &Rival<'_>, trade: &Trade) -> Measured {
        let mut all = Estimate::new();
        let (mut variances, mut cost) = (Estimate::new(), Cost::default());
        let (mut least, mut most) = (f64::INFINITY, f64::NEG_INFINITY);
        for batch in &self.taken {
            all.merge(&batch.estimate);
            variances.push(batch.estimate.variance().unwrap_or(0.0));
            least = least.min(batch.least);
            most = most.max(batch.most);
            cost.evaluations += batch.cost.evaluations;
            cost.random_numbers += batch.cost.random_numbers;
        }
        let draws = all.draws() as f64;
        let furthest = (most - all.mean()).abs().max((all.mean() - least).abs());
        let mut times: Vec<f64> = self.taken.iter().map(|batch| batch.seconds).collect();
        times.sort_by(f64::total_cmp);
        let quartile = |k: usize| times.get(k * times.len() / 4).copied().unwrap_or(f64::NAN);
        Measured {
            name: rival.name.clone(),
            series: rival.series.clone(),
            nature: rival.nature,
            estimate: all,
            truth: trade.truth,
            truth_error: trade.truth_error,
            variance_error: variances.std_error().unwrap_or(f64::NAN),
            heavy_tail: is_heavy(furthest, &all),
            evaluations: cost.evaluations as f64 / draws,
            random_numbers: cost.random_numbers as f64 / draws,
            seconds: quartile(2),
            seconds_range: [quartile(1), quartile(3)],
        }
    }
}

/// How many draws take `aim` seconds, where `time` measures a given number of draws.
///
/// An interruption of the last measurement would make all batches too short, so it is repeated twice, and the
/// shortest time counts.
fn draws_that_take(aim: f64, mut time: impl FnMut(u64) -> Result<f64>) -> Result<u64> {
    let mut draws = FEWEST;
    loop {
        let mut taken = time(draws)?;
        for _ in 0..2 {
            if taken >= 0.5 * aim {
                taken = taken.min(time(draws)?);
            }
        }
        if taken >= 0.5 * aim || draws >= MOST {
            let scaled = draws as f64 * aim / taken.max(1e-9);
            return Ok((scaled as u64).clamp(FEWEST, MOST));
        }
        draws *= 2;
    }
}

/// The probability of marking draws whose tails are those of an exponential distribution.
const FALSE_ALARM: f64 = 1e-3;

/// Whether the largest square contributes more to Σ (X − X̄)² than is plausible if the fourth moment is
/// finite; `furthest` is its root, the largest |X − X̄|.
///
/// The share of the largest of n squares falls like 1/n times a slowly growing factor. Its bound is the
/// larger of
/// - ln²(n/p)/n, for tails no heavier than an exponential's: P(|X − μ| > xσ) ≤ e^(−x), so the largest of n is
///   more than ln(n/p) σ from the mean with probability at most p;
/// - 1/√n, for tails that fall like a power. If E\[X⁴\] is finite, n P((X − μ)² > σ²√n) → 0, so the share is
///   finally below the bound; if P(|X| > x) falls like x^(−α) with α < 4, the share falls like n^(2/α − 1),
///   or not at all for α ≤ 2, and is finally above.
///
/// Below 132 draws the first bound is more than 1, so nothing is marked.
fn is_heavy(furthest: f64, all: &Estimate) -> bool {
    let draws = all.draws() as f64;
    let Some(std_error) = all.std_error() else { return false };
    if std_error == 0.0 {
        return false;
    }
    // furthest²/(σ² n), with no square that might overflow
    let share = (furthest / (std_error * draws)).powi(2);
    share > ((draws / FALSE_ALARM).ln().powi(2) / draws).max(draws.sqrt().recip())
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::Ordering::Relaxed;

    use super::*;
    use crate::estimator::from_fn;
    use crate::inversion::Exponential;
    use crate::lambertian::Lambertian;
    use crate::lambertian::hemisphere::Hemisphere::{Cosine, Uniform};
    use crate::paths::room::{BoxRoom, Scene};
    use crate::paths::{Bounces, FindLight, Paths};
    use crate::rectangle::{Integrand, Rectangle};
    use crate::roulette::LightModel;

    /// A clock for draws of `each` seconds, with an interruption of `stop` seconds in the given calls.
    fn clock(each: f64, stop: f64, calls: &[u32]) -> impl FnMut(u64) -> Result<f64> {
        let mut call = 0;
        move |draws| {
            call += 1;
            Ok(draws as f64 * each + if calls.contains(&call) { stop } else { 0.0 })
        }
    }

    #[test]
    fn batches_last_as_long_as_asked_for_and_warming_up_as_long_as_four() {
        for (each, aim) in
            [(1e-9, 1e-3), (1.3e-9, 1e-3), (1.9e-9, 1e-3), (1e-6, 1e-3), (3e-7, 0.02), (1e-4, 0.25)]
        {
            let (mut ticking, mut all) = (clock(each, 0.0, &[]), 0.0);
            let draws = draws_that_take(aim, |draws| {
                let taken = ticking(draws)?;
                all += taken;
                Ok(taken)
            });
            let draws = draws.unwrap();
            // a draw more or less
            assert!((draws as f64 * each - aim).abs() <= 1.01 * each, "{each} {aim}: {draws}");
            assert!(all <= WARM as f64 * aim && all >= aim, "{each} {aim}: {all}");
        }
    }

    /// An interruption of ten batches' time in any call, and two in consecutive calls.
    #[test]
    fn an_interruption_makes_no_batch_short() {
        for first in 1..=14 {
            for calls in [[first, first], [first, first + 1]] {
                let draws = draws_that_take(1e-3, clock(1e-6, 1e-2, &calls)).unwrap();
                assert!((999..=1001).contains(&draws), "{calls:?}: {draws}");
            }
        }
    }

    #[test]
    fn slow_draws_are_few_and_free_ones_are_not_without_end() {
        let mut called = 0;
        let slow = |draws| {
            called += draws;
            Ok(draws as f64)
        };
        assert_eq!(draws_that_take(1e-3, slow).unwrap(), 2);
        assert_eq!(called, 6);
        assert_eq!(draws_that_take(1e-3, |_| Ok(0.0)).unwrap(), MOST);
    }

    /// Draws that take 2 µs or more, with and without whole pieces: a median is at most twice the mean, and
    /// of 3000 draws' three pieces two are whole.
    #[test]
    fn the_time_of_a_draw_is_that_of_one() {
        let slow = from_fn(|rng| {
            let start = Instant::now();
            while start.elapsed() < Duration::from_micros(2) {}
            rng.uniform()
        });
        for draws in [2, 1000, 3000] {
            let batch = Batch::take(&slow, 1, 1, draws).unwrap();
            assert!(batch.seconds >= 2e-6, "{}", batch.seconds);
            assert!(
                batch.seconds <= 2.0 * 1.5 * batch.elapsed.as_secs_f64() / draws as f64,
                "{}",
                batch.seconds
            );
        }
    }

    /// Of seventeen times the ninth is the median, and the fifth and the thirteenth are the quartiles.
    #[test]
    fn times_are_medians_and_quartiles() {
        let of = |k: u64| {
            let estimate = Estimate::from_draws(&[k as f64, 2.0 * k as f64]);
            let cost = Cost { random_numbers: 2, evaluations: 6 };
            Batch {
                estimate,
                least: k as f64,
                most: 2.0 * k as f64,
                cost,
                elapsed: Duration::ZERO,
                seconds: 1e-6 * k as f64,
            }
        };
        // in a permuted order
        let batches = Batches { draws: 2, taken: (0..COUNT).map(|k| of(1 + 5 * k % COUNT)).collect() };
        let trade = Trade::new(1, 1.0).unwrap();
        let found = batches.measured(&Rival::new("", from_fn(|_| 0.0)), &trade);
        let micros = |seconds: f64| (1e6 * seconds).round();
        assert_eq!(
            [found.seconds_range[0], found.seconds, found.seconds_range[1]].map(micros),
            [5.0, 9.0, 13.0]
        );
        assert_eq!((found.evaluations, found.random_numbers, found.estimate.draws()), (3.0, 1.0, 34));
        // k²/2 is a batch's variance: its std error over the batches, by Σ k⁴ and Σ k²
        let (fourths, squares) =
            (1..=17).map(f64::from).fold((0.0, 0.0), |(a, b), k| (a + k.powi(4), b + k * k));
        let variance: f64 = 0.25 * (fourths - squares * squares / 17.0) / 16.0;
        assert!((found.variance_error - (variance / 17.0).sqrt()).abs() <= 1e-12);
    }

    /// How many of `tries` sets of n draws are marked.
    fn alarms(tries: u64, n: u64, estimator: &dyn Estimator) -> u64 {
        let heavy = |block| {
            let batch = Batch::take(estimator, 11, block, n).unwrap();
            is_heavy(
                (batch.most - batch.estimate.mean()).max(batch.estimate.mean() - batch.least),
                &batch.estimate,
            )
        };
        (0..tries).filter(|block| heavy(*block)).count() as u64
    }

    /// At most one set in a thousand with an exponential's tail is marked: more than 19 of 2,000 with
    /// probability 1e-13. (A threshold of 2 % would mark all of them.)
    #[test]
    fn light_tails_are_not_marked() {
        let room = BoxRoom::new(Scene::default()).unwrap();
        let by_throughput =
            Paths::new(room, Bounces::AllByThroughput, Cosine, FindLight::BySampling).unwrap();
        assert!(alarms(2000, 1024, &Exponential::new(1.0).unwrap()) <= 19);
        assert!(alarms(100, 1 << 14, &Exponential::new(1.0).unwrap()) <= 5);
        assert!(alarms(500, 1024, &by_throughput) <= 9);
        // draws within 11 standard deviations are never marked
        let cosine = Lambertian::new(0.8).unwrap().estimator(|w| w.cos_theta().powi(10), Uniform);
        for n in [2, 100, 132, 1024, 1 << 14] {
            assert_eq!(alarms(20, n, &from_fn(|rng| rng.uniform())), 0);
            assert_eq!(alarms(20, n, &cosine), 0);
        }
        // all of the variance in one draw: not marked for up to 131 draws
        let once = std::sync::atomic::AtomicU64::new(0);
        let lonely = from_fn(|_| if once.fetch_add(1, Relaxed) == 5 { 1.0 } else { 0.0 });
        assert_eq!(alarms(1, 131, &lonely), 0);
        once.store(0, Relaxed);
        assert_eq!(alarms(1, 200, &lonely), 1);
    }

    /// With 16,384 draws a tail P(X > x) ~ x⁻² is missed in about 1 of 400 sets, so in more than 5 of 50 with
    /// probability 4e-9; heavier tails are missed less often. With 1,024 draws two thirds are found; with a
    /// tail ~ 1/x, 98 %. The mean over 64² pairs is nearly normal except far in its tail: 1/r by all pairs is
    /// found in 1 of 40 sets of 1,024 draws, 15 of 40 of 16,384, and all of 262,144.
    #[test]
    fn infinite_variances_are_marked() {
        let square = Rectangle::WORKSHEET;
        let inverse = |x: f64, y: f64| Integrand::InverseDistance.at(x, y);
        let model = LightModel::new(0.8, 0.5).unwrap();
        let pareto = |alpha: f64| from_fn(move |rng| (1.0 - rng.uniform()).powf(-1.0 / alpha));
        let heavy: [&dyn Estimator; 6] = [
            &square.independent(inverse),
            &model.roulette(0.2).unwrap(),
            &model.roulette(0.5).unwrap(),
            &pareto(1.0),
            &pareto(1.5),
            &pareto(2.0),
        ];
        for (index, estimator) in heavy.into_iter().enumerate() {
            let found = alarms(50, 1 << 14, estimator);
            assert!(found >= 45, "{index}: {found} of 50");
        }
        // 98.8 of 100 on average: fewer than 80 with a probability below 1e-20
        assert!(alarms(100, 1024, &pareto(1.0)) >= 80);
    }
}
