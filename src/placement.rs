//! Jittered or Sobol points in place of independent random numbers, for any estimator.
//!
//! An estimator is a function of uniform numbers, f(u₁, u₂, …). Its mean over points that cover the unit cube
//! more evenly than independent ones has the same expectation and less variance. [`sobol`] and [`jittered`]
//! wrap an estimator: one draw of the result, a replicate, is the mean over a whole set of points. The points
//! of a set depend on each other, but each set is randomised independently, so draws are independent and
//! their error bar is valid.
//!
//! # Which dimensions matter
//! With n points in place of n independent draws the variance falls by a factor that depends on how many
//! numbers f depends on, and how smooth it is:
//!
//! - a smooth function of one or two numbers gains most: a factor of nearly n² (Sobol, one or two dimensions)
//!   or n (jittered, two dimensions);
//! - a function with a jump gains less: the points in cells that the jump crosses still vary;
//! - a function of many numbers gains only if it depends mostly on the first few, as only those are well
//!   distributed *together*. A path's first bounce uses the first few. In the worksheet's scene 4,096 points
//!   in place of as many independent paths lower the variance by these factors: 3·10⁶ for one bounce; 280 for
//!   two; 5 for three or fifteen (65,536 points: 23 and 13); 4,500 for two with L_o(p_j) known. The light of
//!   later bounces depends on all of their numbers at once, and jumps at the cube's edges.
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

/// `sobol_burley` uses 16 bits of a point's index, so the sequence repeats after 2¹⁶ points.
const MOST_POINTS: u64 = 1 << 16;

/// The mean of n draws of `estimator` over the first n points of an Owen-scrambled Sobol sequence: number d
/// of draw i is coordinate d of point i.
///
/// For n = 2ᵐ each number falls into every interval of length 1/n once, and the first two fall into every
/// rectangle of 2⁻ᵏ by 2^(k−m) once: the error of a smooth function of them falls nearly as n^(−3/2) (Owen
/// 1997). Other n are allowed, but gain less.
///
/// The first ⌈log₂ n⌉ binary digits are those of `sobol_burley`; further digits come from the stream, as in
/// Owen's definition. Each coordinate is scrambled by 32 random bits of its own, and every point is exactly
/// uniform, on the same grid of 2⁻⁵³ as [`Stream::uniform`]. After the first 256 numbers a draw's numbers are
/// independent.
///
/// # Errors
/// If n is not from 1 to 2¹⁶: the sequence would repeat.
pub fn sobol<E: Estimator>(estimator: E, points: u64) -> Result<impl Estimator> {
    let ok = (1..=MOST_POINTS).contains(&points);
    let points = require_count("the number of Sobol points", points, ok, "from 1 to 65536")?;
    Ok(Placed { estimator, points, side: None })
}

/// The mean of s² draws of `estimator` over one uniform point in each cell of an s × s grid. Numbers 2k and
/// 2k + 1 of a draw are such a point; for each k the cells are in a different random order.
///
/// For a function of two numbers only the variance *within* the cells remains: it falls as s⁻⁴ if the
/// function is smooth, so the error falls as 1/evaluations; with a jump such as a disc's edge, as
/// evaluations^(−3/4). It is never larger than with as many independent points. (*Physically Based
/// Rendering*, 4th ed., section 2.2.1.)
///
/// # Errors
/// If the side s is not from 1 to 256: the set would have more than 2¹⁶ points.
pub fn jittered<E: Estimator>(estimator: E, side: u64) -> Result<impl Estimator> {
    let side = require_count("the side of the grid", side, (1..=256).contains(&side), "from 1 to 256")?;
    Ok(Placed { estimator, points: side * side, side: Some(side) })
}

/// An estimator over a set of points.
struct Placed<E> {
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
            // return the offending value itself, not the mean with it
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
