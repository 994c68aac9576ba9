//! Sine and cosine of an angle given in turns.

use std::f64::consts::TAU;

/// sin 2πv and cos 2πv for v in \[0, 1\], to 2 ulp and exact at quarter turns.
///
/// The angle is reduced to at most an eighth of a turn without rounding; then both are computed by Taylor
/// series.
///
/// ```
/// use unbiased::fast::sin_cos_of_turns;
///
/// assert_eq!(sin_cos_of_turns(0.5), (0.0, -1.0));
/// let (sin, cos) = sin_cos_of_turns(1.0 / 6.0);
/// assert!((sin - 0.75f64.sqrt()).abs() <= f64::EPSILON && (cos - 0.5).abs() <= f64::EPSILON);
/// ```
#[inline(always)]
pub fn sin_cos_of_turns(v: f64) -> (f64, f64) {
    /// 1.5·2⁵²: adding x to it rounds x to an integer, which is then in the lowest bits.
    const MAGIC: f64 = 6_755_399_441_055_744.0;
    // the nearest quarter turn, and the exact remainder of at most an eighth
    let rounded = 4.0 * v + MAGIC;
    let quarters = rounded.to_bits();
    let t = TAU * (v - 0.25 * (rounded - MAGIC));
    // Taylor series: on |t| ≤ π/4 the first omitted term is below 2⁻⁵⁸
    let t2 = t * t;
    let sin = t + t * t2 * series(t2, SIN);
    let cos = 1.0 + t2 * series(t2, COS);
    // select by bits: a branch would be mispredicted half the time
    let (sin, cos) = if quarters & 1 == 0 { (sin, cos) } else { (cos, sin) };
    let sign = |negative: u64, x: f64| f64::from_bits(x.to_bits() ^ ((negative & 2) << 62));
    (sign(quarters, sin), sign(quarters.wrapping_add(1), cos))
}

/// ∓1/n! for n = 3, 5, …, 17: the coefficients of (…) in sin t = t + t·t²·(…).
const SIN: [f64; 8] = [
    -1.0 / 6.0,
    1.0 / 120.0,
    -1.0 / 5_040.0,
    1.0 / 362_880.0,
    -1.0 / 39_916_800.0,
    1.0 / 6_227_020_800.0,
    -1.0 / 1_307_674_368_000.0,
    1.0 / 355_687_428_096_000.0,
];

/// ∓1/n! for n = 2, 4, …, 16: the same for cos t = 1 + t²·(…).
const COS: [f64; 8] = [
    -1.0 / 2.0,
    1.0 / 24.0,
    -1.0 / 720.0,
    1.0 / 40_320.0,
    -1.0 / 3_628_800.0,
    1.0 / 479_001_600.0,
    -1.0 / 87_178_291_200.0,
    1.0 / 20_922_789_888_000.0,
];

/// Σ cₙ zⁿ in pairs, and pairs of pairs (Estrin 1960), which halves the dependency chain.
#[inline(always)]
fn series(z: f64, c: [f64; 8]) -> f64 {
    let (w, pair) = (z * z, |n: usize| c[n] + z * c[n + 1]);
    (pair(0) + w * pair(2)) + (w * w) * (pair(4) + w * pair(6))
}
