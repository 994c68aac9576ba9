//! Section 3: directions, and surfaces under a sky.

use super::*;

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
pub fn most_weight(directions: Hemisphere) -> f64 {
    if directions == Hemisphere::Cosine { 1.0 } else { 2.0 }
}

/// The simple and the general estimator for these directions.
pub fn both(
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

pub fn rows(pick: &mut Pick) -> Vec<Row> {
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
