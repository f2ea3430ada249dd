//! Masks, which hold material in place, and planes about which the flow is symmetric.
//!
//! A mask is a smooth function m of space: zero where the material is held, one where it is free.
//! It multiplies the vector potential P, never the velocity V:
//!
//! ```text
//! V′ = curl(m P) = m V + ∇m × P
//! ```
//!
//! As a curl, the masked field is divergence-free. If m is zero in a neighborhood of a point, so is
//! V′, and the coordinates of the point keep their bits.
//!
//! The mask is the product of the factors of pins and painted vertices over all mirror images.

pub(crate) mod masked_field;
mod mirror_plane;
pub(crate) mod mirrored_field;
mod pin;
mod vertex_mask;

use glam::DVec3;
use isochore_mesh::{LANES, PointBlock};

pub use mirror_plane::MirrorPlane;
pub use pin::Pin;
pub use vertex_mask::VertexMask;

use crate::fields::ScalarBlock;

/// Largest deviation of two mirror planes from perpendicular, as the cosine of the angle between
/// their normals. Larger: the second plane visibly breaks the symmetry about the first. Smaller:
/// rejects normals typed with six digits.
const PERPENDICULAR: f64 = 1e-6;

/// Pins, a mask painted on vertices, and mirror planes, fixed in the space of the target at rest.
///
/// # Examples
/// ```
/// use glam::DVec3;
/// use isochore_field::{Mask, Pin};
///
/// let pin = Pin::new(DVec3::ZERO, 0.5, 0.2)?;
/// let mask = Mask::new(vec![pin], None, Vec::new())?;
/// assert!(mask.is_held(DVec3::X * 0.4));
/// assert!(!mask.is_held(DVec3::X));
/// # Ok::<(), isochore_field::MaskError>(())
/// ```
#[derive(Debug, Clone, Default)]
pub struct Mask {
    pins: Vec<Pin>,
    vertices: Option<VertexMask>,
    mirrors: Vec<MirrorPlane>,
}

impl Mask {
    /// A mask of pins, painted vertices and mirror planes. The mirror images of pins and painted
    /// vertices also hold.
    ///
    /// # Errors
    /// [`MaskError::NotPerpendicular`] if two mirror planes are not perpendicular to each other.
    pub fn new(pins: Vec<Pin>, vertices: Option<VertexMask>, mirrors: Vec<MirrorPlane>) -> Result<Self, MaskError> {
        for (second, plane) in mirrors.iter().enumerate() {
            let is_slanted = |other: &MirrorPlane| other.normal().dot(plane.normal()).abs() > PERPENDICULAR;
            if let Some(first) = mirrors[..second].iter().position(is_slanted) {
                return Err(MaskError::NotPerpendicular { first, second });
            }
        }
        Ok(Self { pins, vertices, mirrors })
    }

    /// Whether the mask leaves every field unchanged.
    pub fn is_empty(&self) -> bool {
        !self.holds() && self.mirrors.is_empty()
    }

    /// Whether a point is held, so that no stroke moves it.
    pub fn is_held(&self, point: DVec3) -> bool {
        self.holds() && self.symmetric_factor(&self.mirrors, point).value == 0.0
    }

    /// Whether the mask has pins or painted vertices.
    pub(crate) fn holds(&self) -> bool {
        !self.pins.is_empty() || self.vertices.is_some()
    }

    /// Planes about which fields are made symmetric.
    pub(crate) fn mirrors(&self) -> &[MirrorPlane] {
        &self.mirrors
    }

    /// Writes m at the `points` whose lanes are active; other lanes of `out` do not change.
    pub(crate) fn evaluate_into(&self, points: &PointBlock, is_active: [bool; LANES], out: &mut ScalarBlock) {
        for lane in (0..LANES).filter(|&lane| is_active[lane]) {
            let factor = self.symmetric_factor(&self.mirrors, points.get(lane));
            out.value[lane] = factor.value;
            out.gradient.set(lane, factor.gradient);
        }
    }

    /// Smallest length over which m varies.
    pub(crate) fn feature_size(&self) -> f64 {
        let pins = self.pins.iter().map(Pin::support);
        pins.chain(self.vertices.as_ref().map(VertexMask::feature_size)).fold(f64::INFINITY, f64::min)
    }

