//! The upper 32 bits of the uniform numbers of seed 1, in blocks of 2¹⁴ draws in the order in which a run
//! sums them: input for TestU01.

use std::io::{self, Write};

use unbiased::{Estimator, Stream, from_uniforms};

fn main() {
    let (uniform, mut draws) = (from_uniforms(|[u]| u), vec![0.0; 1 << 14]);
    let mut out = io::stdout().lock();
    for block in 0.. {
        uniform.fill(&mut Stream::new(1, block), &mut draws);
        let words: Vec<u8> = draws.iter().flat_map(|u| ((u * 2f64.powi(32)) as u32).to_le_bytes()).collect();
        if out.write_all(&words).is_err() {
            break; // the reader has enough
        }
    }
}
