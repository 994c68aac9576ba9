//! Many paths side by side, each a lane of a vector: the loop of [`Paths::walk`] with selections in place of branches.
//!
//! Faces are not told apart one by one. A ray ends on a plane across one axis, where the normal is three numbers, one of them ±1 against the ray and the
//! others 0, and the coordinate on that axis is set exactly, as in the plain loop. A path that has ended goes on with weight 0, until so many have that it pays to move
//! the others together.

use pulp::NullaryFnOnce;

use super::{Ending, Paths, power};
use crate::box_room::{BoxRoom, Face};
use crate::fast::{Real, widest};
use crate::hemisphere::Hemisphere;
use crate::stream::Stream;

/// Paths in a row: as many as fill the widest vectors several times, since the steps of one depend on each other.
const LANES: usize = 32;

/// As many rows as the first-level cache holds with their random numbers.
const ROWS: usize = 8;

/// A number for each path of a row.
type Each<T> = [T; LANES];

/// Of each path of a row its position and the normal there, the albedo, its weight, and the light that it has found.
type Row<T> = [Each<T>; 9];

/// The places of weight and light.
const WEIGHT: usize = 7;
const LIGHT: usize = 8;

/// Fills `draws` with the light of a path each, computed in `T`.
pub(super) fn fill<T: Real>(paths: &Paths, rng: &mut Stream, draws: &mut [f64]) {
    let walk = Walk::<T>::new(paths);
    if paths.ending == Ending::Never {
        for some in draws.chunks_mut(LANES * ROWS) {
            walk.together(rng, some);
        }
    } else {
        walk.one_after_another(rng, draws);
    }
}

/// How paths go.
struct Walk<'a, T> {
    paths: &'a Paths,
    room: Room<T>,
    /// A row of paths that begin.
    start: Row<T>,
    /// Whether the light is found by sampling it.
    sampled: bool,
    /// The most rays of a path.
    last: u32,
    /// What all light is divided by on the way: [`Paths::scale`].
    scale: f64,
}

impl<'a, T: Real> Walk<'a, T> {
    fn new(paths: &'a Paths) -> Self {
        let start = paths.room.point();
        let (at, normal) = (start.position(), start.normal());
        let [fewest, most] = paths.counted;
        let emitted = if fewest == 0 { paths.room.emitted(&start) } else { 0.0 };
        let albedo = paths.room.albedo(&start);
        let scene = paths.room.scene();
        let (sampled, scale) = (paths.samples_light(), paths.scale());
        Self {
            paths,
            room: Room::new(&paths.room, scale),
            start: [at.x, at.y, at.z, normal.x, normal.y, normal.z, albedo, 1.0, emitted / scale]
                .map(|number| [T::of(number); LANES]),
            sampled,
            // as in the plain loop: nothing is left to be found after the last sample but what the faces emit
            last: if sampled && scene.emission == 0.0 { most.saturating_sub(1) } else { most },
            scale,
        }
    }

    /// Paths that all have the same number of bounces.
    fn together(&self, rng: &mut Stream, draws: &mut [f64]) {
        let mut rows = [self.start; ROWS];
        let mut numbers = [[[T::of(0.0); LANES]; 2]; ROWS];
        let used = draws.len().div_ceil(LANES);
        if let (Some(rows), Some(numbers)) = (rows.get_mut(..used), numbers.get_mut(..used)) {
            if let Some(row) = rows.last_mut() {
                // lanes beyond the last path
                let unused = used * LANES - draws.len();
                row[WEIGHT].iter_mut().rev().take(unused).for_each(|weight| *weight = T::of(0.0));
            }
            let [fewest, most] = self.paths.counted;
            for bounces in 0..most {
                if self.sampled && bounces + 1 >= fewest {
                    self.sample(rows, numbers, rng);
                }
                if bounces >= self.last {
                    break;
                }
                self.go(rows, numbers, bounces + 1 >= fewest, rng);
            }
        }
        let light = rows.iter().flat_map(|row| &row[LIGHT]);
        for (draw, light) in draws.iter_mut().zip(light) {
            *draw = light.to_f64() * self.scale;
        }
    }

