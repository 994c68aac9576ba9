//! Many paths side by side, one per lane of a vector: the loop of [`Paths::walk`] with selections in place of
//! branches, and the same random numbers. A path that has ended goes on with throughput 0; with roulette,
//! until the next path takes its lane.

mod step;

use super::{Ending, Paths};
use crate::fast::{Real, widest};
use crate::stream::{Abreast, LANES, Stream};
use step::{End, Go, Numbers, Room, Sample, Step};

/// One number for each path of a row.
type Each<T> = [T; LANES];

/// The largest number of rows of paths that run together, so that they and their random numbers stay in the
/// cache.
const ROWS: usize = 8;
const NUMBERS: usize = 256;

/// Fills `draws` with the radiance of one path each, computed in `T`.
pub(super) fn fill<T: Real>(paths: &Paths, rng: &mut Stream, draws: &mut [f64]) {
    let walk = Walk::<T>::new(paths);
    if paths.ending != Ending::Never {
        let mut abreast = rng.abreast(draws.len());
        walk.one_after_another(&mut abreast, draws);
        return abreast.finish();
    }
    let each = paths.numbers as usize;
    let most = (NUMBERS / each.max(1)).clamp(1, ROWS);
    let sets = most.min(draws.len().div_ceil(LANES) + 1);
    let mut numbers = vec![[T::of(0.0); LANES]; each * sets];
    let mut rest = draws;
    while !rest.is_empty() {
        let lane = rng.lane();
        let some;
        (some, rest) = rest.split_at_mut(rest.len().min(sets * LANES - lane));
        rng.fill_rows(each, sets, some.len(), &mut numbers);
        rng.count_evaluations(walk.together(&numbers, sets, lane, some));
    }
}

/// The radiance of one path, computed in `T`.
pub(super) fn draw<T: Real>(paths: &Paths, rng: &mut Stream) -> f64 {
    let (walk, mut light) = (Walk::<T>::new(paths), [0.0]);
    if paths.ending != Ending::Never {
        walk.one_after_another(&mut rng.alone(), &mut light);
    } else {
        let mut numbers = vec![[T::of(0.0); LANES]; paths.numbers as usize];
        rng.alone().numbers(&mut numbers);
        rng.count_evaluations(walk.together(&numbers, 1, 0, &mut light));
    }
    light[0]
}

/// The positions of a row's paths, their throughput, and the radiance that each has found so far.
#[derive(Clone, Copy)]
struct Front<T> {
    at: [Each<T>; 3],
    normal: [Each<T>; 3],
    albedo: Each<T>,
    throughput: Each<T>,
    light: Each<T>,
}

impl<T: Real> Front<T> {
    /// Starts a new path in a lane, copied from `start`.
    fn begin(&mut self, lane: usize, start: &Self) {
        for axis in 0..3 {
            self.at[axis][lane] = start.at[axis][lane];
            self.normal[axis][lane] = start.normal[axis][lane];
        }
        self.albedo[lane] = start.albedo[lane];
        self.throughput[lane] = start.throughput[lane];
        self.light[lane] = start.light[lane];
    }
}

/// The paths' settings, converted to `T`.
struct Walk<'a, T> {
    paths: &'a Paths,
    room: Room<T>,
    /// A row of paths at their start.
    start: Front<T>,
    /// Whether the light is found by sampling it.
    sampled: bool,
    /// All radiances are divided by this: [`Paths::scale`].
    scale: f64,
}

impl<'a, T: Real> Walk<'a, T> {
    fn new(paths: &'a Paths) -> Self {
        let start = paths.room.point();
        let [fewest, _] = paths.counted;
        let emitted = if fewest == 0 { paths.room.emitted(&start) } else { 0.0 };
        let (sampled, scale) = (paths.samples_light(), paths.scale());
        let all = |number| [T::of(number); LANES];
        let start = Front {
            at: start.position().to_array().map(all),
            normal: start.normal().to_array().map(all),
            albedo: all(paths.room.albedo(&start)),
            throughput: all(1.0),
            light: all(emitted / scale),
        };
        Self { paths, room: Room::new(&paths.room, scale), start, sampled, scale }
    }

