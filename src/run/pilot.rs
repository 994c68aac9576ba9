//! How many draws a budget comes to, by a pilot run whose draws are discarded.

use std::time::Duration;

use super::blocks::{Blocks, LARGEST_BLOCK};
use super::work::{Watch, Work, Workers, one_block};
use super::{Cost, Shortfall};
use crate::error::{Error, Result};
use crate::estimate::Estimate;
use crate::estimator::Estimator;
use crate::stream::mix;

/// Draws in a pilot run's first stage.
const FIRST_STAGE: u64 = 64;

/// Draws of a pilot run of cheap draws: its std error is accurate to 0.1 % if the draws' fourth moment is
/// that of a normal distribution. A draw with more than 16 random numbers or evaluations counts as more than
/// one.
const PILOT_WORK: u64 = 1 << 20;

/// Draws (counted likewise) after which a pilot run without variance ends.
const CONSTANT_WORK: u64 = 1 << 24;

/// Makes the pilot's seeds differ from the run's.
const PILOT_SALT: u64 = 0x7069_6c6f_7420_7275;

/// If a clock has not advanced after this many draws (at least some microseconds), it is taken to stand
/// still.
const CLOCK_DRAWS: u64 = 1 << 16;

impl<E: Estimator + ?Sized> Work<'_, E> {
    /// How many draws fit into `time`, by the speed of all threads in a pilot run of a tenth of it. The
    /// pilot's draws use other streams and are discarded, so the number is independent of the run's values.
    pub fn draws_in(&mut self, time: Duration) -> Result<u64> {
        let (start, seed) = (self.watch.elapsed(), mix(self.run.seed ^ PILOT_SALT));
        let until = start + time.saturating_sub(start) / 10;
        let (estimator, watch) = (self.estimator, &self.watch);
        let pace = |thread: usize| pace(estimator, seed, thread as u64, watch, [start, until]);
        let paces = match &self.workers {
            Workers::Caller => vec![pace(0)],
            Workers::AllCores => rayon::broadcast(|context| pace(context.index())),
            Workers::Own(pool) => pool.broadcast(|context| pace(context.index())),
        };
        let mut draws_per_second = 0.0;
        for pace in paces {
            let (draws_in_a_second, cost) = pace?;
            draws_per_second += draws_in_a_second;
            self.cost.add(cost);
        }
        let left = time.saturating_sub(self.watch.elapsed()).as_secs_f64();
        // a float-to-int cast saturates
        Ok(((draws_per_second * left) as u64).max(2))
    }

    /// The pilot run: doubles its draws, from streams of its own, until it has [`PILOT_WORK`] and its mean
    /// and std error are `enough`, or, while all draws are equal, until [`CONSTANT_WORK`]. The limit on
    /// draws, or a quarter of the run's `max_time`, ends it earlier.
    pub fn pilot(&mut self, enough: impl Fn(f64, f64) -> bool) -> Result<Estimate> {
        let mut pilot = Estimate::new();
        let limit = self.run.max_draws.max(2);
        for stage in 0.. {
            let draws = pilot.draws().max(FIRST_STAGE).min(limit - pilot.draws());
            let mut more = Blocks::starting_at(0);
            let seed = mix(self.run.seed ^ PILOT_SALT.wrapping_add(stage));
            self.extend(&mut more, seed, 0..u64::MAX, draws)?;
            pilot.merge(&more.estimate());
            let work = pilot.draws().max(self.cost.work() / 16);
            let std_error = pilot.std_error().unwrap_or(0.0);
            let long_enough = work >= PILOT_WORK && enough(pilot.mean(), std_error);
            let still = std_error == 0.0 && work >= CONSTANT_WORK;
            let late = self.run.max_time.is_some_and(|time| self.watch.elapsed() >= time / 4);
            if long_enough || still || late || pilot.draws() >= limit {
                break;
            }
        }
        Ok(pilot)
    }

    /// The draws to take for a std error of `target`, by the pilot's variance, and the shortfall if time is
    /// short.
    pub fn needed(&self, pilot: &Estimate, target: f64) -> Result<(u64, Option<Shortfall>)> {
        let reached = pilot.std_error().unwrap_or(0.0);
        // fewer draws than the pilot's might miss rare values that the pilot found
        let fewest = pilot.draws();
        if reached == 0.0 {
            return Ok((fewest.min(PILOT_WORK), None));
        }
        let needed = (fewest as f64 * (reached / target).powi(2)).ceil().max(fewest as f64).min(f64::MAX);
        let limit = match self.run.max_time {
            Some(time) => {
                let elapsed = self.watch.elapsed().as_secs_f64();
                let times = (time.as_secs_f64() - elapsed) / elapsed.max(1e-9);
                ((fewest as f64 * times) as u64).min(self.run.max_draws).max(fewest)
            }
            None => self.run.max_draws.max(fewest),
        };
        if needed <= limit as f64 {
            Ok((needed as u64, None))
        } else if self.run.max_time.is_some() {
            Ok((limit, Some(Shortfall { std_error: target, draws: needed })))
        } else {
            Err(Error::Budget { std_error: target, needed, limit: self.run.max_draws })
        }
    }
}

/// The speed of one thread in draws per second, measured between the two times given.
fn pace(
    estimator: &(impl Estimator + ?Sized),
    seed: u64,
    thread: u64,
    watch: &Watch<'_>,
    [start, until]: [Duration; 2],
) -> Result<(f64, Cost)> {
    let (mut draws, mut chunk, mut cost, mut now) = (0, 1, Cost::default(), start);
    for block in 0.. {
        let (_, of_block) = one_block(estimator, seed, thread << 32 | block, chunk)?;
        cost.add(of_block);
        draws += chunk;
        let before = now;
        now = watch.elapsed();
        if now < before || (now == start && draws >= CLOCK_DRAWS) {
            return Err(Error::Clock);
        }
        if now >= until {
            break;
        }
        // at most what fits into the remaining time
        let room = draws as f64 * (until - now).as_secs_f64() / (now - start).as_secs_f64();
        chunk = (2 * chunk).min(LARGEST_BLOCK).min(room as u64).max(1);
    }
    Ok((draws as f64 / (now - start).as_secs_f64().max(1e-9), cost))
}
