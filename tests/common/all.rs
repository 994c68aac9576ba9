//! One table of all samplers and estimators of the crate, with the closed forms that hold for each.
//!
//! [`all`] gives it with the sheet's parameters and the extreme ones, or with parameters that are drawn.

use std::f64::consts::{LN_2, PI, TAU};

use rand::distr::Distribution;
use statrs::distribution::{Beta, Binomial, ContinuousCDF, DiscreteCDF, Gamma, Normal, Poisson, Weibull};
use unbiased::inversion::{Exponential, Inversion};
use unbiased::lambertian::hemisphere::{Direction, Hemisphere};
use unbiased::lambertian::{CosinePower, Lambertian, Light, RingLight};
use unbiased::paths::room::{BoxRoom, Scene};
use unbiased::paths::{Bounces, FindLight, Paths, reflected};
use unbiased::placement::{jittered, sobol};
use unbiased::rectangle::{Integrand, Rectangle};
use unbiased::roulette::{LightModel, Roulette};
use unbiased::{Density, Estimator, Stream, f_over_p, from_fn, from_uniforms};

use crate::common::{self, NEARLY_ONE, furnace, howell_parallel, net_variance_of_xy};

/// An estimator, and what is known of its draws.
pub struct Row {
    pub name: String,
    pub estimator: Box<dyn Estimator>,
    /// NaN where no number of draws can tell it.
    pub mean: f64,
    pub variance: Option<f64>,
    /// Every draw lies in it; or all but one in 10²⁴, where a draw has no end.
    pub range: [f64; 2],
    pub cdf: Option<Box<dyn Fn(f64) -> f64 + Sync>>,
    /// Nanoseconds of a draw, roughly.
    pub cost: f64,
    /// Random numbers and evaluations of a draw, where every draw takes as many.
    pub takes: Option<[u64; 2]>,
    /// How many numbers it is a function of, where `check::exactly` can integrate it.
    pub smooth: Option<usize>,
    /// How far a filled draw may be from one that is drawn alone, relative to it.
    pub rounding: f64,
}

impl Row {
    fn variance(self, variance: f64) -> Self {
        Self { variance: Some(variance), ..self }
    }

    fn cdf(self, cdf: impl Fn(f64) -> f64 + Sync + 'static) -> Self {
        Self { cdf: Some(Box::new(cdf)), ..self }
    }

    fn takes(self, random_numbers: u64, evaluations: u64) -> Self {
        Self { takes: Some([random_numbers, evaluations]), ..self }
    }

    fn smooth(self, numbers: usize) -> Self {
        Self { smooth: Some(numbers), ..self }
    }

    /// How far a draw may lie from the mean.
    pub fn reach(&self) -> f64 {
        (self.mean - self.range[0]).max(self.range[1] - self.mean)
    }
}

/// Where the parameters come from: as given, or from a stream.
pub struct Pick(Option<Stream>);

impl Pick {
    fn is_given(&self) -> bool {
        self.0.is_none()
    }

    fn between(&mut self, given: f64, [low, high]: [f64; 2]) -> f64 {
        self.0.as_mut().map_or(given, |rng| low + (high - low) * rng.uniform())
    }

    /// Evenly in the logarithm.
    fn log(&mut self, given: f64, [low, high]: [f64; 2]) -> f64 {
        self.between(given.ln(), [low.ln(), high.ln()]).exp()
    }

    /// Up to `high` itself.
    fn count(&mut self, given: u64, [low, high]: [u64; 2]) -> u64 {
        self.between(given as f64, [low as f64, (high + 1) as f64]).floor() as u64
    }

    fn one_of<T: Copy>(&mut self, given: T, all: &[T]) -> T {
        let last = all.len() as u64 - 1;
        if self.is_given() { given } else { all[self.count(0, [0, last]) as usize] }
    }

    fn rectangle(&mut self, given: Rectangle) -> Rectangle {
        let mut side = || {
            let low = self.between(0.0, [-5.0, 5.0]);
            [low, low + self.log(1.0, [1e-2, 1e2])]
        };
        let (x, y) = (side(), side());
        if self.is_given() { given } else { Rectangle::new(x, y).unwrap() }
    }
}

/// What is made of the draws of an estimator, also of those that are filled.
struct Through<E, F>(E, F);

impl<E: Estimator, F: Fn(f64) -> f64 + Sync> Estimator for Through<E, F> {
    fn draw(&self, rng: &mut Stream) -> f64 {
        (self.1)(self.0.draw(rng))
    }

    fn fill(&self, rng: &mut Stream, draws: &mut [f64]) {
        self.0.fill(rng, draws);
        draws.iter_mut().for_each(|draw| *draw = (self.1)(*draw));
    }
}

fn row(
    name: impl Into<String>,
    estimator: impl Estimator + 'static,
    mean: f64,
    range: [f64; 2],
    cost: f64,
) -> Row {
    Row {
        name: name.into(),
        estimator: Box::new(estimator),
        mean,
        variance: None,
        range,
        cdf: None,
        cost,
        takes: None,
        smooth: None,
        rounding: 0.0,
    }
}

/// Every estimator of the crate: as given for the variant 0, extremes among them, and with drawn parameters
/// for every other one.
pub fn all(variant: u64) -> Vec<Row> {
    let stream = (variant > 0).then(|| Stream::new(common::seed(7000 + variant), 0));
    let mut pick = Pick(stream);
    let mut all = from_numbers();
    all.extend(inversions(&mut pick));
    all.extend(over_rectangles(&mut pick));
    all.extend(of_surfaces(&mut pick));
    all.extend(of_paths(&mut pick));
    all.extend(of_roulette(&mut pick));
    if pick.is_given() {
        all.extend(extremes());
        all.extend(sheets_paths());
    }
    all
}

fn from_numbers() -> Vec<Row> {
    let sum = from_uniforms(|u: [f64; 5]| u.iter().sum());
    vec![
        row("no number", from_uniforms(|[]| 1.0), 1.0, [0.0, 2.0], 2.0).variance(0.0).takes(0, 1),
        row("five numbers", sum, 2.5, [0.0, 5.0], 10.0).variance(5.0 / 12.0).takes(5, 1),
    ]
}

