//! The faces of room and cube, and points on them.

use glam::DVec3;

use crate::error::{Error, Result};
use crate::lambertian::hemisphere::Direction;

/// A face of the room, seen from inside, or of the cube, seen from outside. The light is a part of the
/// ceiling.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Face {
    /// The cube's top z = 1.
    CubeTop,
    /// The cube's side x = −½.
    CubeWest,
    /// The cube's side x = ½.
    CubeEast,
    /// The cube's side y = −½.
    CubeSouth,
    /// The cube's side y = ½.
    CubeNorth,
    /// z = 0, outside the cube.
    Floor,
    /// z = 4.
    Ceiling,
    /// The wall x = −2.
    West,
    /// The wall x = 2.
    East,
    /// The wall y = −2.
    South,
    /// The wall y = 2.
    North,
}

impl Face {
    /// Half the room's width in metres.
    pub(crate) const ROOM_HALF_WIDTH: f64 = 2.0;
    /// The room's height in metres.
    pub(crate) const ROOM_HEIGHT: f64 = 4.0;
    /// Half the cube's width in metres.
    pub(crate) const CUBE_HALF_WIDTH: f64 = 0.5;
    /// The cube's height in metres.
    pub(crate) const CUBE_HEIGHT: f64 = 1.0;

    /// All faces; on an edge, [`Vertex::at`] takes the first one that fits.
    pub const ALL: [Self; 11] = [
        Self::CubeTop,
        Self::CubeWest,
        Self::CubeEast,
        Self::CubeSouth,
        Self::CubeNorth,
        Self::Floor,
        Self::Ceiling,
        Self::West,
        Self::East,
        Self::South,
        Self::North,
    ];

    /// Whether it belongs to the cube.
    #[inline]
    pub(crate) fn is_cube(self) -> bool {
        self as u8 <= Self::CubeNorth as u8
    }

    /// The normal, which points into the room and away from the cube.
    ///
    /// ```
    /// use glam::DVec3;
    /// use unbiased::paths::room::Face;
    ///
    /// assert_eq!((Face::CubeTop.normal(), Face::Ceiling.normal()), (DVec3::Z, DVec3::NEG_Z));
    /// ```
    #[inline]
    pub fn normal(self) -> DVec3 {
        self.frame()[2]
    }

    /// Two tangents and the normal.
    #[inline]
    fn frame(self) -> &'static [DVec3; 3] {
        // the index is always in range; the remainder lets the compiler know
        &FRAMES[self as usize % FRAMES.len()]
    }

    /// The smallest and the largest coordinates of the face, in metres. The floor's are those of the whole
    /// square, with the part under the cube.
    #[inline]
    pub(crate) fn bounds(self) -> [DVec3; 2] {
        BOUNDS[self as usize % BOUNDS.len()]
    }

    /// The area in m²: the floor's without the part under the cube, the ceiling's with the light.
    ///
    /// ```
    /// use unbiased::paths::room::Face;
    ///
    /// assert_eq!(Face::ALL.map(Face::area).iter().sum::<f64>(), 5.0 + 15.0 + 5.0 * 16.0);
    /// ```
    pub fn area(self) -> f64 {
        match self {
            Self::Floor => 15.0,
            _ if self.is_cube() => 1.0,
            _ => 16.0,
        }
    }
}

/// Two tangents and the normal of each face, in the order of [`Face::ALL`]. Some frames are left-handed,
/// which makes no difference to directions that are symmetric around the normal.
const FRAMES: [[DVec3; 3]; 11] = [
    [DVec3::X, DVec3::Y, DVec3::Z],
    [DVec3::Y, DVec3::Z, DVec3::NEG_X],
    [DVec3::Y, DVec3::Z, DVec3::X],
    [DVec3::X, DVec3::Z, DVec3::NEG_Y],
    [DVec3::X, DVec3::Z, DVec3::Y],
    [DVec3::X, DVec3::Y, DVec3::Z],
    [DVec3::X, DVec3::Y, DVec3::NEG_Z],
    [DVec3::Y, DVec3::Z, DVec3::X],
    [DVec3::Y, DVec3::Z, DVec3::NEG_X],
    [DVec3::X, DVec3::Z, DVec3::Y],
    [DVec3::X, DVec3::Z, DVec3::NEG_Y],
];