    /// Smallest length over which m varies within a ball; infinite if m is one in the whole ball.
    pub(crate) fn feature_size_near(&self, center: DVec3, radius: f64) -> f64 {
        let mut size = f64::INFINITY;
        for image in images(&self.mirrors, center) {
            let pins = self.pins.iter().filter(|pin| pin.may_touch(image, radius)).map(Pin::support);
            let vertices = self.vertices.iter().filter(|mask| mask.may_touch(image, radius));
            size = pins.chain(vertices.map(VertexMask::feature_size)).fold(size, f64::min);
        }
        size
    }

    /// Points where m varies, at which the speed of a masked field is sampled.
    pub(crate) fn probes(&self) -> Vec<DVec3> {
        let probes = self.pins.iter().flat_map(Pin::probes);
        let probes = probes.chain(self.vertices.iter().flat_map(VertexMask::probes));
        probes.flat_map(|probe| images(&self.mirrors, probe)).collect()
    }

    /// Product of the factors at `point` and at all its mirror images.
    fn symmetric_factor(&self, mirrors: &[MirrorPlane], point: DVec3) -> Factor {
        let Some((plane, others)) = mirrors.split_last() else { return self.factor(point) };
        let image = self.symmetric_factor(others, plane.reflect_point(point));
        let image = Factor { gradient: plane.reflect_vector(image.gradient), ..image };
        self.symmetric_factor(others, point).times(image)
    }

    fn factor(&self, point: DVec3) -> Factor {
        let pins = self.pins.iter().map(|pin| pin.factor(point));
        pins.chain(self.vertices.as_ref().map(|mask| mask.factor(point))).fold(Factor::ONE, Factor::times)
    }
}

/// `point` and all its mirror images.
pub(crate) fn images(mirrors: &[MirrorPlane], point: DVec3) -> Vec<DVec3> {
    mirrors.iter().fold(vec![point], |mut images, plane| {
        images.extend(images.clone().into_iter().map(|image| plane.reflect_point(image)));
        images
    })
}

/// A factor of the mask at one point.
#[derive(Debug, Clone, Copy)]
struct Factor {
    value: f64,
    gradient: DVec3,
}

impl Factor {
    const ONE: Self = Self { value: 1.0, gradient: DVec3::ZERO };

    fn times(self, other: Self) -> Self {
        Self { value: self.value * other.value, gradient: self.gradient * other.value + other.gradient * self.value }
    }
}

/// Errors when constructing a [`Mask`] or its parts.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum MaskError {
    /// A number is infinite or NaN.
    #[error("{0} must be finite")]
    NotFinite(&'static str),
    /// The radius of a pin is negative or not finite.
    #[error("the radius of a pin must be zero or a positive length, not {0}")]
    Radius(f64),
    /// The support of a pin is not a positive length.
    #[error("the support of a pin must be a positive length, not {0}")]
    Support(f64),
    /// The normal of a mirror plane is the zero vector.
    #[error("the normal of a mirror plane must be nonzero")]
    ZeroNormal,
    /// Two mirror planes are not perpendicular. Reflections about such planes generate further
    /// planes, for most angles infinitely many.
    #[error("mirror planes {first} and {second}, counted from 0, are not perpendicular to each other")]
    NotPerpendicular {
        /// Index of the first plane.
        first: usize,
        /// Index of the second plane.
        second: usize,
    },
    /// The number of weights differs from the number of vertices.
    #[error("{found} weights are given for {expected} vertices; give one for each vertex")]
    WeightCount {
        /// Number of weights given.
        found: usize,
        /// Number of vertices of the mesh.
        expected: usize,
    },
    /// A weight is out of range.
    #[error("the weight of vertex {vertex} is {weight}; give a number from 0 (free) to 1 (held)")]
    Weight {
        /// Index of the vertex.
        vertex: usize,
        /// Weight given.
        weight: f64,
    },
    /// The fade of a vertex mask is not a positive length.
    #[error("the fade of a vertex mask must be a positive length, not {0}")]
    Fade(f64),
    /// No fade is given, and the mesh has no edges from which to derive one.
    #[error("the fade of the vertex mask cannot be derived, as the mesh has no edges; give the fade as a length")]
    NoEdges,
    /// The fade is so short that the surface needs too many samples.
    #[error("a fade of {fade} needs more than {most} samples of the surface; choose a longer one")]
    TooManySamples {
        /// Fade given.
        fade: f64,
        /// Largest allowed number of samples.
        most: usize,
    },
    /// The mesh has an index out of range or a coordinate that is not finite.
    #[error("the mesh of a vertex mask has an index out of range or a coordinate that is not finite")]
    Mesh,
}

#[cfg(test)]
pub(crate) mod tests;
