//! What roulette costs and gains: a model of light paths with closed forms for all of it.

use super::coin;
use crate::doubt::Doubt;
use crate::error::{Result, require, require_count};
use crate::estimator::Estimator;
use crate::float::Extended;
use crate::stream::Stream;

/// A model of light paths. Each vertex k = 0, 1, … sees the light with probability v, independently of the
/// others, and its contribution has been reflected k times with albedo ρ. The radiance is Σ ρᵏ v = v/(1 − ρ),
/// in units of the light's radiance.
///
/// Two estimators end the sum: [`roulette`](Self::roulette) at random, without bias, and
/// [`truncated`](Self::truncated) after a fixed number of vertices, with bias but less variance. Their mean
/// square errors at equal numbers of vertices cross at [`crossing`](Self::crossing). (Worksheet 5, "what
/// roulette costs and buys".)
///
/// ```
/// use unbiased::roulette::LightModel;
///
/// let model = LightModel::new(0.8, 0.5)?;
/// let paths = model.roulette(0.8)?;
/// assert!((paths.variance() * paths.cost() - 31.25).abs() < 1e-12);
/// assert!((model.optimum() - 0.898).abs() < 1e-4);
/// assert_eq!(model.roulette(0.2)?.variance(), f64::INFINITY);
/// assert_eq!(model.crossing(0.8, 8)?.floor(), 223.0);
/// # Ok::<(), unbiased::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LightModel {
    albedo: f64,
    visibility: f64,
}

impl LightModel {
    /// The model with albedo ρ and probability v that a vertex sees the light.
    ///
    /// # Errors
    /// If ρ is not in \[0, 1), or v is not in \[0, 1\].
    pub fn new(albedo: f64, visibility: f64) -> Result<Self> {
        require("the albedo ρ", albedo, (0.0..1.0).contains(&albedo), "in [0, 1)")?;
        require("the visibility v", visibility, (0.0..=1.0).contains(&visibility), "in [0, 1]")?;
        // + 0.0 turns −0 into 0
        Ok(Self { albedo: albedo + 0.0, visibility: visibility + 0.0 })
    }

    /// The albedo ρ.
    pub fn albedo(&self) -> f64 {
        self.albedo
    }

    /// The probability v that a vertex sees the light.
    pub fn visibility(&self) -> f64 {
        self.visibility
    }

    /// The true value v/(1 − ρ).
    pub fn mean(&self) -> f64 {
        let [one, rho, v] = self.terms();
        (v / (one - rho)).round()
    }

    /// Paths that go on with probability q after every vertex; the contribution of vertex k has weight
    /// (ρ/q)ᵏ.
    ///
    /// # Errors
    /// If q is not in (0, 1): at 1 a path never ends, and at 0 it has only one vertex. q = 0 is allowed if
    /// nothing follows (ρ = 0 or v = 0).
    pub fn roulette(&self, q: f64) -> Result<RoulettePaths> {
        let nothing_follows = self.albedo == 0.0 || self.visibility == 0.0;
        let ok = (q > 0.0 || q == 0.0 && nothing_follows) && q < 1.0;
        require("the continuation probability q", q, ok, "in (0, 1) (0 is biased unless ρ v = 0)")?;
        Ok(RoulettePaths { model: *self, q: q + 0.0 })
    }

    /// Paths of max_k + 1 vertices, k = 0 … max_k.
    ///
    /// # Errors
    /// If max_k is more than 10⁹: every draw visits every vertex.
    pub fn truncated(&self, max_k: u64) -> Result<TruncatedPaths> {
        let max_k = require_count("the last vertex of a path", max_k, max_k <= 1_000_000_000, "at most 10⁹")?;
        Ok(TruncatedPaths { model: *self, max_k })
    }

