//! Section 4: paths in the box room.

use super::surfaces::most_weight;
use super::*;

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

pub fn rows(pick: &mut Pick) -> Vec<Row> {
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
            let mean = scale * part_of_the_sky(&Vertex::at(once.point).unwrap(), h);
            // f_r L_e A cos θ cos θ′/r² ≤ ρ L_e A/9π, 3 m below
            let most = scale * if by_chance { weight } else { 4.0 * h * h / (9.0 * PI) };
            let bounces = pick.one_of(Bounces::Exactly(1), &[Bounces::Exactly(1), Bounces::UpTo(1)]);
            let name = format!("{bounces:?}, {directions:?}, {light:?}");
            rows.extend(in_both(name, paths(once, bounces, directions, light), mean, most, 70.0));
            // two, by the quadrature of the closed form, which tests/scene.rs holds to another's
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
pub fn of_the_sheet() -> Vec<Row> {
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
