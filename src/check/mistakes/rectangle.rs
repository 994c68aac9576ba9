//! Mistakes in integrating over a rectangle.

use super::{Attempt, Mistake, Probe, Setup, Words, words};
use crate::rectangle::Rectangle;

/// An integrand of the probes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Surface {
    /// f = 1
    One,
    /// f = x² + y²
    Squares,
    /// f = xy
    Product,
    /// f = x + 2y, odd, and not the same in x and y
    Plane,
}

impl Surface {
    /// f(x, y) as a formula.
    pub const fn formula(self) -> &'static str {
        match self {
            Self::One => "1",
            Self::Squares => "x² + y²",
            Self::Product => "xy",
            Self::Plane => "x + 2y",
        }
    }

    /// f(x, y).
    pub fn at(self, x: f64, y: f64) -> f64 {
        match self {
            Self::One => 1.0,
            Self::Squares => x * x + y * y,
            Self::Product => x * y,
            Self::Plane => x + 2.0 * y,
        }
    }

    /// ∫∫ f
    pub(super) fn integral(self, rectangle: &Rectangle) -> f64 {
        rectangle.area() * self.mean(&Points::on(rectangle))
    }

    /// ∫∫ |f|
    pub(super) fn absolute_integral(self, rectangle: &Rectangle) -> f64 {
        2.0 * self.positive_integral(rectangle) - self.integral(rectangle)
    }

    /// ∫∫ max(f, 0)
    fn positive_integral(self, rectangle: &Rectangle) -> f64 {
        let ([a, b], [c, d]) = (rectangle.x_range(), rectangle.y_range());
        match self {
            Self::One | Self::Squares => self.integral(rectangle),
            Self::Product => {
                // ∫ max(±t, 0) dt
                let part = |sign: f64, [from, to]: [f64; 2]| {
                    let square = |t: f64| sign * (sign * t).max(0.0).powi(2);
                    0.5 * (square(to) - square(from))
                };
                part(1.0, [a, b]) * part(1.0, [c, d]) + part(-1.0, [a, b]) * part(-1.0, [c, d])
            }
            Self::Plane => {
                // ∂²/∂x∂y of max(x + 2y, 0)³/12 is max(x + 2y, 0)
                let corner = |x: f64, y: f64| (x + 2.0 * y).max(0.0).powi(3) / 12.0;
                corner(b, d) - corner(a, d) - corner(b, c) + corner(a, c)
            }
        }
    }

    /// E f(X, Y)
    fn mean(self, points: &Points) -> f64 {
        let Points { x, y, xx, yy, xy } = *points;
        match self {
            Self::One => 1.0,
            Self::Squares => xx + yy,
            Self::Product => xy,
            Self::Plane => x + 2.0 * y,
        }
    }
}

pub(super) fn probes() -> Vec<Probe> {
    let sheet = Rectangle::WORKSHEET;
    // neither its area nor its perimeter nor its centre hides a mistake
    let Ok(offset) = Rectangle::new([0.3, 2.0], [-1.1, 3.0]) else { return Vec::new() };
    vec![
        Probe::rectangle(sheet, Surface::One),
        Probe::rectangle(sheet, Surface::Squares),
        Probe::rectangle(sheet, Surface::Product),
        Probe::rectangle(offset, Surface::One),
        Probe::rectangle(offset, Surface::Squares),
        Probe::rectangle(offset, Surface::Product),
        Probe::rectangle(offset, Surface::Plane),
    ]
}

/// Moments of the points at which f is looked up.
#[derive(Debug, Clone, Copy)]
struct Points {
    x: f64,
    y: f64,
    xx: f64,
    yy: f64,
    xy: f64,
}

impl Points {
    /// X and Y independent and uniform.
    fn independent([a, b]: [f64; 2], [c, d]: [f64; 2]) -> Self {
        let mean = |a: f64, b: f64| a.midpoint(b);
        let square = |a: f64, b: f64| (a * a + a * b + b * b) / 3.0;
        Self { x: mean(a, b), y: mean(c, d), xx: square(a, b), yy: square(c, d), xy: mean(a, b) * mean(c, d) }
    }

    fn on(rectangle: &Rectangle) -> Self {
        Self::independent(rectangle.x_range(), rectangle.y_range())
    }
}

