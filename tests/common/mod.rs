//! What all tests share: seeds, proptest's settings, a furnace and a generator that is stuck.
#![allow(dead_code)] // each test takes what it needs

use unbiased::lambertian::hemisphere::{Direction, Hemisphere};

/// Fixed by default; `UNBIASED_SEED=n` gives the whole suite fresh ones.
pub fn seed(n: u64) -> u64 {
    let fresh: u64 = std::env::var("UNBIASED_SEED").ok().and_then(|s| s.parse().ok()).unwrap_or(0);
    n.wrapping_add(fresh.wrapping_mul(1_000_003))
}

/// Set by `tests/mutants`, where a mutant is to cost seconds.
pub fn mutation() -> bool {
    std::env::var_os("UNBIASED_MUTATION").is_some()
}

/// So many draws; under mutation, a twentieth.
pub fn draws(n: u64) -> u64 {
    if mutation() { n.div_ceil(20) } else { n }
}

/// proptest's settings: as many cases as asked for, the same ones on every run; under mutation a tenth, but
/// not below 100.
pub fn config(cases: u32) -> proptest::test_runner::Config {
    proptest::test_runner::Config {
        cases: if mutation() { cases.min(cases.div_ceil(10).max(100)) } else { cases },
        rng_seed: proptest::test_runner::RngSeed::Fixed(seed(1)),
        failure_persistence: None,
        ..Default::default()
    }
}

/// A room without a light in which every face emits 1 and reflects so much.
pub fn furnace(albedo: f64) -> unbiased::paths::room::Scene {
    unbiased::paths::room::Scene {
        wall_albedo: albedo,
        cube_albedo: albedo,
        light_half_width: 0.0,
        emission: 1.0,
        ..Default::default()
    }
}

/// The next number of each of the next draws.
pub fn fill_uniform(rng: &mut unbiased::Stream, uniforms: &mut [f64]) {
    unbiased::Estimator::fill(&unbiased::from_uniforms(|[u]| u), rng, uniforms);
}

/// A generator of one word for ever.
pub struct Stuck(pub u64);

impl rand::TryRng for Stuck {
    type Error = std::convert::Infallible;

    fn try_next_u32(&mut self) -> Result<u32, std::convert::Infallible> {
        Ok((self.0 >> 32) as u32)
    }

    fn try_next_u64(&mut self) -> Result<u64, std::convert::Infallible> {
        Ok(self.0)
    }

    fn try_fill_bytes(&mut self, bytes: &mut [u8]) -> Result<(), std::convert::Infallible> {
        bytes.fill(self.0 as u8);
        Ok(())
    }
}

/// Compares drawn directions with the density claimed for them.
pub fn directions(
    sampler: &impl rand::distr::Distribution<Direction>,
    claimed: Hemisphere,
    deviation: f64,
    alpha: f64,
    seed: u64,
) -> unbiased::Result<unbiased::check::Agreement> {
    let unwarp = |w: &Direction| [claimed.cdf_of_cos_theta(w.cos_theta()), w.phi() / std::f64::consts::TAU];
    unbiased::check::points(sampler, unwarp, deviation, alpha, seed)
}
