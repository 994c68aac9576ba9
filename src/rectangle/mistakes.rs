//! Mistakes in integrating over a rectangle.

use std::fmt;
use std::sync::LazyLock;

use super::Rectangle;
use crate::check::{About, Exercise, Given, Mistake, Problem, Words};
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
            let right = |p: &Integral, rng: &mut Stream| {
                let [x, y] = p.point(rng.uniform(), rng.uniform());
                p.rectangle.area() * p.f(x, y)
            };
            Exercise::new(ABOUT, &[right], mistakes())
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
        let ends = [("a", a), ("b", b), ("c", c), ("d", d)];
        let f = match self.surface {
            Surface::One => "one",
            Surface::Squares => "squares",
            Surface::Product => "product",
            Surface::Plane => "plane",
        };
        let ends = ends.map(|(name, end)| (name, Given::Number(end)));
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
        let surface = match self.surface {
            Surface::One => "1",
            Surface::Squares => "x² + y²",
            Surface::Product => "xy",
            Surface::Plane => "x + 2y",
        };
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

type Text = &'static str;

const fn words(id: Text, name: Text, formula: Text, mend: Text) -> Words {
    Words { id, question: "2.1", name, formula, mend }
}

/// The right points, but another factor than the area, as a function of width and height.
fn factor(words: Words, factor: fn(f64, f64) -> f64) -> Mistake {
    Mistake::new(words, move |p: &Integral, rng| {
        let ([x, y], [w, h]) = (p.point(rng.uniform(), rng.uniform()), p.sides());
        factor(w, h) * p.f(x, y)
    })
}

/// The right factor, but other points, as functions of the problem and two uniform numbers.
fn points(words: Words, at: fn(&Integral, f64, f64) -> [f64; 2]) -> Mistake {
    Mistake::new(words, move |p: &Integral, rng| {
        let [x, y] = at(p, rng.uniform(), rng.uniform());
        p.rectangle.area() * p.f(x, y)
    })
}

/// The right factor and points, but another value than f's.
fn value(words: Words, of: fn(f64) -> f64) -> Mistake {
    Mistake::new(words, move |p: &Integral, rng| {
        let [x, y] = p.point(rng.uniform(), rng.uniform());
        p.rectangle.area() * of(p.f(x, y))
    })
}

