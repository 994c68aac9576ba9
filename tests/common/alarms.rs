//! False alarms: the random tests say what each comparison may give, and their sum is held as they run.

use std::sync::{Mutex, PoisonError};

/// Test files with the probability that, for fresh seeds, any of their comparisons fails though nothing is
/// wrong. All others are arithmetic, or run with fixed seeds.
pub const BUDGETS: [(&str, f64); 9] = [
    ("estimators", 1e-10),
    ("roulette", 2e-11),
    ("paths", 5.2e-13),
    ("placement", 4.2e-12),
    ("estimate", 5e-12),
    ("run", 3e-10),
    ("trade", 2e-11),
    ("examples", 1e-11),
    ("check", 1e-11),
];

static SPENT: Mutex<f64> = Mutex::new(0.0);

/// Spends what a comparison gives in false alarms: the file's budget holds all of them.
pub fn alarm(p: f64) {
    let file = module_path!().split("::").next().unwrap();
    let budget = BUDGETS.iter().find(|(name, _)| *name == file).map_or(0.0, |(_, budget)| *budget);
    let mut spent = SPENT.lock().unwrap_or_else(PoisonError::into_inner);
    *spent += p;
    assert!(*spent <= budget, "{file} has spent {:e} of its {budget:e} of false alarms", *spent);
}

/// z std errors for a comparison to be held to, of a mean that is near normal: spends what they give.
pub fn deviations(z: f64) -> f64 {
    alarm(statrs::function::erf::erfc(z / std::f64::consts::SQRT_2));
    z
}