/// The lower and upper ends of each face, in the order of [`Face::ALL`].
const BOUNDS: [[DVec3; 2]; 11] = {
    const W: f64 = Face::ROOM_HALF_WIDTH;
    const H: f64 = Face::ROOM_HEIGHT;
    const C: f64 = Face::CUBE_HALF_WIDTH;
    const T: f64 = Face::CUBE_HEIGHT;
    [
        [DVec3::new(-C, -C, T), DVec3::new(C, C, T)],
        [DVec3::new(-C, -C, 0.0), DVec3::new(-C, C, T)],
        [DVec3::new(C, -C, 0.0), DVec3::new(C, C, T)],
        [DVec3::new(-C, -C, 0.0), DVec3::new(C, -C, T)],
        [DVec3::new(-C, C, 0.0), DVec3::new(C, C, T)],
        [DVec3::new(-W, -W, 0.0), DVec3::new(W, W, 0.0)],
        [DVec3::new(-W, -W, H), DVec3::new(W, W, H)],
        [DVec3::new(-W, -W, 0.0), DVec3::new(-W, W, H)],
        [DVec3::new(W, -W, 0.0), DVec3::new(W, W, H)],
        [DVec3::new(-W, -W, 0.0), DVec3::new(W, -W, H)],
        [DVec3::new(-W, W, 0.0), DVec3::new(W, W, H)],
    ]
};

/// A point on a face: a vertex of a path.
///
/// ```
/// use unbiased::paths::room::{Face, Vertex};
///
/// let p = Vertex::at([0.0, 0.0, 1.0])?;
/// assert_eq!(p.face(), Face::CubeTop);
/// # Ok::<(), unbiased::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Vertex {
    position: DVec3,
    face: Face,
}

impl Vertex {
    /// The point at these coordinates, with the face that it lies on. On an edge, which several faces share,
    /// the cube's top comes first, then the cube's sides, the floor, the ceiling and the walls.
    ///
    /// ```
    /// use unbiased::paths::room::{Face, Vertex};
    ///
    /// assert_eq!(Vertex::at([2.0, 2.0, 3.0])?.face(), Face::East);
    /// let error = Vertex::at([0.0, 0.25, 0.0]).unwrap_err();
    /// let sentence = "lies under the cube: on the floor, |x| or |y| must be at least 0.5";
    /// assert_eq!(error.to_string(), format!("the point (0, 0.25, 0) {sentence}"));
    /// # Ok::<(), unbiased::Error>(())
    /// ```
    ///
    /// # Errors
    /// If no face is there, or only the part of the floor that the cube stands on.
    pub fn at(point: [f64; 3]) -> Result<Self> {
        let position = DVec3::from_array(point);
        let contains = |face: &Face| {
            let [low, high] = face.bounds();
            position.cmpge(low).all() && position.cmple(high).all()
        };
        match Face::ALL.into_iter().find(contains) {
            Some(Face::Floor) if under_the_cube(position) => {
                Err(off(point, "lies under the cube: on the floor, |x| or |y| must be at least 0.5"))
            }
            Some(face) => Ok(Self { position, face }),
            None => Err(off(point, NO_FACE)),
        }
    }

    #[inline]
    pub(super) fn new(position: DVec3, face: Face) -> Self {
        Self { position, face }
    }

    /// The position, in metres.
    #[inline]
    pub fn position(&self) -> DVec3 {
        self.position
    }

    /// The face that it lies on.
    #[inline]
    pub fn face(&self) -> Face {
        self.face
    }

    /// The normal there.
    #[inline]
    pub fn normal(&self) -> DVec3 {
        self.face.normal()
    }

    /// A direction above this point's face, given in the face's own frame with z along the normal, in the
    /// room's coordinates.
    ///
    /// ```
    /// use glam::DVec3;
    /// use unbiased::paths::room::Vertex;
    /// use unbiased::lambertian::hemisphere::Direction;
    ///
    /// let east = Vertex::at([2.0, 0.3, 3.0])?;
    /// assert_eq!(east.to_room(&Direction::new(0.0, 0.0, 1.0)?), DVec3::NEG_X);
    /// # Ok::<(), unbiased::Error>(())
    /// ```
    #[inline]
    pub fn to_room(&self, direction: &Direction) -> DVec3 {
        let [tangent, other, normal] = self.face.frame();
        let local = direction.vector();
        *tangent * local.x + *other * local.y + *normal * local.z
    }
}

const NO_FACE: &str = "lies on no face: it must lie on the room's (|x| = 2, |y| = 2, z = 0 or z = 4) or on \
                       the cube's (|x| = 0.5 or |y| = 0.5 up to z = 1, or z = 1 within)";

fn under_the_cube(position: DVec3) -> bool {
    position.x.abs().max(position.y.abs()) < Face::CUBE_HALF_WIDTH
}

/// The error for a point that is not a valid vertex.
pub(super) fn off([x, y, z]: [f64; 3], reason: &'static str) -> Error {
    Error::Point { x, y, z, reason }
}
