//! Many paths side by side, one per lane of a vector: the loop of [`Paths::walk`] with selections in place of
//! branches, and the same random numbers.
//!
//! Faces have no index here. A ray ends on a plane across one axis: one component of the normal is ±1,
//! against the ray, and the others are 0. The coordinate on that axis is set exactly, as in the plain loop. A
//! path that has ended goes on with throughput 0; with roulette, until the next path takes its lane.

use pulp::NullaryFnOnce;

use super::{Ending, Paths, by_throughput, power};
use crate::fast::{Real, widest};
use crate::lambertian::hemisphere::Hemisphere;
use crate::paths::room::{BoxRoom, Face};
use crate::stream::{Abreast, LANES, Stream};

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
    x: Each<T>,
    y: Each<T>,
    z: Each<T>,
    normal_x: Each<T>,
    normal_y: Each<T>,
    normal_z: Each<T>,
    albedo: Each<T>,
    throughput: Each<T>,
    light: Each<T>,
}

impl<T: Real> Front<T> {
    /// Starts a new path in a lane, copied from `start`.
    fn begin(&mut self, lane: usize, start: &Self) {
        self.x[lane] = start.x[lane];
        self.y[lane] = start.y[lane];
        self.z[lane] = start.z[lane];
        self.normal_x[lane] = start.normal_x[lane];
        self.normal_y[lane] = start.normal_y[lane];
        self.normal_z[lane] = start.normal_z[lane];
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
        let (at, normal) = (start.position(), start.normal());
        let [fewest, _] = paths.counted;
        let emitted = if fewest == 0 { paths.room.emitted(&start) } else { 0.0 };
        let (sampled, scale) = (paths.samples_light(), paths.scale());
        let all = |number| [T::of(number); LANES];
        let start = Front {
            x: all(at.x),
            y: all(at.y),
            z: all(at.z),
            normal_x: all(normal.x),
            normal_y: all(normal.y),
            normal_z: all(normal.z),
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
            rays += self.go(
                fronts,
                Numbers { rows: &numbers[taken * sets..], sets },
                true,
                bounces + 1 >= fewest,
            );
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
            let directions = [*u, *v];
            let of_directions = Numbers { rows: &directions, sets: 1 };
            let [front] = &mut fronts;
            widest(End { paths: self.paths, front, numbers: of_directions, coins, lanes: LANES });
            rays += self.go(&mut fronts, of_directions, false, true);
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
        let (directions, emitted) = (paths.directions, [of_faces, of_light]);
        widest(Go { room, fronts, numbers, lanes: LANES, directions, reflect, emitted })
    }
}

/// The random numbers of a step: two rows for each row of paths.
#[derive(Clone, Copy)]
struct Numbers<'a, T> {
    rows: &'a [Each<T>],
    sets: usize,
}

impl<'a, T: Real> Numbers<'a, T> {
    #[inline(always)]
    fn of(self, row: usize) -> [&'a Each<T>; 2] {
        [&self.rows[row], &self.rows[self.sets + row]]
    }
}

/// The scene's numbers in `T`.
#[derive(Clone, Copy)]
struct Room<T> {
    wall_albedo: T,
    cube_albedo: T,
    radiance: T,
    emission: T,
    half_width: T,
    /// L_e A/π
    power: T,
}

impl<T: Real> Room<T> {
    fn new(room: &BoxRoom, scale: f64) -> Self {
        let scene = room.scene();
        // without a light no ray may hit it: no |coordinate| is below −1
        let half_width = if scene.light_half_width > 0.0 { scene.light_half_width } else { -1.0 };
        Self {
            wall_albedo: T::of(scene.wall_albedo),
            cube_albedo: T::of(scene.cube_albedo),
            radiance: T::of(scene.radiance / scale),
            emission: T::of(scene.emission / scale),
            half_width: T::of(half_width),
            power: T::of(power(room) / scale),
        }
    }

    /// The part of `point`'s radiance that comes from a point of the light, at the fractions (u, v) of its
    /// sides; and whether a ray was needed to test its visibility.
    #[inline(always)]
    fn lit(&self, at: [T; 3], normal: [T; 3], [u, v]: [T; 2]) -> (T, bool) {
        let (zero, one, two) = (T::of(0.0), T::of(1.0), T::of(2.0));
        let [x, y, z] = [
            self.half_width * (two * u - one) - at[0],
            self.half_width * (two * v - one) - at[1],
            T::of(Face::ROOM_HEIGHT) - at[2],
        ];
        let here = normal[0] * x + normal[1] * y + normal[2] * z;
        let faces = (here > zero) & (z > zero);
        let (_, inverse) = inverted([x, y, z]);
        let (enters, leaves, _) = cube(at, inverse);
        let hidden = (enters < leaves) & (leaves > zero) & (enters < one);
        let r2 = x * x + y * y + z * z;
        let sent = self.power * here * z / (r2 * r2);
        (if faces & !hidden { sent } else { zero }, faces)
    }
}

