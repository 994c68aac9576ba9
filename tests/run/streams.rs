//! The numbers of a stream: the same bits on every machine, uniform, unrelated between streams, and counted.

use rand::Rng;
use unbiased::{Budget, Stream, estimate, from_fn};

use crate::common;

#[test]
fn seeds_and_blocks_are_pinned_bit_for_bit() {
    let first = |seed, block| {
        let mut rng = Stream::new(seed, block);
        [rng.next_u64(), rng.next_u64()]
    };
    assert_eq!(first(0, 0), GOLDEN[0]);
    assert_eq!(first(1, 0), GOLDEN[1]);
    assert_eq!(first(1, 1), GOLDEN[2]);
    assert_eq!(first(u64::MAX, u64::MAX), GOLDEN[3]);
    let uniforms = estimate(&from_fn(|rng| rng.uniform()), Budget::Draws(100_000), 1).unwrap();
    assert_eq!(uniforms.mean().to_bits(), GOLDEN_MEAN, "{:#x}", uniforms.mean().to_bits());
}

/// Computed by a separate program from the definition: SplitMix64's finaliser over seed and block, then
/// xoshiro256++; the mean in exact integers, rounded once.
const GOLDEN: [[u64; 2]; 4] = [
    [0x56b1452f3b256cae, 0x4323aaaa00a3fffa],
    [0xe31fae9cc2093772, 0x98f20772f1a6892],
    [0xfff88350f9ce52a7, 0xc2257985659766ef],
    [0xb79a1330dffb28af, 0xd3d7d97f9e8cb840],
];
const GOLDEN_MEAN: u64 = 0x3fe0030f7a614cdc;

/// The generators of a block, by the same separate program: draw i takes its numbers k·2⁻⁵³ from generator i
/// mod 32.
#[test]
fn numbers_side_by_side_are_pinned_bit_for_bit() {
    for (seed, block, expected) in GOLDEN_LANES {
        let mut uniforms = [0.0; 64];
        let mut rng = Stream::new(seed, block);
        common::fill_uniform(&mut rng, &mut uniforms);
        for (place, k) in [0, 1, 31, 32, 63].into_iter().zip(expected) {
            let exact = k as f64 / (1u64 << 53) as f64;
            assert_eq!(uniforms[place], exact, "seed {seed}, block {block}, place {place}");
        }
        assert_eq!(rng.random_numbers(), 64);
        // in parts, and one at a time
        let mut rng = Stream::new(seed, block);
        let mut parts = [[0.0; 3]; 2];
        for part in &mut parts {
            common::fill_uniform(&mut rng, part);
        }
        assert_eq!(parts.as_flattened(), &uniforms[..6]);
        for uniform in &uniforms[6..] {
            assert_eq!(rng.uniform(), *uniform);
            rng.next_draw();
        }
    }
    let mut scripted = [0.0; 4];
    common::fill_uniform(&mut Stream::scripted(&[0.5, 0.25, 0.75]), &mut scripted);
    assert_eq!(scripted, [0.5, 0.25, 0.75, 0.0]);
}

const GOLDEN_LANES: [(u64, u64, [u64; 5]); 3] = [
    (0, 0, [0xad628a5e764ad, 0x1de2b120f3310c, 0x66322c75fe07b, 0x864755540147f, 0x7e05e1a14dba]),
    (1, 1, [0x1fff106a1f39ca, 0x19d48ba67ca097, 0x27e946caa25bd, 0x1844af30acb2ec, 0x12c863ee964129]),
    (
        u64::MAX,
        u64::MAX,
        [0x16f342661bff65, 0xa4b16b1dada7a, 0x1e3a47dd7687ae, 0x1a7afb2ff3d197, 0x2fb4c296f5151],
    ),
];