// ---- section 1

/// −ln 2⁻⁵³, of the largest number below 1.
const LONGEST: f64 = 53.0 * LN_2;

/// Another library's law: its cdf, support, mean and variance.
type Law = (Box<dyn Fn(f64) -> f64 + Sync>, [f64; 2], f64, f64);

const POSITIVE: [f64; 2] = [0.0, f64::INFINITY];

fn law(which: usize, a: f64, b: f64) -> Law {
    let discrete = |cdf: Box<dyn Fn(u64) -> f64 + Sync>| {
        Box::new(move |x: f64| if x < 0.0 { 0.0 } else { cdf(x as u64) })
    };
    match which {
        0 => {
            let law = Normal::new(a - 2.0, b).unwrap();
            (Box::new(move |x| law.cdf(x)), [f64::NEG_INFINITY, f64::INFINITY], a - 2.0, b * b)
        }
        1 => {
            let law = Gamma::new(a, b).unwrap();
            (Box::new(move |x| law.cdf(x)), POSITIVE, a / b, a / b / b)
        }
        2 => {
            let (law, sum) = (Beta::new(a, b).unwrap(), a + b);
            (Box::new(move |x| law.cdf(x)), [0.0, 1.0], a / sum, a * b / (sum * sum * (sum + 1.0)))
        }
        3 => {
            let moment = |k: f64| statrs::function::gamma::gamma(1.0 + k / a);
            let (law, first) = (Weibull::new(a, b).unwrap(), moment(1.0));
            (Box::new(move |x| law.cdf(x)), POSITIVE, b * first, b * b * (moment(2.0) - first * first))
        }
        4 => {
            let law = Poisson::new(a).unwrap();
            (discrete(Box::new(move |k| law.cdf(k))), POSITIVE, a, a)
        }
        _ => {
            let (p, n) = (b / 3.0, (5.0 * a).floor());
            let law = Binomial::new(p, n as u64).unwrap();
            (discrete(Box::new(move |k| law.cdf(k))), [0.0, n], n * p, n * p * (1.0 - p))
        }
    }
}

fn inversions(pick: &mut Pick) -> Vec<Row> {
    let rate = pick.log(0.37, [1e-3, 1e3]);
    let exponential = Exponential::new(rate).unwrap();
    let cdf = move |x: f64| if x < 0.0 { 0.0 } else { -(-rate * x).exp_m1() };
    let single = from_fn(move |rng| f64::from(Distribution::<f32>::sample(&exponential, rng)));
    let ratio = f_over_p(move |x: &f64| exponential.pdf(*x).powi(2), exponential);
    let variance = 1.0 / (rate * rate);
    let mut rows = vec![
        row(format!("exponential, λ = {rate}"), exponential, 1.0 / rate, [0.0, LONGEST / rate], 4.0)
            .variance(variance)
            .takes(1, 1)
            .cdf(cdf)
            .smooth(1),
        row(format!("exponential in f32, λ = {rate}"), single, 1.0 / rate, [0.0, 16.7 / rate], 8.0)
            .variance(variance)
            .takes(1, 0)
            .cdf(cdf),
        // p(X) is uniform up to λ
        row(format!("p²/p, λ = {rate}"), ratio, rate / 2.0, [0.0, rate], 15.0)
            .variance(rate * rate / 12.0)
            .takes(1, 1)
            .cdf(move |x| (x / rate).clamp(0.0, 1.0))
            .smooth(1),
    ];
    // Lomax: an infinite support with a scale, and for k = 1 not even a mean
    let (scale, k) = (pick.log(1.0, [1e-3, 1e3]), pick.count(1, [1, 3]) as i32);
    let lomax = move |x: f64| 1.0 - (1.0 + x / scale).powi(-k);
    let inversion = Inversion::new(lomax, POSITIVE).unwrap();
    let lomax = from_fn(move |rng| lomax(inversion.sample(rng)));
    rows.push(
        row(format!("F of Lomax's law {k}, {scale}"), lomax, 0.5, [0.0, 1.0], 600.0)
            .variance(1.0 / 12.0)
            .takes(1, 0)
            .cdf(|u| u.clamp(0.0, 1.0)),
    );
    for (which, name, cost) in [
        (0, "normal", 2500.0),
        (1, "Gamma", 12_000.0),
        (2, "Beta", 20_000.0),
        (3, "Weibull", 3000.0),
        (4, "Poisson", 5000.0),
        (5, "binomial", 8000.0),
    ] {
        let (a, b) = (pick.between(1.7, [1.0, 4.0]), pick.between(2.1, [0.5, 3.0]));
        let (cdf, support, mean, variance) = law(which, a, b);
        let inversion = Inversion::new(cdf, support).unwrap();
        // as far as the grid of uniform numbers goes
        let range = [0.5f64.powi(54), NEARLY_ONE].map(|u| inversion.inverse_cdf(u).unwrap());
        let range = [range[0].min(0.0), range[1]];
        let sampler = from_fn(move |rng| inversion.sample(rng));
        let known = row(format!("{name} {a}, {b} by inversion"), sampler, mean, range, cost)
            .variance(variance)
            .takes(1, 0)
            .cdf(law(which, a, b).0);
        rows.push(if which < 4 { known.smooth(1) } else { known });
    }
    rows
}

// ---- section 2

/// 1.7 × 4.1, away from the origin: neither its area nor its perimeter nor its centre hides a mistake.
pub fn offset() -> Rectangle {
    Rectangle::new([0.3, 2.0], [-1.1, 3.0]).unwrap()
}

/// A polynomial Σ c_ij sⁱ tʲ in s = (x − a)/(b − a) and t = (y − c)/(d − c), its coefficients 0 or more.
#[derive(Clone, Copy)]
struct Polynomial {
    rectangle: Rectangle,
    coefficients: [[f64; 3]; 3],
}

