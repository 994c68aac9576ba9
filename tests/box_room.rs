//! Section 4's room: rays, visibility and form factors against slower, plainer computations of the same,
//! special rays one by one, and a great many that bounce about in the closed room.
//!
//! No test here has a false alarm, but for one comparison with a million random directions (3e-15):
//! everything else is compared to rounding.

mod common;

use common::{gauss, howell_parallel, howell_perpendicular};
use std::f64::consts::{FRAC_1_PI, FRAC_1_SQRT_2, PI};

use glam::DVec3;
use proptest::prelude::*;
use rand::distr::Distribution;
use rayon::prelude::*;
use unbiased::lambertian::hemisphere::{Direction, Hemisphere};
use unbiased::paths::room::{BoxRoom, Face, Scene, Vertex, form_factor, nearest_hit, visible};
use unbiased::{Stream, from_fn};

// ---- points and rays by plainer means
// ------------------------------------------------------------------------------

/// A point on the face, uniformly.
fn point_on(face: Face, rng: &mut Stream) -> Vertex {
    loop {
        let [low, high] = face.bounds();
        let u = DVec3::new(rng.uniform(), rng.uniform(), rng.uniform());
        // low + 0·u is low exactly
        if let Ok(vertex) = Vertex::at((low + (high - low) * u).to_array())
            && vertex.face() == face
        {
            return vertex;
        }
    }
}

fn any_point(rng: &mut Stream) -> Vertex {
    let face = Face::ALL[(rng.uniform() * 11.0) as usize];
    point_on(face, rng)
}

fn any_direction(rng: &mut Stream) -> DVec3 {
    let (z, phi) = (2.0 * rng.uniform() - 1.0, 2.0 * PI * rng.uniform());
    let sin = (1.0 - z * z).sqrt();
    DVec3::new(sin * phi.cos(), sin * phi.sin(), z)
}

/// Where the ray meets the plane of `face` within its bounds: the distance in units of `direction`, the
/// point, and how far inside the bounds it is. Every rectangle of the room by itself: no slabs, and nothing
/// is known of which of them belong together.
fn meets(face: Face, origin: DVec3, direction: DVec3) -> Option<(f64, DVec3, f64)> {
    let ([low, high], n) = (face.bounds(), face.normal());
    let speed = n.dot(direction);
    if speed == 0.0 {
        return None;
    }
    let distance = n.dot(low - origin) / speed;
    let at = origin + direction * distance;
    let inside = (0..3)
        .filter(|&axis| n[axis] == 0.0)
        .map(|axis| (at[axis] - low[axis]).min(high[axis] - at[axis]))
        .fold(f64::INFINITY, f64::min);
    (inside >= 0.0).then_some((distance, at, inside))
}

/// The first face that looks towards the ray, and how far inside it the ray ends; all eleven are asked.
fn slow_hit(from: &Vertex, direction: DVec3) -> Option<(Face, DVec3, f64)> {
    Face::ALL
        .into_iter()
        .filter(|face| face.normal().dot(direction) < 0.0)
        .filter_map(|face| {
            meets(face, from.position(), direction).map(|(t, at, inside)| (face, t, at, inside))
        })
        .filter(|(_, t, ..)| *t > -1e-12)
        .min_by(|a, b| a.1.total_cmp(&b.1))
        .map(|(face, _, at, inside)| (face, at, inside))
}

/// Whether the open segment crosses no side of the cube, seen from either side, and leaves a cube's face
/// outwards at both ends.
fn slow_visible(a: &Vertex, b: &Vertex) -> bool {
    let way = b.position() - a.position();
    let into = |vertex: &Vertex, way: DVec3| vertex.face().is_cube() && vertex.normal().dot(way) < 0.0;
    let crosses =
        |face: &Face| meets(*face, a.position(), way).is_some_and(|(t, ..)| t > 1e-12 && t < 1.0 - 1e-12);
    !into(a, way) && !into(b, -way) && !Face::ALL.iter().filter(|face| face.is_cube()).any(crosses)
}

/// Whether a vertex is where its face is, exactly.
fn on_its_face(vertex: &Vertex) -> bool {
    let ([low, high], at) = (vertex.face().bounds(), vertex.position());
    let under = vertex.face() == Face::Floor && at.x.abs().max(at.y.abs()) < 0.5 - 1e-15;
    at.cmpge(low).all() && at.cmple(high).all() && !under
}

// ---- rays
// ----------------------------------------------------------------------------------------------------------

#[test]
fn rays_end_where_eleven_rectangles_say() {
    let near_an_edge: u32 = (0..64u64)
        .into_par_iter()
        .map(|block| {
            let mut rng = Stream::new(common::seed(400), block);
            let mut skipped = 0;
            for _ in 0..20_000 {
                let from = any_point(&mut rng);
                let direction = any_direction(&mut rng);
                let hit = nearest_hit(&from, direction);
                if from.normal().dot(direction) < 0.0 {
                    assert_eq!(hit, None);
                    continue;
                }
                let hit = hit.unwrap();
                assert!(on_its_face(&hit) && hit.face() != from.face(), "{from:?} {direction} {hit:?}");
                let (face, at, inside) = slow_hit(&from, direction).unwrap();
                if inside < 1e-9 {
                    skipped += 1;
                    continue;
                }
                let close = hit.position().distance(at) <= 1e-13;
                assert!(hit.face() == face && close, "{from:?} {direction}: {hit:?}, not {face:?} at {at}");
            }
            skipped
        })
        .sum();
    assert!(near_an_edge <= 3, "{near_an_edge}"); // of 1.3 million, each with less than 1e-8
}

#[test]
fn the_length_of_a_direction_makes_no_difference() {
    let mut rng = Stream::new(common::seed(401), 0);
    for _ in 0..2_000 {
        let (from, direction) = (any_point(&mut rng), any_direction(&mut rng));
        let Some(hit) = nearest_hit(&from, direction) else { continue };
        for length in [2f64.powi(-1000), 2f64.powi(-400), 0.3, 7.0, 1e200, 2f64.powi(1023)] {
            let again = nearest_hit(&from, direction * length).unwrap();
            assert_eq!(again.face(), hit.face());
            assert!(again.position().distance(hit.position()) <= 1e-13);
        }
    }
    // 2⁻¹⁰⁷⁴ times (1, 0, 1)
    let p = Vertex::at([0.0, 0.0, 1.0]).unwrap();
    let hit = nearest_hit(&p, DVec3::new(5e-324, 0.0, 5e-324)).unwrap();
    assert_eq!((hit.face(), hit.position()), (Face::East, DVec3::new(2.0, 0.0, 3.0)));
}