/// No two of a block's 32 generators, nor of its neighbours', have a word in common among their first eight:
/// 1024 of 53 bits each collide by chance with probability 5.9e-11. And pairs from
/// neighbouring places are uniform in the square: 64² cells of 2.6e5 pairs, whose χ² has mean 4095 and
/// deviation 90; 7 deviations (a tail below 2e-11) catch cells that are 17 % off on average.
#[test]
fn generators_side_by_side_share_nothing() {
    let base = common::seed(20);
    let mut words = std::collections::HashSet::new();
    common::alarm(5.9e-11);
    for (seed, block) in [(base, 0), (base, 1), (base + 1, 0), (base + 1, 1)] {
        let mut uniforms = [0.0f64; 256];
        common::fill_uniform(&mut Stream::new(seed, block), &mut uniforms);
        for uniform in uniforms {
            assert!(words.insert(uniform.to_bits()), "{uniform:?} came before");
        }
    }
    for apart in [1, 8, 32] {
        let mut cells = [0u32; 4096];
        let mut uniforms = vec![0.0; (1 << 18) + 32];
        common::fill_uniform(&mut Stream::new(base, apart), &mut uniforms);
        for (x, y) in uniforms.iter().zip(&uniforms[apart as usize..]).take(1 << 18) {
            cells[(x * 64.0) as usize * 64 + (y * 64.0) as usize] += 1;
        }
        let expected = (1 << 18) as f64 / 4096.0;
        let chi2: f64 = cells.iter().map(|n| (f64::from(*n) - expected).powi(2) / expected).sum();
        common::alarm(2e-11);
        assert!((chi2 - 4095.0).abs() <= 7.0 * (2.0f64 * 4095.0).sqrt(), "{apart} apart: {chi2}");
    }
}

/// Any two of 64 × 64 neighbouring (seed, block) pairs: no word shared among their first 16, and half of the
/// bits differ. 6.6e4 words of 64 bits collide by chance with probability 1.2e-10. Each pair of first words
/// differs in 32 ± 4 bits; the mean over 4032 neighbours has std error 0.063, 7 of them 0.44 (2.6e-12).
#[test]
fn neighbouring_seeds_and_blocks_share_nothing() {
    let base = common::seed(0);
    let mut words = std::collections::HashSet::new();
    let mut differing = [0u32; 2];
    for seed in base..base + 64 {
        for block in 0..64 {
            let mut rng = Stream::new(seed, block);
            let here = rng.clone().next_u64();
            differing[0] += (here ^ Stream::new(seed + 1, block).next_u64()).count_ones();
            differing[1] += (here ^ Stream::new(seed, block + 1).next_u64()).count_ones();
            for _ in 0..16 {
                assert!(words.insert(rng.next_u64()), "a word of ({seed}, {block}) came before");
            }
        }
    }
    common::alarm(1.2e-10);
    for sum in differing {
        let mean = f64::from(sum) / 4096.0;
        assert!((mean - 32.0).abs() <= common::deviations(7.0) * 4.0 / 4096f64.sqrt(), "{mean} bits differ");
    }
}

/// Swapping seed and block, or moving one up and the other down, gives another stream.
#[test]
fn seed_and_block_are_not_added_up() {
    let first = |seed, block| Stream::new(seed, block).next_u64();
    for (seed, block) in [(0, 1), (1, 2), (5, 900), (77, 78)] {
        assert_ne!(first(seed, block), first(block, seed));
        assert_ne!(first(seed, block), first(seed + 1, block - 1));
        assert_ne!(first(seed, block), first(seed ^ 1, block ^ 1));
    }
}

/// DKW at α = 1e-12 on 10⁷ uniform numbers sees a deviation of 0.0012 anywhere.
#[test]
fn the_stream_is_uniform() {
    let n = 10_000_000;
    let mut rng = Stream::new(common::seed(6), 0);
    let one_by_one: Vec<f64> = (0..n).map(|_| rng.uniform()).collect();
    let mut side_by_side = vec![0.0; n];
    common::fill_uniform(&mut rng, &mut side_by_side);
    assert_eq!(rng.random_numbers(), 2 * n as u64);
    for uniforms in [one_by_one, side_by_side] {
        let (off, allowed) = common::dkw(uniforms, |u| u);
        assert!(off <= allowed, "{off}");
    }
}

#[test]
fn what_the_stream_gives_is_counted() {
    let mut rng = Stream::new(1, 1);
    rng.next_u32();
    rng.next_u64();
    rng.uniform();
    rng.fill_bytes(&mut [0; 17]);
    rng.count_evaluations(5);
    assert_eq!((rng.random_numbers(), rng.evaluations()), (6, 5));
}
