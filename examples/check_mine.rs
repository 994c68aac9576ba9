//! Check your own estimator: write it between the lines below, and run
//!
//! ```sh
//! cargo run --release --example check_mine
//! ```
//!
//! It is tried on several problems of known truth. You are told the ratio of its mean to the truth on each, and which classic
//! mistakes that is consistent with. As it stands the file holds one of them for question 3.5, and a right estimator for 4.3:
//! `-- --question 4.3`.
//!
//! A number worked out by hand is judged by `-- --question 1.2 --answer 0.602`, and draws from a program in any language by
//! `-- --question 3.5 --draws-from -`, one a line on standard input.

use std::process::ExitCode;

use unbiased::check::Attempt;
use unbiased::workbook;

// ─────────────────────────────── your estimator ───────────────────────────────
//
// 1.1  Attempt::exponential(|rate, rng| …)               one sample
// 2.1  Attempt::rectangle(|f, rectangle, rng| …)         one draw of ∫∫ f(x, y), over any rectangle:
//                                                        let ([a, b], [c, d]) = (rectangle.x_range(), rectangle.y_range());
// 3.4  Attempt::hemisphere(|light, albedo, rng| …)       one draw of the reflected radiance (3.5, too)
// 4.3  Attempt::paths(|room, bounces, rng| …)            one draw of the light that leaves p, below
// 5.1  Attempt::bounces(|p_rr, rng| …)                   one number of bounces
// 5    Attempt::roulette(|x, p_rr, rng| …)               one X_rr, where x(rng) draws X
//
// rng.uniform() is a uniform number in [0, 1).

use rand::distr::Distribution;
use unbiased::box_room::nearest_hit;
use unbiased::hemisphere::Hemisphere;

/// The question that your estimator answers.
const QUESTION: &str = "3.5";

fn mine() -> Attempt<'static> {
    Attempt::hemisphere(|light, albedo, rng| {
        let direction = Hemisphere::Uniform.sample(rng);
        albedo * light(&direction)
    })
}

/// Question 4.3: the light that leaves `room.point()` after as many bounces as `bounces` holds, 2..=2 being exactly two.
///
/// This one finds the light by chance. A point of the room, a vertex of the path, has a `position()` and a `normal()`, and the room knows what `emitted(&vertex)` and
/// `albedo(&vertex)` are there; for a light sample there are `light_corners()`, `light_area()` and `unbiased::box_room::visible(&vertex, point)`.
fn paths() -> Attempt<'static> {
    Attempt::paths(|room, bounces, rng| {
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
