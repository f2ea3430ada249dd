//! Panels and the bodies that they show.

use std::borrow::Cow;

use glam::DVec3;
use isochore_mesh::TriMesh;

use crate::tube;

/// Default paint of a body: the color of fired clay, linear RGB.
const CLAY: DVec3 = DVec3::new(0.58, 0.33, 0.21);

/// A mesh with its paint.
#[derive(Debug, Clone)]
pub struct Body<'a> {
    pub(crate) mesh: Cow<'a, TriMesh>,
    pub(crate) paint: Paint<'a>,
}

/// Colors of a body's surface, linear RGB from 0 to 1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Paint<'a> {
    /// One color for the whole body.
    Uniform(DVec3),
    /// One color per vertex, interpolated across triangles.
    Vertices(&'a [DVec3]),
    /// One color per triangle.
    Triangles(&'a [DVec3]),
}

impl<'a> Body<'a> {
    /// Creates a body in the color of clay.
    pub fn new(mesh: &'a TriMesh) -> Self {
        Self { mesh: Cow::Borrowed(mesh), paint: Paint::Uniform(CLAY) }
    }

    /// Replaces the paint.
    pub fn with_paint(self, paint: Paint<'a>) -> Self {
        Self { paint, ..self }
    }

    /// Creates a tube of `radius` (model units) around a polyline, in one linear RGB `color`. The
    /// body is empty if there are fewer than two distinct points.
    ///
    /// # Examples
    /// ```
    /// use glam::DVec3;
    /// use isochore_picture::{Body, Camera, Options, Panel, render};
    ///
    /// let path = Body::polyline(&[DVec3::ZERO, DVec3::X, DVec3::ONE], 0.02, DVec3::new(0.1, 0.2, 0.6));
    /// let options = Options { width: 64, height: 64, ..Options::default() };
    /// let picture = render(&[Panel::new("path").with(path)], &Camera::default(), &options)?;
    /// assert_eq!((picture.width(), picture.height()), (64, 64));
    /// # Ok::<(), isochore_picture::PictureError>(())
    /// ```
    pub fn polyline(points: &[DVec3], radius: f64, color: DVec3) -> Body<'static> {
        Body { mesh: Cow::Owned(tube::polyline(points, radius)), paint: Paint::Uniform(color) }
    }

    /// Creates arrows from the first point of each pair to the second, with shafts of `radius`
    /// (model units), in one linear RGB `color`. Arrows of zero length are omitted.
    pub fn arrows(arrows: &[(DVec3, DVec3)], radius: f64, color: DVec3) -> Body<'static> {
        Body { mesh: Cow::Owned(tube::arrows(arrows, radius)), paint: Paint::Uniform(color) }
    }
}

/// One panel of a picture: bodies with a caption below them.
#[derive(Debug, Clone, Default)]
pub struct Panel<'a> {
    pub(crate) bodies: Vec<Body<'a>>,
    pub(crate) caption: String,
}

impl<'a> Panel<'a> {
    /// Creates a panel without bodies. Lines of the `caption` are separated by `\n`. An empty
    /// caption takes no space.
    pub fn new(caption: impl Into<String>) -> Self {
        Self { bodies: Vec::new(), caption: caption.into() }
    }

    /// Adds a body.
    pub fn with(mut self, body: Body<'a>) -> Self {
        self.bodies.push(body);
        self
    }
}
