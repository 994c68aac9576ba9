//! Better placed numbers for any estimator: jittered or Sobol points in place of independent ones.
//!
//! An estimator is a function of uniform numbers, f(u₁, u₂, …). Over points that fill the unit cube more
//! evenly than independent ones its mean is the same and varies less. [`sobol`] and [`jittered`] make an
//! estimator of an estimator: one draw of theirs is the mean over a whole set of points. The points of a set
//! depend on each other, but the sets, each randomised afresh, do not, so draws are independent and the error
//! bar made of them is right.
//!
//! # Which dimensions matter
//! With n points in place of n independent draws the variance falls by a factor that depends on how few
//! numbers f hangs on, and how smoothly:
//!
//! - a smooth function of one or two numbers gains most: nearly n² (Sobol, in two dimensions or one) or n
//!   (jittered, in two);
//! - a jump costs most of it: only the points in cells that the jump crosses still vary;
//! - of many numbers only the few that f mostly depends on are placed well *together*. A path's first bounce
//!   has the first few. In the sheet's scene 4,096 points in place of as many paths of one bounce lower the
//!   variance 3·10⁶ times, of two 280 times, of three or fifteen five times (65,536 points: 23 and 13 times),
//!   and of two with L_o(p_j) known 4,500 times: the light of later bounces depends on all of its numbers at
//!   once, and through the cube's edges in jumps.
//!
//! (*Physically Based Rendering*, 4th ed., chapter 8; Owen 1997; Burley 2020.)
//!
//! ```
//! use unbiased::lambertian::hemisphere::Hemisphere::Cosine;
//! use unbiased::{Budget, estimate, f_over_p, placement};
//!
//! // ∫ cos² θ dω over the hemisphere is 2π/3
//! let squared = f_over_p(|w| w.cos_theta().powi(2), Cosine);
//! let placed = placement::sobol(&squared, 1024)?;
//! let independent = estimate(&squared, Budget::Draws(102_400), 1)?;
//! let better = estimate(&placed, Budget::Draws(100), 1)?; // as many evaluations
//! assert!(better.z(2.0943951023931953).unwrap().abs() < 5.0);
//! assert!(better.std_error() < independent.std_error().map(|error| error / 100.0));
//! # Ok::<(), unbiased::Error>(())
//! ```

use crate::doubt::Doubt;
use crate::error::{Result, require_count};
use crate::estimate::{Estimate, SLICE};
use crate::estimator::Estimator;
use crate::fast::all_finite;
use crate::stream::Stream;
use crate::stream::points::{Grid, Placement, Sobol};

/// Sobol's points are kept to 16 digits by `sobol_burley`, so the set repeats after 2¹⁶ of them.
const MOST_POINTS: u64 = 1 << 16;

/// The mean of n draws of `estimator` over the first n points of an Owen-scrambled Sobol sequence: number d
/// of draw i is coordinate d of point i.
///
/// For n = 2ᵐ each number takes every interval of length 1/n once, and the first two every rectangle of 2⁻ᵏ
/// by 2^(k−m): the error of a smooth function of them falls nearly as n^(−3/2) (Owen 1997). Other n are
/// allowed, and gain less.
///
/// The points are those of `sobol_burley`, to as many binary digits as n takes; the digits below come from
/// the stream, as in Owen's definition. Each coordinate has 32 random bits of its own to scramble by, and
/// every point is then exactly uniform, on the same grid of 2⁻⁵³ as [`Stream::uniform`]. Beyond 256 numbers a
/// draw's numbers are independent.
///
/// # Errors
/// If n is not from 1 to 2¹⁶, after which the sequence would repeat.
pub fn sobol<E: Estimator>(estimator: E, points: u64) -> Result<Placed<E>> {
    let ok = (1..=MOST_POINTS).contains(&points);
    let points = require_count("the number of Sobol points", points, ok, "from 1 to 65536")?;
    Ok(Placed { estimator, points, side: None })
}

/// The mean of s² draws of `estimator` over one uniform point in each cell of an s × s grid: numbers 2k and
/// 2k + 1 of a draw are a point of the plane; each plane has its cells in an order of its own.
///
/// For a function of two numbers the variance is that *within* the cells alone: if it is smooth it falls as
/// s⁻⁴ and the error as 1/evaluations; across a jump such as a disc's edge, as evaluations^(−3/4). It is
/// never more than with as many independent points. (*Physically Based Rendering*, 4th ed., section 2.2.1.)
///
/// # Errors
/// If the side s is not from 1 to 256: the set would have more than 2¹⁶ points.
pub fn jittered<E: Estimator>(estimator: E, side: u64) -> Result<Placed<E>> {
    let side = require_count("the side of the grid", side, (1..=256).contains(&side), "from 1 to 256")?;
    Ok(Placed { estimator, points: side * side, side: Some(side) })
}

/// An estimator over a set of points; see [`sobol`] and [`jittered`].
#[derive(Debug, Clone, Copy)]
pub struct Placed<E> {
    estimator: E,
    points: u64,
    /// The side of the grid, if it is one.
    side: Option<u64>,
}

impl<E: Estimator> Estimator for Placed<E> {
    fn draw(&self, rng: &mut Stream) -> f64 {
        let Ok(seed) = rand::TryRng::try_next_u64(rng);
        let placement = match self.side {
            Some(side) => Placement::Jittered(Grid::new(side as u32, seed)),
            None => Placement::Sobol(Sobol::new(self.points as u32, seed)),
        };
        let mut points = Stream::placed(placement, seed);
        let (mut estimate, mut draws) = (Estimate::new(), [0.0; SLICE]);
        while estimate.draws() < self.points {
            let count = (self.points - estimate.draws()).min(SLICE as u64) as usize;
            let draws = &mut draws[..count];
            self.estimator.fill(&mut points, draws);
            // such a value says more than what a mean makes of it
            if !all_finite(draws)
                && let Some(bad) = draws.iter().find(|draw| !draw.is_finite())
            {
                return *bad;
            }
            estimate.extend_from_slice(draws);
        }
        rng.count(&points);
        estimate.mean()
    }

    fn doubt(&self) -> Option<Doubt> {
        self.estimator.doubt()
    }
}
