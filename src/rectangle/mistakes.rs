//! Mistakes in integrating over a rectangle.

use std::fmt;
use std::sync::LazyLock;

use super::Rectangle;
use crate::check::{About, Exercise, Given, Listed, Problem};
use crate::stream::Stream;

/// The problem of estimating ∫∫ f over a rectangle. A draw is A f(X, Y), or any other whose mean is the
/// integral.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Integral {
    /// \[a, b\] × \[c, d\]
    pub rectangle: Rectangle,
    /// f
    pub surface: Surface,
}

/// An integrand.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Surface {
    /// f = 1
    One,
    /// f = x² + y²
    Squares,
    /// f = xy
    Product,
    /// f = x + 2y: odd, and not symmetric in x and y
    Plane,
}

impl Integral {
    /// f(x, y).
    pub fn f(&self, x: f64, y: f64) -> f64 {
        match self.surface {
            Surface::One => 1.0,
            Surface::Squares => x * x + y * y,
            Surface::Product => x * y,
            Surface::Plane => x + 2.0 * y,
        }
    }

    /// The ends \[\[a, b\], \[c, d\]\].
    pub fn ends(&self) -> [[f64; 2]; 2] {
        [self.rectangle.x_range(), self.rectangle.y_range()]
    }

    /// Width and height.
    fn sides(&self) -> [f64; 2] {
        self.ends().map(|[from, to]| to - from)
    }

    /// The point of the rectangle for two uniform numbers.
    fn point(&self, u: f64, v: f64) -> [f64; 2] {
        let ([[a, _], [c, _]], [w, h]) = (self.ends(), self.sides());
        [a + w * u, c + h * v]
    }

    /// f at a uniform point.
    fn value(&self, rng: &mut Stream) -> f64 {
        let [x, y] = self.point(rng.uniform(), rng.uniform());
        self.f(x, y)
    }

    /// A f at another point, a function of two uniform numbers.
    fn at(&self, rng: &mut Stream, point: impl Fn(f64, f64) -> [f64; 2]) -> f64 {
        let [x, y] = point(rng.uniform(), rng.uniform());
        self.rectangle.area() * self.f(x, y)
    }

    /// f at a uniform point, times a function of width and height.
    fn times(&self, rng: &mut Stream, factor: fn(f64, f64) -> f64) -> f64 {
        let [w, h] = self.sides();
        factor(w, h) * self.value(rng)
    }
}

impl Surface {
    /// Its name for programs, and its name for people.
    fn names(self) -> [&'static str; 2] {
        match self {
            Self::One => ["one", "1"],
            Self::Squares => ["squares", "x² + y²"],
            Self::Product => ["product", "xy"],
            Self::Plane => ["plane", "x + 2y"],
        }
    }
}

static PROBLEMS: LazyLock<Vec<Integral>> = LazyLock::new(|| {
    use Surface::{One, Plane, Product, Squares};
    let sheet = Rectangle::WORKSHEET;
    // the area, perimeter and centre of the first hide no mistake; the second is far from square
    let others = [([0.3, 2.0], [-1.1, 3.0]), ([0.0, 1e-3], [0.0, 40.0])];
    let others = others.map(|(x, y)| Rectangle::new(x, y).unwrap_or(sheet));
    let on = |rectangle, surface| Integral { rectangle, surface };
    let [offset, sliver] = others;
    let problems = [(sheet, [One, Squares, Product].as_slice()), (offset, &[One, Squares, Product, Plane])];
    let mut all: Vec<_> = problems.iter().flat_map(|(on_, f)| f.iter().map(|f| on(*on_, *f))).collect();
    all.push(on(sliver, Plane));
    all
});