impl Polynomial {
    fn new(pick: &mut Pick) -> Self {
        let rectangle = pick.rectangle(offset());
        let mut coefficients = [[0.2, 0.0, 0.7], [0.5, 0.9, 0.0], [0.3, 0.1, 0.6]];
        coefficients.as_flattened_mut().iter_mut().for_each(|c| *c = pick.between(*c, [0.0, 1.0]));
        // so that it is not nearly 0 nearly everywhere
        coefficients[0][0] += 0.1;
        Self { rectangle, coefficients }
    }

    fn at(&self, x: f64, y: f64) -> f64 {
        let ([a, b], [c, d]) = (self.rectangle.x_range(), self.rectangle.y_range());
        let (s, t) = ((x - a) / (b - a), (y - c) / (d - c));
        let [low, middle, high] = self.coefficients.map(|row| (row[2] * t + row[1]) * t + row[0]);
        (high * s + middle) * s + low
    }

    /// sⁱ tʲ has the mean 1/((i + 1)(j + 1)).
    fn mean(&self) -> f64 {
        let terms = self.terms().map(|(i, j, c)| c / ((i + 1) * (j + 1)) as f64);
        self.rectangle.area() * terms.sum::<f64>()
    }

    fn variance(&self) -> f64 {
        let product = |(i, j, c): (usize, usize, f64)| {
            self.terms().map(move |(k, l, d)| c * d / ((i + k + 1) * (j + l + 1)) as f64).sum::<f64>()
        };
        self.rectangle.area().powi(2) * self.terms().map(product).sum::<f64>() - self.mean().powi(2)
    }

    fn terms(&self) -> impl Iterator<Item = (usize, usize, f64)> {
        self.coefficients
            .into_iter()
            .enumerate()
            .flat_map(|(i, row)| row.into_iter().enumerate().map(move |(j, coefficient)| (i, j, coefficient)))
    }

    fn range(&self) -> [f64; 2] {
        [0.0, self.rectangle.area() * self.coefficients.as_flattened().iter().sum::<f64>() * (1.0 + 1e-12)]
    }
}

/// An integrand's mean, variance and the range of A f.
fn known(f: Integrand, r: &Rectangle) -> (f64, Option<f64>, [f64; 2]) {
    let ends = |[a, b]: [f64; 2]| {
        let nearest = if a <= 0.0 && b >= 0.0 { 0.0 } else { a.abs().min(b.abs()) };
        (nearest, a.abs().max(b.abs()))
    };
    let ((near_x, far_x), (near_y, far_y)) = (ends(r.x_range()), ends(r.y_range()));
    let most = match f {
        Integrand::Constant => 2.0,
        Integrand::Paraboloid => far_x * far_x + far_y * far_y,
        Integrand::Product => far_x * far_y,
        Integrand::Disc | Integrand::Gaussian => 1.0,
        Integrand::InverseDistance => 1.0 / near_x.hypot(near_y),
    };
    let low = if f == Integrand::Product { -most } else { 0.0 };
    (f.integral(r).unwrap(), f.variance(r), [low, most].map(|y| r.area() * y * (1.0 + 1e-12)))
}

/// Jittered xy: within a cell of w_c × h_c about (x̄, ȳ), Var XY = x̄² h_c²/12 + ȳ² w_c²/12 + w_c² h_c²/144,
/// and Σ x̄² over the columns is s (x̄² + (w² − w_c²)/12).
fn jittered_variance_of_xy(r: &Rectangle, side: u64) -> f64 {
    let ([a, b], [c, d], s) = (r.x_range(), r.y_range(), side as f64);
    let ([w, h], [wc, hc]) = ([b - a, d - c], [(b - a) / s, (d - c) / s]);
    let x2 = (0.5 * (a + b)).powi(2) + (w * w - wc * wc) / 12.0;
    let y2 = (0.5 * (c + d)).powi(2) + (h * h - hc * hc) / 12.0;
    let of_cells = x2 * hc * hc / 12.0 + y2 * wc * wc / 12.0 + wc * wc * hc * hc / 144.0;
    r.area().powi(2) * of_cells / (s * s)
}

/// xy about (x̄, ȳ) is x̄ȳ + x̄ h V + ȳ w U + w h UV with uncorrelated parts; x alone falls into 2ᵐ cells
/// with one uniform point in each, 1/(12n³).
fn sobol_variance_of_xy(r: &Rectangle, m: u32) -> f64 {
    let ([a, b], [c, d]) = (r.x_range(), r.y_range());
    let ([w, h], [x, y]) = ([b - a, d - c], [0.5 * (a + b), 0.5 * (c + d)]);
    let linear = ((x * h).powi(2) + (y * w).powi(2)) / 12.0 / 8f64.powi(m as i32);
    r.area().powi(2) * (linear + (w * h).powi(2) * net_variance_of_xy(m))
}

/// A sum of a function of x and one of y, for which each axis alone decides: with n = 2ᵐ points Σ over the
/// cells of 1/n² Var, Var X² = x̄² l²/3 + l⁴/180 in each, and Σ x̄² as for jittered cells.
fn sobol_variance_of_squares(r: &Rectangle, m: u32) -> f64 {
    let n = f64::from(1u32 << m);
    let cells = |[a, b]: [f64; 2]| {
        let (middle, length) = (0.5 * (a + b), b - a);
        let cell = length / n;
        (middle.powi(2) + (length * length - cell * cell) / 12.0) * cell * cell / 3.0 + cell.powi(4) / 180.0
    };
    r.area().powi(2) * (cells(r.x_range()) + cells(r.y_range())) / n
}

