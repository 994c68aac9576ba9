//! Random numbers at which an estimator is wrong, for checking by hand.

use std::fmt;

use super::attempt::Attempt;
use super::exercise::{Draw, Exercise, Probe};
use crate::stream::Stream;

/// Random numbers at which an estimator's draw differs from the right estimator's.
#[derive(Debug, Clone)]
pub struct Counterexample {
    /// The probe.
    pub probe: &'static Probe,
    /// The uniform numbers of the draw, in the order in which it took them.
    pub numbers: Vec<f64>,
    /// The draw.
    pub yours: f64,
    /// The right estimator's draw from the same numbers.
    pub right: f64,
}

/// As a sentence: `For instance on “λ = 2”, at u = ½: yours is 1.39, right is 0.35.`
impl fmt::Display for Counterexample {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let named = self.numbers.iter().zip(["u", "v"]).map(|(number, name)| {
            let number = EASY.iter().find(|(easy, _)| easy == number).map_or("", |(_, text)| text);
            format!("{name} = {number}")
        });
        let (numbers, yours, right) = (named.collect::<Vec<_>>().join(", "), self.yours, self.right);
        write!(f, "For instance on “{}”, at {numbers}: yours is {yours:.4}, right is {right:.4}.", self.probe)
    }
}

/// Uniform numbers that are easy to calculate with by hand.
const EASY: [(f64, &str); 4] = [(0.5, "½"), (0.75, "¾"), (0.25, "¼"), (0.125, "⅛")];

/// A counterexample makes sense only if the attempt uses its random numbers as a right estimator does. That
/// is assumed if, on each probe, the ratio or the difference of the two is constant over all points, or if at
/// each point their ratio is the same on every probe: then they sample the same points, and only a factor or
/// a summand may be wrong.
pub(super) fn counterexample(exercise: &'static Exercise, attempt: &Attempt<'_>) -> Option<Counterexample> {
    let probes: Vec<_> = exercise.probes.iter().filter(|probe| probe.averages_draws).collect();
    exercise.right.iter().find_map(|right| {
        let all = [0.5, 0.25, 0.75, 0.125, 0.5, 0.25];
        let (_, count) = drawn(right, 0, &all);
        if !(1..=2).contains(&count) || drawn(&attempt.draw, 0, &all).1 != count {
            return None;
        }
        let points: Vec<Vec<f64>> = EASY
            .iter()
            .flat_map(|(u, _)| match count {
                1 => vec![vec![*u]],
                _ => EASY.iter().map(|(v, _)| vec![*u, *v]).collect(),
            })
            .collect();
        let on = |probe: usize, point: &[f64]| {
            [drawn(&attempt.draw, probe, point).0, drawn(right, probe, point).0]
        };
        let pairs: Vec<Vec<_>> =
            probes.iter().map(|probe| points.iter().map(|point| on(probe.index, point)).collect()).collect();
        if !(alike_on_each_probe(&pairs) || alike_at_each_point(&pairs)) {
            return None;
        }
        let off = |[yours, right]: [f64; 2]| (yours - right).abs() > 0.05 * right.abs() && right != 0.0;
        probes.iter().zip(&pairs).find_map(|(probe, pairs)| {
            let (point, [yours, right]) = points.iter().zip(pairs).find(|(_, pair)| off(**pair))?;
            Some(Counterexample { probe, numbers: point.clone(), yours: *yours, right: *right })
        })
    })
}

/// A draw from these numbers, and how many of them it took.
fn drawn(draw: &Draw<'_>, probe: usize, numbers: &[f64]) -> (f64, u64) {
    let mut rng = Stream::scripted(numbers);
    (draw(probe, 1.0, &mut rng), rng.random_numbers())
}

fn same(a: f64, b: f64) -> bool {
    (a - b).abs() <= 1e-9 * a.abs().max(b.abs())
}

/// Whether on each probe the ratio, or the difference, is the same at all points.
fn alike_on_each_probe(pairs: &[Vec<[f64; 2]>]) -> bool {
    pairs.iter().all(|pairs| {
        let one_ratio = |[yours, right]: [f64; 2]| pairs.iter().all(|[y, r]| same(y * right, r * yours));
        let one_difference = |[yours, right]: [f64; 2]| pairs.iter().all(|[y, r]| same(y + right, r + yours));
        pairs.iter().find(|[_, right]| *right != 0.0).copied().is_some_and(one_ratio)
            || pairs.first().copied().is_some_and(one_difference)
    })
}

/// Whether the ratio at each point is the same on all probes; points where the right draw is always 0 pass.
fn alike_at_each_point(pairs: &[Vec<[f64; 2]>]) -> bool {
    let points = pairs.first().map_or(0, Vec::len);
    (0..points).all(|point| {
        let at: Vec<_> = pairs.iter().filter_map(|pairs| pairs.get(point).copied()).collect();
        let Some([yours, right]) = at.iter().find(|[_, right]| *right != 0.0).copied() else { return true };
        at.iter().all(|[y, r]| same(y * right, r * yours))
    })
}