/// The sum of the counts of all lanes.
#[inline(always)]
fn total<T: Real>(counts: Each<T>) -> u64 {
    counts.iter().map(|count| count.to_f64()).sum::<f64>() as u64
}

/// The direction with components near 0 replaced by a tiny one, which moves nothing but has an inverse; and
/// the inverses of all components, with one division.
#[inline(always)]
fn inverted<T: Real>(direction: [T; 3]) -> ([T; 3], [T; 3]) {
    let [x, y, z] = direction.map(|d| if d.abs() < T::FLAT { T::FLAT } else { d });
    let xy = x * y;
    let all = T::of(1.0) / (xy * z);
    ([x, y, z], [y * z * all, x * z * all, xy * all])
}

/// The distances at which a line enters and leaves the cube, and the axis of the face that it enters by. The
/// line hits the cube if it enters before it leaves. Nothing passes under the cube.
#[inline(always)]
fn cube<T: Real>(at: [T; 3], inverse: [T; 3]) -> (T, T, [bool; 3]) {
    let slab = |at: T, inverse: T| {
        let w = T::of(Face::CUBE_HALF_WIDTH);
        let (low, high) = ((-w - at) * inverse, (w - at) * inverse);
        (low.least(high), low.most(high))
    };
    let (x_in, x_out) = slab(at[0], inverse[0]);
    let (y_in, y_out) = slab(at[1], inverse[1]);
    let to_top = (T::of(Face::CUBE_HEIGHT) - at[2]) * inverse[2];
    let down = inverse[2] < T::of(0.0);
    let far = T::of(1e30);
    let (z_in, z_out) = (if down { to_top } else { -far }, if down { far } else { to_top });
    let sides = x_in.most(y_in);
    let top = z_in > sides;
    let across_y = y_in > x_in;
    (sides.most(z_in), x_out.least(y_out).least(z_out), [!top & !across_y, !top & across_y, top])
}

/// Next-event estimation for all paths.
struct Sample<'a, T> {
    room: Room<T>,
    fronts: &'a mut [Front<T>],
    numbers: Numbers<'a, T>,
    /// [`LANES`], hidden from the compiler: otherwise it unrolls the loop before it vectorizes it.
    lanes: usize,
}

impl<T: Real> NullaryFnOnce for Sample<'_, T> {
    /// Number of rays to the light.
    type Output = u64;

    #[inline(always)]
    fn call(self) -> u64 {
        let mut rays = [T::of(0.0); LANES];
        for (row, front) in self.fronts.iter_mut().enumerate() {
            sample(self.room, self.lanes, self.numbers.of(row), front, &mut rays);
        }
        total(rays)
    }
}

/// A light sample for each path of a row.
#[inline(always)]
fn sample<T: Real>(
    room: Room<T>,
    lanes: usize,
    [u, v]: [&Each<T>; 2],
    front: &mut Front<T>,
    rays: &mut Each<T>,
) {
    let (zero, one) = (T::of(0.0), T::of(1.0));
    for lane in 0..lanes.min(LANES) {
        let at = [front.x[lane], front.y[lane], front.z[lane]];
        let normal = [front.normal_x[lane], front.normal_y[lane], front.normal_z[lane]];
        let (sent, ray) = room.lit(at, normal, [u[lane], v[lane]]);
        let reflected = front.throughput[lane] * front.albedo[lane];
        front.light[lane] = front.light[lane] + reflected * sent;
        let counts = ray & (reflected != zero);
        rays[lane] = rays[lane] + if counts { one } else { zero };
    }
}

/// Roulette: multiplies throughputs by f_r cos θ/p(ω), and decides which paths go on.
struct End<'a, T> {
    paths: &'a Paths,
    front: &'a mut Front<T>,
    numbers: Numbers<'a, T>,
    coins: &'a Each<T>,
    lanes: usize,
}

