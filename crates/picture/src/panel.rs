//! What a panel shows.

use std::borrow::Cow;

use glam::DVec3;
use isochore_mesh::TriMesh;

use crate::tube;

/// The color of fired clay, linear RGB: the paint of a body that has none of its own.
const CLAY: DVec3 = DVec3::new(0.58, 0.33, 0.21);

/// A mesh and how it is painted.
#[derive(Debug, Clone)]
pub struct Body<'a> {
    pub(crate) mesh: Cow<'a, TriMesh>,
    pub(crate) paint: Paint<'a>,
}

/// Colors of a body's surface, linear RGB from 0 to 1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Paint<'a> {
    /// One color all over.
    Uniform(DVec3),
    /// One color a vertex, blended in between.
    Vertices(&'a [DVec3]),
    /// One color a triangle.
    Triangles(&'a [DVec3]),
}

impl<'a> Body<'a> {
    /// A body in the color of clay.
    pub fn new(mesh: &'a TriMesh) -> Self {
        Self { mesh: Cow::Borrowed(mesh), paint: Paint::Uniform(CLAY) }
    }

    /// The same body in other colors.
    pub fn with_paint(self, paint: Paint<'a>) -> Self {
        Self { paint, ..self }
    }

    /// A polyline as a tube of `radius` (model units), in one linear RGB `color`. Fewer than two distinct points give
    /// nothing to see.
    pub fn polyline(points: &[DVec3], radius: f64, color: DVec3) -> Body<'static> {
        Body { mesh: Cow::Owned(tube::polyline(points, radius)), paint: Paint::Uniform(color) }
    }

    /// Arrows from each first to each second point, with shafts of `radius` (model units), in one linear RGB `color`.
    /// An arrow without length is left out.
    pub fn arrows(arrows: &[(DVec3, DVec3)], radius: f64, color: DVec3) -> Body<'static> {
        Body { mesh: Cow::Owned(tube::arrows(arrows, radius)), paint: Paint::Uniform(color) }
    }
}

/// One of the fields of a picture: bodies and a caption below them.
#[derive(Debug, Clone, Default)]
pub struct Panel<'a> {
    pub(crate) bodies: Vec<Body<'a>>,
    pub(crate) caption: String,
}

impl<'a> Panel<'a> {
    /// An empty panel. Lines of the `caption` are separated by `\n`; an empty one takes no room.
    pub fn new(caption: impl Into<String>) -> Self {
        Self { bodies: Vec::new(), caption: caption.into() }
    }

    /// This panel with one more body.
    pub fn with(mut self, body: Body<'a>) -> Self {
        self.bodies.push(body);
        self
    }
}