/// From, direction, and the end with the faces that it may be on.
type Special = ([f64; 3], [f64; 3], [f64; 3], &'static [Face]);

const H: f64 = FRAC_1_SQRT_2;

#[test]
fn special_rays_end_as_documented() {
    use Face::*;
    let cases: [Special; 34] = [
        // along a face of the room, to the wall ahead
        ([2.0, 0.3, 3.0], [0.0, 1.0, 0.0], [2.0, 2.0, 3.0], &[North]),
        ([2.0, 0.3, 3.0], [0.0, 0.0, -1.0], [2.0, 0.3, 0.0], &[Floor]),
        ([1.0, 0.3, 4.0], [-1.0, 0.0, 0.0], [-2.0, 0.3, 4.0], &[West]),
        ([1.0, 1.3, 0.0], [-1.0, 0.0, 0.0], [-2.0, 1.3, 0.0], &[West]),
        // along the floor to the cube
        ([1.0, 0.3, 0.0], [-1.0, 0.0, 0.0], [0.5, 0.3, 0.0], &[CubeEast]),
        ([0.25, -2.0, 0.0], [0.0, 1.0, 0.0], [0.25, -0.5, 0.0], &[CubeSouth]),
        ([-1.25, 0.0, 0.0], [1.0, 0.0, 0.0], [-0.5, 0.0, 0.0], &[CubeWest]),
        ([-1.25, 0.5, 0.0], [1.0, 0.0, 0.0], [2.0, 0.5, 0.0], &[East]), // touches its side
        // along a face of the cube it passes
        ([0.1, 0.2, 1.0], [1.0, 0.0, 0.0], [2.0, 0.2, 1.0], &[East]),
        ([0.5, 0.2, 0.25], [0.0, 0.0, 1.0], [0.5, 0.2, 4.0], &[Ceiling]),
        ([0.5, 0.2, 0.25], [0.0, 0.0, -1.0], [0.5, 0.2, 0.0], &[Floor]),
        ([0.5, 0.2, 0.25], [0.0, -1.0, 0.0], [0.5, -2.0, 0.25], &[South]),
        ([-2.0, 0.2, 1.0], [1.0, 0.0, 0.0], [2.0, 0.2, 1.0], &[East]), // along its top from a wall
        ([-2.0, 0.5, 0.5], [1.0, 0.0, 0.0], [2.0, 0.5, 0.5], &[East]),
        ([-0.5, -2.0, 0.5], [0.0, 1.0, 0.0], [-0.5, 2.0, 0.5], &[North]),
        ([0.5, 0.5, 4.0], [0.0, 0.0, -1.0], [0.5, 0.5, 0.0], &[Floor]), // down its edge
        // through its edge or corner it passes
        ([-1.0, 0.0, 0.0], [1.0, 0.0, 2.0], [1.0, 0.0, 4.0], &[Ceiling]), // the edge x = −½, z = 1 upwards
        ([2.0, -1.0, 0.5], [-1.0, 1.0, 0.0], [-1.0, 2.0, 0.5], &[North]), // the edge x = y = ½
        ([-1.0, -1.0, 0.0], [1.0, 1.0, 2.0], [1.0, 1.0, 4.0], &[Ceiling]), // the corner (−½, −½, 1)
        // into its edge
        ([2.0, 0.25, 2.5], [-1.0, 0.0, -1.0], [0.5, 0.25, 1.0], &[CubeTop, CubeEast]),
        ([2.0, 2.0, 0.25], [-1.0, -1.0, 0.0], [0.5, 0.5, 0.25], &[CubeNorth, CubeEast]),
        // into an edge or a corner of the room
        ([0.0, 0.0, 1.0], [1.0, 1.0, 1.0], [2.0, 2.0, 3.0], &[East, North]),
        ([0.0, 0.0, 1.0], [2.0, 2.0, 3.0], [2.0, 2.0, 4.0], &[East, North, Ceiling]),
        ([0.0, 0.0, 1.0], [-2.0, 0.0, 3.0], [-2.0, 0.0, 4.0], &[West, Ceiling]),
        ([2.0, 2.0, 4.0], [-1.0, -1.0, 0.0], [-2.0, -2.0, 4.0], &[West, South]),
        // from an edge of the room along both faces, and towards the other one
        ([2.0, 2.0, 1.0], [0.0, 0.0, 1.0], [2.0, 2.0, 4.0], &[Ceiling]),
        ([2.0, 2.0, 1.0], [-1.0, 0.5, 0.0], [2.0, 2.0, 1.0], &[North]),
        ([2.0, 0.0, 0.0], [1.0, 0.0, 0.0], [2.0, 0.0, 0.0], &[East]),
        // from an edge of the cube
        ([0.5, 0.5, 1.0], [1.0, 1.0, 0.0], [2.0, 2.0, 1.0], &[East, North]),
        ([0.5, 0.5, 0.5], [0.0, 1.0, 0.0], [0.5, 2.0, 0.5], &[North]),
        ([0.5, 0.0, 0.0], [1.0, 0.0, -1.0], [0.5, 0.0, 0.0], &[Floor]),
        ([-0.5, 0.0, 1.0], [-1.0, 0.0, 1.0], [-2.0, 0.0, 2.5], &[West]),
        // components too small to move anything
        ([0.0, 0.0, 1.0], [1.0, 5e-324, 1e-300], [2.0, 0.0, 1.0], &[East]),
        ([1.0, 1e-300, 0.0], [-1.0, 1e-310, 1e-310], [0.5, 1e-300, 0.0], &[CubeEast]),
    ];
    for (i, (from, direction, end, faces)) in cases.into_iter().enumerate() {
        let vertex = Vertex::at(from).unwrap();
        let hit = nearest_hit(&vertex, DVec3::from_array(direction)).unwrap();
        let off = hit.position().distance(DVec3::from_array(end));
        assert!(faces.contains(&hit.face()) && off <= 4e-16, "{i}: {hit:?}");
        assert!(on_its_face(&hit));
    }
    let p = Vertex::at([0.0, 0.0, 1.0]).unwrap();
    let none = [
        DVec3::ZERO,
        DVec3::NEG_Z,
        DVec3::new(1.0, 0.0, -5e-324),
        DVec3::new(f64::NAN, 0.0, 1.0),
        DVec3::new(0.0, f64::INFINITY, 1.0),
        DVec3::new(0.0, 0.0, f64::INFINITY),
    ];
    for direction in none {
        assert_eq!(nearest_hit(&p, direction), None, "{direction}");
    }
    assert_eq!(nearest_hit(&p, DVec3::new(H, 0.0, H)).unwrap().face(), East);
}

/// Coordinates and components of every kind of f64, and often one that lies on a face.
fn numbers() -> impl Strategy<Value = f64> {
    let special = prop::sample::select(vec![
        -2.0,
        -0.5,
        -0.0,
        0.0,
        0.5,
        1.0,
        2.0,
        4.0,
        5e-324,
        -5e-324,
        1e-300,
        -1e-300,
        1e-16,
        f64::MAX,
        f64::NAN,
        f64::INFINITY,
    ]);
    let near = prop::sample::select(vec![-2.0f64, -0.5, 0.5, 1.0, 2.0, 4.0])
        .prop_flat_map(|x| prop::sample::select(vec![x.next_up(), x.next_down()]));
    prop_oneof![2 => any::<u64>().prop_map(f64::from_bits), 4 => special, 2 => near, 3 => -2.0..4.0]
}

proptest! {
    #![proptest_config(common::config(200_000))]

    /// Any bits at all: a point is on a face or an error, a ray ends on a face other than its own or is None
    /// as documented.
    #[test]
    fn any_bits_end_on_a_face(point in prop::array::uniform3(numbers()),
        direction in prop::array::uniform3(numbers())) {
        let Ok(from) = Vertex::at(point) else { return Ok(()) };
        prop_assert!(on_its_face(&from));
        let direction = DVec3::from_array(direction);
        let allowed = direction.is_finite() && direction != DVec3::ZERO
            && from.normal().dot(direction) >= 0.0;
        let hit = nearest_hit(&from, direction);
        prop_assert_eq!(hit.is_some(), allowed);
        if let Some(hit) = hit {
            prop_assert!(on_its_face(&hit) && hit.face() != from.face(), "{:?}", hit);
            prop_assert!(hit.position().is_finite());
        }
    }
}

proptest! {
    #![proptest_config(common::config(20_000))]

    /// Points that rounding put a hair inside the cube, or that lie on several faces: a ray goes on from
    /// every hit, and does not come out on the cube's other side.
    #[test]
    fn rays_go_on_from_wherever_they_end(
        (x, z) in (prop::sample::select(vec![0.5f64, 0.5f64.next_up(), 0.5f64.next_down(), 0.5 - 2e-16,
            0.7]), 0.0..3.0),
        (from_y, to_y) in (-1.9..1.9, -0.6..0.6),
        mirror in any::<bool>(),
        u in (0.0..1.0, 0.0..1.0),
    ) {
        // at the foot of the cube from a wall
        let side = if mirror { -1.0 } else { 1.0 };
        let wall = Vertex::at([2.0 * side, from_y, z]).unwrap();
        let foot = DVec3::new(x * side, to_y, 0.0);
        let Some(mut at) = nearest_hit(&wall, foot - wall.position()) else { return Ok(()) };
        for _ in 0..4 {
            let direction = at.to_room(&Hemisphere::Cosine.direction_of(u.0, u.1).unwrap());
            let next = nearest_hit(&at, direction).unwrap();
            prop_assert!(on_its_face(&next) && next.face() != at.face(), "{:?} {:?}", at, next);
            let way = next.position() - at.position();
            // it went where it was sent
            let off = way - direction * way.dot(direction);
            prop_assert!(off.length() <= 1e-14 && way.dot(direction) >= -1e-15, "{:?} {} \
                {:?}", at, direction, next);
            at = next;
        }
    }
}

/// Paths of `bounces` rays each in one long walk: whether every ray ended on a face other than its own.
fn bounce(blocks: u64, bounces: u64) {
    (0..blocks).into_par_iter().for_each(|block| {
        let mut rng = Stream::new(common::seed(402), block);
        let mut at = any_point(&mut rng);
        let mut met = [0u64; 11];
        for i in 0..bounces {
            let direction = at.to_room(&Hemisphere::ALL[(i % 2) as usize].sample(&mut rng));
            let Some(next) = nearest_hit(&at, direction) else { panic!("lost: {at:?} {direction}") };
            let fine = on_its_face(&next) && next.face() != at.face();
            assert!(fine, "{at:?} {direction} {next:?}");
            met[next.face() as usize] += 1;
            at = next;
        }
        assert!(bounces < 1_000_000 || met.iter().all(|count| *count > bounces / 1000), "{met:?}");
    });
}

#[test]
fn twenty_million_rays_stay_in_the_room() {
    bounce(20, 1_000_000);
}

/// `cargo test --release --test box_room -- --ignored`
#[test]
#[ignore = "takes a minute"]
fn a_thousand_million_rays_stay_in_the_room() {
    bounce(1000, 1_000_000);
}

// ---- faces
// ---------------------------------------------------------------------------------------------------------

#[test]
fn faces_are_where_the_worksheet_puts_them() {
    use Face::*;
    // area, normal, a point
    let faces: [(Face, f64, [f64; 3], [f64; 3]); 11] = [
        (CubeTop, 1.0, [0.0, 0.0, 1.0], [0.3, -0.2, 1.0]),
        (CubeWest, 1.0, [-1.0, 0.0, 0.0], [-0.5, 0.1, 0.2]),
        (CubeEast, 1.0, [1.0, 0.0, 0.0], [0.5, 0.1, 0.2]),
        (CubeSouth, 1.0, [0.0, -1.0, 0.0], [0.1, -0.5, 0.2]),
        (CubeNorth, 1.0, [0.0, 1.0, 0.0], [0.1, 0.5, 0.2]),
        (Floor, 15.0, [0.0, 0.0, 1.0], [0.6, 0.1, 0.0]),
        (Ceiling, 16.0, [0.0, 0.0, -1.0], [0.6, 0.1, 4.0]),
        (West, 16.0, [1.0, 0.0, 0.0], [-2.0, 0.1, 2.0]),
        (East, 16.0, [-1.0, 0.0, 0.0], [2.0, 0.1, 2.0]),
        (South, 16.0, [0.0, 1.0, 0.0], [0.1, -2.0, 2.0]),
        (North, 16.0, [0.0, -1.0, 0.0], [0.1, 2.0, 2.0]),
    ];
    for (face, area, normal, point) in faces {
        assert_eq!(face.area(), area);
        assert_eq!(face.normal(), DVec3::from_array(normal));
        let vertex = Vertex::at(point).unwrap();
        assert_eq!((vertex.face(), vertex.position().to_array()), (face, point));
        assert_eq!(face.is_cube(), area == 1.0);
        // the face's frame: unit, at right angles, its z along the normal
        let axes = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]
            .map(|[x, y, z]| vertex.to_room(&Direction::new(x, y, z).unwrap()));
        assert_eq!(axes[2], face.normal());
        for (i, a) in axes.iter().enumerate() {
            for (j, b) in axes.iter().enumerate() {
                assert_eq!(a.dot(*b), f64::from(u8::from(i == j)));
            }
        }
    }
}

