//! The test set of worksheet 2.1: six integrands whose integrals are known.

use std::f64::consts::{LN_2, PI};
use std::fmt;

use super::Rectangle;
use crate::fast;

/// An integrand of the test set, with its integral over a rectangle and the variance of the estimator A f(X,
/// Y).
///
/// On the sheet's square [−2, 2]²:
///
/// | integrand | integral | variance of a draw |
/// |---|---|---|
/// | 1 | 16 | 0 |
/// | x² + y² | 128/3 | 728.18 |
/// | 1 where x² + y² ≤ 4 | 4π | 43.148 |
/// | e^(−x²−y²) | π erf(2)² = 3.112270 | 15.443 |
/// | xy | 0 | 455.11 |
/// | 1/√(x² + y²) | 16 ln(1 + √2) = 14.102 | ∞ |
///
/// The last one has a finite mean, so it can be estimated, but an infinite variance, so its error bar is
/// meaningless.
///
/// ```
/// use unbiased::rectangle::{Integrand, Rectangle};
///
/// assert_eq!(Integrand::Paraboloid.at(1.0, 2.0), 5.0);
/// assert_eq!(Integrand::Disc.integral(&Rectangle::WORKSHEET), Some(4.0 * std::f64::consts::PI));
/// assert_eq!(Integrand::InverseDistance.variance(&Rectangle::WORKSHEET), Some(f64::INFINITY));
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Integrand {
    /// f = 1: the variance is 0, and mistakes such as X used for Y do not show.
    Constant,
    /// f = x² + y²: a function of x plus one of y, for which all pairs are no better than independent ones.
    Paraboloid,
    /// f = 1 where x² + y² ≤ 4, else 0: a jump.
    Disc,
    /// f = e^(−x²−y²): smooth.
    Gaussian,
    /// f = xy: its integral over a square about the origin is 0, unless X is used for Y as well.
    Product,
    /// f = 1/√(x² + y²): a finite integral, but an infinite variance if the rectangle holds the origin.
    InverseDistance,
}

/// Radius² of the disc.
const RADIUS_2: f64 = 4.0;

impl Integrand {
    /// All six, in the order of the worksheet's table.
    pub const ALL: [Self; 6] =
        [Self::Constant, Self::Paraboloid, Self::Disc, Self::Gaussian, Self::Product, Self::InverseDistance];

