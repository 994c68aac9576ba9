//! Running estimators: budgets are kept, errors named. That threads and shards have the same bits is in
//! `estimators.rs`.

mod common;
#[path = "run/streams.rs"]
mod streams;

use std::sync::atomic::{AtomicU64, Ordering::SeqCst};
use std::time::Duration;

use unbiased::inversion::Exponential;
use unbiased::{Budget, Error, Estimate, Estimator, Outcome, Run, Stream, estimate, from_fn};

#[test]
fn a_draw_that_is_not_finite_ends_the_run_and_is_named() {
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        // the only uniform number of this stream below 1e-5 decides which draw it is
        let sometimes = from_fn(|rng| if rng.uniform() < 1e-5 { bad } else { 1.0 });
        let mut errors = Vec::new();
        for threads in [1, 2, 8] {
            let run = Run::new(common::seed(7)).threads(threads);
            errors.push(run.estimate(&sometimes, Budget::Draws(3_000_000)).unwrap_err());
        }
        let Error::Draw { seed, block, draw, value } = errors[0].clone() else { panic!("{:?}", errors[0]) };
        assert_eq!(errors.iter().map(ToString::to_string).collect::<std::collections::HashSet<_>>().len(), 1);
        assert_eq!(value.to_bits(), bad.to_bits());
        // the name is right: the same stream gives the same draw there, and none before it
        let mut rng = Stream::new(seed, block);
        let mut finite = || {
            let finite = sometimes.draw(&mut rng).is_finite();
            rng.next_draw();
            finite
        };
        let position = (0..).find(|_| !finite()).unwrap();
        assert_eq!(position, draw);
    }
}

#[test]
fn an_empty_budget_is_an_error() {
    let one = from_fn(|_| 1.0);
    for budget in [
        Budget::Draws(0),
        Budget::StdError(0.0),
        Budget::StdError(-1.0),
        Budget::StdError(f64::NAN),
        Budget::RelativeError(0.0),
        Budget::RelativeError(f64::NAN),
        Budget::Time(Duration::ZERO),
    ] {
        assert!(estimate(&one, budget, 1).is_err(), "{budget:?}");
    }
    for threads in [0, 1025, 100_000, usize::MAX] {
        assert!(Run::new(1).threads(threads).estimate(&one, Budget::Draws(1)).is_err(), "{threads}");
    }
}

/// Whether a pilot saw no variance.
fn never_varied(outcome: &Outcome) -> bool {
    outcome.pilot.unwrap().std_error() == Some(0.0)
}

/// The pilot's variance of 10⁶ draws is known to 0.3 %, so the std error reached is within 2 % (7 of its std
/// errors) of the one asked for, if that takes more draws than the pilot.
#[test]
fn a_budget_of_error_reaches_it() {
    let uniform = from_fn(|rng| 1.0 + rng.uniform());
    for seed in 0..5 {
        common::alarm(2.0 * 2.6e-12);
        let outcome = Run::new(common::seed(seed)).estimate(&uniform, Budget::StdError(2e-4)).unwrap();
        let reached = outcome.estimate.std_error().unwrap();
        assert!((reached / 2e-4 - 1.0).abs() <= 0.02, "{reached}");
        let outcome = Run::new(common::seed(seed)).estimate(&uniform, Budget::RelativeError(1e-4)).unwrap();
        let reached = outcome.estimate.std_error().unwrap() / outcome.estimate.mean();
        assert!((reached / 1e-4 - 1.0).abs() <= 0.02, "{reached}");
        assert!(!never_varied(&outcome));
    }
}

/// The result of an error budget is the run of as many draws without one: the pilot leaves no trace in it.
#[test]
fn the_pilot_is_discarded() {
    let uniform = from_fn(|rng| rng.uniform());
    let outcome = Run::new(common::seed(8)).estimate(&uniform, Budget::StdError(1e-4)).unwrap();
    let draws = outcome.estimate.draws();
    let plain = estimate(&uniform, Budget::Draws(draws), common::seed(8)).unwrap();
    assert_eq!(outcome.estimate, plain);
    // and its stream is its own: not the run's first draws
    let pilot = outcome.pilot.unwrap();
    let first = estimate(&uniform, Budget::Draws(pilot.draws()), common::seed(8)).unwrap();
    assert_ne!(pilot, first);
    assert_eq!(outcome.cost.random_numbers, draws + outcome.pilot.unwrap().draws());
}