impl Problem for Integral {
    fn exercise() -> &'static Exercise {
        static EXERCISE: LazyLock<Exercise> = LazyLock::new(|| {
            Exercise::new(ABOUT, &[|p: &Integral, rng| p.rectangle.area() * p.value(rng)], mistakes())
        });
        &EXERCISE
    }

    fn all() -> &'static [Self] {
        &PROBLEMS
    }

    fn truth(&self) -> f64 {
        let [x, y] = self.ends().map(|[from, to]| from.midpoint(to));
        let square = |[from, to]: [f64; 2]| (from * from + from * to + to * to) / 3.0;
        let [xx, yy] = self.ends().map(square);
        self.rectangle.area()
            * match self.surface {
                Surface::One => 1.0,
                Surface::Squares => xx + yy,
                Surface::Product => x * y,
                Surface::Plane => x + 2.0 * y,
            }
    }

    /// xy integrates to 0 about the origin: errors are relative to ∫∫ |f| there.
    fn scale(&self) -> f64 {
        let truth = self.truth().abs();
        if truth > 0.0 {
            return truth;
        }
        // 0 only if the range of x, or that of y, is symmetric about 0
        let absolute = |[from, to]: [f64; 2]| 0.5 * (to * to.abs() - from * from.abs());
        let [x, y] = self.ends().map(absolute);
        if self.surface == Surface::Product && x * y > 0.0 { x * y } else { self.rectangle.area() }
    }

    fn given(&self) -> Vec<(&'static str, Given)> {
        let [[a, b], [c, d]] = self.ends();
        let ends = [("a", a), ("b", b), ("c", c), ("d", d)].map(|(name, end)| (name, Given::Number(end)));
        let [f, _] = self.surface.names();
        ends.into_iter().chain([("f", Given::Word(f))]).collect()
    }

    fn factors(&self) -> Vec<(&'static str, f64)> {
        let [w, h] = self.sides();
        vec![("the area", w * h), ("the width", w), ("the height", h)]
    }
}

impl fmt::Display for Integral {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [[a, b], [c, d]] = self.ends();
        let [_, surface] = self.surface.names();
        write!(f, "f = {surface} on [{a}, {b}]×[{c}, {d}]")
    }
}

const ABOUT: About = About {
    id: "integral",
    name: "integral over a rectangle",
    questions: &[("2.1", 0)],
    draw: "A draw is one of an estimate of the integral of f(x, y) over [a, b] × [c, d], made of one point \
           of it:\none: f = 1; squares: f = x² + y²; product: f = xy; plane: f = x + 2y.",
};