    /// The name.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Constant => "constant",
            Self::Paraboloid => "paraboloid",
            Self::Disc => "disc",
            Self::Gaussian => "Gaussian",
            Self::Product => "product",
            Self::InverseDistance => "inverse distance",
        }
    }

    /// f(x, y) as a formula.
    pub const fn formula(self) -> &'static str {
        match self {
            Self::Constant => "1",
            Self::Paraboloid => "x² + y²",
            Self::Disc => "[x² + y² ≤ 4]",
            Self::Gaussian => "e^(−x²−y²)",
            Self::Product => "xy",
            Self::InverseDistance => "1/√(x² + y²)",
        }
    }

    /// f(x, y).
    ///
    /// The inverse distance is set to 0 at the origin and where 1/r would overflow (r < 2⁻¹⁰²⁴), as an
    /// infinite draw would end the run. This changes no integral, and has probability 2⁻¹⁰⁶.
    #[inline(always)]
    pub fn at(self, x: f64, y: f64) -> f64 {
        match self {
            Self::Constant => 1.0,
            Self::Paraboloid => x * x + y * y,
            Self::Disc => f64::from(u8::from(x * x + y * y <= RADIUS_2)),
            Self::Gaussian => fast::exp(-x * x - y * y),
            Self::Product => x * y,
            Self::InverseDistance => inverse_distance(x, y),
        }
    }

    /// ∫∫ f over the rectangle.
    ///
    /// `None` if the disc's edge crosses the rectangle's, and if the closed form of the inverse distance
    /// would cancel to fewer than 12 digits (a small rectangle far from the origin).
    pub fn integral(self, rectangle: &Rectangle) -> Option<f64> {
        let Rectangle { x: [a, b], y: [c, d], width, height, area, .. } = *rectangle;
        let (x, y) = (a.midpoint(b), c.midpoint(d));
        match self {
            Self::Constant => Some(area),
            // E X² = x̄² + (b − a)²/12
            Self::Paraboloid => Some(
                product([area, x, x])
                    + product([area, y, y])
                    + (product([area, width, width]) + product([area, height, height])) / 12.0,
            ),
            Self::Disc => part_of_disc(rectangle),
            Self::Gaussian => Some(bell(1.0, rectangle.x) * bell(1.0, rectangle.y)),
            Self::Product => Some(product([area, x, y])),
            Self::InverseDistance => {
                let corners = [corner(b, d), -corner(a, d), -corner(b, c), corner(a, c)];
                with_digits(corners.iter().sum(), corners.iter().fold(0.0, |most, term| most.max(term.abs())))
            }
        }
    }

    /// The variance of one draw A f(X, Y), A ∫∫ f² − (∫∫ f)².
    ///
    /// +∞ for the inverse distance if the origin lies in the rectangle or on its edge, otherwise `None`, as
    /// there is no elementary form. `None` as well if the disc's edge crosses the rectangle's, and if the
    /// Gaussian is so nearly constant that its variance would cancel to fewer than 12 digits.
    pub fn variance(self, rectangle: &Rectangle) -> Option<f64> {
        let Rectangle { x: [a, b], y: [c, d], width, height, area, .. } = *rectangle;
        match self {
            Self::Constant => Some(0.0),
            Self::Paraboloid => self.main_effects(rectangle).map(|[x, y]| x + y),
            Self::Disc => part_of_disc(rectangle).map(|part| part * (area - part)),
            // A² [E g² E h² − (E g E h)²]
            Self::Gaussian => {
                let squares = bell(2.0, rectangle.x) / width * (bell(2.0, rectangle.y) / height);
                let mean = bell(1.0, rectangle.x) / width * (bell(1.0, rectangle.y) / height);
                Some(product([area, area, with_digits(squares - mean * mean, squares)?]))
            }
            Self::Product => {
                let [x, y] = self.main_effects(rectangle)?;
                Some(x + y + (product([area, width, height]) / 12.0).powi(2))
            }
            Self::InverseDistance => {
                ((a..=b).contains(&0.0) && (c..=d).contains(&0.0)).then_some(f64::INFINITY)
            }
        }
    }

    /// The variance of one draw of all n² pairs, \[V + (n − 1)(V_x + V_y)\]/n² with V the variance of A f(X,
    /// Y), V_x that of A E\[f|X\] and V_y that of A E\[f|Y\]; see [`Rectangle::all_pairs`].
    ///
    /// `None` for n = 0 and where a variance has no closed form.
    ///
    /// ```
    /// use unbiased::rectangle::{Integrand, Rectangle};
    ///
    /// // 32 values each of x and y, at 32 times the evaluations: a small gain for the Gaussian, none for
    /// // the paraboloid
    /// let square = Rectangle::WORKSHEET;
    /// let variances = [(Integrand::Gaussian, 0.4826, 0.3732), (Integrand::Paraboloid, 22.756, 22.756)];
    /// for (f, independent, all_pairs) in variances {
    ///     assert!((f.variance(&square).unwrap() / 32.0 / independent - 1.0).abs() < 1e-4);
    ///     assert!((f.all_pairs_variance(&square, 32).unwrap() / all_pairs - 1.0).abs() < 2e-4);
    /// }
    /// ```
    pub fn all_pairs_variance(self, rectangle: &Rectangle, n: u64) -> Option<f64> {
        let variance = self.variance(rectangle)?;
        let n = if n > 0 { n as f64 } else { return None };
        if variance.is_infinite() {
            return Some(variance);
        }
        let [x, y] = self.main_effects(rectangle)?;
        Some(variance / n / n + (x + y) * ((n - 1.0) / n) / n)
    }

    /// The variances of A E\[f|X\] and of A E\[f|Y\].
    fn main_effects(self, rectangle: &Rectangle) -> Option<[f64; 2]> {
        let Rectangle { x: [a, b], y: [c, d], width, height, area, .. } = *rectangle;
        let (x, y) = (a.midpoint(b), c.midpoint(d));
        match self {
            Self::Constant => Some([0.0; 2]),
            // Var X² = x̄² (b − a)²/3 + (b − a)⁴/180
            Self::Paraboloid => Some([(x, width), (y, height)].map(|(middle, length)| {
                product([area, middle, length]).powi(2) / 3.0
                    + product([area, length, length]).powi(2) / 180.0
            })),
            // E[f|X] = 2√(4 − X²)/(d − c) where |X| ≤ 2
            Self::Disc => Some(match part_of_disc(rectangle)? {
                part if part == 0.0 || part == area => [0.0; 2],
                part => [width, height].map(|length| length * (128.0 / 3.0) - part.powi(2)),
            }),
            Self::Gaussian => {
                let (across, along) = (bell(1.0, rectangle.x), bell(1.0, rectangle.y));
                Some([
                    bell_variance(rectangle.x)? * along * along,
                    bell_variance(rectangle.y)? * across * across,
                ])
            }
            // Var X = (b − a)²/12
            Self::Product => {
                Some([product([area, y, width]), product([area, x, height])].map(|sd| sd * sd / 12.0))
            }
            Self::InverseDistance => None,
        }
    }
}