#[test]
fn points_on_edges_belong_to_the_first_face() {
    use Face::*;
    let points = [
        ([0.5, 0.5, 1.0], CubeTop),
        ([-0.5, 0.2, 1.0], CubeTop),
        ([-0.5, -0.5, 0.5], CubeWest),
        ([0.5, 0.5, 0.5], CubeEast),
        ([0.5, 0.0, 0.0], CubeEast),
        ([0.0, -0.5, 0.0], CubeSouth),
        ([2.0, 2.0, 0.0], Floor),
        ([2.0, 2.0, 4.0], Ceiling),
        ([-2.0, 2.0, 3.0], West),
        ([2.0, -2.0, 3.0], East),
        ([-0.0, 0.0, 1.0], CubeTop),
    ];
    for (point, face) in points {
        assert_eq!(Vertex::at(point).unwrap().face(), face, "{point:?}");
    }
}

// ---- visibility
// ----------------------------------------------------------------------------------------------------

/// A point on one of the faces, off their edges by 1e-6 or more.
fn inner_point(rng: &mut Stream) -> Vertex {
    loop {
        let vertex = any_point(rng);
        let ([low, high], at, n) = (vertex.face().bounds(), vertex.position(), vertex.normal());
        let inside = |axis: usize| n[axis] != 0.0 || (at[axis] - low[axis]).min(high[axis] - at[axis]) > 1e-6;
        if (0..3).all(inside) {
            return vertex;
        }
    }
}

#[test]
fn what_is_seen_is_what_five_squares_leave_free() {
    (0..64u64).into_par_iter().for_each(|block| {
        let mut rng = Stream::new(common::seed(403), block);
        let mut seen = 0;
        for _ in 0..20_000 {
            let (a, b) = (inner_point(&mut rng), inner_point(&mut rng));
            let (there, back) = (visible(&a, b.position()), visible(&b, a.position()));
            assert_eq!(there, back, "{a:?} {b:?}");
            assert_eq!(there, slow_visible(&a, &b), "{a:?} {b:?}");
            seen += u32::from(there);
        }
        assert!((9_000..17_000).contains(&seen), "{seen}");
    });
}

/// Every ray sees its end.
#[test]
fn a_ray_sees_what_it_hits() {
    (0..16u64).into_par_iter().for_each(|block| {
        let mut rng = Stream::new(common::seed(404), block);
        let mut at = any_point(&mut rng);
        for _ in 0..50_000 {
            let next = nearest_hit(&at, at.to_room(&Hemisphere::Cosine.sample(&mut rng))).unwrap();
            // rounding may put a point next to an edge behind it
            let edge = {
                let ([low, high], p, n) = (next.face().bounds(), next.position(), next.normal());
                (0..3).any(|i| n[i] == 0.0 && (p[i] - low[i]).min(high[i] - p[i]) < 1e-12)
            };
            assert!(
                edge || (visible(&at, next.position()) && visible(&next, at.position())),
                "{at:?} {next:?}"
            );
            at = next;
        }
    });
}