impl<T: Real> NullaryFnOnce for End<'_, T> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let one = T::of(1.0);
        match self.paths.directions {
            Hemisphere::Cosine => self.reflect(|_| one),
            Hemisphere::Uniform => self.reflect(|u| T::of(2.0) * (one - u)),
        }
    }
}

impl<T: Real> End<'_, T> {
    #[inline(always)]
    fn reflect(self, cosine: impl Fn(T) -> T) {
        match self.paths.ending {
            Ending::ByThroughput => self.end(cosine, by_throughput),
            _ => {
                let q = self.paths.goes_on(T::of(1.0));
                self.end(cosine, |_| q);
            }
        }
    }

    #[inline(always)]
    fn end(self, cosine: impl Fn(T) -> T, goes_on: impl Fn(T) -> T) {
        let (front, [u, _]) = (self.front, self.numbers.of(0));
        let mut throughput = front.throughput;
        for lane in 0..self.lanes.min(LANES) {
            let reflected = throughput[lane] * (front.albedo[lane] * cosine(u[lane]));
            let q = goes_on(reflected);
            throughput[lane] = if self.coins[lane] < q { reflected / q } else { T::of(0.0) };
        }
        front.throughput = throughput;
    }
}

/// Traces rays to the next vertices, and adds what those emit.
struct Go<'a, T> {
    room: Room<T>,
    fronts: &'a mut [Front<T>],
    numbers: Numbers<'a, T>,
    lanes: usize,
    directions: Hemisphere,
    /// Whether throughputs are still to be multiplied by f_r cos θ/p(ω).
    reflect: bool,
    /// By the faces and by the light.
    emitted: [T; 2],
}

impl<T: Real> NullaryFnOnce for Go<'_, T> {
    /// Number of paths that go on.
    type Output = u64;

    #[inline(always)]
    fn call(self) -> u64 {
        let (one, two) = (T::of(1.0), T::of(2.0));
        match self.directions {
            Hemisphere::Cosine => self.along(|u| [u.sqrt(), (one - u).sqrt(), one]),
            Hemisphere::Uniform => self.along(|u| [(u * (two - u)).sqrt(), one - u, two * (one - u)]),
        }
    }
}

impl<T: Real> Go<'_, T> {
    /// Directions whose sin θ, cos θ and cos θ/(π p) are computed from a uniform number.
    #[inline(always)]
    fn along(self, of_theta: impl Fn(T) -> [T; 3]) -> u64 {
        let mut alive = [T::of(0.0); LANES];
        for (row, front) in self.fronts.iter_mut().enumerate() {
            let step =
                Step { room: self.room, emitted: self.emitted, lanes: self.lanes, reflect: self.reflect };
            step.go(&of_theta, self.numbers.of(row), front, &mut alive);
        }
        total(alive)
    }
}

/// One step of a row of paths.
struct Step<T> {
    room: Room<T>,
    emitted: [T; 2],
    lanes: usize,
    reflect: bool,
}