#[rustfmt::skip] // a list to be read
fn mistakes() -> &'static [Listed<Integral>] { &[
    (["2.1", "no-area", "no division by p", "f(X, Y)", DIVIDE], |p, rng| p.value(rng)),
    (["2.1", "times-p", "multiplied by p", "f(X, Y)/A", DIVIDE], |p, rng| p.times(rng, |w, h| 1.0 / (w * h))),
    (["2.1", "area-squared", "divided by p twice", "A² f(X, Y)", DIVIDE],
        |p, rng| p.times(rng, |w, h| (w * h).powi(2))),
    (["2.1", "width-only", "divided by p(x) alone", "(b − a) f(X, Y)", BOTH],
        |p, rng| p.times(rng, |w, _| w)),
    (["2.1", "height-only", "divided by p(y) alone", "(d − c) f(X, Y)", BOTH],
        |p, rng| p.times(rng, |_, h| h)),
    (["2.1", "p-added", "densities added", "f(X, Y)/(p(X) + p(Y))", BOTH],
        |p, rng| p.times(rng, |w, h| w * h / (w + h))),
    (["2.1", "width-squared", "width squared for the area", "(b − a)² f(X, Y)", AREA],
        |p, rng| p.times(rng, |w, _| w * w)),
    (["2.1", "height-squared", "height squared for the area", "(d − c)² f(X, Y)", AREA],
        |p, rng| p.times(rng, |_, h| h * h)),
    (["2.1", "sides-added", "width + height for the area", "(w + h) f(X, Y)", AREA],
        |p, rng| p.times(rng, |w, h| w + h)),
    (["2.1", "perimeter", "the perimeter for the area", "2(w + h) f(X, Y)", AREA],
        |p, rng| p.times(rng, |w, h| 2.0 * (w + h))),
    (["2.1", "root-area", "the root of the area", "√A f(X, Y)", AREA],
        |p, rng| p.times(rng, |w, h| (w * h).sqrt())),
    (["2.1", "diagonal", "the diagonal for the area", "√(w² + h²) f(X, Y)", AREA],
        |p, rng| p.times(rng, f64::hypot)),
    (["2.1", "half", "a triangle's area, or divided by the 2n values", "A/(2n) Σ f", "divide by the n pairs"],
        |p, rng| p.times(rng, |w, h| 0.5 * w * h)),
    (["2.1", "half-widths", "half widths", "w/2 · h/2 · f(X, Y)", "the width is b − a, all of it"],
        |p, rng| p.times(rng, |w, h| 0.25 * w * h)),
    (["2.1", "sixteen", "the sheet's 16 for every area", "16 f(X, Y)", SHEET], |p, rng| 16.0 * p.value(rng)),
    (["2.1", "sheet-only", "16 and ±2 are fixed", "16 f(4U − 2, 4V − 2)", SHEET],
        |p, rng| 16.0 * p.f(4.0 * rng.uniform() - 2.0, 4.0 * rng.uniform() - 2.0)),
    (["2.1", "sheet-points", "the sheet's interval for every rectangle", "X = 4U − 2, Y = 4V − 2", PLACE],
        |p, rng| p.at(rng, |u, v| [4.0 * u - 2.0, 4.0 * v - 2.0])),
    (["2.1", "same-u", "the same U for x and y", "f(a + wU, c + hU)", OWN],
        |p, rng| p.at(rng, |u, _| p.point(u, u))),
    (["2.1", "one-minus-u", "1 − U for y", "f(a + wU, c + h(1 − U))", OWN],
        |p, rng| p.at(rng, |u, _| p.point(u, 1.0 - u))),
    (["2.1", "x-for-y", "X used for Y as well", "f(X, X)", OWN], |p, rng| p.at(rng, |u, v| {
        let [x, _] = p.point(u, v);
        [x, x]
    })),
    (["2.1", "y-from-x", "Y drawn from X's interval", "Y = a + (b − a)V", PLACE], |p, rng| p.at(rng, |u, v| {
        let ([x, _], [y, _]) = (p.point(u, u), p.point(v, v));
        [x, y]
    })),
    (["2.1", "exchanged", "x and y exchanged", "f(Y, X)", "the first argument is x, drawn from [a, b]"],
        |p, rng| p.at(rng, |u, v| {
            let [x, y] = p.point(u, v);
            [y, x]
        })),
    (["2.1", "end-for-width", "the end for the width", "X = a + bU, Y = c + dV", PLACE],
        |p, rng| p.at(rng, |u, v| {
            let [[a, b], [c, d]] = p.ends();
            [a + b * u, c + d * v]
        })),
    (["2.1", "no-offset", "the lower end forgotten", "X = (b − a)U, Y = (d − c)V", PLACE],
        |p, rng| p.at(rng, |u, v| {
            let [w, h] = p.sides();
            [w * u, h * v]
        })),
    (["2.1", "centred", "centred on the origin", "X = w(U − ½), Y = h(V − ½)", PLACE],
        |p, rng| p.at(rng, |u, v| {
            let [w, h] = p.sides();
            [w * (u - 0.5), h * (v - 0.5)]
        })),
    (["2.1", "unit", "U left as it is", "f(U, V)", PLACE], |p, rng| p.at(rng, |u, v| [u, v])),
    (["2.1", "y-centre", "y kept at the centre", "f(X, (c + d)/2)", OWN],
        |p, rng| p.at(rng, |u, _| p.point(u, 0.5))),
    (["2.1", "whole", "U rounded to 0 or 1", "f at a corner", PLACE],
        |p, rng| p.at(rng, |u, v| p.point(u.round(), v.round()))),
    (["2.1", "disc", "points of a disc lifted to the square", "r = U, φ = 2πV", PLACE],
        |p, rng| p.at(rng, |u, v| {
            let (sin, cos) = (std::f64::consts::TAU * v).sin_cos();
            p.point(0.5 + 0.5 * u * cos, 0.5 + 0.5 * u * sin)
        })),
    (["2.1", "positive", "negative values cut off", "A max(f(X, Y), 0)", SIGN],
        |p, rng| p.rectangle.area() * p.value(rng).max(0.0)),
    (["2.1", "absolute", "the absolute value of f", "A |f(X, Y)|", SIGN],
        |p, rng| p.rectangle.area() * p.value(rng).abs()),
    (["2.1", "squared", "f squared", "A f(X, Y)²", "f² is for the variance; the mean takes f"],
        |p, rng| p.rectangle.area() * p.value(rng).powi(2)),
] }

const DIVIDE: &str = "divide by p(x, y) = 1/area: multiply by the area";
const BOTH: &str = "p(x, y) = p(x) p(y) = 1/width · 1/height";
const AREA: &str = "the area is width · height";
const OWN: &str = "X needs a random number of its own, and so does Y";
const PLACE: &str = "X = a + (b − a)U, Y = c + (d − c)V";
const SIGN: &str = "leave the sign of f: negative values count";
const SHEET: &str = "right on the sheet's square; take the area and the ends from the rectangle given";
