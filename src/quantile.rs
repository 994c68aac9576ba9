//! Student's t for a confidence level.
//!
//! |T| with ν degrees of freedom is at most t with probability P = I_y(½, ν/2), y = t²/(ν + t²), and larger
//! with Q = 1 − P = I_x(ν/2, ½), x = ν/(ν + t²) (Abramowitz & Stegun 26.7.1); ln|T| has the density 2 √y
//! x^(ν/2)/B(ν/2, ½). For few degrees of freedom, t is found by solving for the smaller of P and Q. For many,
//! t is Fisher's expansion about the normal quantile z (Fisher & Cornish 1960; A&S 26.7.5):
//!
//! > t = z + g₁/ν + g₂/ν² + g₃/ν³ + g₄/ν⁴, g₁ = (z³ + z)/4, …

use std::f64::consts::SQRT_2;

use statrs::function::beta::{beta, beta_reg};
use statrs::function::erf::{erf_inv, erfc_inv};

/// The expansion is used from this many degrees of freedom on. Its next term is near 3/40960 (z²/ν)⁵ z, since
/// t is near √(ν(e^(z²/ν) − 1)): 1.3e-10 of t here for z = 8.3, the quantile of the largest level below 1.
const MANY: f64 = 1000.0;

/// The t with P(|T| ≤ t) = `level`, to 2e-10, for Student's T with `freedom` degrees of freedom.
///
/// `freedom` is at least 1, and `level` strictly between 0 and 1.
//
// statrs' own quantile stops its search too early: in far tails, and at some ν above 1e5
pub(crate) fn student_t(freedom: f64, level: f64) -> f64 {
    // 1 − level is exact only for level ≥ ½; below, use `level` itself
    let upper = level >= 0.5;
    let wanted = if upper { 1.0 - level } else { level };
    let z = SQRT_2 * if upper { erfc_inv(wanted) } else { erf_inv(wanted) };
    if freedom >= MANY {
        return z * expansion(z * z, freedom);
    }
    let half = 0.5 * freedom;
    let beta = beta(half, 0.5);
    // near 0 the density is constant, and t² may underflow
    if level < 1e-8 {
        return level * (0.5 * freedom.sqrt() * beta);
    }
    let mut t = (freedom * (z * z / freedom).exp_m1()).sqrt();
    // Newton steps for ln P or ln Q as functions of ln t: both are concave, so it converges; 4 steps are
    // enough
    for _ in 0..5 {
        let (x, y) = (freedom / (freedom + t * t), t * t / (freedom + t * t));
        let density = 2.0 * y.sqrt() * x.powf(half) / beta;
        let (found, slope) =
            if upper { (beta_reg(half, 0.5, x), -density) } else { (beta_reg(0.5, half, y), density) };
        t *= (wanted / found).powf(found / slope);
    }
    t
}

/// t/z, for w = z².
fn expansion(w: f64, freedom: f64) -> f64 {
    let g1 = (w + 1.0) / 4.0;
    let g2 = ((5.0 * w + 16.0) * w + 3.0) / 96.0;
    let g3 = (((3.0 * w + 19.0) * w + 17.0) * w - 15.0) / 384.0;
    let g4 = ((((79.0 * w + 776.0) * w + 1482.0) * w - 1920.0) * w - 945.0) / 92160.0;
    1.0 + (g1 + (g2 + (g3 + g4 / freedom) / freedom) / freedom) / freedom
}