impl<T: Real> Step<T> {
    /// Moves all paths to their next vertices.
    #[inline(always)]
    fn go(
        &self,
        of_theta: &impl Fn(T) -> [T; 3],
        [u, v]: [&Each<T>; 2],
        front: &mut Front<T>,
        alive: &mut Each<T>,
    ) {
        let Self { room, emitted, lanes, reflect } = *self;
        let Front { x, y, z, normal_x, normal_y, normal_z, albedo, throughput, light } = front;
        let (zero, one) = (T::of(0.0), T::of(1.0));
        let [wall, cube_wall] = [T::of(Face::ROOM_HALF_WIDTH), T::of(Face::CUBE_HALF_WIDTH)];
        let [height, cube_height] = [T::of(Face::ROOM_HEIGHT), T::of(Face::CUBE_HEIGHT)];
        // two loops rather than one: the processor then overlaps several steps of each
        let (mut way_x, mut way_y, mut way_z) = ([zero; LANES], [zero; LANES], [zero; LANES]);
        for lane in 0..lanes.min(LANES) {
            let normal = [normal_x[lane], normal_y[lane], normal_z[lane]];
            // the direction in the face's own frame, and in the room
            let [sin_theta, cos_theta, cosine] = of_theta(u[lane]);
            throughput[lane] = throughput[lane] * if reflect { albedo[lane] * cosine } else { one };
            let (sin_phi, cos_phi) = v[lane].sin_cos_of_turns();
            let (one_way, other_way) = (sin_theta * cos_phi, sin_theta * sin_phi);
            let [across_x, across_y, across_z] = normal.map(|n| n != zero);
            let dx = if across_x { normal[0] * cos_theta } else { one_way };
            let dy = if across_x { one_way } else { other_way };
            let dy = if across_y { normal[1] * cos_theta } else { dy };
            let dz = if across_z { normal[2] * cos_theta } else { other_way };
            way_x[lane] = dx;
            way_y[lane] = dy;
            way_z[lane] = dz;
        }
        for lane in 0..lanes.min(LANES) {
            let at = [x[lane], y[lane], z[lane]];
            let ([dx, dy, dz], inverse) = inverted([way_x[lane], way_y[lane], way_z[lane]]);
            // distances to the room's planes
            let [ahead_x, ahead_y, ahead_z] = [dx, dy, dz].map(|d| d > zero);
            let to_x = ((if ahead_x { wall } else { -wall }) - at[0]) * inverse[0];
            let to_y = ((if ahead_y { wall } else { -wall }) - at[1]) * inverse[1];
            let to_z = ((if ahead_z { height } else { zero }) - at[2]) * inverse[2];
            let to_side = to_x.least(to_y);
            let to_wall = to_side.least(to_z);
            let on_z = to_z < to_side;
            let on_y = to_y < to_x;
            let (enters, leaves, on) = cube(at, inverse);
            let is_cube = (enters < leaves) & (leaves > zero) & (enters <= to_wall);
            let distance = if is_cube { enters.most(zero) } else { to_wall };
            let hit_x = if is_cube { on[0] } else { !on_z & !on_y };
            let hit_y = if is_cube { on[1] } else { !on_z & on_y };
            let hit_z = if is_cube { on[2] } else { on_z };
            let against = |hit: bool, ahead: bool| {
                let normal = if ahead { -one } else { one };
                if hit { normal } else { zero }
            };
            let n = [against(hit_x, ahead_x), against(hit_y, ahead_y), against(hit_z, ahead_z)];
            // on its face exactly, and within it
            let w = if is_cube { cube_wall } else { wall };
            let top = if is_cube { cube_height } else { height };
            let outwards = if is_cube { w } else { -w };
            let put = |hit: bool, normal: T, at: T| {
                if hit { normal * outwards } else { at.most(-w).least(w) }
            };
            let new_x = put(hit_x, n[0], at[0] + dx * distance);
            let new_y = put(hit_y, n[1], at[1] + dy * distance);
            let within = (at[2] + dz * distance).most(zero).least(top);
            let upper = is_cube | ahead_z;
            let new_z = if hit_z { if upper { top } else { zero } } else { within };
            let half = room.half_width;
            let on_ceiling = hit_z & ahead_z;
            let is_light = on_ceiling & (new_x.abs() <= half) & (new_y.abs() <= half);
            let of_face = if is_cube { room.cube_albedo } else { room.wall_albedo };
            albedo[lane] = if is_light { zero } else { of_face };
            let emitted = if is_light { emitted[1] } else { emitted[0] };
            light[lane] = light[lane] + throughput[lane] * emitted;
            x[lane] = new_x;
            y[lane] = new_y;
            z[lane] = new_z;
            normal_x[lane] = n[0];
            normal_y[lane] = n[1];
            normal_z[lane] = n[2];
            alive[lane] = alive[lane] + if throughput[lane] != zero { one } else { zero };
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::estimator::Estimator;
    use crate::fast::tests::both;
    use crate::paths::Bounces;
    use crate::paths::FindLight;
    use crate::paths::room::Scene;
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
                    if paths.most_bounces() <= 3 {
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

    /// Every draw is filled, for any number of draws, and with a path of its own: there are as many different
    /// ones as expected.
    #[test]
    fn any_number_of_draws_is_filled() {
        let room = BoxRoom::new(Scene { emission: 0.3, ..Scene::default() }).unwrap();
        for bounces in [Bounces::UpTo(3), Bounces::All(0.5), Bounces::AllByThroughput] {
            let paths = Paths::new(room, bounces, Hemisphere::Uniform, FindLight::BySampling).unwrap();
            for count in [0, 1, 31, 32, 33, 255, 256, 257, 1000] {
                let mut draws = vec![f64::NAN; count];
                paths.fill(&mut Stream::new(9, count as u64), &mut draws);
                assert!(draws.iter().all(|draw| *draw > 0.3), "{bounces:?}, {count}");
                draws.sort_by(f64::total_cmp);
                draws.dedup();
                assert_eq!(draws.len(), count, "{bounces:?}");
            }
        }
    }
}
