//! Where a ray ends: two slab tests.
//!
//! A ray is inside the room and outside the cube. So it ends at the first plane of the room ahead, unless it
//! enters the cube before that. The coordinate along the normal of the face that it hits is set exactly, and
//! the others are kept within the face. So no ray starts behind its face, none hits the face it starts on,
//! and no offset has to be added.

use glam::DVec3;

use super::face::{Face, Vertex};

/// The first point that a ray from `from` hits in `direction` (of any length, in the room's coordinates).
/// `None` if the direction is 0, not finite, or points below the horizon of `from`.
///
/// Every ray ends on a face, also in special cases:
/// - Along a face of the room, it goes on to the wall ahead. Along a face of the cube, or through an edge or
///   corner of it without entering, it passes.
/// - Into an edge or corner of the room, it ends there, on one of the faces that meet.
/// - Along the floor, it ends at the cube: nothing passes under it.
/// - From an edge between two faces of the room towards the other face, it ends where it starts, on that
///   other face.
///
/// ```
/// use glam::DVec3;
/// use unbiased::paths::room::{Face, Vertex, nearest_hit};
///
/// let p = Vertex::at([0.0, 0.0, 1.0])?;
/// let hit = nearest_hit(&p, DVec3::new(1.0, 0.0, 1.0)).unwrap();
/// assert_eq!((hit.face(), hit.position()), (Face::East, DVec3::new(2.0, 0.0, 3.0)));
/// assert_eq!(nearest_hit(&p, DVec3::NEG_Z), None);
/// # Ok::<(), unbiased::Error>(())
/// ```
pub fn nearest_hit(from: &Vertex, direction: DVec3) -> Option<Vertex> {
    let largest = direction.abs().max_element();
    if !(direction.is_finite() && largest > 0.0 && from.normal().dot(direction) >= 0.0) {
        return None;
    }
    // normalized in two steps, as the largest component may be subnormal
    let scaled = direction / largest;
    Some(nearest(from.position(), scaled / scaled.length()))
}

/// The same for a unit direction that is known to be above the horizon.
#[inline]
pub(crate) fn nearest(origin: DVec3, direction: DVec3) -> Vertex {
    let ray = Ray::new(origin, direction);
    let (to_wall, wall) = ray.room();
    let (enters, leaves, side) = ray.cube();
    let (distance, face) =
        if blocks(enters, leaves) && enters <= to_wall { (enters.max(0.0), side) } else { (to_wall, wall) };
    ray.at(distance, face)
}

/// Whether `to`, a point of the room, is visible from `from`: the cube may be touched, but does not hide it.
/// A point that is not finite is not visible.
///
/// ```
/// use glam::DVec3;
/// use unbiased::paths::room::{Vertex, visible};
///
/// let floor = Vertex::at([1.5, 0.0, 0.0])?;
/// assert!(visible(&floor, DVec3::new(0.5, 0.0, 4.0)));
/// assert!(!visible(&floor, DVec3::new(-1.5, 0.0, 0.5)));
/// # Ok::<(), unbiased::Error>(())
/// ```
#[inline]
pub fn visible(from: &Vertex, to: DVec3) -> bool {
    to.is_finite() && sees(from, to)
}

/// The same for a point that is known to be finite.
#[inline]
pub(crate) fn sees(from: &Vertex, to: DVec3) -> bool {
    let origin = from.position();
    if origin.z.min(to.z) >= Face::CUBE_HEIGHT {
        return true; // quickly, for most
    }
    let (enters, leaves, _) = Ray::new(origin, to - origin).cube();
    // if `to` lies on the cube, `enters` is 1 up to rounding
    !(blocks(enters, leaves) && enters < 1.0 - f64::EPSILON)
}

/// Whether a line that enters and leaves the cube at these distances does so ahead of its origin. An origin
/// that rounding has put just inside the cube counts as on the nearer face, so that a ray away from that face
/// does not come out on the other side.
#[inline]
fn blocks(enters: f64, leaves: f64) -> bool {
    enters < leaves && enters + leaves > 0.0
}

