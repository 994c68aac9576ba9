//! The natural logarithm.

/// ln x to 1 ulp for a positive, normal x (2.2e-308 or more); meaningless for any other.
///
/// With x = 2ᵏ(1 + f), √½ ≤ 1 + f < √2, and s = f/(2 + f): ln x = k ln 2 + 2s + ⅔s³ + …, by a polynomial in
/// s² (Sun's fdlibm, `e_log.c`, 1993).
///
/// ```
/// assert_eq!(unbiased::fast::ln(1.0), 0.0);
/// assert!((unbiased::fast::ln(0.3) - 0.3f64.ln()).abs() <= f64::EPSILON);
/// ```
#[inline(always)]
pub fn ln(x: f64) -> f64 {
    /// ln 2 in two parts; the product of the first with an exponent is exact.
    const LN2: [f64; 2] = [6.931_471_803_691_238_164_90e-1, 1.908_214_929_270_587_700_02e-10];
    const MANTISSA: u64 = (1 << 52) - 1;
    /// The bits of √½, the lower bound of 1 + f.
    const ROOT: u64 = 0x3fe6_a09e_667f_3bcd;
    const MAGIC: u64 = 0x433 << 52; // 2⁵² holds an integer in its lowest bits
    let shifted = x.to_bits().wrapping_sub(ROOT);
    let exponent = shifted.wrapping_add(1023 << 52) >> 52;
    let k = f64::from_bits(MAGIC | exponent) - (f64::from_bits(MAGIC) + 1023.0);
    let f = f64::from_bits((shifted & MANTISSA).wrapping_add(ROOT)) - 1.0;
    let s = f / (2.0 + f);
    let z = s * s;
    let w = z * z;
    let odd = w
        * (0.399_999_999_994_094_190_8 + w * (0.222_221_984_321_497_839_6 + w * 0.153_138_376_992_093_733_2));
    let even = z
        * (0.666_666_666_666_673_513_0
            + w * (0.285_714_287_436_623_914_9
                + w * (0.181_835_721_616_180_501_2 + w * 0.147_981_986_051_165_859_1)));
    let half = 0.5 * f * f;
    k * LN2[0] - ((half - (s * (half + (odd + even)) + k * LN2[1])) - f)
}