fn over_rectangles(pick: &mut Pick) -> Vec<Row> {
    let mut rows = Vec::new();
    let sheet = Rectangle::WORKSHEET;
    for (f, given) in [
        (Integrand::Paraboloid, sheet),
        (Integrand::Disc, sheet),
        (Integrand::Gaussian, sheet),
        (Integrand::Gaussian, offset()),
        (Integrand::Product, offset()),
        (Integrand::InverseDistance, offset()),
    ] {
        let r = pick.rectangle(given);
        // where no closed form holds, the rectangle stays as given
        let known_there = f.variance(&r).is_some_and(|variance| variance > 0.0 && variance < 1e9);
        let r = if known_there && f != Integrand::InverseDistance { r } else { given };
        let (mean, variance, range) = known(f, &r);
        let name = |way: &str| format!("{way} of {f} on {:?} × {:?}", r.x_range(), r.y_range());
        let at = move |x: f64, y: f64| f.at(x, y);
        for mut one in [
            row(name("independent"), r.independent(at), mean, range, 12.0),
            row(name("f/p"), f_over_p(move |&[x, y]: &[f64; 2]| f.at(x, y), r), mean, range, 12.0),
        ] {
            one.variance = variance;
            one.smooth = (!matches!(f, Integrand::Disc | Integrand::InverseDistance)).then_some(2);
            rows.push(one.takes(2, 1));
        }
        if f == Integrand::InverseDistance {
            continue;
        }
        let n = pick.count(9, [1, 12]);
        let mut pairs = row(
            name(&format!("{n}² pairs")),
            r.all_pairs(at, n).unwrap(),
            mean,
            range,
            30.0 + 5.0 * (n * n) as f64,
        );
        pairs.variance = f.all_pairs_variance(&r, n);
        rows.push(pairs.takes(2 * n, n * n));
        let points = pick.count(100, [1, 200]);
        rows.push(
            row(
                name(&format!("{points} Sobol points")),
                r.sobol(at, points).unwrap(),
                mean,
                range,
                1000.0 + 40.0 * points as f64,
            )
            .takes(2 * points + 1, points),
        );
    }
    let r = pick.rectangle(offset());
    let (mean, _, range) = known(Integrand::Product, &r);
    let side = pick.count(3, [1, 12]);
    rows.push(
        row(
            format!("{side}² cells of xy"),
            r.jittered(|x, y| x * y, side).unwrap(),
            mean,
            range,
            500.0 + 20.0 * (side * side) as f64,
        )
        .variance(jittered_variance_of_xy(&r, side))
        .takes(2 * side * side + 1, side * side),
    );
    for m in [0, 4, pick.count(7, [1, 8]) as u32] {
        let n = 1u64 << m;
        let cost = 1000.0 + 40.0 * n as f64;
        rows.push(
            row(format!("{n} Sobol points of xy"), r.sobol(|x, y| x * y, n).unwrap(), mean, range, cost)
                .variance(sobol_variance_of_xy(&r, m))
                .takes(2 * n + 1, n),
        );
        let (mean, _, range) = known(Integrand::Paraboloid, &r);
        let squares = r.sobol(|x, y| x * x + y * y, n).unwrap();
        rows.push(
            row(format!("{n} Sobol points of x² + y²"), squares, mean, range, cost)
                .variance(sobol_variance_of_squares(&r, m))
                .takes(2 * n + 1, n),
        );
    }
    let f = Polynomial::new(pick);
    let at = move |x: f64, y: f64| f.at(x, y);
    let (mean, range) = (f.mean(), f.range());
    let (n, side, points) = (pick.count(3, [1, 5]), pick.count(4, [1, 4]), pick.count(11, [1, 19]));
    rows.extend([
        row("polynomial, independent", f.rectangle.independent(at), mean, range, 12.0)
            .variance(f.variance())
            .takes(2, 1)
            .smooth(2),
        row("polynomial, all pairs", f.rectangle.all_pairs(at, n).unwrap(), mean, range, 150.0),
        row("polynomial, jittered", f.rectangle.jittered(at, side).unwrap(), mean, range, 700.0),
        row("polynomial, Sobol", f.rectangle.sobol(at, points).unwrap(), mean, range, 1200.0),
    ]);
    // x of a point, and what the points of a set come to
    let [a, b] = r.x_range();
    rows.push(
        row("x of a point", from_fn(move |rng| r.sample(rng)[0]), 0.5 * (a + b), [a, b], 6.0)
            .variance((b - a).powi(2) / 12.0)
            .takes(2, 0)
            .cdf(move |x| ((x - a) / (b - a)).clamp(0.0, 1.0)),
    );
    let [c, d] = r.y_range();
    rows.push(
        row("y of a point", from_fn(move |rng| r.sample(rng)[1]), 0.5 * (c + d), [c, d], 6.0)
            .variance((d - c).powi(2) / 12.0)
            .takes(2, 0)
            .cdf(move |y| ((y - c) / (d - c)).clamp(0.0, 1.0)),
    );
    rows
}

// ---- section 3

/// A sky that depends on the direction in every way: c₀ + c₁ cos θ + c₂ cos² θ + c₃ x² + c₄ (1 + y) + c₅
/// \[the half towards φ is lit\].
#[derive(Clone, Copy)]
struct Sky {
    parts: [f64; 6],
    phi: f64,
}

impl Sky {
    fn new(pick: &mut Pick) -> Self {
        let parts = [0.3, 0.8, 0.2, 0.5, 0.4, 1.0].map(|part| pick.between(part, [0.2, 1.0]));
        Self { parts, phi: pick.between(1.0, [0.0, TAU]) }
    }

    fn at(&self, direction: &Direction) -> f64 {
        let [c0, c1, c2, c3, c4, c5] = self.parts;
        let [x, y, z] = direction.vector().to_array();
        let lit = x * self.phi.cos() + y * self.phi.sin() > 0.0;
        c0 + c1 * z + c2 * z * z + c3 * x * x + c4 * (1.0 + y) + if lit { c5 } else { 0.0 }
    }

    /// ∫ L cos θ/π dω = ∫ L̄ 2z dz with L̄ the mean over φ: z gives 2/3, z² 1/2, x² 1/4, y 0, a half 1/2.
    fn mean(&self) -> f64 {
        let [c0, c1, c2, c3, c4, c5] = self.parts;
        c0 + c1 * 2.0 / 3.0 + c2 / 2.0 + c3 / 4.0 + c4 + c5 / 2.0
    }

    fn most(&self) -> f64 {
        self.parts.iter().sum::<f64>() + self.parts[4]
    }
}

/// All directions alike, those below the horizon too: p = 1/(4π).
#[derive(Clone, Copy)]
struct Sphere;

