//! The form factor of a polygon: parts that make up the whole, polygons that fill nothing or half the space,
//! and any bits. Its values at all sizes are those of tests/vectors.rs.

mod common;

use std::f64::consts::PI;

use common::{any_direction, any_number, howell_parallel};
use glam::DVec3;
use proptest::prelude::*;
use unbiased::Stream;
use unbiased::paths::room::{Vertex, form_factor, nearest_hit, visible};

fn rectangle(x: [f64; 2], y: [f64; 2], z: f64) -> [DVec3; 4] {
    [[x[0], y[0]], [x[1], y[0]], [x[1], y[1]], [x[0], y[1]]].map(|[x, y]| DVec3::new(x, y, z))
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
    fn form_factors_of_any_bits_are_in_range_or_nan(
        corners in prop::collection::vec(prop::array::uniform3(any_number()), 0..6),
        point in prop::array::uniform3(-2.0..2.0), normal in prop::array::uniform3(any_number()),
    ) {
        let corners: Vec<DVec3> = corners.into_iter().map(DVec3::from_array).collect();
        let [point, normal] = [point, normal].map(DVec3::from_array);
        for (corners, normal) in [(&corners[..], DVec3::Z), (&corners[..], normal), (&[][..], normal)] {
            let p = form_factor(corners, point, normal);
            let sound = corners.iter().all(|corner| corner.is_finite()) && normal.is_finite()
                && normal != DVec3::ZERO;
            prop_assert!(if sound { (0.0..=1.0).contains(&p) } else { p.is_nan() }, "{p:?} of {corners:?}");
        }
    }
}