/// A ray, in the form that both tests need.
struct Ray {
    origin: DVec3,
    direction: DVec3,
    inverse: DVec3,
}

impl Ray {
    #[inline]
    fn new(origin: DVec3, direction: DVec3) -> Self {
        // components so small that their inverse may overflow move nothing in a room of a few metres
        let flat = |d: f64| if d.abs() < 1e-300 { 0.0 } else { d };
        let direction = DVec3::new(flat(direction.x), flat(direction.y), flat(direction.z));
        Self { origin, direction, inverse: direction.recip() }
    }

    /// The distance of the first of the room's planes, and its face.
    #[inline]
    fn room(&self) -> (f64, Face) {
        let w = Face::ROOM_HALF_WIDTH;
        let x = self.ahead(self.direction.x, self.origin.x, self.inverse.x, -w, w);
        let y = self.ahead(self.direction.y, self.origin.y, self.inverse.y, -w, w);
        let z = self.ahead(self.direction.z, self.origin.z, self.inverse.z, 0.0, Face::ROOM_HEIGHT);
        let pick = |ahead: bool, high, low| if ahead { high } else { low };
        // one selection after another: a branch for the least of three would be mispredicted
        let mut first = (x, pick(self.direction.x > 0.0, Face::East, Face::West));
        if y < first.0 {
            first = (y, pick(self.direction.y > 0.0, Face::North, Face::South));
        }
        if z < first.0 {
            first = (z, pick(self.direction.z > 0.0, Face::Ceiling, Face::Floor));
        }
        first
    }

    /// The distance of the plane ahead on one axis.
    #[inline]
    fn ahead(&self, direction: f64, origin: f64, inverse: f64, low: f64, high: f64) -> f64 {
        if direction == 0.0 {
            return f64::INFINITY;
        }
        let plane = if direction > 0.0 { high } else { low };
        (plane - origin) * inverse
    }

    /// The distances at which the ray's line enters and leaves the cube, and the face that it enters by. The
    /// line hits the cube if it enters before it leaves. The cube has no lower end in z, as nothing passes
    /// under it.
    #[inline]
    fn cube(&self) -> (f64, f64, Face) {
        let (w, top) = (Face::CUBE_HALF_WIDTH, Face::CUBE_HEIGHT);
        let (x_in, x_out) = between(self.direction.x, self.origin.x, self.inverse.x, w);
        let (y_in, y_out) = between(self.direction.y, self.origin.y, self.inverse.y, w);
        let to_top = (top - self.origin.z) * self.inverse.z;
        let (z_in, z_out) = match self.direction.z {
            z if z > 0.0 => (f64::NEG_INFINITY, to_top),
            z if z < 0.0 => (to_top, f64::INFINITY),
            _ if self.origin.z < top => (f64::NEG_INFINITY, f64::INFINITY),
            _ => (f64::INFINITY, f64::NEG_INFINITY),
        };
        let pick = |ahead: bool, low, high| if ahead { low } else { high };
        let mut last = (x_in, pick(self.direction.x > 0.0, Face::CubeWest, Face::CubeEast));
        if y_in > last.0 {
            last = (y_in, pick(self.direction.y > 0.0, Face::CubeSouth, Face::CubeNorth));
        }
        if z_in > last.0 {
            last = (z_in, Face::CubeTop);
        }
        (last.0, x_out.min(y_out).min(z_out), last.1)
    }

    /// The point at this distance, put on its face exactly.
    #[inline]
    fn at(&self, distance: f64, face: Face) -> Vertex {
        let [low, high] = face.bounds();
        Vertex::new((self.origin + self.direction * distance).clamp(low, high), face)
    }
}

/// Where a line enters and leaves the slab from −w to w on one axis. A line parallel to the slab is inside if
/// it is strictly between the planes.
#[inline]
fn between(direction: f64, origin: f64, inverse: f64, w: f64) -> (f64, f64) {
    if direction == 0.0 {
        let inside = if origin.abs() < w { f64::INFINITY } else { f64::NEG_INFINITY };
        return (-inside, inside);
    }
    let (low, high) = ((-w - origin) * inverse, (w - origin) * inverse);
    (low.min(high), low.max(high))
}
