//! Section 4: the box room, the scene of the worksheet's paths.
//!
//! In metres, z up: a room \[−2, 2\]×\[−2, 2\]×\[0, 4\] of diffuse faces; the cube \[−½, ½\]²×\[0, 1\] on its
//! floor; a square light in the middle of the ceiling, which faces down and reflects nothing; and p, the
//! point whose radiance is asked for. The shapes are fixed, so a ray needs two slab tests, one from inside
//! the room and one from outside the cube: [`nearest_hit`] and [`visible`]. The other numbers can be chosen:
//! [`Scene`] holds them, and [`BoxRoom`] is a scene that has been checked.
//!
//! The radiance after one bounce has a closed form if the cube hides nothing, [`BoxRoom::direct`], made of
//! the form factor of a polygon, [`form_factor`]. Radiance after more bounces is estimated by
//! [`paths`](crate::paths).

use glam::DVec3;

use crate::error::{Result, require};
use crate::stream::Stream;

pub(crate) mod exact;
mod face;
mod polygon;
mod ray;
mod volume;

pub use face::{Face, Vertex};
pub use polygon::form_factor;
pub(crate) use ray::nearest;
use ray::sees;
pub use ray::{nearest_hit, visible};

/// The numbers of the scene, unchecked; [`Default`] is the worksheet's.
///
/// ```
/// use unbiased::paths::room::{BoxRoom, Scene};
///
/// let dark_walls = BoxRoom::new(Scene { wall_albedo: 0.1, ..Scene::default() })?;
/// assert_eq!(dark_walls.scene().cube_albedo, 0.8);
/// # Ok::<(), unbiased::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Scene {
    /// The albedo ρ of the room's six faces, 0.5.
    pub wall_albedo: f64,
    /// The albedo ρ of the cube's five faces, 0.8.
    pub cube_albedo: f64,
    /// The radiance L_e of the light in W m⁻² sr⁻¹, 10. 0, or from 1e-100 to 1e100, so that neither its
    /// products with areas and weights nor their squares leave the range of `f64`.
    pub radiance: f64,
    /// Half the light's side in metres, ½. From 1e-50 to 2, or 0 for no light.
    pub light_half_width: f64,
    /// The radiance in W m⁻² sr⁻¹ that every face but the light emits: 0, within the same limits. With
    /// emission and no light the room is a furnace test, in which every radiance is known exactly.
    pub emission: f64,
    /// The point p, (0, 0, 1): the middle of the cube's top.
    pub point: [f64; 3],
}

impl Default for Scene {
    fn default() -> Self {
        Self {
            wall_albedo: 0.5,
            cube_albedo: 0.8,
            radiance: 10.0,
            light_half_width: 0.5,
            emission: 0.0,
            point: [0.0, 0.0, 1.0],
        }
    }
}

/// A scene that has been checked.
///
/// ```
/// use unbiased::paths::room::{BoxRoom, Scene};
///
/// let room = BoxRoom::new(Scene::default())?;
/// assert!((room.direct(&room.point()) - 0.2728543591976926).abs() < 1e-15);
/// let error = BoxRoom::new(Scene { point: [0.0, 0.0, 1.5], ..Scene::default() }).unwrap_err();
/// assert!(error.to_string().starts_with("the point (0, 0, 1.5) lies on no face: "));
/// # Ok::<(), unbiased::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BoxRoom {
    scene: Scene,
    point: Vertex,
}

impl BoxRoom {
    /// The scene, checked.
    ///
    /// # Errors
    /// If an albedo is not in \[0, 1\], the radiance or the emission is neither 0 nor from 1e-100 to 1e100,
    /// the light is larger than the ceiling or its half-width is below 1e-50 m, or p lies on no face, under
    /// the cube, or on the light, which reflects nothing.
    pub fn new(scene: Scene) -> Result<Self> {
        let fraction = |name, albedo: f64| {
            let allowed = "between 0 and 1 (above 1 it would create energy)";
            require(name, albedo, (0.0..=1.0).contains(&albedo), allowed)
        };
        let radiance = |name, value: f64| {
            let ok = value == 0.0 || (1e-100..=1e100).contains(&value);
            require(name, value, ok, "0, or from 1e-100 to 1e100")
        };
        fraction("the walls' albedo", scene.wall_albedo)?;
        fraction("the cube's albedo", scene.cube_albedo)?;
        radiance("the light's radiance", scene.radiance)?;
        radiance("the faces' emission", scene.emission)?;
        let h = scene.light_half_width;
        let fits = h == 0.0 || (1e-50..=Face::ROOM_HALF_WIDTH).contains(&h);
        require("the light's half-width", h, fits, "0 (no light), or from 1e-50 to 2 (all of the ceiling)")?;
        let point = Vertex::at(scene.point)?;
        let room = Self { scene, point };
        if room.is_light(&point) {
            let reason = "lies on the light, which reflects nothing: on the ceiling, |x| or |y| must be \
                          above the light's half-width";
            return Err(face::off(scene.point, reason));
        }
        Ok(room)
    }

