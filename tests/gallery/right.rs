//! Right estimators of every exercise, which are never called wrong.

use std::f64::consts::PI;

use glam::DVec3;
use rand::distr::Distribution;
use unbiased::check::{self, Attempt, Finding};
use unbiased::inversion::Exponential;
use unbiased::inversion::mistakes::Samples;
use unbiased::lambertian::hemisphere::{Direction, Hemisphere};
use unbiased::lambertian::mistakes::Reflection;
use unbiased::paths::mistakes::LightOfPaths;
use unbiased::paths::room::{BoxRoom, nearest_hit, visible};
use unbiased::paths::{Bounces, FindLight, Paths};
use unbiased::rectangle::mistakes::Integral;
use unbiased::roulette::Roulette;
use unbiased::roulette::mistakes::{NumberOfBounces, Wrapped};
use unbiased::{Stream, check::Problem};

use crate::{DRAWS, common, diagnosed, exercise, is_faint};

fn right() -> Vec<Attempt<'static>> {
    vec![
        Attempt::new(|p: &Samples, rng| -(1.0 - rng.uniform()).ln() / p.rate),
        Attempt::new(|p: &Samples, rng| Exponential::new(p.rate).unwrap().sample(rng)),
        Attempt::new(|p: &Samples, rng| rand_distr::Exp::new(p.rate).unwrap().sample(rng)),
        Attempt::new(|p: &Integral, rng| {
            let [x, y] = p.rectangle.sample(rng);
            p.rectangle.area() * p.f(x, y)
        }),
        // four points at a time, one in each quarter
        Attempt::new(|p: &Integral, rng| {
            let [[a, b], [c, d]] = p.ends();
            let cell = |cell: u8, rng: &mut Stream| {
                let (u, v) = (rng.uniform() + f64::from(cell % 2), rng.uniform() + f64::from(cell / 2));
                p.f(a + 0.5 * u * (b - a), c + 0.5 * v * (d - c))
            };
            0.25 * p.rectangle.area() * (0..4).map(|index| cell(index, rng)).sum::<f64>()
        }),
        Attempt::new(|p: &Reflection, rng| {
            let direction = Hemisphere::Uniform.sample(rng);
            2.0 * p.albedo * p.light(&direction) * direction.cos_theta()
        }),
        Attempt::new(|p: &Reflection, rng| p.albedo * p.light(&Hemisphere::Cosine.sample(rng))),
        // in f32
        Attempt::new(|p: &Reflection, rng| {
            let light = p.light(&Hemisphere::Cosine.sample(rng)) as f32;
            f64::from(p.albedo as f32 / std::f32::consts::PI * light * std::f32::consts::PI)
        }),
        // the normal + a point on the sphere
        Attempt::new(|p: &Reflection, rng| {
            let z = 2.0 * rng.uniform() - 1.0;
            let (sin, cos) = (2.0 * PI * rng.uniform()).sin_cos();
            let r = (1.0 - z * z).sqrt();
            Direction::new(r * cos, r * sin, z + 1.0).map_or(0.0, |at| p.albedo * p.light(&at))
        }),
        Attempt::new(|p: &Wrapped, rng| {
            let goes_on = Roulette::new(p.p_rr).unwrap().continues(rng);
            if goes_on { p.x(rng) / p.p_rr } else { 0.0 }
        }),
        // no roulette at all
        Attempt::new(|p: &Wrapped, rng| p.x(rng)),
        Attempt::new(|p: &NumberOfBounces, rng| ((1.0 - rng.uniform()).ln() / p.p_rr.ln()).floor()),
        Attempt::new(|p: &NumberOfBounces, rng| {
            std::iter::repeat_with(|| rng.uniform()).take_while(|u| *u < p.p_rr).count() as f64
        }),
        // the closed form
        Attempt::new(|p: &NumberOfBounces, _| p.p_rr / (1.0 - p.p_rr)),
        library(Hemisphere::Cosine, FindLight::BySampling),
        library(Hemisphere::Uniform, FindLight::BySampling),
        Attempt::new(shared_sample),
    ]
}

/// The same point of the light for all vertices of a path: that looks like a mistake, and is none.
pub fn shared_sample(p: &LightOfPaths, rng: &mut Stream) -> f64 {
    let (room, bounces): (&BoxRoom, _) = (&p.room, p.bounces());
    let h = room.scene().light_half_width;
    let y = DVec3::new(h * (2.0 * rng.uniform() - 1.0), h * (2.0 * rng.uniform() - 1.0), 4.0);
    let (mut vertex, mut throughput, mut light) = (room.point(), 1.0, 0.0);
    for k in 0..=*bounces.end() {
        if bounces.contains(&k) && !room.is_light(&vertex) {
            light += throughput * room.emitted(&vertex);
        }
        let way = y - vertex.position();
        let cosines = vertex.normal().dot(way) * way.z;
        throughput *= room.albedo(&vertex);
        if bounces.contains(&(k + 1)) && cosines > 0.0 && visible(&vertex, y) {
            let solid = cosines / way.length_squared().powi(2) * room.light_area();
            light += throughput / PI * room.scene().radiance * solid;
        }
        let direction = Hemisphere::Cosine.sample(rng);
        vertex = nearest_hit(&vertex, vertex.to_room(&direction)).unwrap();
    }
    light
}