/// What the pilot saw of rare values, fewer draws than its own might miss: their error bar would be too good
/// to be true.
#[test]
fn an_error_that_is_easily_reached_takes_as_many_draws_as_the_pilot() {
    let rare = from_fn(|rng| if rng.uniform() < 1e-3 { 1.0 } else { 0.0 });
    for budget in [Budget::StdError(0.5), Budget::StdError(f64::INFINITY), Budget::RelativeError(10.0)] {
        let outcome = Run::new(common::seed(11)).estimate(&rare, budget).unwrap();
        assert_eq!(outcome.pilot.unwrap().draws(), 1 << 20);
        assert_eq!(outcome.estimate.draws(), 1 << 20);
        assert!(outcome.estimate.mean() > 0.0 && !never_varied(&outcome));
    }
    // the limit on draws comes first
    let outcome = Run::new(1).max_draws(100).estimate(&Wide, Budget::StdError(1.0)).unwrap();
    assert_eq!(outcome.estimate.draws(), 100);
}

/// Without any variance a pilot gives up after 2²⁴ draws, and what follows is of 2²⁰. A value that comes up
/// once in 10⁶ draws, which the first 2²⁰ may miss, is missed by 2²⁴ with probability 5e-8: the seeds
/// are fixed.
#[test]
fn a_pilot_without_variance_ends_early_but_not_at_once() {
    let still = from_fn(|rng| rng.uniform() * 0.0 + 0.1);
    for budget in [Budget::StdError(1e-9), Budget::RelativeError(1e-9)] {
        let outcome = Run::new(1).estimate(&still, budget).unwrap();
        assert!(never_varied(&outcome) && outcome.shortfall.is_none());
        assert_eq!(outcome.pilot.unwrap().draws(), 1 << 24);
        assert_eq!(outcome.estimate.draws(), 1 << 20);
        assert_eq!(outcome.cost.random_numbers, (1 << 24) + (1 << 20));
    }
    let mut doubled = 0;
    for seed in 0..8 {
        let rare = from_fn(|rng| if rng.uniform() < 1e-6 { 1.0 } else { 0.0 });
        let outcome = Run::new(30 + seed).estimate(&rare, Budget::StdError(1.0)).unwrap();
        assert!(!never_varied(&outcome));
        let pilot = outcome.pilot.unwrap().draws();
        doubled += u64::from(pilot > 1 << 20);
        assert_eq!(outcome.estimate.draws(), pilot);
    }
    // 2²⁰ draws miss it with probability 0.35
    assert!(doubled > 0);
}

#[test]
fn what_is_out_of_reach_is_said_in_few_digits() {
    let uniform = from_fn(|rng| rng.uniform());
    let said = |target| Run::new(1).estimate(&uniform, Budget::StdError(target)).unwrap_err().to_string();
    // σ² = 1/12: 8.3e10 draws, from a pilot whose variance is right to 0.5 %
    assert_eq!(
        said(1e-6),
        "a std error of 1e-6 takes about 8.3e10 draws, more than the limit of 1000000000: ask for a larger \
         error, allow more draws, or give a time"
    );
    assert!(said(1e-300).starts_with("a std error of 1e-300 takes more than 1e300 draws, more than"));
    // to three digits: 1.23e-6
    assert!(said(1.234_567e-6).starts_with("a std error of 1.23e-6 takes about 5.5e10 draws"));
    let relative = Run::new(1).estimate(&from_fn(|rng| rng.uniform() + 1.0), Budget::RelativeError(1e-6));
    assert!(relative.unwrap_err().to_string().starts_with("a std error of 1.5e-6 takes about 3.7e10 draws"));
}

