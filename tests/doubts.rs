//! Doubts: what the parameters tell of an error bar before a draw is made.

use unbiased::lambertian::hemisphere::Hemisphere;
use unbiased::paths::room::{BoxRoom, Scene};
use unbiased::paths::{Bounces, FindLight, Paths};
use unbiased::placement::sobol;
use unbiased::roulette::LightModel;
use unbiased::{Doubt, Estimator};

use Bounces::{All, AllByThroughput, Exactly, UpTo};
use FindLight::{ByChance, BySampling};
use Hemisphere::{Cosine, Uniform};

const WAYS: [(Hemisphere, FindLight); 4] =
    [(Cosine, BySampling), (Uniform, BySampling), (Cosine, ByChance), (Uniform, ByChance)];

/// Why an error bar may be wrong: for each scene, by its albedos and its light's half-width.
#[test]
fn a_doubt_says_when_the_variance_may_be_infinite() {
    let with = |wall_albedo, cube_albedo, light_half_width| Scene {
        wall_albedo,
        cube_albedo,
        light_half_width,
        ..Scene::default()
    };
    let grey = |half_width| with(0.5, 0.5, half_width);
    let infinite = |why: &str| format!("the variance may be infinite, and the error bar too short: {why}");
    let few = |why: &str, n: &str| {
        format!("{why}, so that the error bar of fewer than about {n} draws means nothing")
    };
    let small = "uniform directions make most throughputs far too small and a few very large";
    let seldom = "few paths find the light";
    let near = "the light is so near the walls that a few of its samples outweigh all others";
    let touches = infinite("the light touches the walls, where its samples weigh without bound");
    let says = |scene, bounces, way: (Hemisphere, FindLight), told: Option<&str>| {
        let paths = Paths::new(BoxRoom::new(scene).unwrap(), bounces, way.0, way.1).unwrap();
        let doubt = paths.doubt().map(|doubt| doubt.to_string());
        assert_eq!(doubt.as_deref(), told, "{bounces:?} {way:?} in {scene:?}");
        // single precision changes no law
        if let Ok(single) = paths.in_f32() {
            assert_eq!(single.doubt(), paths.doubt(), "{bounces:?} {way:?} in {scene:?}");
        }
    };
    // q against ρ² and (4/3)ρ² of the larger albedo, whichever it is
    for scene in [with(0.5, 0.8, 0.5), with(0.8, 0.1, 0.5)] {
        for light in FindLight::ALL {
            says(scene, All(0.6400001), (Cosine, light), None);
            let told = infinite("q = 0.64 is not above ρ² = 0.6400 for the largest albedo");
            says(scene, All(0.64), (Cosine, light), Some(&told));
            let told = infinite("q = 0.2 is not above ρ² = 0.6400 for the largest albedo");
            says(scene, All(0.2), (Cosine, light), Some(&told));
            says(scene, All(0.86), (Uniform, light), None);
            let told = infinite("q = 0.85 is not above (4/3)ρ² = 0.8533 for the largest albedo");
            says(scene, All(0.85), (Uniform, light), Some(&told));
        }
    }
    // by weight: never with cosine directions; with uniform ones from ρ² = 3/4 on
    says(with(0.5, 0.99, 0.5), AllByThroughput, WAYS[0], None);
    says(with(0.5, 0.86, 0.5), AllByThroughput, WAYS[1], None);
    let told = infinite(
        "the squared throughput of a path grows by (4/3)ρ² = 1.0092 a bounce for the largest albedo, and \
         nothing ends a path of throughput 1 or more",
    );
    says(with(0.5, 0.87, 0.5), AllByThroughput, WAYS[1], Some(&told));
    // a number of bounces ends every path, but uniform directions make weights that vary too much: from 24 of
    // them on, (9/5)²⁴ = 1.3e6
    for albedo in [1.0, 0.5, 1e-3] {
        let scene = with(albedo, albedo, 0.5);
        says(scene, Exactly(24), WAYS[1], None);
        says(scene, Exactly(25), WAYS[1], Some(&few(small, "1e6")));
        says(scene, Exactly(64), WAYS[1], Some(&few(small, "1e16")));
        let furnace = Scene { emission: 1.0, light_half_width: 0.0, ..scene };
        says(furnace, Exactly(23), WAYS[3], None);
        says(furnace, Exactly(24), WAYS[3], Some(&few(small, "1e6")));
        for (light, bounces) in FindLight::ALL.into_iter().zip([Exactly(64), UpTo(64)]) {
            says(scene, bounces, (Cosine, light), None);
        }
    }
    // a sum is no worse than its terms: with an albedo that makes the first ones the largest there is nothing
    // to say
    says(grey(0.5), UpTo(64), WAYS[1], None);
    says(with(1.0, 1.0, 0.5), UpTo(12), WAYS[1], None);
    says(with(1.0, 1.0, 0.5), UpTo(64), WAYS[1], Some(&few(small, "2e17")));
    // a light that one path in 100 finds, in 1e6 of them, and in more
    says(grey(0.5), Exactly(15), WAYS[3], None);
    says(grey(0.5), Exactly(16), WAYS[3], Some(&few(&format!("{small}, and {seldom}"), "1e6")));
    says(grey(0.00501), Exactly(1), WAYS[2], None);
    says(grey(0.0005), Exactly(1), WAYS[2], Some(&few(seldom, "1e8")));
    says(grey(0.0), Exactly(1), WAYS[2], None);
    says(grey(0.0005), UpTo(0), WAYS[2], None);
    says(Scene { emission: 1.0, ..grey(0.0005) }, AllByThroughput, WAYS[2], None);
    // a light that touches the walls, sampled from there; and one that all but does: 8/(2 − h)³
    for bounces in [UpTo(2), Exactly(2), All(0.9), AllByThroughput] {
        for (half_width, told) in
            [(2.0, Some(touches.as_str())), (1.979, None), (1.999, Some(&few(near, "8e9")))]
        {
            says(grey(half_width), bounces, WAYS[0], told);
            says(grey(half_width), bounces, WAYS[2], None);
        }
    }
    says(grey(2.0), UpTo(1), WAYS[0], None);
}

/// What the parameters tell of an error bar is told by whatever holds the estimator, too.
#[test]
fn a_doubt_is_told_through_boxes_references_and_placements() {
    let paths = |q| LightModel::new(0.8, 0.5).unwrap().roulette(q).unwrap();
    for (q, doubt) in
        [(0.2, Some(Doubt::InfiniteVariance)), (0.64, Some(Doubt::InfiniteVariance)), (0.65, None)]
    {
        let boxed: Box<dyn Estimator> = Box::new(paths(q));
        assert_eq!(paths(q).doubt(), doubt);
        assert_eq!(<&dyn Estimator>::doubt(&(&paths(q) as &dyn Estimator)), doubt);
        assert_eq!(boxed.doubt(), doubt);
        assert_eq!(sobol(paths(q), 4).unwrap().doubt(), doubt);
    }
}