#[test]
fn touching_the_cube_hides_nothing() {
    let sees = |from: [f64; 3], to: [f64; 3]| visible(&Vertex::at(from).unwrap(), DVec3::from_array(to));
    assert!(sees([-2.0, 0.5, 0.5], [2.0, 0.5, 0.5])); // along its side
    assert!(sees([-2.0, 0.2, 1.0], [2.0, 0.2, 1.0])); // along its top
    assert!(!sees([-2.0, 0.5f64.next_down(), 0.5], [2.0, 0.5f64.next_down(), 0.5]));
    assert!(!sees([-2.0, 0.2, 1f64.next_down()], [2.0, 0.2, 1f64.next_down()]));
    assert!(sees([-1.0, 0.0, 0.0], [1.0, 0.0, 4.0])); // through an edge
    assert!(sees([2.0, -1.0, 0.5], [-1.0, 2.0, 0.5]));
    assert!(!sees([0.0, 0.0, 1.0], [0.6, 0.0, 0.0])); // below the top's horizon
    assert!(!sees([0.5, 0.0, 0.5], [-2.0, 0.0, 0.5])); // behind the side
    assert!(sees([0.0, 0.0, 1.0], [0.0, 0.0, 1.0])); // itself
    assert!(!sees([1.0, 0.0, 0.0], [-1.0, 0.0, 0.0])); // nothing passes under it
}

// ---- form factors
// --------------------------------------------------------------------------------------------------

/// ∫ cos θ cos θ′/(πr²) dA over a triangle given as seen from the point, all of it above the horizon of `n`.
fn by_quadrature([a, b, c]: [DVec3; 3], n: DVec3, rule: &[(f64, f64)]) -> f64 {
    let (e, f) = (b - a, c - b);
    let area = e.cross(f);
    let mut sum = 0.0;
    for (s, ws) in rule {
        for (t, wt) in rule {
            let v = a + e * *s + f * (s * t);
            let r2 = v.length_squared();
            sum += ws * wt * s * area.dot(v).abs() * n.dot(v) / (r2 * r2);
        }
    }
    sum * FRAC_1_PI
}

/// The same for any triangle: its part above the horizon is none of it, itself, a triangle, or two.
fn cut_and_integrated(mut corners: [DVec3; 3], n: DVec3, rule: &[(f64, f64)]) -> f64 {
    corners.sort_by(|a, b| n.dot(*b).total_cmp(&n.dot(*a)));
    let [high, middle, low] = corners;
    let at_horizon = |a: DVec3, b: DVec3| a.lerp(b, n.dot(a) / (n.dot(a) - n.dot(b)));
    let above = |corner: DVec3| n.dot(corner) > 0.0;
    if above(low) {
        by_quadrature(corners, n, rule)
    } else if above(middle) {
        let (left, right) = (at_horizon(high, low), at_horizon(middle, low));
        by_quadrature([high, middle, right], n, rule) + by_quadrature([high, right, left], n, rule)
    } else if above(high) {
        by_quadrature([high, at_horizon(high, middle), at_horizon(high, low)], n, rule)
    } else {
        0.0
    }
}

fn rectangle(x: [f64; 2], y: [f64; 2], z: f64) -> [DVec3; 4] {
    [[x[0], y[0]], [x[1], y[0]], [x[1], y[1]], [x[0], y[1]]].map(|[x, y]| DVec3::new(x, y, z))
}

#[test]
fn form_factors_are_howells() {
    let mut rng = Stream::new(common::seed(405), 0);
    let mut worst = [0.0f64; 2];
    for _ in 0..20_000 {
        let [a, b, c] = [(); 3].map(|()| 10f64.powf(2.0 * rng.uniform() - 1.0));
        let flat = rectangle([0.0, a], [0.0, b], c);
        let off = form_factor(&flat, DVec3::ZERO, DVec3::Z) / howell_parallel(a, b, c) - 1.0;
        worst[0] = worst[0].max(off.abs() / f64::EPSILON);
        // its two terms cancel where a is much smaller than c
        let exact = howell_perpendicular(a, b, c);
        let off = (form_factor(&flat, DVec3::ZERO, DVec3::X) - exact).abs();
        worst[1] = worst[1].max(off / (f64::EPSILON * (b / c).atan()));
    }
    println!("parallel to {} ε, perpendicular to {} ε of its larger term", worst[0], worst[1]);
    assert!(worst[0] <= 12.0 && worst[1] <= 2.0, "{worst:?}");
    // the worksheet's: half-width a at the distance 3
    let exact = 4.0 * howell_parallel(0.5, 0.5, 3.0);
    assert!((exact - 0.03410679489971157).abs() <= 1e-17);
}

#[test]
fn form_factors_are_integrals() {
    let (rule, mut rng) = (gauss(48), Stream::new(common::seed(406), 0));
    let (mut worst, mut cut) = (0.0f64, 0);
    for i in 0..6_000 {
        // a triangle of any size around 1 at a distance that lets 48² nodes see all of it, and any horizon
        let centre = any_direction(&mut rng) * (1.0 + 2.0 * rng.uniform());
        let size = 10f64.powf(-3.0 * rng.uniform());
        let corners = [(); 3].map(|()| centre + any_direction(&mut rng) * (0.6 * size));
        let [a, b, c] = corners;
        let normal = (b - a).cross(c - a);
        let flatness = normal.length() / (a - b).length().max((b - c).length()).max((c - a).length()).powi(2);
        let tilt = normal.normalize().dot(a).abs();
        if flatness < 0.1 || tilt < 0.2 {
            continue; // a needle or edge on: for these no few ulp are promised
        }
        // half of them at the horizon
        let n = any_direction(&mut rng);
        let n = if i % 2 == 0 { n } else { n.cross(a).normalize() };
        let exact = cut_and_integrated(corners, n, &rule);
        cut += u32::from(corners.iter().any(|v| n.dot(*v) < 0.0) && exact > 0.0);
        let given = form_factor(&corners, DVec3::ZERO, n);
        let turned = form_factor(&[c, b, a], DVec3::ZERO, n);
        // in ulp of what it is overhead, as cos θ has fewer digits at the horizon
        let overhead = by_quadrature(corners, centre.normalize(), &rule);
        worst = worst.max((given - exact).abs().max((turned - exact).abs()) / overhead / f64::EPSILON);
    }
    println!("{cut} cut at the horizon, worst {worst} ε");
    assert!(cut > 1_000 && worst <= 128.0, "{cut} {worst}");
}