#[test]
fn a_time_limit_ends_a_run_short_of_its_error() {
    let uniform = from_fn(|rng| rng.uniform());
    for budget in [Budget::StdError(1e-300), Budget::StdError(1e-9), Budget::RelativeError(1e-9)] {
        let run = Run::new(common::seed(12)).max_draws(u64::MAX).max_time(Duration::from_millis(200));
        let outcome = run.estimate(&uniform, budget).unwrap();
        let short = outcome.shortfall.unwrap();
        let draws = outcome.estimate.draws();
        assert!(short.draws > draws as f64 && outcome.estimate.std_error().unwrap() > short.std_error);
        assert!(draws >= outcome.pilot.unwrap().draws());
        // as with any number of draws
        assert_eq!(outcome.estimate, estimate(&uniform, Budget::Draws(draws), common::seed(12)).unwrap());
    }
    // within reach of the time, nothing is missing
    let run = Run::new(common::seed(12)).max_time(Duration::from_secs(100));
    let outcome = run.estimate(&uniform, Budget::StdError(2e-4)).unwrap();
    assert_eq!(
        outcome,
        Outcome {
            elapsed: outcome.elapsed,
            ..Run::new(common::seed(12)).estimate(&uniform, Budget::StdError(2e-4)).unwrap()
        }
    );
    assert!(outcome.shortfall.is_none());
    // no time at all: the pilot's beginning, and as many draws again
    let outcome =
        Run::new(1).max_time(Duration::ZERO).estimate(&from_fn(|_| 1.0), Budget::StdError(1.0)).unwrap();
    assert_eq!((outcome.pilot.unwrap().draws(), outcome.estimate.draws()), (64, 64));
    // the limit on draws holds, too
    let run = Run::new(1).max_draws(1_500_000).max_time(Duration::from_secs(100));
    let outcome = run.estimate(&uniform, Budget::StdError(1e-6)).unwrap();
    assert_eq!(outcome.estimate.draws(), 1_500_000);
    assert_eq!(outcome.shortfall.unwrap().to_string(), "a std error of 1e-6 takes about 8.3e10 draws");
}

#[test]
fn a_pilot_that_never_varies_says_so_and_one_out_of_reach_is_an_error() {
    let outcome =
        Run::new(1).max_draws(5_000_000).estimate(&from_fn(|_| 0.1), Budget::StdError(1e-6)).unwrap();
    assert!(never_varied(&outcome));
    assert_eq!(outcome.pilot.unwrap().draws(), 5_000_000);
    assert_eq!(outcome.estimate.draws(), 1 << 20);
    // a mean of 0 has no relative error
    let centred = from_fn(|rng| rng.uniform() - 0.5);
    let run = Run::new(common::seed(9)).max_draws(4_000_000);
    assert!(matches!(run.estimate(&centred, Budget::RelativeError(1e-3)), Err(Error::Budget { .. })));
    let run = Run::new(1).max_draws(1000);
    assert!(matches!(run.estimate(&centred, Budget::StdError(1e-6)), Err(Error::Budget { .. })));
}

#[test]
fn a_budget_of_time_is_kept_and_its_draws_repeat_it() {
    let uniform = from_fn(|rng| rng.uniform());
    let outcome = Run::new(3).estimate(&uniform, Budget::Time(Duration::from_millis(200))).unwrap();
    let again = estimate(&uniform, Budget::Draws(outcome.estimate.draws()), 3).unwrap();
    assert_eq!(outcome.estimate, again);
}

#[test]
fn progress_is_reported_up_to_the_end() {
    let seen = std::cell::RefCell::new(Vec::new());
    let note = |done, total| seen.borrow_mut().push((done, total));
    Run::new(1).progress(&note).estimate(&from_fn(|_| 0.0), Budget::Draws(40_000_000)).unwrap();
    let seen = seen.into_inner();
    assert!(seen.len() > 1 && seen.is_sorted());
    assert_eq!(seen.last(), Some(&(40_000_000, 40_000_000)));
}

/// An estimator that fills side by side.
struct Wide;

impl Estimator for Wide {
    fn draw(&self, rng: &mut Stream) -> f64 {
        rng.uniform()
    }