/// Not inlined, to keep the calling loop small.
#[inline(never)]
fn inverse_distance(x: f64, y: f64) -> f64 {
    let inverse = x.hypot(y).recip();
    if inverse.is_infinite() { 0.0 } else { inverse }
}

/// The formula.
impl fmt::Display for Integrand {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.formula())
    }
}

/// The area of the disc in the rectangle: none, all of the rectangle, or all of the disc; `None` where their
/// edges cross.
fn part_of_disc(&Rectangle { x: [a, b], y: [c, d], area, .. }: &Rectangle) -> Option<f64> {
    let radius = RADIUS_2.sqrt();
    let square = |[x, y]: [f64; 2]| x * x + y * y;
    let farthest = square([a.abs().max(b.abs()), c.abs().max(d.abs())]);
    let nearest = square([0f64.clamp(a, b), 0f64.clamp(c, d)]);
    if farthest <= RADIUS_2 {
        Some(area)
    } else if nearest > RADIUS_2 {
        Some(0.0)
    } else if a.max(c) <= -radius && b.min(d) >= radius {
        Some(PI * RADIUS_2)
    } else {
        None
    }
}

/// The product, smallest and largest factor first, so that it over- or underflows only if the result does.
fn product(mut factors: [f64; 3]) -> f64 {
    factors.sort_by(|a, b| a.abs().total_cmp(&b.abs()));
    let [least, middle, greatest] = factors;
    least * greatest * middle
}

/// `value`, a difference of terms up to `largest`, unless cancellation leaves fewer than 12 digits.
fn with_digits(value: f64, largest: f64) -> Option<f64> {
    (value.is_finite() && value >= largest / 1024.0).then_some(value)
}

/// ∫ e^(−kx²) dx from a to b (for k = 1, ½√π (erf b − erf a)), by quadrature, as a difference of two erf
/// cancels.
pub(super) fn bell(k: f64, [a, b]: [f64; 2]) -> f64 {
    if a < 0.0 && 0.0 < b {
        return bell(k, [0.0, -a]) + bell(k, [0.0, b]);
    }
    // with x = near + t: e^(−k near²) ∫ e^(−k t (2 near + t)) dt
    let (near, length) = (a.abs().min(b.abs()), b - a);
    let square = near * near;
    if square > 745.0 {
        return 0.0; // below f64's range
    }
    let lost = near.mul_add(near, -square);
    let fall = |t: f64| k * t * (2.0 * near + t);
    let panel = 1f64.min(1.0 / (k * near));
    let (mut sum, mut start) = (0.0, 0.0);
    while start < length && fall(start) < 40.0 {
        let half = 0.5 * panel.min(length - start);
        for (node, weight) in GAUSS_LEGENDRE {
            let [left, right] = [1.0 - node, 1.0 + node].map(|at| (-fall(start + half * at)).exp());
            sum += weight * half * (left + right);
        }
        start += panel;
    }
    sum * (-k * square).exp() * (1.0 - k * lost)
}

/// Positive nodes and weights of the ten-point Gauss–Legendre rule; its error on a panel of [`bell`] is below
/// 4e-19.
const GAUSS_LEGENDRE: [(f64, f64); 5] = [
    (0.14887433898163122, 0.29552422471475287),
    (0.4333953941292472, 0.26926671930999635),
    (0.6794095682990244, 0.21908636251598204),
    (0.8650633666889845, 0.1494513491505806),
    (0.9739065285171717, 0.06667134430868814),
];

/// (b − a)² Var e^(−X²) = (b − a) ∫ e^(−2x²) dx − (∫ e^(−x²) dx)².
fn bell_variance(range: [f64; 2]) -> Option<f64> {
    let [a, b] = range;
    let square = (b - a) * bell(2.0, range);
    with_digits(square - bell(1.0, range).powi(2), square)
}

/// ∫∫ 1/r from the origin to the corner (x, y), x asinh(y/|x|) + y asinh(x/|y|), negative where one of x and
/// y is.
fn corner(x: f64, y: f64) -> f64 {
    let sign = x.signum() * y.signum();
    let (x, y) = (x.abs(), y.abs());
    sign * (half_corner(x, y) + half_corner(y, x))
}

/// x asinh(y/x) for x, y ≥ 0, also where the quotient over- or underflows.
fn half_corner(x: f64, y: f64) -> f64 {
    let slope = y / x;
    if x == 0.0 || y == 0.0 {
        0.0
    } else if slope < 1e-9 {
        y // asinh s = s (1 − s²/6 …)
    } else if slope.is_infinite() {
        x * (LN_2 + y.ln() - x.ln()) // asinh s = ln 2s + 1/(4s²) …
    } else {
        x * slope.asinh()
    }
}
