//! Check your own estimator: write it between the lines below, and run
//!
//! ```sh
//! cargo run --release --example check_mine
//! ```
//!
//! It is tried on several problems of known truth. You are told the ratio of its mean to the truth on each,
//! and which classic mistakes that is consistent with. As it stands the file holds one of them for question
//! 3.5, and a right estimator for 4.3: `-- --question 4.3`.
//!
//! A number worked out by hand is judged by `-- --question 1.2 --answer 0.602`, and a program in another
//! language by what it writes: `-- --help` says how.

use std::process::ExitCode;

use unbiased::check::Attempt;
use unbiased::workbook;

// ─────────────────────────────── your estimator ───────────────────────────────
//
// It is a closure of a problem p and of random numbers, rng.uniform() being uniform in [0, 1):
//
// 1.1  |p: &Samples, rng|       one sample at the rate p.rate 2.1  |p: &Integral, rng|      one draw of ∫∫
// p.f(x, y) over p.rectangle; its ends: let [[a, b], [c, d]] = p.ends(); 3.4  |p: &Reflection, rng|    one
// draw of the radiance reflected under p.light(&direction) by p.albedo (3.5, too) 4.3  |p: &LightOfPaths,
// rng|  one draw of the light that leaves p.room.point() after p.bounces(), below 5.1  |p: &Bounces, rng|
// one number of bounces at p.p_rr 5    |p: &Wrapped, rng|       one X_rr at p.p_rr, where p.x(rng) draws X
//
// Each of these problems is in `unbiased::…::mistakes` of its topic.

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

/// Question 4.3: the light that leaves p after as many bounces as `p.bounces()` holds, 2..=2 being exactly
/// two.
///
/// This one finds the light by chance. A point of the room, a vertex of the path, has a `position()` and a
/// `normal()`, and the room knows what `emitted(&vertex)` and `albedo(&vertex)` are there; for a light sample
/// there are `light_corners()`, `light_area()` and `unbiased::paths::room::visible(&vertex, point)`.
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
