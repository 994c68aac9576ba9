//! Sets of points that depend on each other, each set one draw.

use rand::Rng;
use sobol_burley::parts::{owen_scramble_rev, sobol_int4_rev};

use super::Rectangle;
use crate::error::{Result, require_count};
use crate::run::Estimator;
use crate::stream::Stream;

/// Sobol's points are kept to 16 digits by `sobol_burley`, so the set repeats after 2¹⁶ of them; a side of a
/// grid gets the same limit, which makes a draw 2³² evaluations at most.
const LIMIT: u64 = 1 << 16;

fn require_points(name: &'static str, n: u64) -> Result<u32> {
    Ok(require_count(name, n, (1..=LIMIT).contains(&n), "from 1 to 65536")? as u32)
}

impl Rectangle {
    /// The estimator A/n² Σᵢ Σⱼ f(Xᵢ, Yⱼ): n values of x, n of y, all n² pairs.
    ///
    /// The sheet's 2n values give n independent pairs, or n² that are not. These are unbiased, too, since
    /// every single pair is uniform, but the variance does not fall as 1/n²: with σ² = Var f(X, Y), σ_x² =
    /// Var E\[f|X\] and σ_y² = Var E\[f|Y\] it is A² \[σ² + (n − 1)(σ_x² + σ_y²)\]/n². The n independent
    /// pairs have A² σ²/n, which is never less, and is no more where f(x, y) = g(x) + h(y), since then σ² =
    /// σ_x² + σ_y². (Efron & Stein 1981;
    /// [`Integrand::all_pairs_variance`](super::Integrand::all_pairs_variance).)
    ///
    /// # Errors
    /// If n is not from 1 to 2¹⁶.
    ///
    /// ```
    /// use unbiased::{Budget, Run, rectangle::Rectangle};
    ///
    /// let bell = Rectangle::WORKSHEET.all_pairs(|x, y| (-x * x - y * y).exp(), 32)?;
    /// let outcome = Run::new(1).estimate(&bell, Budget::Draws(1000))?;
    /// assert_eq!(outcome.cost.random_numbers, 1000 * 2 * 32);
    /// assert_eq!(outcome.cost.evaluations, 1000 * 32 * 32);
    /// # Ok::<(), unbiased::Error>(())
    /// ```
    pub fn all_pairs<F: Fn(f64, f64) -> f64 + Sync>(self, f: F, n: u64) -> Result<AllPairs<F>> {
        let n = require_points("the number n of values", n)?;
        Ok(AllPairs { rectangle: self, f, n })
    }

    /// The estimator A/s² Σ f over one uniform point in each cell of an s × s grid.
    ///
    /// The variance is that *within* the cells alone, A²/s⁴ Σ Var f(cell): for a smooth f it falls as s⁻⁴ and
    /// the error as 1/evaluations; across a jump such as the disc's edge, as evaluations^(−3/4). It is never
    /// more than with as many independent points. (*Physically Based Rendering*, 4th ed., section 2.2.1.)
    ///
    /// # Errors
    /// If the side s is not from 1 to 2¹⁶.
    pub fn jittered<F: Fn(f64, f64) -> f64 + Sync>(self, f: F, side: u64) -> Result<Jittered<F>> {
        let side = require_points("the side of the grid", side)?;
        Ok(Jittered { rectangle: self, f, side })
    }

    /// The estimator A/n Σ f over the first n points of an Owen-scrambled Sobol sequence in two dimensions.
    ///
    /// For n = 2ᵐ every rectangle of 2⁻ᵏ of the width and 2^(k−m) of the height holds exactly one point: the
    /// error of a smooth f falls nearly as n^(−3/2) (Owen 1997). Other n are allowed, and gain less.
    ///
    /// The points are those of `sobol_burley`, to as many binary digits as n takes; the digits below come
    /// from the stream, as in Owen's definition. Each axis has 32 random bits of its own to scramble by, and
    /// every point is then exactly uniform, on the same grid of 2⁻⁵³ as [`Stream::uniform`].
    ///
    /// # Errors
    /// If n is not from 1 to 2¹⁶, after which the sequence would repeat.
    ///
    /// ```
    /// use unbiased::{Budget, estimate, rectangle::Rectangle};
    ///
    /// let bell = Rectangle::WORKSHEET.sobol(|x, y| (-x * x - y * y).exp(), 1024)?;
    /// let estimate = estimate(&bell, Budget::Draws(100), 1)?;
    /// assert!(estimate.z(3.1122703197174722).unwrap().abs() < 5.0);
    /// assert!(estimate.std_error().unwrap() < 2e-4); // 1024 × 100 independent points: 0.012
    /// # Ok::<(), unbiased::Error>(())
    /// ```
    pub fn sobol<F: Fn(f64, f64) -> f64 + Sync>(self, f: F, points: u64) -> Result<Sobol<F>> {
        let points = require_points("the number of Sobol points", points)?;
        Ok(Sobol { rectangle: self, f, points })
    }
}

/// The estimator over all n² pairs; see [`Rectangle::all_pairs`].
#[derive(Debug, Clone, Copy)]
pub struct AllPairs<F> {
    rectangle: Rectangle,
    f: F,
    n: u32,
}