/// Triangles of 1e-8 to 0.3 m, each with the point and P above the horizon of z, from this script (mpmath):
///
/// ```python
/// mp.dps = 40
/// def P(c, p):  # c the corners, p the point, as mpf
///     a, b, d = [[x - y for x, y in zip(q, p)] for q in c]
///     e = [x - y for x, y in zip(b, a)]; f = [x - y for x, y in zip(d, a)]
///     N = [e[1]*f[2] - e[2]*f[1], e[2]*f[0] - e[0]*f[2], e[0]*f[1] - e[1]*f[0]]
///     def g(s, t):
///         v = [a[i] + s*e[i] + s*t*(f[i] - e[i]) for i in range(3)]
///         r2 = sum(x*x for x in v)
///         return s * abs(sum(x*y for x, y in zip(v, N))) * v[2] / (pi * r2 * r2)
///     return quad(g, [0, 1], [0, 1], maxdegree=4)
/// ```
const SMALL: [([[f64; 3]; 3], [f64; 3], f64); 6] = [
    (
        [
            [-1.7458630910863404, -2.45430566570891, 0.6866194974735884],
            [-1.7458631050068778, -2.4543056709843567, 0.6866194877039892],
            [-1.7458631059921508, -2.4543056795942912, 0.686619486458345],
        ],
        [-1.055807641050262, -1.5873358630771368, -0.41576702955727596],
        5.4850574044842917651e-18,
    ),
    (
        [
            [2.310798205337686, 0.7025514357900519, 2.191384329851564],
            [2.310798210399189, 0.7025514228865227, 2.1913843248756346],
            [2.310798206232203, 0.7025514312712332, 2.1913843163144002],
        ],
        [1.7099025257122418, 1.3156801951136776, 1.2266093868092938],
        2.2765339324945854694e-18,
    ),
    (
        [
            [0.6253207084513259, -1.5473372870307276, 2.688722829594099],
            [0.6253205867989236, -1.5473374150195802, 2.6887218928517056],
            [0.6253200885356915, -1.5473375696782963, 2.6887213876008316],
        ],
        [-0.10564844965941944, -1.6426151709384387, 1.7383534555996323],
        4.5350249755689045171e-15,
    ),
    (
        [
            [-1.6869026919030428, 1.5030650136355126, -0.9064277376335935],
            [-1.6868101604871844, 1.5030098803171563, -0.9064137473553965],
            [-1.6869690821387842, 1.5030972986146478, -0.9064410453196861],
        ],
        [-0.779553614269044, 1.2503692745384827, -1.827046123711006],
        3.890412794712022328e-11,
    ),
    (
        [
            [-0.46838680956300416, 1.790978315827941, -0.06055198409771737],
            [-0.4573103729012338, 1.7911492704196723, -0.0692338890168082],
            [-0.4660682205338766, 1.7955813020665694, -0.0749990051686025],
        ],
        [-0.5766769815705919, 0.9877707239618503, -0.7173243870010322],
        0.000013211404303169450162,
    ),
    (
        [
            [1.1323213195344313, 2.7830503538540663, 2.5113753424444303],
            [1.2051800474352508, 2.7694313200849816, 2.418537964187459],
            [1.449680119212877, 2.3794924518673186, 2.161080804194585],
        ],
        [0.7891675258460737, 1.5837111164472906, 1.8189503933693802],
        0.0010569460998372368538,
    ),
];

#[test]
fn form_factors_of_small_polygons_keep_their_digits() {
    for (corners, point, exact) in SMALL {
        let given = form_factor(&corners.map(DVec3::from_array), DVec3::from_array(point), DVec3::Z);
        println!("{given:e}: {:.1} ε", (given / exact - 1.0) / f64::EPSILON);
        assert!((given / exact - 1.0).abs() <= 1e-13, "{given} for {exact}");
    }
    // squares of side 2a overhead and off to the side: A cos θ cos θ′/(πr²), as the next term is smaller by
    // a²
    for a in [1e-8, 1e-9, 1e-12] {
        for [x, y] in [[0.0, 0.0], [0.1, 0.3], [0.3, -0.45], [0.5, 0.5]] {
            let r2 = x * x + y * y + 9.0;
            let exact = 4.0 * a * a * 9.0 / (PI * r2 * r2);
            let given = form_factor(&rectangle([-a, a], [-a, a], 4.0), DVec3::new(x, y, 1.0), DVec3::Z);
            assert!((given / exact - 1.0).abs() <= 1e-14, "{a} {x} {y}: {}", given / exact - 1.0);
        }
    }
}

/// Convex polygons of up to eight corners are the sum of their triangles, whatever the horizon.
#[test]
fn form_factors_add_up() {
    let mut rng = Stream::new(common::seed(407), 0);
    for _ in 0..5_000 {
        let sides = 4 + (rng.uniform() * 5.0) as usize;
        let mut turns: Vec<f64> = (0..sides).map(|_| 2.0 * PI * rng.uniform()).collect();
        turns.sort_by(f64::total_cmp);
        let [x, y, z] = [(); 3].map(|()| any_direction(&mut rng));
        let (u, v) = (x, y - x * x.dot(y)); // at right angles: the polygon lies in an ellipse
        let corners: Vec<DVec3> = turns.iter().map(|t| z * 2.0 + u * t.cos() + v * t.sin()).collect();
        let n = any_direction(&mut rng);
        let whole = form_factor(&corners, DVec3::ZERO, n);
        let parts: f64 = (1..sides - 1)
            .map(|i| form_factor(&[corners[0], corners[i], corners[i + 1]], DVec3::ZERO, n))
            .sum();
        assert!((whole - parts).abs() <= 2e-15, "{whole} {parts}");
        assert!((0.0..=1.0).contains(&whole));
    }
}

/// The part of the cosine directions that meet a polygon is its P: 1.2 million draws, z ≤ 8 (1.2e-15 each of
/// the two), and a bias of 1 % is caught.
#[test]
fn form_factors_are_probabilities() {
    for (i, n) in [DVec3::Z, DVec3::new(0.6, 0.0, 0.8)].into_iter().enumerate() {
        let corners = rectangle([-1.0, 2.0], [-0.5, 1.5], 1.25);
        let p = form_factor(&corners, DVec3::ZERO, n);
        let side = n.cross(DVec3::Y).normalize();
        let hits = from_fn(|rng| {
            let w = Hemisphere::Cosine.sample(rng).vector();
            let w = side * w.x + DVec3::Y * w.y + n * w.z;
            let at = w * (1.25 / w.z);
            f64::from(u8::from(w.z > 0.0 && at.x > -1.0 && at.x < 2.0 && at.y > -0.5 && at.y < 1.5))
        });
        let budget = unbiased::Budget::Draws(1_200_000);
        let found = unbiased::estimate(&hits, budget, common::seed(408 + i as u64)).unwrap();
        let std_error = (p * (1.0 - p) / 1.2e6).sqrt();
        assert!((found.mean() - p).abs() <= common::deviations(8.0) * std_error, "{} for {p}", found.mean());
    }
}