    /// The q* in \[ρ, 1\] that minimizes roulette's variance × cost.
    ///
    /// With A = v²ρ²/(1 − ρ)² and B = v(1 − v) it is the root of (B − A)q² + 2Aq − (A + Bρ²) = 0. It is
    /// computed as ρ(a + b)/(aρ + √(b(a(1 − ρ²) + b))) with a = v/(1 − ρ)² and b = 1 − v, where all terms are
    /// positive, and these need no special case:
    /// - A = B;
    /// - ρ = 0: q* = 0, as only the first vertex counts;
    /// - v = 1: q* = 1, which is not allowed itself, as variance × cost = A/(q − ρ²) decreases up to q = 1;
    /// - v = 0: the variance is 0 for every q, and q* = ρ is the limit for v → 0.
    pub fn optimum(&self) -> f64 {
        if self.albedo == 0.0 {
            return 0.0; // for v = 1, too, where the formula is 0/0
        }
        let [one, rho, v] = self.terms();
        let (a, b) = (v / (one - rho).squared(), one - v);
        let root = rho * (a + b) / (a * rho + (b * (a * (one - rho.squared()) + b)).sqrt());
        root.round().clamp(self.albedo, 1.0)
    }

    /// The number of vertices C above which roulette with q has a smaller mean square error than truncation
    /// after max_k: C = (Var × cost of roulette − Var × cost of truncation)/bias². 0 if roulette is always
    /// better or both errors are 0, +∞ if it never is better.
    ///
    /// # Errors
    /// Those of [`roulette`](Self::roulette) and [`truncated`](Self::truncated).
    pub fn crossing(&self, q: f64, max_k: u64) -> Result<f64> {
        let (roulette, truncated) = (self.roulette(q)?, self.truncated(max_k)?);
        let lead = roulette.excess() - truncated.excess();
        if self.visibility == 0.0 || !lead.is_positive() {
            return Ok(0.0);
        }
        let [one, rho, v] = self.terms();
        let missing = truncated.missing() / (one - rho);
        Ok((lead / (v * missing.squared())).round())
    }

    /// 1, ρ and v as double-doubles: closed forms are computed in these and rounded once.
    fn terms(&self) -> [Extended; 3] {
        [Extended::ONE, self.albedo.into(), self.visibility.into()]
    }

    /// v(1 − v), the variance of whether a vertex sees the light.
    fn spread(&self) -> Extended {
        let [one, _, v] = self.terms();
        v * (one - v)
    }
}

/// Paths that end by roulette, an unbiased estimator of [`LightModel::mean`]; see [`LightModel::roulette`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RoulettePaths {
    model: LightModel,
    q: f64,
}

impl RoulettePaths {
    /// The continuation probability q.
    pub fn q(&self) -> f64 {
        self.q
    }

    /// The mean v/(1 − ρ), which is the true value.
    pub fn mean(&self) -> f64 {
        self.model.mean()
    }

    /// The variance of one path, (A(1 − q) + Bq)/(q − ρ²) with A = v²ρ²/(1 − ρ)² and B = v(1 − v); **+∞ for q
    /// ≤ ρ²**, where weights grow faster than long paths become rare.
    pub fn variance(&self) -> f64 {
        self.extended_variance().round()
    }

    /// The expected number of vertices of one path, 1/(1 − q).
    pub fn cost(&self) -> f64 {
        1.0 / (1.0 - self.q)
    }

    /// The mean square error of the mean of as many paths as take C vertices: variance × cost/C.
    ///
    /// # Errors
    /// If C is not positive and finite.
    pub fn mean_square_error(&self, vertices: f64) -> Result<f64> {
        let paths = Extended::from(require_vertices(vertices)?) * (Extended::ONE - self.q.into());
        Ok((self.extended_variance() / paths).round())
    }

    fn extended_variance(&self) -> Extended {
        let [one, rho, v] = self.model.terms();
        let (later, growth) = self.growth();
        let mean = v / (one - rho);
        (later * mean.squared() * (one - self.q.into()) + self.model.spread()) * growth
    }

    /// Variance × cost/v − (1 − v), computed without that difference, which cancels.
    fn excess(&self) -> Extended {
        let [one, rho, v] = self.model.terms();
        let (later, growth) = self.growth();
        let q = Extended::from(self.q);
        (later * v / (one - rho).squared() + (one - v) * (q / (one - q) + later)) * growth
    }

