//! The steps of many paths: a light sample, roulette, and a ray to the next vertex.
//!
//! Faces have no index here. A ray ends on a plane across one axis: one component of the normal is ±1,
//! against the ray, and the others are 0. The coordinate on that axis is set exactly, as in the plain loop.

use pulp::NullaryFnOnce;

use super::{Each, Front};
use crate::fast::Real;
use crate::lambertian::hemisphere::Hemisphere;
use crate::paths::room::{BoxRoom, Face};
use crate::paths::{Ending, Paths, by_throughput, power};
use crate::stream::LANES;

/// The random numbers of a step: two rows for each row of paths.
#[derive(Clone, Copy)]
pub(super) struct Numbers<'a, T> {
    pub(super) rows: &'a [Each<T>],
    pub(super) sets: usize,
}

impl<'a, T: Real> Numbers<'a, T> {
    #[inline(always)]
    fn of(self, row: usize) -> [&'a Each<T>; 2] {
        [&self.rows[row], &self.rows[self.sets + row]]
    }
}

/// The scene's numbers in `T`.
#[derive(Clone, Copy)]
pub(super) struct Room<T> {
    wall_albedo: T,
    cube_albedo: T,
    pub(super) radiance: T,
    pub(super) emission: T,
    half_width: T,
    /// L_e A/π
    power: T,
}

impl<T: Real> Room<T> {
    pub(super) fn new(room: &BoxRoom, scale: f64) -> Self {
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
pub(super) struct Sample<'a, T> {
    pub(super) room: Room<T>,
    pub(super) fronts: &'a mut [Front<T>],
    pub(super) numbers: Numbers<'a, T>,
    /// [`LANES`], hidden from the compiler: otherwise it unrolls the loop before it vectorizes it.
    pub(super) lanes: usize,
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
        let [at, normal] = [&front.at, &front.normal].map(|[x, y, z]| [x[lane], y[lane], z[lane]]);
        let (sent, ray) = room.lit(at, normal, [u[lane], v[lane]]);
        let reflected = front.throughput[lane] * front.albedo[lane];
        front.light[lane] = front.light[lane] + reflected * sent;
        let counts = ray & (reflected != zero);
        rays[lane] = rays[lane] + if counts { one } else { zero };
    }
}

/// Roulette: multiplies throughputs by f_r cos θ/p(ω), and decides which paths go on.
pub(super) struct End<'a, T> {
    pub(super) paths: &'a Paths,
    pub(super) front: &'a mut Front<T>,
    pub(super) u: &'a Each<T>,
    pub(super) coins: &'a Each<T>,
    pub(super) lanes: usize,
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
        let Self { front, u, coins, lanes, .. } = self;
        let mut throughput = front.throughput;
        for lane in 0..lanes.min(LANES) {
            let reflected = throughput[lane] * (front.albedo[lane] * cosine(u[lane]));
            let q = goes_on(reflected);
            throughput[lane] = if coins[lane] < q { reflected / q } else { T::of(0.0) };
        }
        front.throughput = throughput;
    }
}

/// Traces rays to the next vertices, and adds what those emit.
pub(super) struct Go<'a, T> {
    pub(super) step: Step<T>,
    pub(super) fronts: &'a mut [Front<T>],
    pub(super) numbers: Numbers<'a, T>,
    pub(super) directions: Hemisphere,
}

/// What is the same for all rows of a step.
#[derive(Clone, Copy)]
pub(super) struct Step<T> {
    pub(super) room: Room<T>,
    /// By the faces and by the light.
    pub(super) emitted: [T; 2],
    pub(super) lanes: usize,
    /// Whether throughputs are still to be multiplied by f_r cos θ/p(ω).
    pub(super) reflect: bool,
}

impl<T: Real> NullaryFnOnce for Go<'_, T> {
    /// Number of paths that go on.
    type Output = u64;

    #[inline(always)]
    fn call(self) -> u64 {
        let (one, two) = (T::of(1.0), T::of(2.0));
        // sin θ, cos θ and cos θ/(π p), computed from a uniform number
        match self.directions {
            Hemisphere::Cosine => self.along(|u| [u.sqrt(), (one - u).sqrt(), one]),
            Hemisphere::Uniform => self.along(|u| [(u * (two - u)).sqrt(), one - u, two * (one - u)]),
        }
    }
}

impl<T: Real> Go<'_, T> {
    #[inline(always)]
    fn along(self, of_theta: impl Fn(T) -> [T; 3]) -> u64 {
        let mut alive = [T::of(0.0); LANES];
        for (row, front) in self.fronts.iter_mut().enumerate() {
            self.step.go(&of_theta, self.numbers.of(row), front, &mut alive);
        }
        total(alive)
    }
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
        let Front { at: [x, y, z], normal: [normal_x, normal_y, normal_z], albedo, throughput, light } =
            front;
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