#[test]
fn degenerate_polygons_fill_nothing() {
    let p = |corners: &[[f64; 3]], n: DVec3| {
        let corners: Vec<DVec3> = corners.iter().map(|c| DVec3::from_array(*c)).collect();
        form_factor(&corners, DVec3::ZERO, n)
    };
    let normals = [DVec3::X, DVec3::Y, DVec3::Z, DVec3::NEG_Z, DVec3::new(0.6, 0.0, 0.8)];
    for n in normals {
        // too few corners, or all on a line or in a point
        assert_eq!(p(&[], n), 0.0);
        assert_eq!(p(&[[1.0, 1.0, 1.0]], n), 0.0);
        assert_eq!(p(&[[1.0, 1.0, 1.0], [1.0, 2.0, 1.0]], n), 0.0);
        assert_eq!(p(&[[1.0, 1.0, 1.0]; 4], n), 0.0);
        assert!(p(&[[1.0, 1.0, 1.0], [1.0, 2.0, 1.0], [1.0, 3.0, 1.0]], n) <= 1e-16);
        // the point in the polygon's plane: inside, on an edge, at a corner, outside
        assert_eq!(p(&[[-1.0, -1.0, 0.0], [1.0, -1.0, 0.0], [0.0, 2.0, 0.0]], n), 0.0);
        assert_eq!(p(&[[-1.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 2.0, 0.0]], n), 0.0);
        assert_eq!(p(&[[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 2.0, 0.0]], n), 0.0);
        assert_eq!(p(&[[3.0, 0.3, 0.0], [4.0, 0.0, 0.0], [3.0, 2.0, 0.0]], n), 0.0);
        // an edge or a corner that passes through the point, the polygon upright
        assert_eq!(p(&[[-1.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 2.0]], n), 0.0);
    }
    // below the horizon, or touching it
    assert_eq!(p(&[[1.0, 0.0, -1.0], [1.0, 1.0, -1.0], [0.0, 1.0, -1.0]], DVec3::Z), 0.0);
    assert_eq!(p(&[[1.0, 0.0, 0.0], [1.0, 1.0, -1.0], [0.0, 1.0, -1.0]], DVec3::Z), 0.0);
    assert_eq!(p(&[[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 1.0, -1.0]], DVec3::Z), 0.0);
    // all of the sky, but for what is hidden behind its own edge
    let all = rectangle([-1e9, 1e9], [-1e9, 1e9], 1.0);
    assert!((form_factor(&all, DVec3::ZERO, DVec3::Z) - 1.0).abs() <= 1e-15);
    // coordinates whose differences leave f64
    for (half, z) in [(1.7e308, 1e308), (f64::MAX, f64::MAX), (f64::MAX, 1e300)] {
        let exact = 4.0 * howell_parallel(half / z, half / z, 1.0);
        let given = form_factor(&rectangle([-half, half], [-half, half], z), DVec3::ZERO, DVec3::Z);
        assert!((given - exact).abs() <= 2e-15, "{half:e}: {given} for {exact}");
        // from a point as far below the origin, and off to the side
        let given =
            form_factor(&rectangle([0.0, half], [-half, half], z), DVec3::new(-half, 0.0, -z), DVec3::Z);
        let exact = 2.0 * (howell_parallel(half, half / 2.0, z) - howell_parallel(half / 2.0, half / 2.0, z));
        assert!((given - exact).abs() <= 2e-15, "{half:e}: {given} for {exact}");
    }
    // coordinates whose squares leave f64
    for scale in [1e-300, 1e-170, 1e160, 1e300] {
        let square = rectangle([-scale, scale], [-scale, scale], scale);
        let exact = 4.0 * howell_parallel(1.0, 1.0, 1.0);
        let given = form_factor(&square, DVec3::ZERO, DVec3::Z);
        assert!((given - exact).abs() <= 1e-15, "{scale}: {given}");
    }
}

/// A normal of any length is that direction; what is not finite, or no direction, has no P.
#[test]
fn normals_have_a_direction_and_points_are_finite() {
    let square = rectangle([-1.0, 2.0], [-0.5, 1.5], 1.25);
    for n in [DVec3::Z, DVec3::new(0.6, 0.0, 0.8), DVec3::new(-0.48, 0.64, 0.6)] {
        let p = form_factor(&square, DVec3::ZERO, n);
        for length in [2.0, 0.3, 5e-324, 1e-200, 1e200, 1.7e308] {
            let n = if length == 5e-324 { DVec3::Z * length } else { n * length };
            let p = if length == 5e-324 { form_factor(&square, DVec3::ZERO, DVec3::Z) } else { p };
            let given = form_factor(&square, DVec3::ZERO, n);
            assert!((given - p).abs() <= 1e-15, "{n} {given} {p}");
        }
    }
    assert!(form_factor(&square, DVec3::ZERO, DVec3::ZERO).is_nan());
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        for axis in DVec3::AXES {
            let mut corners = square;
            corners[2] += axis * bad;
            assert!(form_factor(&corners, DVec3::ZERO, DVec3::Z).is_nan());
            assert!(form_factor(&square, axis * bad, DVec3::Z).is_nan());
            assert!(form_factor(&square, DVec3::ZERO, axis * bad).is_nan());
            assert!(form_factor(&[], axis * bad, DVec3::Z).is_nan());
            // nothing is seen there, from above the cube's height or below
            for from in [[0.0, 0.0, 1.0], [1.5, 0.0, 0.0], [2.0, 0.3, 3.0]] {
                let from = Vertex::at(from).unwrap();
                assert!(!visible(&from, DVec3::new(0.0, 0.0, 4.0) + axis * bad));
                assert_eq!(nearest_hit(&from, axis * bad), None);
            }
        }
    }
}

/// By tests/data/closed_forms.py's formula in 2400 bits: the sky above a plane, seen aslant, of which the
/// horizon takes 8 %.
#[test]
fn the_largest_polygons_are_half_spaces() {
    let tilted = DVec3::new(0.3, -0.5, 0.9);
    for (half, exact) in
        [(1e9, 0.919_627_163_395_042_26), (1e16, 0.919_627_163_708_141_17), (1e300, 0.919_627_163_708_141_2)]
    {
        let mut square = rectangle([-half, half], [-half, half], 1.0);
        for _ in 0..4 {
            let given = form_factor(&square, DVec3::ZERO, tilted);
            assert!((given - exact).abs() <= 1e-15, "{half:e}: {given}");
            square.rotate_left(1);
        }
        square.reverse();
        assert!((form_factor(&square, DVec3::ZERO, tilted) - exact).abs() <= 1e-15);
    }
    // the other side of the plane is seen only where the horizon lets it
    for (normal, z) in [(tilted, -1.0), (-tilted, 1.0)] {
        let given = form_factor(&rectangle([-1e16, 1e16], [-1e16, 1e16], z), DVec3::ZERO, normal);
        assert!((given + 0.919_627_163_708_141_2 - 1.0).abs() <= 1e-15, "{given}");
    }
}