    /// ρ²/q and 1/(1 − ρ²/q), the sum of its powers: +∞ for q ≤ ρ².
    fn growth(&self) -> (Extended, Extended) {
        if self.model.albedo == 0.0 || self.model.visibility == 0.0 {
            return (Extended::from(0.0), Extended::ONE); // only the first vertex, if any, sees light
        }
        let (square, q) = (Extended::from(self.model.albedo).squared(), Extended::from(self.q));
        let margin = q - square;
        (square / q, if margin.is_positive() { q / margin } else { f64::INFINITY.into() })
    }
}

impl Estimator for RoulettePaths {
    #[inline]
    fn draw(&self, rng: &mut Stream) -> f64 {
        let LightModel { albedo, visibility } = self.model;
        let (mut sum, mut weight, mut vertices) = (0.0, 1.0, 1);
        loop {
            if coin(rng, visibility) {
                sum += weight;
            }
            if !coin(rng, self.q) {
                break;
            }
            weight *= albedo / self.q;
            vertices += 1;
        }
        rng.count_evaluations(vertices);
        sum
    }

    fn doubt(&self) -> Option<Doubt> {
        self.variance().is_infinite().then_some(Doubt::InfiniteVariance)
    }
}

/// Paths that end after a fixed number of vertices, a biased estimator of [`LightModel::mean`]; see
/// [`LightModel::truncated`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TruncatedPaths {
    model: LightModel,
    max_k: u64,
}

impl TruncatedPaths {
    /// The last vertex K.
    pub fn max_k(&self) -> u64 {
        self.max_k
    }

    /// The mean v(1 − ρᴷ⁺¹)/(1 − ρ).
    pub fn mean(&self) -> f64 {
        let [_, rho, v] = self.model.terms();
        let (_, sum) = rho.powers(self.vertices());
        (v * sum).round()
    }

    /// The bias, mean minus true value, −v ρᴷ⁺¹/(1 − ρ): a fraction ρᴷ⁺¹ of the radiance is missing.
    pub fn bias(&self) -> f64 {
        0.0 - self.shortfall().round() // where nothing is missing it is 0, not −0
    }

    /// The variance of one path, v(1 − v)(1 − ρ²⁽ᴷ⁺¹⁾)/(1 − ρ²).
    pub fn variance(&self) -> f64 {
        self.extended_variance().round()
    }

    /// The number of vertices of every path, K + 1.
    pub fn cost(&self) -> f64 {
        self.vertices() as f64
    }

    /// The mean square error of the mean of as many paths as take C vertices: bias² + variance × cost / C.
    ///
    /// # Errors
    /// If C is not positive and finite.
    pub fn mean_square_error(&self, vertices: f64) -> Result<f64> {
        let paths = Extended::from(require_vertices(vertices)?) / self.cost().into();
        Ok((self.shortfall().squared() + self.extended_variance() / paths).round())
    }

    fn vertices(&self) -> u64 {
        self.max_k + 1
    }

    fn extended_variance(&self) -> Extended {
        self.model.spread() * self.sum_of_squares()
    }

    /// Variance × cost / v − (1 − v).
    fn excess(&self) -> Extended {
        let [one, _, v] = self.model.terms();
        (one - v) * (self.sum_of_squares() * self.cost().into() - one)
    }

    /// v ρᴷ⁺¹/(1 − ρ)
    fn shortfall(&self) -> Extended {
        let [one, rho, v] = self.model.terms();
        v * self.missing() / (one - rho)
    }

    /// ρᴷ⁺¹
    fn missing(&self) -> Extended {
        Extended::from(self.model.albedo).powers(self.vertices()).0
    }

    /// 1 + ρ² + … + ρ²ᴷ
    fn sum_of_squares(&self) -> Extended {
        Extended::from(self.model.albedo).squared().powers(self.vertices()).1
    }
}

impl Estimator for TruncatedPaths {
    #[inline]
    fn draw(&self, rng: &mut Stream) -> f64 {
        let LightModel { albedo, visibility } = self.model;
        let (mut sum, mut weight) = (0.0, 1.0);
        for _ in 0..self.vertices() {
            if coin(rng, visibility) {
                sum += weight;
            }
            weight *= albedo;
        }
        rng.count_evaluations(self.vertices());
        sum
    }
}

fn require_vertices(vertices: f64) -> Result<f64> {
    require("the number of vertices", vertices, vertices > 0.0 && vertices.is_finite(), "positive and finite")
}