    /// Paths that roulette ends: where one has ended the next begins.
    fn one_after_another(&self, rng: &mut Stream, draws: &mut [f64]) {
        let mut rows = [self.start];
        let mut numbers = [[[T::of(0.0); LANES]; 2]];
        let mut coins = [T::of(0.0); LANES];
        let mut draws = draws.iter_mut();
        let mut own = [const { None }; LANES];
        for (own, weight) in own.iter_mut().zip(&mut rows[0][WEIGHT]) {
            *own = draws.next();
            if own.is_none() {
                *weight = T::of(0.0);
            }
        }
        let mut under_way = own.iter().flatten().count();
        while under_way > 0 {
            if self.sampled {
                self.sample(&mut rows, &mut numbers, rng);
            }
            T::fill(&mut coins, rng);
            self.go_on(&mut rows, &mut numbers, &coins, rng);
            let [row] = &mut rows;
            for lane in 0..LANES {
                if row[WEIGHT][lane] == T::of(0.0)
                    && let Some(draw) = own[lane].take()
                {
                    *draw = row[LIGHT][lane].to_f64() * self.scale;
                    own[lane] = draws.next();
                    if own[lane].is_some() {
                        for (numbers, start) in row.iter_mut().zip(&self.start) {
                            numbers[lane] = start[lane];
                        }
                    } else {
                        under_way -= 1;
                    }
                }
            }
        }
    }
}

impl<T: Real> Walk<'_, T> {
    /// Adds a sample of the light at every path's vertex.
    fn sample(&self, rows: &mut [Row<T>], pairs: &mut [[Each<T>; 2]], rng: &mut Stream) {
        T::fill(pairs.as_flattened_mut().as_flattened_mut(), rng);
        rng.count_evaluations(widest(Sample { room: self.room, rows, pairs, lanes: LANES }));
    }

    /// Follows every path to its next vertex, whose own light counts if `counted`.
    fn go(&self, rows: &mut [Row<T>], pairs: &mut [[Each<T>; 2]], counted: bool, rng: &mut Stream) {
        T::fill(pairs.as_flattened_mut().as_flattened_mut(), rng);
        self.trace(rows, pairs, true, counted, rng);
    }

    /// The same for the paths that roulette lets go on.
    fn go_on(
        &self,
        rows: &mut [Row<T>; 1],
        pairs: &mut [[Each<T>; 2]; 1],
        coins: &Each<T>,
        rng: &mut Stream,
    ) {
        T::fill(pairs.as_flattened_mut().as_flattened_mut(), rng);
        let directions = self.paths.directions;
        widest(Weigh { rows, pairs, lanes: LANES, directions });
        let [row] = &mut *rows;
        let q = match self.paths.ending {
            // a q below `T`'s range is on the grid's first point, too
            Ending::Roulette(roulette) => Some(on_the_grid(T::of(roulette.p_rr()).most(T::STEP))),
            _ => None,
        };
        widest(End { weight: &mut row[WEIGHT], coins, q, lanes: LANES });
        self.trace(rows, pairs, false, true, rng);
    }

    fn trace(
        &self,
        rows: &mut [Row<T>],
        pairs: &[[Each<T>; 2]],
        weigh: bool,
        counted: bool,
        rng: &mut Stream,
    ) {
        let room = self.room;
        let of_faces = if counted { room.emission } else { T::of(0.0) };
        let of_light = if counted && !self.sampled { room.radiance } else { T::of(0.0) };
        let (directions, emitted) = (self.paths.directions, [of_faces, of_light]);
        rng.count_evaluations(widest(Go { room, rows, pairs, lanes: LANES, directions, weigh, emitted }));
    }
}

/// The scene's numbers.
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
        // without a light none is met: no coordinate is below −1
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

    /// The part of `point`'s radiance that a point of the light, at the fractions (u, v) of it, sends by way of this vertex, and whether a ray was needed to see it.
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

/// The sum of what was counted in each lane.
#[inline(always)]
fn total<T: Real>(counts: Each<T>) -> u64 {
    counts.iter().map(|count| count.to_f64()).sum::<f64>() as u64
}

/// A direction without a component that is 0, or nearly, which moves nothing but would have no inverse; and the inverses of its components, by one division.
#[inline(always)]
fn inverted<T: Real>(direction: [T; 3]) -> ([T; 3], [T; 3]) {
    let [x, y, z] = direction.map(|d| if d.abs() < T::FLAT { T::FLAT } else { d });
    let xy = x * y;
    let all = T::of(1.0) / (xy * z);
    ([x, y, z], [y * z * all, x * z * all, xy * all])
}

/// Where a line enters the cube and where it leaves it, and the axis across which it enters; it meets the cube where it enters before it leaves. Nothing passes under it.
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

/// Light that is sampled.
struct Sample<'a, T> {
    room: Room<T>,
    rows: &'a mut [Row<T>],
    pairs: &'a [[Each<T>; 2]],
    /// [`LANES`], which the compiler must not know, or it would unroll a loop before it looks whether it goes wide.
    lanes: usize,
}

impl<T: Real> NullaryFnOnce for Sample<'_, T> {
    /// Rays to the light.
    type Output = u64;

    #[inline(always)]
    fn call(self) -> u64 {
        let mut rays = [T::of(0.0); LANES];
        for (row, [u, v]) in self.rows.iter_mut().zip(self.pairs) {
            let [x, y, z, normal_x, normal_y, normal_z, albedo, weight, light] = row;
            let (at, normal) = ([&*x, y, z], [&*normal_x, normal_y, normal_z]);
            sample(self.room, self.lanes, u, v, at, normal, albedo, weight, light, &mut rays);
        }
        total(rays)
    }
}

