//! Random words: mixing them, and turning them into uniform numbers.

/// Generators of a block: four times as many as the widest vectors hold, to hide the latency of dependent
/// steps.
pub(crate) const LANES: usize = 32;

/// How many different values a uniform number has.
pub const GRID: f64 = (1u64 << 53) as f64;

/// The upper 53 bits as a number in [0, 1).
///
/// The upper and the lower half are put into the mantissas of two `f64`: on x86, converting an integer to
/// `f64` would depend on the register's previous value, often the previous draw.
#[inline(always)]
pub(crate) fn on_the_grid(bits: u64) -> f64 {
    const UPPER: f64 = 19_342_813_113_834_066_795_298_816.0; // 2⁸⁴: its last place is 2³²
    const LOWER: f64 = 4_503_599_627_370_496.0; // 2⁵²: its last place is 1
    let upper = f64::from_bits(UPPER.to_bits() | bits >> 43);
    let lower = f64::from_bits(LOWER.to_bits() | bits >> 11 & 0xffff_ffff);
    (upper - (UPPER + LOWER) + lower) * (1.0 / GRID)
}

/// 2⁶⁴/φ, the increment of SplitMix64.
pub(crate) const GOLDEN: u64 = 0x9e37_79b9_7f4a_7c15;

/// SplitMix64's finaliser (Stafford's mix 13): a bijection in which every input bit moves half of the
/// output's.
pub(crate) const fn mix(mut z: u64) -> u64 {
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

#[cfg(test)]
mod tests {
    use rand::Rng;

    use super::*;
    use crate::fast::Real;
    use crate::stream::Stream;

    /// The conversion by bits agrees with the plain one.
    #[test]
    fn a_word_is_the_same_number_either_way() {
        let mut rng = Stream::new(5, 0);
        let random = std::iter::repeat_with(|| rng.next_u64()).take(100_000);
        for word in [0, u64::MAX, 1 << 11, (1 << 11) - 1, 1 << 43, (1 << 43) - 1].into_iter().chain(random) {
            assert_eq!(on_the_grid(word), f64::of_word(word));
            assert_eq!(f64::of_word(on_the_grid(word).word()), on_the_grid(word));
        }
    }
}
