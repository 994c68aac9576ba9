//! Why a path's error bar may be wrong, from its parameters alone: [`Estimator::doubt`] of [`Paths`] has the
//! formulas.
//!
//! [`Estimator::doubt`]: crate::Estimator::doubt

use super::room::Face;
use super::{Ending, FindLight, Paths, most_albedo};
use crate::lambertian::hemisphere::Hemisphere;

/// The number of draws of a typical run.
const A_MILLION: f64 = 1e6;

impl Paths {
    /// The reason that [`doubt`](Estimator::doubt) gives.
    pub(super) fn reason(&self) -> Option<String> {
        let albedo = most_albedo(&self.room);
        let (spread, shown) = match self.directions {
            Hemisphere::Cosine => (1.0, "ρ²"),
            Hemisphere::Uniform => (4.0 / 3.0, "(4/3)ρ²"),
        };
        let growth = spread * albedo * albedo;
        let infinite = "the variance may be infinite, and the error bar too short:";
        let touches = self.room.scene().light_half_width >= 2.0 && self.light == FindLight::BySampling;
        match self.ending {
            Ending::Roulette(q) if q <= growth => {
                return Some(format!(
                    "{infinite} q = {q} is not above {shown} = {growth:.4} for the largest albedo"
                ));
            }
            // throughputs of cosine directions never exceed 1 then, and those of uniform ones grow while they
            // do
            Ending::ByThroughput if self.directions == Hemisphere::Uniform && growth >= 1.0 => {
                return Some(format!(
                    "{infinite} the squared throughput of a path grows by {shown} = {growth:.4} a bounce for \
                     the largest albedo, and nothing ends a path of throughput 1 or more"
                ));
            }
            _ => {}
        }
        if touches && self.counted[1] > 1 {
            return Some(format!(
                "{infinite} the light touches the walls, where its samples weigh without bound"
            ));
        }
        let reasons = [
            (
                self.kurtosis_of_throughputs(),
                "uniform directions make most throughputs far too small and a few very large",
            ),
            (1.0 / self.found_by_chance(), "few paths find the light"),
            (
                self.kurtosis_of_samples(),
                "the light is so near the walls that a few of its samples outweigh all others",
            ),
        ];
        let draws: f64 = reasons.iter().map(|(kurtosis, _)| kurtosis).product();
        // leave out reasons that do not matter
        let told: Vec<&str> =
            reasons.iter().filter(|(kurtosis, _)| *kurtosis >= 10.0).map(|(_, reason)| *reason).collect();
        (draws >= A_MILLION).then(|| {
            let why = told.join(", and ");
            format!("{why}, so that the error bar of fewer than about {draws:.0e} draws means nothing")
        })
    }

    /// An approximate E X⁴/(E X²)² of a light sample at a wall vertex, for a light close to the wall.
    fn kurtosis_of_samples(&self) -> f64 {
        let beside = Face::ROOM_HALF_WIDTH - self.room.scene().light_half_width;
        // farther away the whole light counts, not only its edge
        let near = self.light == FindLight::BySampling && self.counted[1] > 1 && beside < 0.5;
        if near { 8.0 / beside.powi(3) } else { 1.0 }
    }

    /// An upper bound for E X⁴/(E X²)² of a path without roulette, in a room where every vertex sees the same
    /// irradiance.
    fn kurtosis_of_throughputs(&self) -> f64 {
        if self.ending != Ending::Never || self.directions == Hemisphere::Cosine {
            return 1.0;
        }
        let albedo = most_albedo(&self.room);
        // with next-event estimation one direction less is drawn
        let less = u32::from(self.samples_light() && self.room.scene().emission == 0.0);
        let [fewest, most] = self.counted.map(|bounces| bounces.saturating_sub(less) as i32);
        // relative to the term of the fewest bounces, as only ratios count
        let sum = |factor: f64| {
            let terms = (fewest..=most).map(|k| albedo.powi(k - fewest) * factor.powf(f64::from(k)));
            terms.fold([0.0, 0.0], |[sum, squares], term| [sum + term, squares + term * term])
        };
        // ‖ΣX‖₄ ≤ Σ ‖X‖₄; E (ΣX)² is at least Σ E X² and at least (Σ E X)²
        let ([fourth, _], [mean, _], [_, square]) =
            (sum(3.2f64.powf(0.25)), sum(1.0), sum((4.0f64 / 3.0).sqrt()));
        let ratio = fourth * fourth / square.max(mean * mean);
        ratio * ratio
    }

    /// The approximate fraction of paths that hit the light: at each bounce, the light's share of the area of
    /// all faces.
    fn found_by_chance(&self) -> f64 {
        let scene = self.room.scene();
        let dark = scene.light_half_width == 0.0 || scene.emission > 0.0 || self.counted[1] == 0;
        if self.light == FindLight::BySampling || dark {
            return 1.0;
        }
        let [fewest, most] = self.counted;
        let area: f64 = Face::ALL.iter().map(|face| face.area()).sum();
        let bounces = f64::from(most - fewest.max(1).min(most)) + 1.0;
        (self.room.light_area() / area * bounces).min(1.0)
    }
}
