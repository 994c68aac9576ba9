//! The exponential function.

/// eˣ to 1.1 ulp where the result is normal, 0 or +∞ where it is outside `f64`'s range, and NaN for NaN.
///
/// With k the integer nearest to x/ln 2 and r = x − k ln 2, |r| ≤ ½ ln 2: eˣ = 2ᵏ eʳ, and eʳ by its Taylor
/// series.
///
/// ```
/// assert_eq!(unbiased::fast::exp(0.0), 1.0);
/// assert!((unbiased::fast::exp(-0.3) - (-0.3f64).exp()).abs() <= f64::EPSILON);
/// assert_eq!(unbiased::fast::exp(-1e300), 0.0);
/// ```
#[inline(always)]
pub fn exp(x: f64) -> f64 {
    const LN2: [f64; 2] = [6.931_471_803_691_238_164_90e-1, 1.908_214_929_270_587_700_02e-10];
    /// 1.5·2⁵²: adding x to it rounds x to an integer, which is then in the lowest bits.
    const MAGIC: f64 = 6_755_399_441_055_744.0;
    // at and beyond these bounds eˣ is 0 or infinite; NaN passes through
    let x = if x < -746.0 { -746.0 } else { x };
    let x = if x > 710.0 { 710.0 } else { x };
    let rounded = x * std::f64::consts::LOG2_E + MAGIC;
    let k = rounded - MAGIC;
    let r = (x - k * LN2[0]) - k * LN2[1];
    // Estrin's scheme (1960): shorter dependency chains than Horner's
    let (r2, c) = (r * r, COEFFICIENTS);
    let four = |n: usize| (c[n] + r * c[n + 1]) + r2 * (c[n + 2] + r * c[n + 3]);
    let r4 = r2 * r2;
    let series = four(0) + r4 * (four(4) + r4 * four(8));
    // 2ᵏ as a product of two: k from −1076 to 1024 is too wide for one
    let biased = rounded.to_bits().wrapping_sub(MAGIC.to_bits()).wrapping_add(2048);
    let half = biased >> 1;
    let power = |n: u64| f64::from_bits(n.wrapping_sub(1024 - 1023) << 52);
    // the smaller terms first
    (1.0 + (r + r2 * series)) * power(half) * power(biased - half)
}

/// 1/n! for n = 2, 3, …, 13: the first omitted term is below 2⁻⁵⁷.
const COEFFICIENTS: [f64; 12] = [
    1.0 / 2.0,
    1.0 / 6.0,
    1.0 / 24.0,
    1.0 / 120.0,
    1.0 / 720.0,
    1.0 / 5_040.0,
    1.0 / 40_320.0,
    1.0 / 362_880.0,
    1.0 / 3_628_800.0,
    1.0 / 39_916_800.0,
    1.0 / 479_001_600.0,
    1.0 / 6_227_020_800.0,
];