proptest! {
    #![proptest_config(common::config(2_000))]

    /// P has no unit of length: a power of two changes no bit.
    #[test]
    fn form_factors_know_no_unit_of_length(
        corners in prop::collection::vec(prop::array::uniform3(-1.0..1.0), 3..6),
            sizes in prop::collection::vec(-40..40, 6),
        point in prop::array::uniform3(-1.0..1.0), n in prop::array::uniform3(-1.0..1.0), power in -800..800,
    ) {
        let corners = corners.into_iter().zip(sizes).map(|(c, size)| DVec3::from_array(c) * 2f64.powi(size));
        let (corners, point): (Vec<DVec3>, _) = (corners.collect(), DVec3::from_array(point));
        let (n, unit) = (DVec3::from_array(n), 2f64.powi(power));
        let scaled: Vec<DVec3> = corners.iter().map(|c| *c * unit).collect();
        prop_assert_eq!(form_factor(&corners, point, n), form_factor(&scaled, point * unit, n));
    }

    /// A rectangle of any size, cut into four anywhere, at any tilt: each of five values is off by 1e-15 at
    /// most.
    #[test]
    fn parts_make_up_the_whole(
        logs in prop::array::uniform2(-16.0..300.0), offset in prop::array::uniform2(-1.5..1.5),
        cut in prop::array::uniform2(0.0..1.0), n in prop::array::uniform3(-1.0..1.0), turn in 0..3usize,
    ) {
        let ends = [0, 1].map(|axis| {
            let size = 10f64.powf(logs[axis]);
            [size * (offset[axis] - 1.0), size * (offset[axis] + 1.0)]
        });
        let [x, y] = [0, 1].map(|axis| {
            let [low, high] = ends[axis];
            [low, low + cut[axis] * (high - low), high]
        });
        let p = |x: [f64; 2], y: [f64; 2]| {
            let corners = rectangle(x, y, 1.0).map(|c| match turn {
                0 => c,
                1 => DVec3::new(c.z, c.x, c.y),
                _ => DVec3::new(c.y, c.z, c.x),
            });
            form_factor(&corners, DVec3::ZERO, DVec3::from_array(n))
        };
        let whole = p([x[0], x[2]], [y[0], y[2]]);
        let halves = p([x[0], x[1]], [y[0], y[2]]) + p([x[1], x[2]], [y[0], y[2]]);
        let quarters: f64 = [0, 1].iter().flat_map(|i| [0, 1].map(|j| p([x[*i], x[i + 1]], [y[j],
            y[j + 1]]))).sum();
        prop_assert!((whole - halves).abs() <= 3e-15, "{whole} {halves}");
        prop_assert!((whole - quarters).abs() <= 5e-15, "{whole} {quarters}");
    }

    /// What a triangle around the foot leaves out of the half-space lies within r⁻¹ of the plane's horizon, r
    /// the radius of the circle in it in units of the distance: a band of the solid angle 2π/r, and so less
    /// than 2/r of P, by a factor of two or more. Up to 1e12, where the coordinates are rounded by 1e-3 of
    /// the distance.
    #[test]
    fn large_triangles_are_half_spaces(
        way in prop::array::uniform3(-1.0..1.0), n in prop::array::uniform3(-1.0..1.0), log in 1.0..12.0f64,
            turn in 0.0..6.3f64,
    ) {
        let [way, n] = [way, n].map(DVec3::from_array);
        prop_assume!(way.length() > 0.1 && n.length() > 0.1);
        let (way, r) = (way.normalize(), 10f64.powf(log));
        let (u, v) = way.any_orthonormal_pair();
        let at = |i: i32| {
            let (sin, cos) = (turn + f64::from(i) * 2.0 * PI / 3.0).sin_cos();
            way + (u * cos + v * sin) * (2.0 * r)
        };
        let corners = [at(0), at(1), at(2)];
        let p = form_factor(&corners, DVec3::ZERO, n);
        let half_space = 0.5 * (1.0 + n.normalize().dot(way));
        prop_assert!((p - half_space).abs() <= 2.0 / r, "{p} {half_space}");
    }

    /// In the plane of a triangle: at a corner, in the middle of an edge, on it, inside or outside, however
    /// large and wherever.
    #[test]
    fn nothing_is_seen_edge_on(
        p in prop::array::uniform3(-1i64 << 40..1i64 << 40),
            u in prop::array::uniform3(-1i64 << 40..1i64 << 40),
        v in prop::array::uniform3(-1i64 << 40..1i64 << 40), n in prop::array::uniform3(-1.0..1.0),
        places in prop::array::uniform3(prop::array::uniform2(-3i64..4)), power in -900..900,
    ) {
        let corner = |[a, b]: [i64; 2]| {
            let at = |i: usize| (p[i] + a * u[i] + b * v[i]) as f64 * 2f64.powi(power);
            DVec3::new(at(0), at(1), at(2))
        };
        prop_assert_eq!(form_factor(&places.map(corner), corner([0, 0]), DVec3::from_array(n)), 0.0);
    }

    /// A hair beside the plane, of triangles of any place and size: one side sees what the other does not.
    #[test]
    fn the_plane_is_passed_at_once(
        p in prop::array::uniform3(-1i64 << 40..1i64 << 40),
            u in prop::array::uniform3(-1i64 << 40..1i64 << 40),
        v in prop::array::uniform3(-1i64 << 40..1i64 << 40), n in prop::array::uniform3(-1.0..1.0),
            axis in 0..3usize,
    ) {
        let at = |a: i64, b: i64| DVec3::from_array([0, 1, 2].map(|i| (p[i] + a * u[i] + b * v[i]) as f64));
        let (corners, n) = ([at(2, 0), at(-1, 2), at(-1, -2)], DVec3::from_array(n));
        let area = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
        prop_assume!(area.abs().min_element() > 1e-3 * area.length() && area.length() > 1e20
            && n.length() > 0.1);
        // 2⁻¹² m beside a triangle of 10⁹ km
        let aside = DVec3::AXES[axis] * 0.5f64.powi(12);
        let seen = [aside, -aside].map(|aside| form_factor(&corners, at(0, 0) + aside, n));
        let toward = area.normalize() * -area[axis].signum();
        let half_space = 0.5 * (1.0 + n.normalize().dot(toward));
        // the foot is the triangle's centre, a third of its least height from an edge; the band of the test
        // above
        let [a, b, c] = corners;
        let longest = (a - b).length().max((b - c).length()).max((c - a).length());
        let room = 2.0 * aside.length() / (area.length() / longest / 3.0) + 1e-15;
        prop_assert!((seen[0] - half_space).abs() <= room && (seen[1] - (1.0 - half_space)).abs() <= room,
            "{seen:?} {half_space}");
    }
}

proptest! {
    #![proptest_config(common::config(20_000))]

    #[test]
    fn form_factors_of_anything_finite_are_in_range(
        corners in prop::collection::vec(prop::array::uniform3(numbers().prop_filter("finite",
            |x| x.is_finite())), 0..6),
        point in prop::array::uniform3(-2.0..2.0),
        up in 0..3usize,
    ) {
        let corners: Vec<DVec3> = corners.into_iter().map(DVec3::from_array).collect();
        let p = form_factor(&corners, DVec3::from_array(point), DVec3::AXES[up]);
        prop_assert!((0.0..=1.0).contains(&p), "{}", p);
    }
}

// ---- the scene
// -----------------------------------------------------------------------------------------------------

#[test]
fn direct_light_is_the_worksheets() {
    let room = BoxRoom::new(Scene::default()).unwrap();
    let p = room.point();
    assert_eq!((p.face(), p.position()), (Face::CubeTop, DVec3::Z));
    let close = |given: f64, exact: f64| (given - exact).abs() <= 2.0 * f64::EPSILON * exact / 2.0;
    assert!(close(room.direct(&p), 0.2728543591976926), "{}", room.direct(&p));
    assert!(close(form_factor(&room.light_corners(), p.position(), p.normal()), 0.03410679489971157));
    assert_eq!(room.light_area(), 1.0);
    // in the ceiling's plane there is none, and none without a light
    for half_width in [0.5, 1.9, 0.0] {
        let room = BoxRoom::new(Scene { light_half_width: half_width, ..Scene::default() }).unwrap();
        for point in [[1.95, 0.3, 4.0], [-1.96, -2.0, 4.0]] {
            assert_eq!(room.direct(&Vertex::at(point).unwrap()), 0.0);
        }
        assert_eq!(room.direct(&room.point()) > 0.0, half_width > 0.0);
    }
    // a whole ceiling over its edge is seen edge on
    let room = BoxRoom::new(Scene { light_half_width: 2.0, ..Scene::default() }).unwrap();
    for point in [[2.0, 0.3, 4.0], [2.0, 2.0, 4.0], [1.0, 1.0, 4.0]] {
        assert_eq!(room.direct(&Vertex::at(point).unwrap()), 0.0);
    }
}

