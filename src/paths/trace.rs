//! Traced paths: what a path visits and samples, for drawing.

use glam::DVec3;

use super::Paths;
use super::room::Vertex;
use crate::stream::Stream;

/// What happens along a path.
pub(super) enum Event<'a> {
    Vertex(&'a Vertex),
    Light { point: DVec3, visible: bool },
}

/// A traced path.
#[derive(Debug, Clone, PartialEq)]
pub struct Path {
    /// Its vertices, starting with p; the last one may be on the light.
    pub vertices: Vec<Vertex>,
    /// The light samples drawn along it.
    pub samples: Vec<Sample>,
    /// The radiance that it finds: the draw.
    pub light: f64,
}

/// A point drawn on the light.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sample {
    /// The index of the vertex that it was drawn for.
    pub from: usize,
    /// Where it is.
    pub point: DVec3,
    /// Whether that vertex sees it.
    pub visible: bool,
}

impl Paths {
    /// One path with its vertices, for drawing: the one that [`draw`](crate::Estimator::draw) follows with
    /// the same stream.
    ///
    /// ```
    /// # use unbiased::paths::room::{BoxRoom, Scene};
    /// # use unbiased::lambertian::hemisphere::Hemisphere;
    /// # use unbiased::paths::{Bounces, FindLight, Paths};
    /// # use unbiased::{Estimator, Stream};
    /// let room = BoxRoom::new(Scene::default())?;
    /// let twice = Paths::new(room, Bounces::Exactly(2), Hemisphere::Cosine, FindLight::BySampling)?;
    /// let path = twice.trace(&mut Stream::new(1, 0));
    /// // p and p_j; the light is sampled at p_j
    /// assert_eq!((path.vertices[0], path.vertices.len(), path.samples[0].from), (room.point(), 2, 1));
    /// assert_eq!(path.light, twice.draw(&mut Stream::new(1, 0)));
    /// # Ok::<(), unbiased::Error>(())
    /// ```
    pub fn trace(&self, rng: &mut Stream) -> Path {
        let mut path = Path { vertices: Vec::new(), samples: Vec::new(), light: 0.0 };
        path.light = self.walk(&self.room.point(), rng, |event| match event {
            Event::Vertex(vertex) => path.vertices.push(*vertex),
            Event::Light { point, visible } => {
                path.samples.push(Sample { from: path.vertices.len().saturating_sub(1), point, visible });
            }
        });
        path
    }
}
