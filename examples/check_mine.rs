//! Check your own estimator: write it between the lines below, and run
//!
//! ```sh
//! cargo run --release --example check_mine
//! ```
//!
//! It is run on several problems whose truth is known. The output is the ratio of its mean to the truth on
//! each, and the classic mistakes that are consistent with these ratios. The file as it is contains one of
//! these mistakes for question 3.5, and a right estimator for 4.3: `-- --question 4.3`.
//!
//! `-- --question 1.2 --answer 0.602` judges a number worked out by hand. Draws of a program in another
//! language can be judged, too: see `-- --help`.

use std::process::ExitCode;

use unbiased::check::Attempt;
use unbiased::workbook;

// ─────────────────────────────── your estimator ───────────────────────────────
//
// A closure of a problem p and a source of random numbers: rng.uniform() is uniform in [0, 1).
//
// question  closure                      one draw
// 1.1       |p: &Samples, rng|           a sample of the exponential distribution with rate p.rate
// 2.1       |p: &Integral, rng|          of ∫∫ p.f(x, y) over p.rectangle = [a, b] × [c, d], where
//                                        [[a, b], [c, d]] = p.ends()
// 3.4, 3.5  |p: &Reflection, rng|        of the reflected radiance, for the incoming radiance
//                                        p.light(&direction) and the albedo p.albedo
// 4.3       |p: &LightOfPaths, rng|      of the radiance that leaves p.room.point() after p.bounces()
// 5.1       |p: &NumberOfBounces, rng|   a number of bounces at p.p_rr
// 5         |p: &Wrapped, rng|           an X_rr at p.p_rr; p.x(rng) draws X
//
// Each problem type is in the module `mistakes` of its topic, such as `unbiased::lambertian::mistakes`.

use rand::distr::Distribution;
use unbiased::lambertian::hemisphere::Hemisphere;
use unbiased::lambertian::mistakes::Reflection;
use unbiased::paths::mistakes::LightOfPaths;
use unbiased::paths::room::nearest_hit;

/// The question that your estimator answers.
const QUESTION: &str = "3.5";

fn mine() -> Attempt<'static> {
    Attempt::new(|p: &Reflection, rng| {
        let direction = Hemisphere::Uniform.sample(rng);
        p.albedo * p.light(&direction)
    })
}

/// Question 4.3: the radiance that leaves p, summed over the numbers of bounces in `p.bounces()`; 2..=2 is
/// exactly two.
///
/// This one finds the light by chance. A vertex has a `position()` and a `normal()`, and the room has
/// `emitted(&vertex)` and `albedo(&vertex)`. For a light sample there are `light_corners()`, `light_area()`
/// and `unbiased::paths::room::visible(&vertex, point)`.
fn paths() -> Attempt<'static> {
    Attempt::new(|p: &LightOfPaths, rng| {
        let (room, bounces) = (&p.room, p.bounces());
        let (mut vertex, mut throughput, mut light) = (room.point(), 1.0, 0.0);
        for bounce in 0..=*bounces.end() {
            if bounces.contains(&bounce) {
                light += throughput * room.emitted(&vertex);
            }
            let direction = Hemisphere::Cosine.sample(rng);
            throughput *= room.albedo(&vertex); // f_r cos θ/p(ω) = ρ
            let Some(hit) = nearest_hit(&vertex, vertex.to_room(&direction)) else { break };
            vertex = hit;
        }
        light
    })
}

// ──────────────────────────────────────────────────────────────────────────────

fn main() -> ExitCode {
    workbook::check_mine(QUESTION, &[mine(), paths()])
}