    /// Runs paths that all have the same number of bounces and of random numbers; the first is in `lane` of
    /// its row. `numbers` has rows for `sets` rows of paths. Returns the number of rays.
    fn together(&self, numbers: &[Each<T>], sets: usize, lane: usize, draws: &mut [f64]) -> u64 {
        let mut fronts = [self.start; ROWS];
        let fronts = &mut fronts[..(lane + draws.len()).div_ceil(LANES)];
        // unused lanes before the first path and after the last
        let end = (lane + draws.len() - 1) % LANES + 1;
        if let Some(front) = fronts.first_mut() {
            front.throughput[..lane].fill(T::of(0.0));
        }
        if let Some(front) = fronts.last_mut() {
            front.throughput[end..].fill(T::of(0.0));
        }
        let ([fewest, most], last) = (self.paths.counted, self.paths.last());
        let (mut taken, mut rays) = (0, 0);
        for bounces in 0..most {
            if self.sampled && bounces + 1 >= fewest {
                rays += self.sample(fronts, Numbers { rows: &numbers[taken * sets..], sets });
                taken += 2;
            }
            if bounces >= last {
                break;
            }
            let own = Numbers { rows: &numbers[taken * sets..], sets };
            rays += self.go(fronts, own, true, bounces + 1 >= fewest);
            taken += 2;
        }
        let light = fronts.iter().flat_map(|front| &front.light).skip(lane);
        for (draw, light) in draws.iter_mut().zip(light) {
            *draw = light.to_f64() * self.scale;
        }
        rays
    }

    /// Runs paths that roulette ends: when one has ended, the next one starts in its lane. Every vertex takes
    /// the same number of random numbers.
    fn one_after_another(&self, abreast: &mut Abreast<'_>, draws: &mut [f64]) {
        let mut fronts = [self.start];
        for lane in 0..LANES {
            if abreast.draw(lane).is_none() {
                fronts[0].throughput[lane] = T::of(0.0);
            }
        }
        let mut numbers = [[T::of(0.0); LANES]; 5];
        let each = if self.sampled { 5 } else { 3 };
        let mut rays = 0;
        loop {
            let [front] = &mut fronts;
            for lane in 0..LANES {
                while (front.throughput[lane] == T::of(0.0)) | (front.albedo[lane] == T::of(0.0))
                    && let Some(draw) = abreast.draw(lane)
                {
                    draws[draw] = front.light[lane].to_f64() * self.scale;
                    front.begin(lane, &self.start);
                    if !abreast.next_draw(lane) {
                        front.throughput[lane] = T::of(0.0);
                    }
                }
            }
            if !abreast.under_way() {
                break;
            }
            abreast.numbers(&mut numbers[..each]);
            let [.., u, v, coins] = &numbers[..each] else { break };
            if self.sampled {
                rays += self.sample(&mut fronts, Numbers { rows: &numbers, sets: 1 });
            }
            let [front] = &mut fronts;
            widest(End { paths: self.paths, front, u, coins, lanes: LANES });
            rays += self.go(&mut fronts, Numbers { rows: &[*u, *v], sets: 1 }, false, true);
        }
        abreast.count_evaluations(rays);
    }

    /// Adds a light sample at every path's vertex. Returns the number of rays.
    fn sample(&self, fronts: &mut [Front<T>], numbers: Numbers<'_, T>) -> u64 {
        widest(Sample { room: self.room, fronts, numbers, lanes: LANES })
    }