impl Density<2> for Sphere {
    type Point = Direction;

    fn warp(&self, [u, v]: [f64; 2]) -> Direction {
        Direction::polar(1.0 - 2.0 * u, TAU * v).unwrap()
    }

    fn pdf(&self, _: &Direction) -> f64 {
        0.25 / PI
    }
}

/// The largest cos θ/(π p(ω)).
fn most_weight(directions: Hemisphere) -> f64 {
    if directions == Hemisphere::Cosine { 1.0 } else { 2.0 }
}

/// The simple and the general estimator for these directions.
fn both(
    surface: Lambertian,
    directions: Hemisphere,
    light: impl Fn(&Direction) -> f64 + Sync + Copy + 'static,
) -> [(&'static str, Box<dyn Estimator>); 2] {
    let simple: Box<dyn Estimator> = match directions {
        Hemisphere::Uniform => Box::new(surface.uniform_estimator(light)),
        Hemisphere::Cosine => Box::new(surface.cosine_estimator(light)),
    };
    [("simple", simple), ("f/p", Box::new(surface.estimator(light, directions)))]
}

fn of_surfaces(pick: &mut Pick) -> Vec<Row> {
    let mut rows = Vec::new();
    for directions in Hemisphere::ALL {
        let uniform = directions == Hemisphere::Uniform;
        let weight = most_weight(directions);
        let albedo = pick.between(0.61, [0.05, 1.0]);
        let surface = Lambertian::new(albedo).unwrap();
        // brighter overhead, and below 0 along the horizon, as far as fourth moments go
        let darker =
            pick.between(if uniform { -0.3 } else { -0.1 }, if uniform { [-1.0, 0.0] } else { [-0.1, 0.0] });
        for a in [darker, pick.between(2.5, [0.0, 6.0])] {
            let power = CosinePower::new(a).unwrap();
            // a draw is k cos^b θ, whose cdf is a power of it
            let (k, b) = if uniform { (2.0 * albedo, a + 1.0) } else { (albedo, a) };
            let root = if uniform { 1.0 } else { 2.0 } / b;
            let most = if b >= 0.0 { k } else { k * 1.05e-8f64.powf(b) };
            let variance = power.variance(surface, directions);
            let incoming = move |w: &Direction| power.incoming(w);
            for (way, estimator) in both(surface, directions, incoming) {
                let name = format!("cos^{a} θ, {way}, {directions:?}, ρ = {albedo}");
                let mut one =
                    row(name, estimator, power.reflected(surface), [0.0, most * (1.0 + 1e-12)], 45.0)
                        .variance(variance)
                        .takes(2, 1)
                        .cdf(move |x| {
                            let lower = (x / k).max(0.0).powf(root).clamp(0.0, 1.0);
                            if b > 0.0 { lower } else { 1.0 - lower }
                        });
                one.smooth = (a > 0.0).then_some(2);
                rows.push(one);
            }
        }
        let ring = RingLight::new(pick.between(0.37, [0.2, 1.0])).unwrap();
        for (way, estimator) in both(surface, directions, move |w| ring.incoming(w)) {
            let name = format!("ring {}, {way}, {directions:?}, ρ = {albedo}", ring.width());
            let most = albedo * if uniform { 2.0 * ring.width() } else { 1.0 };
            rows.push(
                row(name, estimator, ring.reflected(surface), [0.0, most * (1.0 + 1e-12)], 15.0)
                    .variance(ring.variance(surface, directions))
                    .takes(2, 1),
            );
        }
        let sky = Sky::new(pick);
        let range = [0.0, weight * albedo * sky.most()];
        for (way, estimator) in both(surface, directions, move |w| sky.at(w)) {
            let name = format!("a sky, {way}, {directions:?}");
            rows.push(row(name, estimator, albedo * sky.mean(), range, 25.0).takes(2, 1));
        }
        let (mean, variance) = if uniform { (0.5, 1.0 / 12.0) } else { (2.0 / 3.0, 1.0 / 18.0) };
        rows.push(
            row(
                format!("cos θ of {directions:?}"),
                from_fn(move |rng| directions.sample(rng).cos_theta()),
                mean,
                [0.0, 1.0],
                15.0,
            )
            .variance(variance)
            .takes(2, 0)
            .cdf(move |c| if uniform { c } else { c * c }),
        );
        rows.push(
            row(
                format!("φ of {directions:?}, in turns"),
                from_fn(move |rng| directions.sample(rng).phi() / TAU),
                0.5,
                [0.0, 1.0],
                30.0,
            )
            .variance(1.0 / 12.0)
            .takes(2, 0)
            .cdf(|v| v),
        );
    }
    let (sky, albedo) = (Sky::new(pick), pick.between(0.61, [0.05, 1.0]));
    let sphere = Lambertian::new(albedo).unwrap().estimator(move |w: &Direction| sky.at(w), Sphere);
    let range = [0.0, 4.0 * albedo * sky.most()];
    rows.push(row("a sky, the whole sphere", sphere, albedo * sky.mean(), range, 25.0).takes(2, 1));
    rows
}

// ---- section 4

fn paths(scene: Scene, bounces: Bounces, directions: Hemisphere, light: FindLight) -> Paths {
    Paths::new(BoxRoom::new(scene).unwrap(), bounces, directions, light).unwrap()
}

/// Paths, in both precisions; in `f32` the same ones but for 1e-5.
fn in_both(name: String, paths: Paths, mean: f64, most: f64, cost: f64) -> [Row; 2] {
    let range = [0.0, most * (1.0 + 1e-5)];
    let double = row(name.clone(), paths, mean, range, cost);
    [
        // other roundings, which every further bounce makes more of
        Row { rounding: 1e-11, ..double },
        row(format!("{name}, in f32"), paths.in_f32().unwrap(), mean, range, 0.7 * cost),
    ]
}

/// The part of the sky that the light fills above a point of the cube's top: four rectangles that have a
/// corner above it.
fn seen_from_the_top([x, y]: [f64; 2], h: f64) -> f64 {
    let corner = |a: f64, b: f64| howell_parallel(a, b, 3.0);
    corner(h - x, h - y) + corner(h + x, h - y) + corner(h - x, h + y) + corner(h + x, h + y)
}

fn of_paths(pick: &mut Pick) -> Vec<Row> {
    let mut rows = Vec::new();
    for directions in Hemisphere::ALL {
        let weight = most_weight(directions);
        for light in FindLight::ALL {
            let by_chance = light == FindLight::ByChance;
            let scene = Scene {
                wall_albedo: pick.between(0.5, [0.05, 1.0]),
                cube_albedo: pick.between(0.8, [0.05, 1.0]),
                radiance: pick.log(10.0, [1e-2, 1e2]),
                ..Scene::default()
            };
            // one bounce from anywhere on the cube's top, to a light that is found often enough
            let [x, y] = [0.0, 0.0].map(|given| pick.between(given, [-0.5, 0.5]));
            let h = pick.between(if by_chance { 1.5 } else { 0.5 }, [0.8, 2.0]);
            let once = Scene { light_half_width: h, point: [x, y, 1.0], ..scene };
            let scale = scene.cube_albedo * scene.radiance;
            let mean = scale * seen_from_the_top([x, y], h);
            // f_r L_e A cos θ cos θ′/r² ≤ ρ L_e A/9π, 3 m below
            let most = scale * if by_chance { weight } else { 4.0 * h * h / (9.0 * PI) };
            let bounces = pick.one_of(Bounces::Exactly(1), &[Bounces::Exactly(1), Bounces::UpTo(1)]);
            let name = format!("{bounces:?}, {directions:?}, {light:?}");
            rows.extend(in_both(name, paths(once, bounces, directions, light), mean, most, 70.0));
            // two, by the quadrature of the closed form, which tests/box_room.rs holds to another's
            let h = if by_chance { pick.between(1.7, [1.4, 2.0]) } else { pick.between(0.5, [0.3, 1.3]) };
            let twice = Scene { light_half_width: h, point: [x, y, 1.0], ..scene };
            let scale = scale * scene.wall_albedo;
            let mean = BoxRoom::new(twice).unwrap().two_bounces().unwrap();
            // at a wall, a = 2 − h or more from the light, cos θ cos θ′/r² is az/(a² + z²)² at most, and that
            // at most 0.325/a²
            let sampled = scale * weight * 4.0 * h * h / PI * 0.325 / (2.0 - h).powi(2);
            let most = if by_chance { scale * weight * weight } else { sampled };
            let name = format!("Exactly(2), {directions:?}, {light:?}");
            let estimator = paths(twice, Bounces::Exactly(2), directions, light);
            rows.extend(in_both(name, estimator, mean, most, 150.0));
            if by_chance {
                continue;
            }
            let (room, once) = (*estimator.room(), paths(twice, Bounces::Exactly(1), directions, light));
            rows.push(row(
                format!("two bounces, the second known, {directions:?}"),
                reflected(room, directions, move |p_j, _| room.direct(p_j)),
                mean,
                [0.0, most],
                400.0,
            ));
            rows.push(row(
                format!("two bounces, the second estimated, {directions:?}"),
                reflected(room, directions, move |p_j, rng| once.light_from(p_j, rng)),
                mean,
                [0.0, most],
                200.0,
            ));
        }
        // every face emits 1 and reflects ρ: ρᵏ after k bounces
        let (albedo, k) = (pick.between(0.5, [0.05, 0.9]), pick.count(3, [0, 5]) as u32);
        let light = pick.one_of(FindLight::BySampling, &FindLight::ALL);
        let sum = |x: f64| (0..=k as i32).map(|j| x.powi(j)).sum();
        for (bounces, mean, most) in [
            (Bounces::Exactly(k), albedo.powi(k as i32), (albedo * weight).powi(k as i32)),
            (Bounces::UpTo(k), sum(albedo), sum(albedo * weight)),
        ] {
            let name = format!("furnace {albedo}, {bounces:?}, {directions:?}, {light:?}");
            let estimator = paths(furnace(albedo), bounces, directions, light);
            rows.extend(in_both(name, estimator, mean, most.max(1.01 * mean), 150.0));
        }
        // X ≤ Σ (wρ/q)ʲ = q/(q − wρ) for q > wρ
        let albedo = albedo.min(0.85 / weight);
        let q = albedo * weight + pick.between(0.5, [0.3, 0.9]) * (1.0 - albedo * weight);
        let estimator = paths(furnace(albedo), Bounces::All(q), directions, light);
        let name = format!("furnace {albedo}, All({q}), {directions:?}, {light:?}");
        rows.extend(in_both(name, estimator, 1.0 / (1.0 - albedo), q / (q - albedo * weight), 300.0));
    }
    // with cosine directions a path goes on with probability ρ and weight 1: a draw is the number of vertices
    let albedo = pick.between(0.8, [0.05, 0.9]);
    for light in FindLight::ALL {
        let estimator = paths(furnace(albedo), Bounces::AllByThroughput, Hemisphere::Cosine, light);
        let most = 2.0 + 24.0 * 10f64.ln() / -albedo.ln();
        let name = format!("furnace {albedo}, AllByThroughput, {light:?}");
        let mean = 1.0 / (1.0 - albedo);
        let both = in_both(name, estimator, mean, most, 300.0);
        rows.extend(both.map(|one| one.variance(albedo * mean * mean)));
    }
    rows
}

/// All light in the sheet's own scene: up to three bounces by the sheet, to 15 from 3000 sets of 65,536
/// points to 9e-7, and all of it as known.
fn sheets_paths() -> Vec<Row> {
    let mut rows = Vec::new();
    let (scene, cosine) = (Scene::default(), Hemisphere::Cosine);
    let room = BoxRoom::new(scene).unwrap();
    let two = room.one_bounce() + room.two_bounces().unwrap();
    for (bounces, mean, cost) in [
        (Bounces::UpTo(2), two, 150.0),
        (Bounces::UpTo(3), 0.33502, 200.0),
        (Bounces::UpTo(15), 0.355_326_94, 700.0),
        (Bounces::All(0.7), 0.355_331_1, 250.0),
        (Bounces::AllByThroughput, 0.355_331_1, 250.0),
    ] {
        for light in FindLight::ALL {
            let name = format!("the sheet's {bounces:?}, {light:?}");
            // a light found by chance ends the path: 10 times what roulette makes of 0.8
            rows.extend(in_both(name, paths(scene, bounces, cosine, light), mean, 12.0, cost));
        }
    }
    for (bounces, most) in [(Bounces::All(0.995), 200.0), (Bounces::AllByThroughput, 5500.0)] {
        let estimator = paths(furnace(0.99), bounces, cosine, FindLight::ByChance);
        rows.extend(in_both(format!("furnace 0.99, {bounces:?}"), estimator, 100.0, most, 4000.0));
    }
    // the faces' own light at p_j, and the lamp's
    let scene = Scene { emission: 0.3, ..scene };
    let room = BoxRoom::new(scene).unwrap();
    let part = room.one_bounce() / (scene.cube_albedo * scene.radiance);
    let mean = scene.cube_albedo * (scene.radiance * part + scene.emission * (1.0 - part));
    rows.push(row(
        "what p_j emits",
        reflected(room, Hemisphere::Uniform, move |p_j, _| room.emitted(p_j)),
        mean,
        [0.0, 16.0],
        60.0,
    ));
    rows
}

// ---- section 5

fn of_roulette(pick: &mut Pick) -> Vec<Row> {
    let mut rows = Vec::new();
    // beyond this many bounces once in 10²⁴
    let last = |p: f64| 2.0 + 24.0 * 10f64.ln() / -p.ln();
    for p in [pick.between(0.8, [0.05, 0.9]), pick.between(0.2, [0.05, 0.9])] {
        let bounces = Roulette::new(p).unwrap().bounces();
        let (mean, variance) = (p / (1.0 - p), p / (1.0 - p).powi(2));
        let cdf = move |n: f64| if n < 0.0 { 0.0 } else { 1.0 - p.powf(n.floor() + 1.0) };
        let by_inversion = bounces.by_inversion().unwrap();
        rows.push(
            row(format!("bounces by inversion, p = {p}"), by_inversion, mean, [0.0, last(p)], 5.0)
                .variance(variance)
                .takes(1, 1)
                .cdf(cdf),
        );
        let by_simulation = bounces.by_simulation().unwrap();
        let cost = 10.0 / (1.0 - p);
        rows.push(
            row(format!("bounces by simulation, p = {p}"), by_simulation, mean, [0.0, last(p)], cost)
                .variance(variance)
                .cdf(cdf),
        );
    }
    // a staircase of one number: E min(N, c)² = Σ (2j − 1) P(N ≥ j)
    let (p, cut) = (0.5f64.powi(pick.count(1, [1, 3]) as i32), pick.count(6, [1, 7]) as i32);
    let mean: f64 = (1..=cut).map(|j| p.powi(j)).sum();
    let square: f64 = (1..=cut).map(|j| f64::from(2 * j - 1) * p.powi(j)).sum();
    let inverted = Roulette::new(p).unwrap().bounces().by_inversion().unwrap();
    let cut_off = Through(inverted, move |n: f64| n.min(cut.into()));
    rows.push(
        row(format!("min(N, {cut}), p = {p}"), cut_off, mean, [0.0, cut.into()], 6.0)
            .variance(square - mean * mean)
            .takes(1, 1)
            .smooth(1),
    );
    // the coin is one number and X another
    let p = pick.count(50, [1, 64]) as f64 / 64.0;
    let x = from_uniforms(|[u]| 3.0 * u * u);
    rows.push(
        row(format!("X_rr of 3U², p = {p}"), Roulette::new(p).unwrap().wrap(x), 1.0, [0.0, 3.0 / p], 15.0)
            .variance(9.0 / 5.0 / p - 1.0)
            .smooth(2),
    );
    let exponential = Exponential::new(pick.log(0.37, [1e-3, 1e3])).unwrap();
    let signed = || from_uniforms(|[u]| 3.0 * u - 1.0);
    let f = Polynomial::new(pick);
    for (given, least) in [(0.83, 0.5), (0.2, 0.1)] {
        let roulette = Roulette::new(pick.between(given, [least, 1.0])).unwrap();
        let p = roulette.p_rr();
        let of = |mean, variance| roulette.wrapped_variance(mean, variance).unwrap();
        let (mean, most) = (exponential.mean(), LONGEST * exponential.mean() / p);
        rows.push(
            row(
                format!("X_rr of an exponential, p = {p}"),
                roulette.wrap(exponential),
                mean,
                [0.0, most],
                20.0,
            )
            .variance(of(mean, exponential.variance()))
            .cdf(move |x| if x < 0.0 { 0.0 } else { 1.0 - p * exponential.survival(p * x) }),
        );
        rows.push(
            row(format!("X_rr of 3U − 1, p = {p}"), roulette.wrap(signed()), 0.5, [-1.0 / p, 2.0 / p], 15.0)
                .variance(of(0.5, 0.75)),
        );
        let x = f.rectangle.independent(move |x, y| f.at(x, y));
        rows.push(
            row(
                format!("X_rr of a polynomial, p = {p}"),
                roulette.wrap(x),
                f.mean(),
                f.range().map(|y| y / p),
                25.0,
            )
            .variance(of(f.mean(), f.variance())),
        );
    }
    // the weights fall, stay, and grow
    let visibility = pick.between(0.5, [0.3, 1.0]);
    let albedo = pick.between(0.8, [0.1, 0.85]);
    let model = LightModel::new(albedo, visibility).unwrap();
    let falling = albedo + pick.between(0.4, [0.15, 0.85]) * (1.0 - albedo);
    let growing = albedo * (1.0 - pick.between(0.1, [0.02, 0.1]) * (1.0 - albedo));
    for q in [falling, albedo, growing] {
        let x = model.roulette(q).unwrap();
        let name = format!("ρ = {albedo}, v = {visibility}, q = {q}");
        let most = match q {
            _ if q > albedo => q / (q - albedo),
            _ => (0..last(q) as i32).map(|k| (albedo / q).powi(k)).sum(),
        };
        rows.push(row(name, x, model.mean(), [0.0, most], 15.0 / (1.0 - q)).variance(x.variance()));
    }
    // far below ρ draws have no variance: \[X > 0\], since every weight is 1 or more
    let seldom = albedo * pick.between(0.25, [0.1, 0.6]);
    let sees = visibility / (1.0 - seldom * (1.0 - visibility));
    let hit = Through(model.roulette(seldom).unwrap(), |x: f64| x.min(1.0));
    rows.push(
        row(format!("light seen, ρ = {albedo}, q = {seldom}"), hit, sees, [0.0, 1.0], 20.0)
            .variance(sees * (1.0 - sees)),
    );
    let last = pick.count(8, [0, 20]);
    let x = model.truncated(last).unwrap();
    let most = (0..=last as i32).map(|k| albedo.powi(k)).sum::<f64>();
    rows.push(
        row(
            format!("truncated at {last}"),
            x,
            x.mean(),
            [0.0, most * (1.0 + 1e-12)],
            10.0 + 4.0 * last as f64,
        )
        .variance(x.variance()),
    );
    rows
}

// ---- the ends

fn extremes() -> Vec<Row> {
    let mut rows = Vec::new();
    for rate in [1e-300, 1e300] {
        let x = Exponential::new(rate).unwrap();
        rows.push(
            row(format!("exponential, λ = {rate:e}"), x, 1.0 / rate, [0.0, LONGEST / rate], 4.0)
                .takes(1, 1)
                .cdf(move |x| if x < 0.0 { 0.0 } else { -(-rate * x).exp_m1() }),
        );
    }
    // 53 ln 2/−ln p steps at most, between f64 that lie 64 apart
    let bounces = Roulette::new(NEARLY_ONE).unwrap().bounces();
    let longest = 330_895_682_712_764_032.0;
    rows.push(
        row(
            "bounces by inversion, p = 1 − 2⁻⁵³",
            bounces.by_inversion().unwrap(),
            bounces.mean(),
            [0.0, longest],
            5.0,
        )
        .variance(bounces.variance())
        .takes(1, 1)
        .cdf(move |n| if n < 0.0 { 0.0 } else { bounces.cdf(n as u64) }),
    );
    rows.push(
        row(
            "X_rr of 1, p = 1",
            Roulette::new(1.0).unwrap().wrap(from_uniforms(|[]| 1.7)),
            1.7,
            [0.0, 2.0],
            5.0,
        )
        .variance(0.0),
    );
    rows.push(row(
        "X_rr of U, p = 1e-300",
        Roulette::new(1e-300).unwrap().wrap(from_uniforms(|[u]| u)),
        f64::NAN,
        [0.0, 1e300],
        5.0,
    ));
    let tall = Rectangle::new([-1e300, 1e300], [1e-300, 3e-300]).unwrap();
    rows.push(
        row("xy on 2e300 × 2e-300", tall.independent(|x, y| x * y), 0.0, [-12.1, 12.1], 10.0)
            .variance(16.0 * 13.0 / 9.0)
            .takes(2, 1),
    );
    let surface = Lambertian::new(0.61).unwrap();
    for (directions, a) in [
        (Hemisphere::Uniform, 300.0),
        (Hemisphere::Cosine, 300.0),
        (Hemisphere::Uniform, -1.99),
        (Hemisphere::Cosine, -0.5),
    ] {
        let power = CosinePower::new(a).unwrap();
        let (k, b, root) = match directions {
            Hemisphere::Uniform => (1.22, a + 1.0, 1.0 / (a + 1.0)),
            Hemisphere::Cosine => (0.61, a, 2.0 / a),
        };
        let most = if b > 0.0 { k } else { k * 2f64.powi(-53).powf(b) };
        for (way, estimator) in both(surface, directions, move |w| power.incoming(w)) {
            let mean = if a < -1.0 { f64::NAN } else { power.reflected(surface) };
            let name = format!("cos^{a} θ, {way}, {directions:?}");
            let one = row(name, estimator, mean, [0.0, most * (1.0 + 1e-9)], 45.0)
                .variance(power.variance(surface, directions))
                .takes(2, 1);
            // cos^300 θ is 0 in f64 for many directions
            let law = move |x: f64| 1.0 - (x / k).max(0.0).powf(root).clamp(0.0, 1.0);
            rows.push(if b < 0.0 { one.cdf(law) } else { one });
        }
    }
    // once in a hundred draws, and never any variance
    let ring = RingLight::new(0.1).unwrap();
    rows.push(
        row(
            "ring 0.1, cosine",
            surface.cosine_estimator(move |w| ring.incoming(w)),
            0.0061,
            [0.0, 0.611],
            10.0,
        )
        .variance(ring.variance(surface, Hemisphere::Cosine))
        .takes(2, 1),
    );
    rows.push(
        row("7, cosine", surface.cosine_estimator(|_| 7.0), 4.27, [0.0, 8.0], 8.0).variance(0.0).takes(2, 1),
    );
    let offset = offset();
    rows.push(
        row("constant on a rectangle", offset.independent(|_, _| 1.0), 6.97, [0.0, 8.0], 8.0).takes(2, 1),
    );
    rows.push(
        row("1024 cells of 1", offset.jittered(|_, _| 1.0, 32).unwrap(), 6.97, [0.0, 8.0], 20_000.0)
            .takes(2049, 1024),
    );
    // sets within sets
    let exponential = Exponential::new(0.37).unwrap();
    let x = Roulette::new(0.8).unwrap().wrap(exponential);
    let range = [0.0, LONGEST / 0.37 / 0.8];
    rows.push(row("jittered X_rr", jittered(x, 3).unwrap(), 1.0 / 0.37, range, 600.0));
    rows.push(row("64 Sobol points of X_rr", sobol(x, 64).unwrap(), 1.0 / 0.37, range, 3000.0));
    rows
}