/// Width and height.
fn sides(rectangle: &Rectangle) -> [f64; 2] {
    let ([a, b], [c, d]) = (rectangle.x_range(), rectangle.y_range());
    [b - a, d - c]
}

fn right_point(rectangle: &Rectangle, u: f64, v: f64) -> [f64; 2] {
    let ([a, _], [c, _], [w, h]) = (rectangle.x_range(), rectangle.y_range(), sides(rectangle));
    [a + w * u, c + h * v]
}

/// The right points, and another factor than the area, a function of width and height.
fn factor(words: Words, factor: fn(f64, f64) -> f64) -> Mistake {
    let of = move |rectangle: &Rectangle| {
        let [w, h] = sides(rectangle);
        factor(w, h)
    };
    let wrong = Attempt::rectangle(move |f, rectangle, rng| {
        let [x, y] = right_point(rectangle, rng.uniform(), rng.uniform());
        of(rectangle) * f(x, y)
    });
    Mistake::new(words, 2, wrong, move |setup| match setup {
        Setup::Rectangle { rectangle, surface } => of(rectangle) * surface.mean(&Points::on(rectangle)),
        _ => f64::NAN,
    })
}

/// The right factor, and other points.
fn points(
    words: Words,
    at: fn(&Rectangle, f64, f64) -> [f64; 2],
    moments: fn(&Rectangle) -> Points,
) -> Mistake {
    let wrong = Attempt::rectangle(move |f, rectangle, rng| {
        let (u, v) = (rng.uniform(), rng.uniform());
        let [x, y] = at(rectangle, u, v);
        rectangle.area() * f(x, y)
    });
    Mistake::new(words, 2, wrong, move |setup| match setup {
        Setup::Rectangle { rectangle, surface } => rectangle.area() * surface.mean(&moments(rectangle)),
        _ => f64::NAN,
    })
}

/// The right factor and points, and another value than f's.
fn value(words: Words, of: fn(f64) -> f64, integral: fn(Surface, &Rectangle) -> f64) -> Mistake {
    let wrong = Attempt::rectangle(move |f, rectangle, rng| {
        let [x, y] = right_point(rectangle, rng.uniform(), rng.uniform());
        rectangle.area() * of(f(x, y))
    });
    Mistake::new(words, 2, wrong, move |setup| match setup {
        Setup::Rectangle { rectangle, surface } => integral(*surface, rectangle),
        _ => f64::NAN,
    })
}