    fn fill(&self, rng: &mut Stream, draws: &mut [f64]) {
        draws.fill_with(|| 2.0 * rng.uniform());
    }
}

/// E[2U] = 1, std error √(1/3/10⁵): 7 of them is a false alarm of 2.6e-12 and catches a bias of 1.3 %; `draw`
/// would give 1/2.
#[test]
fn a_run_uses_fill_through_references_and_boxes() {
    let direct = estimate(&Wide, Budget::Draws(100_000), common::seed(10)).unwrap();
    assert!((direct.mean() - 1.0).abs() <= common::deviations(7.0) * (1.0f64 / 3.0 / 1e5).sqrt());
    let boxed: Box<dyn Estimator> = Box::new(Wide);
    assert_eq!(estimate(&boxed, Budget::Draws(100_000), common::seed(10)).unwrap(), direct);
    assert_eq!(estimate(&&Wide, Budget::Draws(100_000), common::seed(10)).unwrap(), direct);
}

/// A run of n draws has blocks of the largest power of two up to n/32, and up to 2¹⁴, merged two by two.
#[test]
fn blocks_are_cut_by_the_number_of_draws() {
    let uniform = from_fn(|rng| rng.uniform());
    let seed = common::seed(10);
    for (draws, size) in
        [(1u64, 1), (63, 1), (64, 2), (65_535, 1024), (65_536, 2048), (1 << 20, 1 << 14), (3 << 20, 1 << 14)]
    {
        let mut estimates: Vec<Estimate> = (0..draws.div_ceil(size))
            .map(|block| {
                let mut own = vec![0.0; size.min(draws - block * size) as usize];
                uniform.fill(&mut Stream::new(seed, block), &mut own);
                Estimate::from_draws(&own)
            })
            .collect();
        while estimates.len() > 1 {
            let pairs = estimates.chunks(2).map(|pair| {
                let mut both = pair[0];
                pair[1..].iter().for_each(|right| both.merge(right));
                both
            });
            estimates = pairs.collect();
        }
        assert_eq!(estimate(&uniform, Budget::Draws(draws), seed).unwrap(), estimates[0], "{draws}");
    }
}

/// A clock that only the draws move: what a run makes of its time does not depend on the machine then.
#[derive(Default)]
struct Ticking(AtomicU64);

impl Ticking {
    /// What a draw takes, added to the time by the draw itself.
    fn take(&self, time: Duration) {
        self.0.fetch_add(time.as_nanos() as u64, SeqCst);
    }

    fn read(&self) -> Duration {
        Duration::from_nanos(self.0.load(SeqCst))
    }
}

/// Draws of 1 ns to 10 ms by a clock of their own: within a tenth of the time, or a draw where those are
/// longer than that.
#[test]
fn a_budget_of_time_is_kept_whatever_a_draw_costs() {
    for time in [1_000_000, 100_000_000, 3_000_000_000u64] {
        for cost in [1, 7, 130, 2_000, 41_000, 200_000, 3_100_000, 10_000_000] {
            let clock = Ticking::default();
            let slow = from_fn(|rng| {
                clock.take(Duration::from_nanos(cost));
                rng.uniform()
            });
            if time / cost > 20_000_000 {
                continue;
            }
            let read = || clock.read();
            let run = Run::new(1).threads(1).clock(&read);
            let outcome = run.estimate(&slow, Budget::Time(Duration::from_nanos(time))).unwrap();
            let off = outcome.elapsed.as_nanos().abs_diff(u128::from(time)) as u64;
            // two draws follow a pilot that one alone makes too long
            assert!(
                off <= (time / 10).max(cost) || outcome.estimate.draws() == 2,
                "{cost} ns for {time} ns: {off}"
            );
            assert!(outcome.elapsed == clock.read() && outcome.estimate.draws() >= 2);
            let again = Run::new(1).estimate(&slow, Budget::Draws(outcome.estimate.draws())).unwrap();
            assert_eq!(outcome.estimate, again.estimate);
        }
    }
}