#[rustfmt::skip] // a list to be read
fn mistakes() -> Vec<Mistake> {
    let divide = "divide by p(x, y) = 1/area: multiply by the area";
    let both = "p(x, y) = p(x) p(y) = 1/width · 1/height";
    let area = "the area is width · height";
    let own = "X needs a random number of its own, and so does Y";
    let place = "X = a + (b − a)U, Y = c + (d − c)V";
    let sign = "leave the sign of f: negative values count";
    let sheet = "right on the sheet's square; take the area and the ends from the rectangle given";
    vec![
        factor(words("no-area", "no division by p", "f(X, Y)", divide), |_, _| 1.0),
        factor(words("times-p", "multiplied by p", "f(X, Y)/A", divide), |w, h| 1.0 / (w * h)),
        factor(words("area-squared", "divided by p twice", "A² f(X, Y)", divide), |w, h| (w * h).powi(2)),
        factor(words("width-only", "divided by p(x) alone", "(b − a) f(X, Y)", both), |w, _| w),
        factor(words("height-only", "divided by p(y) alone", "(d − c) f(X, Y)", both), |_, h| h),
        factor(words("p-added", "densities added", "f(X, Y)/(p(X) + p(Y))", both), |w, h| w * h / (w + h)),
        factor(words("width-squared", "width squared for the area", "(b − a)² f(X, Y)", area), |w, _| w * w),
        factor(words("height-squared", "height squared for the area", "(d − c)² f(X, Y)", area),
            |_, h| h * h),
        factor(words("sides-added", "width + height for the area", "(w + h) f(X, Y)", area), |w, h| w + h),
        factor(words("perimeter", "the perimeter for the area", "2(w + h) f(X, Y)", area),
            |w, h| 2.0 * (w + h)),
        factor(words("root-area", "the root of the area", "√A f(X, Y)", area), |w, h| (w * h).sqrt()),
        factor(words("diagonal", "the diagonal for the area", "√(w² + h²) f(X, Y)", area), f64::hypot),
        factor(words("half", "a triangle's area, or divided by the 2n values", "A/(2n) Σ f",
            "divide by the n pairs"), |w, h| 0.5 * w * h),
        factor(words("half-widths", "half widths", "w/2 · h/2 · f(X, Y)", "the width is b − a, all of it"),
            |w, h| 0.25 * w * h),
        factor(words("sixteen", "the sheet's 16 for every area", "16 f(X, Y)", sheet), |_, _| 16.0),
        Mistake::new(
            words("sheet-only", "16 and ±2 are fixed", "16 f(4U − 2, 4V − 2)", sheet),
            |p: &Integral, rng| 16.0 * p.f(4.0 * rng.uniform() - 2.0, 4.0 * rng.uniform() - 2.0),
        ),
        points(words("sheet-points", "the sheet's interval for every rectangle", "X = 4U − 2, Y = 4V − 2",
            place), |_, u, v| [4.0 * u - 2.0, 4.0 * v - 2.0]),
        points(words("same-u", "the same U for x and y", "f(a + wU, c + hU)", own), |p, u, _| p.point(u, u)),
        points(words("one-minus-u", "1 − U for y", "f(a + wU, c + h(1 − U))", own),
            |p, u, _| p.point(u, 1.0 - u)),
        points(words("x-for-y", "X used for Y as well", "f(X, X)", own), |p, u, _| {
            let [x, _] = p.point(u, u);
            [x, x]
        }),
        points(words("y-from-x", "Y drawn from X's interval", "Y = a + (b − a)V", place), |p, u, v| {
            let ([x, _], [y, _]) = (p.point(u, u), p.point(v, v));
            [x, y]
        }),
        points(
            words("exchanged", "x and y exchanged", "f(Y, X)", "the first argument is x, drawn from [a, b]"),
            |p, u, v| {
                let [x, y] = p.point(u, v);
                [y, x]
            },
        ),
        points(
            words("end-for-width", "the end for the width", "X = a + bU, Y = c + dV", place),
            |p, u, v| {
                let [[a, b], [c, d]] = p.ends();
                [a + b * u, c + d * v]
            },
        ),
        points(
            words("no-offset", "the lower end forgotten", "X = (b − a)U, Y = (d − c)V", place),
            |p, u, v| {
                let [w, h] = p.sides();
                [w * u, h * v]
            },
        ),
        points(
            words("centred", "centred on the origin", "X = w(U − ½), Y = h(V − ½)", place),
            |p, u, v| {
                let [w, h] = p.sides();
                [w * (u - 0.5), h * (v - 0.5)]
            },
        ),
        points(words("unit", "U left as it is", "f(U, V)", place), |_, u, v| [u, v]),
        points(words("y-centre", "y kept at the centre", "f(X, (c + d)/2)", own), |p, u, _| p.point(u, 0.5)),
        points(words("whole", "U rounded to 0 or 1", "f at a corner", place),
            |p, u, v| p.point(u.round(), v.round())),
        points(
            words("disc", "points of a disc lifted to the square", "r = U, φ = 2πV", place),
            |p, u, v| {
                let (sin, cos) = (std::f64::consts::TAU * v).sin_cos();
                p.point(0.5 + 0.5 * u * cos, 0.5 + 0.5 * u * sin)
            },
        ),
        value(words("positive", "negative values cut off", "A max(f(X, Y), 0)", sign), |f| f.max(0.0)),
        value(words("absolute", "the absolute value of f", "A |f(X, Y)|", sign), f64::abs),
        value(
            words("squared", "f squared", "A f(X, Y)²", "f² is for the variance; the mean takes f"),
            |f| f * f,
        ),
    ]
}
