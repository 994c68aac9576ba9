//! Rounding down.

/// ⌊x⌋ for x ≥ 0, without a library call on processors that have no instruction for it.
///
/// ```
/// use unbiased::fast::floor;
///
/// assert_eq!([0.0, 0.999, 1.0, 4.5e15 + 0.5, 1e300].map(floor), [0.0, 0.0, 1.0, 4.5e15, 1e300]);
/// ```
#[inline(always)]
pub fn floor(x: f64) -> f64 {
    /// 2⁵²: from here on every `f64` is an integer, so adding x to it rounds x.
    const WHOLE: f64 = 4_503_599_627_370_496.0;
    let rounded = (x + WHOLE) - WHOLE;
    let whole = if rounded > x { rounded - 1.0 } else { rounded };
    if x < WHOLE { whole } else { x }
}