/// A sample of the light for each path of a row.
#[allow(clippy::too_many_arguments)]
#[inline(always)]
fn sample<T: Real>(
    room: Room<T>,
    lanes: usize,
    u: &Each<T>,
    v: &Each<T>,
    [x, y, z]: [&Each<T>; 3],
    [normal_x, normal_y, normal_z]: [&Each<T>; 3],
    albedo: &Each<T>,
    weight: &Each<T>,
    light: &mut Each<T>,
    rays: &mut Each<T>,
) {
    let (zero, one) = (T::of(0.0), T::of(1.0));
    for lane in 0..lanes.min(LANES) {
        let at = [x[lane], y[lane], z[lane]];
        let normal = [normal_x[lane], normal_y[lane], normal_z[lane]];
        let (sent, ray) = room.lit(at, normal, [u[lane], v[lane]]);
        let reflected = weight[lane] * albedo[lane];
        light[lane] = light[lane] + reflected * sent;
        let counts = ray & (reflected != zero);
        rays[lane] = rays[lane] + if counts { one } else { zero };
    }
}

/// Weights times f_r cos θ/p(ω).
struct Weigh<'a, T> {
    rows: &'a mut [Row<T>],
    pairs: &'a [[Each<T>; 2]],
    lanes: usize,
    directions: Hemisphere,
}

impl<T: Real> NullaryFnOnce for Weigh<'_, T> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        for (row, [u, _]) in self.rows.iter_mut().zip(self.pairs) {
            let [.., albedo, mut weight, _] = *row;
            for lane in 0..self.lanes.min(LANES) {
                let cosine = match self.directions {
                    Hemisphere::Cosine => T::of(1.0),
                    Hemisphere::Uniform => T::of(2.0) * (T::of(1.0) - u[lane]),
                };
                weight[lane] = weight[lane] * (albedo[lane] * cosine);
            }
            row[WEIGHT] = weight;
        }
    }
}

/// Roulette. A probability of going on is rounded up to the grid of the uniform numbers, on which it is kept exactly, and the weight divided by what it became: no
/// second number is ever needed, and the mean is exact.
struct End<'a, T> {
    weight: &'a mut Each<T>,
    coins: &'a Each<T>,
    /// The probability of going on, if it is not the weight.
    q: Option<T>,
    lanes: usize,
}

impl<T: Real> NullaryFnOnce for End<'_, T> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let (zero, one) = (T::of(0.0), T::of(1.0));
        let (mut weight, coins) = (*self.weight, *self.coins);
        if let Some(q) = self.q {
            for lane in 0..self.lanes.min(LANES) {
                weight[lane] = if coins[lane] < q { weight[lane] / q } else { zero };
            }
        } else {
            for lane in 0..self.lanes.min(LANES) {
                let q = if weight[lane] < one { on_the_grid(weight[lane]) } else { one };
                weight[lane] = if coins[lane] < q { weight[lane] / q } else { zero };
            }
        }
        *self.weight = weight;
    }
}

/// A probability rounded up to the grid of the uniform numbers.
#[inline(always)]
fn on_the_grid<T: Real>(p: T) -> T {
    (p / T::STEP).ceil() * T::STEP
}

/// Rays to the next vertices, and what those emit.
struct Go<'a, T> {
    room: Room<T>,
    rows: &'a mut [Row<T>],
    pairs: &'a [[Each<T>; 2]],
    lanes: usize,
    directions: Hemisphere,
    /// Whether weights are still to be multiplied by f_r cos θ/p(ω).
    weigh: bool,
    /// By the faces and by the light.
    emitted: [T; 2],
}

impl<T: Real> NullaryFnOnce for Go<'_, T> {
    /// Paths that are under way.
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
    /// Along directions whose sin θ, cos θ and cos θ/(π p) come from a uniform number.
    #[inline(always)]
    fn along(self, of_theta: impl Fn(T) -> [T; 3]) -> u64 {
        let mut alive = [T::of(0.0); LANES];
        for (row, [u, v]) in self.rows.iter_mut().zip(self.pairs) {
            let [x, y, z, normal_x, normal_y, normal_z, albedo, weight, light] = row;
            let at = (x, y, z, normal_x, normal_y, normal_z);
            let Self { room, lanes, emitted, weigh, .. } = self;
            go(
                room, emitted, lanes, &of_theta, weigh, u, v, at.0, at.1, at.2, at.3, at.4, at.5, albedo,
                weight, light, &mut alive,
            );
        }
        total(alive)
    }
}