    /// Moves every path that goes on to its next vertex; what that vertex emits is added if `counted`.
    /// Returns the number of rays.
    fn go(&self, fronts: &mut [Front<T>], numbers: Numbers<'_, T>, reflect: bool, counted: bool) -> u64 {
        let Self { room, paths, .. } = *self;
        let of_faces = if counted { room.emission } else { T::of(0.0) };
        let of_light = if counted && !self.sampled { room.radiance } else { T::of(0.0) };
        let step = Step { room, emitted: [of_faces, of_light], lanes: LANES, reflect };
        widest(Go { step, fronts, numbers, directions: paths.directions })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::estimator::Estimator;
    use crate::fast::tests::both;
    use crate::lambertian::hemisphere::Hemisphere;
    use crate::paths::room::{BoxRoom, Scene};
    use crate::paths::{Bounces, FindLight};
    use crate::stream::points::{Grid, Placement, Sobol};

    fn every_way(mut see: impl FnMut(Paths)) {
        let scenes = [
            Scene::default(),
            Scene { emission: 0.3, ..Scene::default() },
            Scene { light_half_width: 0.0, emission: 1.0, ..Scene::default() },
            Scene { light_half_width: 1.7, wall_albedo: 0.9, point: [2.0, 0.3, 0.4], ..Scene::default() },
            Scene { point: [0.5, 0.1, 0.6], cube_albedo: 0.0, ..Scene::default() },
            Scene { point: [-1.1, 0.7, 0.0], ..Scene::default() },
            Scene { point: [-1.1, -2.0, 3.0], ..Scene::default() },
            Scene { point: [1.1, 0.7, 4.0], ..Scene::default() },
        ];
        let bounces = [0, 1, 2, 3, 15].map(Bounces::Exactly).into_iter();
        let bounces = bounces.chain([0, 1, 4].map(Bounces::UpTo));
        for bounces in bounces.chain([Bounces::All(0.6), Bounces::AllByThroughput]) {
            for scene in scenes {
                for directions in Hemisphere::ALL {
                    for light in FindLight::ALL {
                        let room = BoxRoom::new(scene).unwrap();
                        see(Paths::new(room, bounces, directions, light).unwrap());
                    }
                }
            }
        }
    }

    /// Independent and placed numbers.
    fn streams(seed: u64) -> [Stream; 3] {
        let placements = [Placement::Sobol(Sobol::new(512, seed)), Placement::Jittered(Grid::new(23, seed))];
        let [sobol, jittered] = placements.map(|placement| Stream::placed(placement, seed));
        [Stream::new(seed, 0), sobol, jittered]
    }

    /// Each path finds the radiance of the plain loop with the same numbers, and takes the same number of
    /// random numbers and rays. Rounding moves a hit by 1e-16, and each further grazing bounce enlarges that.
    /// A ray within 1e-14 of an edge may end on the other side of it; from the lengths of the edges, that
    /// happens to fewer than one path in 1e12 here.
    #[test]
    fn every_path_is_one_of_the_plain_loop() {
        let (mut lit, mut seed) = (0, 0);
        every_way(|paths| {
            seed += 1;
            for mut rng in streams(seed) {
                let (mut one, mut filled) = (rng.clone(), [0.0; 110]);
                // parts of 75 also test rows that start or end in the middle
                for part in filled.chunks_mut(75) {
                    paths.fill(&mut rng, part);
                }
                for light in filled {
                    let plain = paths.draw(&mut one);
                    one.next_draw();
                    assert!((light - plain).abs() <= 1e-11 * plain, "{light} and {plain} by {paths:?}");
                    lit += u32::from(light > 0.0);
                }
                let counted = |rng: &Stream| (rng.random_numbers(), rng.evaluations());
                assert_eq!(counted(&rng), counted(&one), "{paths:?}");
            }
        });
        assert!(lit > 10_000, "{lit} paths found light");
    }

    /// In single precision the paths are the same, one at a time or many. Up to three bounces all agree to a
    /// few roundings of 6e-8, except those that pass an edge within 1e-6.
    #[test]
    fn single_precision_follows_the_same_paths() {
        let (mut far, mut all, mut seed) = (0, 0, 0);
        every_way(|paths| {
            let Ok(single) = paths.in_f32() else { return };
            seed += 1;
            for mut rng in streams(seed) {
                let (mut one, mut double) = (rng.clone(), rng.clone());
                let [mut filled, mut exact] = [[0.0; 110]; 2];
                for part in filled.chunks_mut(75) {
                    single.fill(&mut rng, part);
                }
                paths.fill(&mut double, &mut exact);
                for (light, exact) in filled.into_iter().zip(exact) {
                    assert_eq!(light, single.draw(&mut one), "{paths:?}");
                    one.next_draw();
                    if paths.counted[1] <= 3 {
                        all += 1;
                        far += u32::from((light - exact).abs() > 1e-4 * exact);
                    }
                }
            }
        });
        assert!(all > 10_000 && far < all / 1000, "{far} of {all}");
    }

    /// Vectors of any width, or none, give the same bits, so every processor gives the same results.
    #[test]
    fn wide_and_narrow_loops_have_the_same_bits() {
        let mut seed = 0;
        every_way(|paths| {
            seed += 1;
            for single in [false, true] {
                let [wide, narrow] = both(|| {
                    let (mut rng, mut draws) = (Stream::new(seed, 1), [0.0; 300]);
                    if single {
                        paths.in_f32().unwrap().fill(&mut rng, &mut draws);
                    } else {
                        paths.fill(&mut rng, &mut draws);
                    }
                    (draws.map(f64::to_bits), rng.random_numbers(), rng.evaluations())
                });
                assert_eq!(wide, narrow, "{paths:?}");
            }
        });
    }
}
