//! Section 2: points on rectangles.

use super::*;

/// 1.7 × 4.1, away from the origin: neither its area nor its perimeter nor its centre hides a mistake.
pub fn offset() -> Rectangle {
    Rectangle::new([0.3, 2.0], [-1.1, 3.0]).unwrap()
}

/// A polynomial Σ c_ij sⁱ tʲ in s = (x − a)/(b − a) and t = (y − c)/(d − c), its coefficients 0 or more.
#[derive(Clone, Copy)]
pub struct Polynomial {
    pub rectangle: Rectangle,
    coefficients: [[f64; 3]; 3],
}

impl Polynomial {
    pub fn new(pick: &mut Pick) -> Self {
        let rectangle = pick.rectangle(offset());
        let mut coefficients = [[0.2, 0.0, 0.7], [0.5, 0.9, 0.0], [0.3, 0.1, 0.6]];
        coefficients.as_flattened_mut().iter_mut().for_each(|c| *c = pick.between(*c, [0.0, 1.0]));
        // so that it is not nearly 0 nearly everywhere
        coefficients[0][0] += 0.1;
        Self { rectangle, coefficients }
    }

    pub fn at(&self, x: f64, y: f64) -> f64 {
        let ([a, b], [c, d]) = (self.rectangle.x_range(), self.rectangle.y_range());
        let (s, t) = ((x - a) / (b - a), (y - c) / (d - c));
        let [low, middle, high] = self.coefficients.map(|row| (row[2] * t + row[1]) * t + row[0]);
        (high * s + middle) * s + low
    }

    /// sⁱ tʲ has the mean 1/((i + 1)(j + 1)).
    pub fn mean(&self) -> f64 {
        let terms = self.terms().map(|(i, j, c)| c / ((i + 1) * (j + 1)) as f64);
        self.rectangle.area() * terms.sum::<f64>()
    }

    pub fn variance(&self) -> f64 {
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

    pub fn range(&self) -> [f64; 2] {
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

pub fn rows(pick: &mut Pick) -> Vec<Row> {
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