/// The paths of a row to their next vertices. Each array is an argument of its own, so that the compiler knows them apart.
#[allow(clippy::too_many_arguments)]
#[inline(always)]
fn go<T: Real>(
    room: Room<T>,
    emitted: [T; 2],
    lanes: usize,
    of_theta: &impl Fn(T) -> [T; 3],
    weigh: bool,
    u: &Each<T>,
    v: &Each<T>,
    x: &mut Each<T>,
    y: &mut Each<T>,
    z: &mut Each<T>,
    normal_x: &mut Each<T>,
    normal_y: &mut Each<T>,
    normal_z: &mut Each<T>,
    albedo: &mut Each<T>,
    weight: &mut Each<T>,
    light: &mut Each<T>,
    alive: &mut Each<T>,
) {
    let (zero, one) = (T::of(0.0), T::of(1.0));
    let [wall, cube_wall] = [T::of(Face::ROOM_HALF_WIDTH), T::of(Face::CUBE_HALF_WIDTH)];
    let [height, cube_height] = [T::of(Face::ROOM_HEIGHT), T::of(Face::CUBE_HEIGHT)];
    // two loops rather than one: a processor then works on several steps of each at a time
    let (mut way_x, mut way_y, mut way_z) = ([zero; LANES], [zero; LANES], [zero; LANES]);
    for lane in 0..lanes.min(LANES) {
        let normal = [normal_x[lane], normal_y[lane], normal_z[lane]];
        // the direction in the face's own frame, and in the room
        let [sin_theta, cos_theta, cosine] = of_theta(u[lane]);
        weight[lane] = weight[lane] * if weigh { albedo[lane] * cosine } else { one };
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
        // how far the room's planes are
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
        light[lane] = light[lane] + weight[lane] * emitted;
        x[lane] = new_x;
        y[lane] = new_y;
        z[lane] = new_z;
        normal_x[lane] = n[0];
        normal_y[lane] = n[1];
        normal_z[lane] = n[2];
        alive[lane] = alive[lane] + if weight[lane] != zero { one } else { zero };
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::box_room::Scene;
    use crate::fast::tests::both;
    use crate::paths::Bounces;
    use crate::paths::FindLight;
    use crate::run::Estimator;

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
        for bounces in bounces.chain([Bounces::All(0.6), Bounces::AllByWeight]) {
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

    /// The random numbers of one lane, in the order in which the plain loop takes them.
    fn of_lane(paths: &Paths, uniforms: &[f64], lane: usize) -> Vec<f64> {
        let walk = Walk::<f64>::new(paths);
        let mut taken = Vec::new();
        let mut rows = uniforms.chunks_exact(LANES).map(|row| row[lane]);
        for bounces in 0..paths.most_bounces() {
            if walk.sampled && bounces + 1 >= paths.counted[0] {
                taken.extend(rows.by_ref().take(2));
            }
            if bounces >= walk.last {
                break;
            }
            taken.extend(rows.by_ref().take(2));
        }
        taken
    }

    /// Lane by lane the same light from the same uniform numbers as the plain loop, to rounding. A ray within 1e-14 of an edge may end on the other side of it,
    /// which by the lengths of the edges happens to fewer than one path in 1e12 here.
    #[test]
    fn every_lane_is_a_path_of_the_plain_loop() {
        let (mut lit, mut seed) = (0, 0);
        every_way(|paths| {
            if paths.ending != Ending::Never {
                return;
            }
            seed += 1;
            let mut uniforms = vec![0.0; 70 * LANES];
            Stream::new(seed, 0).fill_uniform(&mut uniforms);
            let mut filled = [0.0; LANES];
            let mut rng = Stream::scripted(&uniforms);
            paths.fill(&mut rng, &mut filled);
            let mut rays = 0;
            for (lane, light) in filled.into_iter().enumerate() {
                let mut one = Stream::scripted(&of_lane(&paths, &uniforms, lane));
                let plain = paths.draw(&mut one);
                rays += one.evaluations();
                assert!((light - plain).abs() <= 1e-12 * plain, "{light} and {plain} by {paths:?}");
                lit += u32::from(light > 0.0);
            }
            assert_eq!(rng.evaluations(), rays, "{paths:?}");
        });
        assert!(lit > 1000, "{lit} paths found light");
    }

    /// The same bits with vectors of any width, and without: what this processor gives is what every other gives.
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

    /// Every draw is filled, whatever their number, and with a path of its own: as many different ones as there should be.
    #[test]
    fn any_number_of_draws_is_filled() {
        let room = BoxRoom::new(Scene { emission: 0.3, ..Scene::default() }).unwrap();
        for bounces in [Bounces::UpTo(3), Bounces::All(0.5), Bounces::AllByWeight] {
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