impl<F: Fn(f64, f64) -> f64 + Sync> AllPairs<F> {
    fn replicate(&self, rng: &mut Stream, xs: &mut Vec<f64>) -> f64 {
        xs.clear();
        xs.extend((0..self.n).map(|_| self.rectangle.x_at(rng.uniform())));
        let mut mean = Mean::new(self.rectangle.area, self.evaluations());
        for _ in 0..self.n {
            let y = self.rectangle.y_at(rng.uniform());
            for &x in xs.iter() {
                mean.add((self.f)(x, y));
            }
        }
        rng.count_evaluations(self.evaluations());
        mean.times_area()
    }

    fn evaluations(&self) -> u64 {
        u64::from(self.n) * u64::from(self.n)
    }
}

impl<F: Fn(f64, f64) -> f64 + Sync> Estimator for AllPairs<F> {
    fn draw(&self, rng: &mut Stream) -> f64 {
        self.replicate(rng, &mut Vec::with_capacity(self.n as usize))
    }

    fn fill(&self, rng: &mut Stream, draws: &mut [f64]) {
        let mut xs = Vec::with_capacity(self.n as usize);
        for draw in draws {
            *draw = self.replicate(rng, &mut xs);
        }
    }
}

/// The estimator over one point in each cell of a grid; see [`Rectangle::jittered`].
#[derive(Debug, Clone, Copy)]
pub struct Jittered<F> {
    rectangle: Rectangle,
    f: F,
    side: u32,
}

impl<F> Jittered<F> {
    fn evaluations(&self) -> u64 {
        u64::from(self.side) * u64::from(self.side)
    }
}

impl<F: Fn(f64, f64) -> f64 + Sync> Estimator for Jittered<F> {
    fn draw(&self, rng: &mut Stream) -> f64 {
        let cell = 1.0 / f64::from(self.side);
        let mut mean = Mean::new(self.rectangle.area, self.evaluations());
        for row in 0..self.side {
            for column in 0..self.side {
                let u = (f64::from(column) + rng.uniform()) * cell;
                let v = (f64::from(row) + rng.uniform()) * cell;
                let [x, y] = self.rectangle.at(u, v);
                mean.add((self.f)(x, y));
            }
        }
        rng.count_evaluations(self.evaluations());
        mean.times_area()
    }
}

/// The estimator over a scrambled Sobol set; see [`Rectangle::sobol`].
#[derive(Debug, Clone, Copy)]
pub struct Sobol<F> {
    rectangle: Rectangle,
    f: F,
    points: u32,
}

impl<F: Fn(f64, f64) -> f64 + Sync> Estimator for Sobol<F> {
    fn draw(&self, rng: &mut Stream) -> f64 {
        let digits = self.points.next_power_of_two().trailing_zeros();
        // both axes scrambled by bits of their own: one 32-bit seed for both, as `sobol_burley::sample`
        // takes, knows only 2³² replicates
        let scrambles = rng.next_u64();
        let mut mean = Mean::new(self.rectangle.area, self.points.into());
        for index in 0..self.points {
            let [u, v, ..]: [u32; 4] = sobol_int4_rev(index.reverse_bits(), 0).into();
            let u = scrambled(u, scrambles as u32, digits, rng.next_u64());
            let v = scrambled(v, (scrambles >> 32) as u32, digits, rng.next_u64());
            let [x, y] = self.rectangle.at(u, v);
            mean.add((self.f)(x, y));
        }
        rng.count_evaluations(self.points.into());
        mean.times_area()
    }
}

/// A coordinate on the grid k·2⁻⁵³ in [0, 1): its first `digits` ≤ 16 binary digits are those of a Sobol
/// point (given in reverse), scrambled, and the rest are those of `random`.
///
/// Over all scrambles the first 16 digits take each value equally often (`owen_scramble_rev` adds the
/// scramble's low half and then only permutes); the further ones of `sobol_burley`'s 23 do not quite.
#[inline]
pub(crate) fn scrambled(sobol_rev: u32, scramble: u32, digits: u32, random: u64) -> f64 {
    const STEP: f64 = 1.0 / (1u64 << 53) as f64;
    let sobol = owen_scramble_rev(sobol_rev, scramble).reverse_bits();
    let below = u64::MAX >> digits;
    let bits = (u64::from(sobol) << 32) & !below | random & below;
    (bits >> 11) as f64 * STEP
}

/// The sum A/n Σ f of a replicate, compensated (Neumaier 1974): 2³² terms are as accurate as one.
///
/// Terms are first scaled by the power of two below A/n, which is exact, so the sum overflows only where the
/// result does.
struct Mean {
    area: f64,
    points: f64,
    scale: f64,
    sum: f64,
    lost: f64,
}

impl Mean {
    fn new(area: f64, points: u64) -> Self {
        const EXPONENT: u64 = 0x7ff << 52;
        let points = points as f64;
        let scale = f64::from_bits((area / points).to_bits() & EXPONENT).max(f64::MIN_POSITIVE);
        Self { area, points, scale, sum: 0.0, lost: 0.0 }
    }

    #[inline]
    fn add(&mut self, f: f64) {
        let term = f * self.scale;
        let sum = self.sum + term;
        let added = sum - self.sum;
        self.lost += (self.sum - (sum - added)) + (term - added);
        self.sum = sum;
    }

    fn times_area(self) -> f64 {
        // an infinite term has left NaN in what was lost: the infinity itself says more
        let sum = if self.sum.is_finite() { self.sum + self.lost } else { self.sum };
        sum / self.points * (self.area / self.scale)
    }
}
