//! Paths in single precision.

use std::fmt;

use super::{Paths, side_by_side};
use crate::doubt::Doubt;
use crate::error::{Result, require};
use crate::estimator::Estimator;
use crate::stream::Stream;

impl Paths {
    /// The same paths computed in `f32`: about twice as fast and less accurate. They take the same random
    /// numbers, and draws are summed in `f64`.
    ///
    /// The mean is biased by rounding, and by the coarser grid k·2⁻²⁴ of the uniform numbers. No such bias
    /// was measured in the sheet's scene: with cosine directions and next-event estimation it is 0 ± 7e-7 of
    /// the one-bounce radiance in 10⁹ paths, and 0 ± 1.6e-5 of that of up to fifteen bounces in 1.5·10⁸.
    ///
    /// Radiances are scaled, so any size that a scene allows will do. What cannot be scaled is the ratio of
    /// the strongest and the weakest contribution.
    ///
    /// ```
    /// use unbiased::paths::room::{BoxRoom, Scene};
    /// use unbiased::lambertian::hemisphere::Hemisphere;
    /// use unbiased::paths::{Bounces, FindLight, Paths};
    /// use unbiased::{Budget, estimate};
    ///
    /// let room = BoxRoom::new(Scene::default())?;
    /// let once = Paths::new(room, Bounces::Exactly(1), Hemisphere::Cosine, FindLight::BySampling)?;
    /// let found = estimate(&once.in_f32()?, Budget::Draws(100_000), 1)?;
    /// assert!(found.z(0.2728543591976926).unwrap().abs() < 5.0);
    /// # Ok::<(), unbiased::Error>(())
    /// ```
    ///
    /// # Errors
    /// If a path's throughput could leave the range of `f32`: if the smallest albedo above 0, to the power of
    /// the smallest number of bounces that counts (two, if fewer count and two may), is below 1e-25; or if
    /// the faces emit less than 1e-10 of L_e A/π, or of L_e if the light is found by chance.
    pub fn in_f32(self) -> Result<impl Estimator + fmt::Debug> {
        let scene = self.room.scene();
        let albedos = [scene.wall_albedo, scene.cube_albedo].into_iter().filter(|albedo| *albedo > 0.0);
        let [fewest, most] = self.counted;
        // at most 64
        let bounces = fewest.max(most.min(2)) as i32;
        let throughput = albedos.fold(1.0, f64::min).powi(bounces);
        let allowed = "at least 1e-25 in single precision";
        require("the least albedo, to the power of the bounces,", throughput, throughput >= 1e-25, allowed)?;
        let part = scene.emission / self.light();
        let ok = part == 0.0 || part.is_nan() || part >= 1e-10;
        let allowed = "0 or at least 1e-10 in single precision";
        require("the faces' emission, in parts of the light's,", part, ok, allowed)?;
        Ok(PathsF32(self))
    }
}

/// [`Paths`] in single precision.
#[derive(Debug)]
struct PathsF32(Paths);

impl Estimator for PathsF32 {
    fn draw(&self, rng: &mut Stream) -> f64 {
        side_by_side::draw::<f32>(&self.0, rng)
    }

    fn fill(&self, rng: &mut Stream, draws: &mut [f64]) {
        side_by_side::fill::<f32>(&self.0, rng, draws);
    }

    fn doubt(&self) -> Option<Doubt> {
        self.0.doubt()
    }
}