/// Draws that take the longer the larger they are: a run that stopped by the clock would favour the small
/// ones. 10⁴ seeds of some 10 draws each: |z| ≥ 7 is a false alarm of 2.6e-12. The std error is 0.0039, so
/// that a bias of 5 % is seen with near certainty (z = 12.8). A pilot that takes the run's own draws has one
/// of 14 % here.
#[test]
fn a_budget_of_time_is_unbiased_where_work_depends_on_the_value() {
    let mut means = Estimate::new();
    for seed in 0..10_000 {
        let clock = Ticking::default();
        let exponential = Exponential::new(1.0).unwrap();
        let slow = from_fn(|rng| {
            let x = exponential.draw(rng);
            clock.take(Duration::from_secs_f64(1e-3 * x));
            x
        });
        let read = || clock.read();
        let run = Run::new(common::seed(1000 + seed)).threads(1).clock(&read);
        means.push(run.estimate(&slow, Budget::Time(Duration::from_millis(12))).unwrap().estimate.mean());
    }
    let z = means.z(1.0).unwrap();
    println!("{means}, z = {z}");
    assert!(z.abs() <= common::deviations(7.0), "{z}");
}

#[test]
fn a_time_that_cannot_be_kept_is_an_error_or_two_draws() {
    let uniform = from_fn(|rng| rng.uniform());
    for threads in [1, 2, 8] {
        for nanoseconds in [1, 50_000] {
            let run = Run::new(1).threads(threads);
            let outcome = run.estimate(&uniform, Budget::Time(Duration::from_nanos(nanoseconds))).unwrap();
            assert!(outcome.estimate.draws() >= 2 && outcome.estimate.mean().is_finite());
        }
        // a draw that takes longer than the whole time
        let sleepy = from_fn(|rng| {
            std::thread::sleep(Duration::from_millis(2));
            rng.uniform()
        });
        let run = Run::new(1).threads(threads);
        let outcome = run.estimate(&sleepy, Budget::Time(Duration::from_micros(10))).unwrap();
        assert_eq!(outcome.estimate.draws(), 2);
    }
    for time in [Duration::from_secs(1_000_000_000), Duration::MAX] {
        let error = Run::new(1).estimate(&uniform, Budget::Time(time)).unwrap_err();
        assert!(
            error.to_string().starts_with("the time in seconds must be positive and at most 1e6"),
            "{error}"
        );
    }
    // a clock that stands still, and one that goes back
    let still = || Duration::ZERO;
    let reads = AtomicU64::new(1 << 40);
    let back = || Duration::from_nanos(reads.fetch_sub(1000, SeqCst));
    for threads in [1, 2] {
        for clock in [&still as &unbiased::Clock<'_>, &back] {
            let run = Run::new(1).threads(threads).clock(clock);
            let found = run.estimate(&uniform, Budget::Time(Duration::from_millis(1)));
            assert_eq!(found, Err(Error::Clock));
            // other budgets do not mind
            let run = run.max_draws(1 << 21).max_time(Duration::from_secs(1));
            assert_eq!(run.estimate(&uniform, Budget::Draws(10)).unwrap().estimate.draws(), 10);
            assert!(run.estimate(&uniform, Budget::StdError(1e-9)).unwrap().shortfall.is_some());
        }
    }
}

/// A pilot of draws that are much work is short: 2²⁰ draws of 10⁶ random numbers each would take an hour.
#[test]
fn a_pilot_of_expensive_draws_is_short() {
    let expensive = from_fn(|rng| {
        rng.count_evaluations(1_000_000);
        rng.uniform()
    });
    let outcome = Run::new(1).estimate(&expensive, Budget::StdError(1.0)).unwrap();
    assert_eq!(outcome.pilot.unwrap().draws(), 64);
    let still = from_fn(|rng| {
        rng.count_evaluations(1_000_000);
        1.0
    });
    let outcome = Run::new(1).estimate(&still, Budget::StdError(1.0)).unwrap();
    assert!(never_varied(&outcome) && outcome.pilot.unwrap().draws() == 512);
    assert_eq!(outcome.estimate.draws(), 512);
}