/// The crate's own paths.
fn library(directions: Hemisphere, light: FindLight) -> Attempt<'static> {
    Attempt::new(move |p: &LightOfPaths, rng| {
        let (first, last) = p.bounces().into_inner();
        let bounces = if first == last { Bounces::Exactly(last) } else { Bounces::UpTo(last) };
        let paths = Paths::new(p.room, bounces, directions, light).unwrap();
        paths.light_from(&p.room.point(), rng)
    })
}

#[test]
fn a_right_estimator_is_never_diagnosed() {
    for (what, attempt) in right().into_iter().enumerate() {
        for round in 0..4 {
            let diagnosis = diagnosed(&attempt, DRAWS, 1000 + round);
            assert_eq!(diagnosis.finding, Finding::NothingWrong, "{what}: {diagnosis}");
            assert_eq!(diagnosis.candidates.len(), 0);
            let faint = |mistake| is_faint(attempt.exercise, mistake);
            assert!(diagnosis.hidden.iter().copied().all(faint), "{what}: {diagnosis}");
            assert!(diagnosis.to_string().starts_with("Nothing wrong seen"));
        }
    }
}

/// However few draws, of one probe or all: 0 of 10⁴ are called wrong.
#[test]
fn few_draws_of_a_right_estimator_are_never_called_wrong() {
    let mut attempts = right();
    // one path in a hundred finds the light: very skew draws
    attempts.push(library(Hemisphere::Cosine, FindLight::ByChance));
    let (mut runs, mut decided) = (0, 0);
    for (what, attempt) in attempts.iter().enumerate() {
        let is_slow = std::ptr::eq(attempt.exercise, LightOfPaths::exercise());
        for draws in [2, 3, 5, 10, 20, 30, 31, 40, 60, 100, 200, 500, 1000] {
            let rounds = if common::mutation() {
                2
            } else if is_slow {
                8
            } else {
                16
            };
            for round in 0..rounds {
                let measured = check::measure(attempt, draws, 70_000 + round).unwrap();
                let parts = measured.iter().map(std::slice::from_ref).chain([&measured[..]]);
                for part in parts {
                    let diagnosis = check::diagnose(part).unwrap();
                    let wrong = matches!(diagnosis.finding, Finding::Known | Finding::Unknown);
                    assert!(!wrong, "{what}, {draws} draws, round {round}: {diagnosis}");
                    runs += 1;
                    decided += u32::from(diagnosis.finding == Finding::NothingWrong);
                    assert!(draws >= 30 || diagnosis.finding == Finding::Unclear);
                }
            }
        }
    }
    println!("{runs} right submissions, none called wrong, {decided} called right");
    assert!(runs > 10_000 || common::mutation());
}

/// What a right estimator may show once in a thousand or a million times, by hand: one hit where ten were
/// due, one miss where ten were due, and thirty draws whose spread came out small.
#[test]
fn rare_luck_is_not_called_wrong() {
    let finding = |question: &str, draws: &[(u32, f64)]| {
        let mut tally = check::Tally::default();
        draws.iter().for_each(|(count, draw)| (0..*count).for_each(|_| tally.push(*draw)));
        let probe = exercise(question).unwrap().probes_of(question)[0];
        check::diagnose(&[tally.on(probe)]).unwrap().finding
    };
    let is_wrong = |found: Finding| matches!(found, Finding::Known | Finding::Unknown);
    // paths that find the light bring 4, one in a hundred does: t = −9 of one hit, yet likely enough
    assert!(!is_wrong(finding("4.3", &[(999, 0.0), (1, 4.0)])));
    // none of that helps where there are draws enough
    assert!(is_wrong(finding("4.3", &[(99_900, 0.0), (100, 4.0)])));
    // t = 9 of one miss in a thousand, with mean 1 and ten due
    assert!(!is_wrong(finding("5", &[(999, 1.0 / 0.99), (1, 0.0)])));
    // thirty draws, 8 std errors off: Student's law with 29 degrees of freedom is not normal
    let off = |deviations: f64| {
        let step = 29f64.sqrt() / deviations;
        finding("5", &[(15, 1.0 + 1e-2 + step * 1e-2), (15, 1.0 + 1e-2 - step * 1e-2)])
    };
    assert!(!is_wrong(off(8.0)) && is_wrong(off(20.0)));
}