    /// Its numbers.
    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    /// The point p with its face.
    pub fn point(&self) -> Vertex {
        self.point
    }

    /// Whether a point belongs to the light, its edge included.
    ///
    /// ```
    /// use unbiased::paths::room::{BoxRoom, Scene, Vertex};
    ///
    /// let room = BoxRoom::new(Scene::default())?;
    /// let [light, ceiling] = [Vertex::at([0.5, 0.0, 4.0])?, Vertex::at([0.6, 0.0, 4.0])?];
    /// assert_eq!([light, ceiling].map(|at| room.is_light(&at)), [true, false]);
    /// assert_eq!([light, ceiling].map(|at| room.albedo(&at)), [0.0, 0.5]);
    /// assert_eq!([light, ceiling].map(|at| room.emitted(&at)), [10.0, 0.0]);
    /// # Ok::<(), unbiased::Error>(())
    /// ```
    #[inline]
    pub fn is_light(&self, vertex: &Vertex) -> bool {
        let (h, at) = (self.scene.light_half_width, vertex.position());
        vertex.face() == Face::Ceiling && at.x.abs().max(at.y.abs()) <= h && h > 0.0
    }

    /// The albedo ρ at a point: the walls', the cube's, or 0 on the light. [`is_light`](Self::is_light) has
    /// an example.
    #[inline]
    pub fn albedo(&self, vertex: &Vertex) -> f64 {
        match vertex.face() {
            face if face.is_cube() => self.scene.cube_albedo,
            _ if self.is_light(vertex) => 0.0,
            _ => self.scene.wall_albedo,
        }
    }

    /// The radiance L_e that a point emits, in W m⁻² sr⁻¹: the light's radiance, or the faces' emission.
    /// [`is_light`](Self::is_light) has an example.
    #[inline]
    pub fn emitted(&self, vertex: &Vertex) -> f64 {
        if self.is_light(vertex) { self.scene.radiance } else { self.scene.emission }
    }

    /// The light's four corners, as [`form_factor`] takes them.
    ///
    /// ```
    /// use unbiased::paths::room::{BoxRoom, Scene, form_factor};
    ///
    /// let room = BoxRoom::new(Scene::default())?;
    /// let p = room.point();
    /// let seen = form_factor(&room.light_corners(), p.position(), p.normal());
    /// assert_eq!(room.direct(&p), 0.8 * 10.0 * seen);
    /// assert_eq!(room.light_area(), 1.0);
    /// # Ok::<(), unbiased::Error>(())
    /// ```
    pub fn light_corners(&self) -> [DVec3; 4] {
        let h = self.scene.light_half_width;
        [[-h, -h], [h, -h], [h, h], [-h, h]].map(|[x, y]| DVec3::new(x, y, Face::ROOM_HEIGHT))
    }

    /// The light's area in m², the square of its side. [`light_corners`](Self::light_corners) has an example.
    pub fn light_area(&self) -> f64 {
        let side = 2.0 * self.scene.light_half_width;
        side * side
    }

    /// The radiance, in W m⁻² sr⁻¹, that comes from the light and leaves a point after one bounce, ρ L_e P
    /// with P the light's [`form_factor`], **as if the cube hid nothing**.
    /// [`light_corners`](Self::light_corners) has an example.
    ///
    /// The cube hides a part of the light only from the floor near it, where max(|x|, |y|) < (2 + h)/3 for a
    /// light of half-width h; [`one_bounce`](Self::one_bounce) accounts for that.
    pub fn direct(&self, vertex: &Vertex) -> f64 {
        let seen = form_factor(&self.light_corners(), vertex.position(), vertex.normal());
        self.albedo(vertex) * self.scene.radiance * seen
    }

    /// A point drawn uniformly on the light, and the irradiance that it gives at `vertex`.
    #[inline]
    pub(crate) fn sample_light(&self, vertex: &Vertex, rng: &mut Stream) -> LightSample {
        let h = self.scene.light_half_width;
        let (u, v) = (rng.uniform(), rng.uniform());
        let point = DVec3::new(h * (2.0 * u - 1.0), h * (2.0 * v - 1.0), Face::ROOM_HEIGHT);
        let way = point - vertex.position();
        // r cos θ at the vertex, and at the light, which looks down
        let (here, there) = (vertex.normal().dot(way), way.z);
        if here <= 0.0 || there <= 0.0 {
            return LightSample { point, irradiance: 0.0, visible: false };
        }
        rng.count_evaluations(1);
        let visible = sees(vertex, point);
        let r2 = way.length_squared();
        let geometry = here * there / (r2 * r2);
        let irradiance = if visible { self.scene.radiance * self.light_area() * geometry } else { 0.0 };
        LightSample { point, irradiance, visible }
    }
}

/// A light sample: a uniform point of the light.
#[derive(Debug, Clone, Copy)]
pub(crate) struct LightSample {
    /// The position of the point.
    pub point: DVec3,
    /// L_e A cos θ cos θ′/r², an unbiased estimate of the irradiance in W m⁻²; 0 if the point is not visible.
    pub irradiance: f64,
    /// Whether it is visible.
    pub visible: bool,
}