/// Lights up to the whole ceiling, p in the middle of the cube's top, in its corner, and elsewhere:
/// half-width, p's x and y, and the part of two bounces for albedos and a radiance of 1, by
/// tests/data/two_bounces.py.
const TWO_BOUNCES: [(f64, [f64; 2], f64); 27] = [
    (0.5, [0.0, 0.0], 0.009975980387042279),
    (0.5, [0.5, -0.5], 0.010152748997395585),
    (0.5, [0.21, -0.43], 0.010068077054039933),
    (1.0, [0.0, 0.0], 0.040567707679614804),
    (1.0, [0.5, -0.5], 0.04108240469256288),
    (1.0, [0.21, -0.43], 0.040843442089380256),
    (1.2, [0.0, 0.0], 0.058769683842531318),
    (1.2, [0.5, -0.5], 0.05934669907600761),
    (1.2, [0.21, -0.43], 0.059087113901419767),
    (1.5, [0.0, 0.0], 0.092172326066653306),
    (1.5, [0.5, -0.5], 0.092605801718764196),
    (1.5, [0.21, -0.43], 0.092440486490090728),
    (1.9, [0.0, 0.0], 0.145252452823966264),
    (1.9, [0.5, -0.5], 0.144781679166209066),
    (1.9, [0.21, -0.43], 0.145113869978267033),
    (1.99, [0.0, 0.0], 0.157539550596856411),
    (1.99, [0.5, -0.5], 0.156743593260245248),
    (1.99, [0.21, -0.43], 0.157250497448360718),
    (1.999, [0.0, 0.0], 0.158738475194193826),
    (1.999, [0.5, -0.5], 0.157908922336847623),
    (1.999, [0.21, -0.43], 0.158433805505638651),
    (1.999999, [0.0, 0.0], 0.158870742028913175),
    (1.999999, [0.5, -0.5], 0.158037476387899969),
    (1.999999, [0.21, -0.43], 0.158564345417137392),
    (2.0, [0.0, 0.0], 0.158870874296065122),
    (2.0, [0.5, -0.5], 0.158037604943371936),
    (2.0, [0.21, -0.43], 0.158564475957737283),
];

/// Also where the light comes within a micrometre of the walls, and where it touches them.
#[test]
fn two_bounces_are_known_to_1e_12() {
    let of = |light_half_width, [x, y]: [f64; 2]| {
        let point = [x, y, 1.0];
        let scene = Scene {
            wall_albedo: 1.0,
            cube_albedo: 1.0,
            radiance: 1.0,
            light_half_width,
            point,
            ..Scene::default()
        };
        BoxRoom::new(scene).unwrap().two_bounces().unwrap()
    };
    let mut worst = 0.0f64;
    for (h, at, exact) in TWO_BOUNCES {
        let off = (of(h, at) / exact - 1.0).abs();
        println!("h = {h} at {at:?}: {off:.1e}");
        worst = worst.max(off);
    }
    assert!(worst <= 1e-12, "{worst:e}");
    // no jump where the cells change, or where they can be no smaller; L₂ rises by 0.13 of itself a metre at
    // the end, and by 1.6 or less elsewhere
    let steps = [0.9999999999, 1.0, 1.0000000001, 1.0000000002];
    let last = [1e-9, 1e-11, 1e-13, 0.0].map(|d| 2.0 - d);
    for h in [&steps[..], &last[..]] {
        for pair in h.windows(2) {
            let (one, other) = (of(pair[0], [0.1, 0.3]), of(pair[1], [0.1, 0.3]));
            let off = (other / one - 1.0).abs();
            assert!(off <= 3.0 * (pair[1] - pair[0]) + 1e-12, "{pair:?}: {off:e}");
        }
    }
}

#[test]
fn a_vertex_has_the_albedo_and_the_emission_of_its_face() {
    let scene = Scene { wall_albedo: 0.3, cube_albedo: 0.6, emission: 0.25, ..Scene::default() };
    let room = BoxRoom::new(scene).unwrap();
    for (point, albedo, emitted, light) in [
        ([0.0, 0.0, 1.0], 0.6, 0.25, false),
        ([0.5, 0.0, 0.5], 0.6, 0.25, false),
        ([1.5, 0.0, 0.0], 0.3, 0.25, false),
        ([2.0, 0.0, 2.0], 0.3, 0.25, false),
        ([0.51, 0.0, 4.0], 0.3, 0.25, false),
        ([0.5, -0.5, 4.0], 0.0, 10.0, true),
        ([0.0, 0.0, 4.0], 0.0, 10.0, true),
    ] {
        let vertex = Vertex::at(point).unwrap();
        assert_eq!((room.albedo(&vertex), room.emitted(&vertex)), (albedo, emitted), "{point:?}");
        assert_eq!(room.is_light(&vertex), light);
    }
    assert_eq!(*room.scene(), scene);
    let dark = BoxRoom::new(Scene { light_half_width: 0.0, ..scene }).unwrap();
    assert!(!dark.is_light(&Vertex::at([0.0, 0.0, 4.0]).unwrap()));
    assert_eq!(dark.light_area(), 0.0);
}

#[test]
fn bad_scenes_are_errors() {
    let says = |scene: Scene, sentence: &str| {
        assert_eq!(BoxRoom::new(scene).unwrap_err().to_string(), sentence);
    };
    let scene = Scene::default();
    for (value, shown) in [(1.0000000000000002, "1.0000000000000002"), (-0.1, "-0.1"), (f64::NAN, "NaN")] {
        let rest = format!("albedo must be between 0 and 1 (above 1 it would create energy), not {shown}");
        says(Scene { wall_albedo: value, ..scene }, &format!("the walls' {rest}"));
        says(Scene { cube_albedo: value, ..scene }, &format!("the cube's {rest}"));
    }
    for (value, shown) in [
        (-1.0, "-1"),
        (f64::INFINITY, "inf"),
        (f64::NAN, "NaN"),
        (1e100f64.next_up(), "1.0000000000000002e100"),
        (1e-100f64.next_down(), "9.999999999999999e-101"),
    ] {
        let rest = format!("must be 0, or from 1e-100 to 1e100, not {shown}");
        says(Scene { radiance: value, ..scene }, &format!("the light's radiance {rest}"));
        says(Scene { emission: value, ..scene }, &format!("the faces' emission {rest}"));
    }
    for (value, shown) in [
        (2.0000000000000004, "2.0000000000000004"),
        (-0.5, "-0.5"),
        (f64::NAN, "NaN"),
        (1e-50f64.next_down(), "9.999999999999999e-51"),
    ] {
        let rest = format!("must be 0 (no light), or from 1e-50 to 2 (all of the ceiling), not {shown}");
        says(Scene { light_half_width: value, ..scene }, &format!("the light's half-width {rest}"));
    }
    let no_face = "lies on no face: it must lie on the room's (|x| = 2, |y| = 2, z = 0 or z = 4) or on the \
                   cube's (|x| = 0.5 or |y| = 0.5 up to z = 1, or z = 1 within)";
    let under = "lies under the cube: on the floor, |x| or |y| must be at least 0.5";
    let light = "lies on the light, which reflects nothing: on the ceiling, |x| or |y| must be above the \
                 light's half-width";
    let points = [
        ([0.0, 0.0, 1.5], "(0, 0, 1.5)", no_face),
        ([0.0, 0.0, 0.5], "(0, 0, 0.5)", no_face),
        ([2.5, 0.0, 0.0], "(2.5, 0, 0)", no_face),
        ([0.0, f64::NAN, 1.0], "(0, NaN, 1)", no_face),
        ([0.0, f64::INFINITY, 1.0], "(0, inf, 1)", no_face),
        ([0.0, 0.25, 0.0], "(0, 0.25, 0)", under),
        ([0.0, 0.25, 4.0], "(0, 0.25, 4)", light),
        ([0.5, 0.5, 4.0], "(0.5, 0.5, 4)", light),
    ];
    for (point, at, reason) in points {
        says(Scene { point, ..scene }, &format!("the point {at} {reason}"));
    }
    // the ends of what is allowed
    let ends = Scene {
        wall_albedo: 1.0,
        cube_albedo: 0.0,
        radiance: 0.0,
        light_half_width: 2.0,
        emission: 1e100,
        point: [2.0, 2.0, 0.0],
    };
    assert!(BoxRoom::new(ends).is_ok());
    assert!(
        BoxRoom::new(Scene { radiance: 1e-100, light_half_width: 1e-50, emission: -0.0, ..ends }).is_ok()
    );
}