pub(super) fn mistakes() -> Vec<Mistake> {
    let divide = "divide by p(x, y) = 1/area: multiply by the area";
    let both = "p(x, y) = p(x) p(y) = 1/width · 1/height";
    let area = "the area is width · height";
    let own = "X needs a random number of its own, and so does Y";
    let place = "X = a + (b − a)U, Y = c + (d − c)V";
    let sign = "leave the sign of f: negative values count";
    vec![
        factor(words("2.1", "no division by p", "f(X, Y)", divide), |_, _| 1.0),
        factor(words("2.1", "multiplied by p", "f(X, Y)/A", divide), |w, h| 1.0 / (w * h)),
        factor(words("2.1", "divided by p twice", "A² f(X, Y)", divide), |w, h| (w * h).powi(2)),
        factor(words("2.1", "divided by p(x) alone", "(b − a) f(X, Y)", both), |w, _| w),
        factor(words("2.1", "divided by p(y) alone", "(d − c) f(X, Y)", both), |_, h| h),
        factor(words("2.1", "densities added", "f(X, Y)/(p(X) + p(Y))", both), |w, h| w * h / (w + h)),
        factor(words("2.1", "width squared for the area", "(b − a)² f(X, Y)", area), |w, _| w * w),
        factor(words("2.1", "height squared for the area", "(d − c)² f(X, Y)", area), |_, h| h * h),
        factor(words("2.1", "width + height for the area", "(w + h) f(X, Y)", area), |w, h| w + h),
        factor(words("2.1", "the perimeter for the area", "2(w + h) f(X, Y)", area), |w, h| 2.0 * (w + h)),
        factor(words("2.1", "the root of the area", "√A f(X, Y)", area), |w, h| (w * h).sqrt()),
        factor(words("2.1", "the diagonal for the area", "√(w² + h²) f(X, Y)", area), f64::hypot),
        factor(
            words(
                "2.1",
                "a triangle's area, or divided by the 2n values",
                "A/(2n) Σ f",
                "divide by the n pairs",
            ),
            |w, h| 0.5 * w * h,
        ),
        factor(words("2.1", "half widths", "w/2 · h/2 · f(X, Y)", "[−2, 2] is 4 wide, not 2"), |w, h| {
            0.25 * w * h
        }),
        factor(words("2.1", "the sheet's 16 for every area", "16 f(X, Y)", area), |_, _| 16.0),
        points(
            words("2.1", "the same U for x and y", "f(a + wU, c + hU)", own),
            |rectangle, u, _| right_point(rectangle, u, u),
            |rectangle| {
                let points = Points::on(rectangle);
                Points { xy: points.xy + rectangle.area() / 12.0, ..points }
            },
        ),
        points(
            words("2.1", "1 − U for y", "f(a + wU, c + h(1 − U))", own),
            |rectangle, u, _| right_point(rectangle, u, 1.0 - u),
            |rectangle| {
                let points = Points::on(rectangle);
                Points { xy: points.xy - rectangle.area() / 12.0, ..points }
            },
        ),
        points(
            words("2.1", "X used for Y as well", "f(X, X)", own),
            |rectangle, u, _| {
                let [x, _] = right_point(rectangle, u, u);
                [x, x]
            },
            |rectangle| {
                let Points { x, xx, .. } = Points::on(rectangle);
                Points { x, y: x, xx, yy: xx, xy: xx }
            },
        ),
        points(
            words("2.1", "Y drawn from X's interval", "Y = a + (b − a)V", place),
            |rectangle, u, v| {
                let ([x, _], [y, _]) = (right_point(rectangle, u, u), right_point(rectangle, v, v));
                [x, y]
            },
            |rectangle| Points::independent(rectangle.x_range(), rectangle.x_range()),
        ),
        points(
            words("2.1", "x and y exchanged", "f(Y, X)", "the first argument is x, drawn from [a, b]"),
            |rectangle, u, v| {
                let [x, y] = right_point(rectangle, u, v);
                [y, x]
            },
            |rectangle| Points::independent(rectangle.y_range(), rectangle.x_range()),
        ),
        points(
            words("2.1", "the end for the width", "X = a + bU, Y = c + dV", place),
            |rectangle, u, v| {
                let ([a, b], [c, d]) = (rectangle.x_range(), rectangle.y_range());
                [a + b * u, c + d * v]
            },
            |rectangle| {
                let ([a, b], [c, d]) = (rectangle.x_range(), rectangle.y_range());
                Points::independent([a, a + b], [c, c + d])
            },
        ),
        points(
            words("2.1", "the lower end forgotten", "X = (b − a)U, Y = (d − c)V", place),
            |rectangle, u, v| {
                let [w, h] = sides(rectangle);
                [w * u, h * v]
            },
            |rectangle| {
                let [w, h] = sides(rectangle);
                Points::independent([0.0, w], [0.0, h])
            },
        ),
        points(
            words("2.1", "the sheet's interval for every rectangle", "X = 4U − 2, Y = 4V − 2", place),
            |_, u, v| [4.0 * u - 2.0, 4.0 * v - 2.0],
            |_| Points::on(&Rectangle::WORKSHEET),
        ),
        points(
            words("2.1", "U left as it is", "f(U, V)", place),
            |_, u, v| [u, v],
            |_| Points::independent([0.0, 1.0], [0.0, 1.0]),
        ),
        points(
            words("2.1", "y kept at the centre", "f(X, (c + d)/2)", own),
            |rectangle, u, _| right_point(rectangle, u, 0.5),
            |rectangle| {
                let points = Points::on(rectangle);
                Points { yy: points.y * points.y, ..points }
            },
        ),
        value(
            words("2.1", "negative values cut off", "A max(f(X, Y), 0)", sign),
            |f| f.max(0.0),
            Surface::positive_integral,
        ),
        value(
            words("2.1", "the absolute value of f", "A |f(X, Y)|", sign),
            f64::abs,
            Surface::absolute_integral,
        ),
    ]
}
