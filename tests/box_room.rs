//! Section 4's room: rays and visibility against slower, plainer computations of the same, special rays one
//! by one. No test here has a false alarm: everything is compared to rounding.

mod common;

use common::{any_direction, any_number, any_point, bounds, is_cube};
use glam::DVec3;
use proptest::prelude::*;
use rayon::prelude::*;
use unbiased::Stream;
use unbiased::lambertian::hemisphere::{Direction, Hemisphere};
use unbiased::paths::room::{Face, Vertex, nearest_hit, visible};

// ---- rays by plainer means

/// Where the ray meets the plane of `face` within its bounds: the distance in units of `direction`, the
/// point, and how far inside the bounds it is. Every rectangle of the room by itself: no slabs, and nothing
/// is known of which of them belong together.
fn meets(face: Face, origin: DVec3, direction: DVec3) -> Option<(f64, DVec3, f64)> {
    let ([low, high], n) = (bounds(face), face.normal());
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
    let into = |vertex: &Vertex, way: DVec3| is_cube(vertex.face()) && vertex.normal().dot(way) < 0.0;
    let crosses =
        |face: &Face| meets(*face, a.position(), way).is_some_and(|(t, ..)| t > 1e-12 && t < 1.0 - 1e-12);
    !into(a, way) && !into(b, -way) && !Face::ALL.iter().filter(|face| is_cube(**face)).any(crosses)
}

/// Whether a vertex is where its face is, exactly.
fn on_its_face(vertex: &Vertex) -> bool {
    let ([low, high], at) = (bounds(vertex.face()), vertex.position());
    let under = vertex.face() == Face::Floor && at.x.abs().max(at.y.abs()) < 0.5 - 1e-15;
    at.cmpge(low).all() && at.cmple(high).all() && !under
}

// ---- rays

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
}

/// Coordinates and components of every kind of f64, and often one that lies on a face, or next to one.
fn numbers() -> impl Strategy<Value = f64> {
    let planes = [-2.0f64, -0.5, 0.0, 0.5, 1.0, 2.0, 4.0].map(|x| [x, x, x.next_up(), x.next_down()]);
    prop_oneof![2 => any_number(), 6 => prop::sample::select(planes.as_flattened().to_vec()), 3 => -2.0..4.0]
}

proptest! {
    #![proptest_config(common::config(200_000))]

    /// Any bits at all: a point is on a face or an error, a ray ends on a face other than its own or is None
    /// as documented.
    #[test]
    fn any_bits_end_on_a_face(point in prop::array::uniform3(numbers()),
        direction in prop::array::uniform3(numbers()), to in prop::array::uniform3(numbers())) {
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
        let to = DVec3::from_array(to);
        prop_assert!(to.is_finite() || !visible(&from, to));
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

// ---- faces

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
        assert_eq!(is_cube(face), area == 1.0);
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

/// A point on one of the faces, off their edges by 1e-6 or more.
fn inner_point(rng: &mut Stream) -> Vertex {
    loop {
        let vertex = any_point(rng);
        let ([low, high], at, n) = (bounds(vertex.face()), vertex.position(), vertex.normal());
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
