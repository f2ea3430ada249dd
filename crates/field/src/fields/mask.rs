//! Masks: where the flow is held back, and planes it is symmetric about.
//!
//! A mask is a smooth scalar m of space, zero where the material is held and one where it is free. It multiplies the vector
//! potential P, never the velocity V:
//!
//! ```text
//! V′ = curl(m P) = m V + ∇m × P
//! ```
//!
//! so that the masked field is divergence-free like any other curl. Where m is zero around a point, so is V′, and the point
//! keeps its bits.

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

/// Normals of two mirror planes may be this far from perpendicular, as the cosine of their angle. Larger lets the second plane
/// visibly break the symmetry about the first; smaller refuses normals typed with six digits.
const PERPENDICULAR: f64 = 1e-6;

/// What holds the flow back, fixed in the space of the target at rest: pins, a mask painted on vertices, and mirror planes.
#[derive(Debug, Clone, Default)]
pub struct Mask {
    pins: Vec<Pin>,
    vertices: Option<VertexMask>,
    mirrors: Vec<MirrorPlane>,
}

impl Mask {
    /// A mask of all that is given; pins and painted vertices also act where the mirrors show them.
    ///
    /// # Errors
    /// [`MaskError::NotPerpendicular`] for mirrors that are not perpendicular to each other.
    pub fn new(pins: Vec<Pin>, vertices: Option<VertexMask>, mirrors: Vec<MirrorPlane>) -> Result<Self, MaskError> {
        for (second, plane) in mirrors.iter().enumerate() {
            let is_slanted = |other: &MirrorPlane| other.normal().dot(plane.normal()).abs() > PERPENDICULAR;
            if let Some(first) = mirrors[..second].iter().position(is_slanted) {
                return Err(MaskError::NotPerpendicular { first, second });
            }
        }
        Ok(Self { pins, vertices, mirrors })
    }

    /// Whether the mask leaves every field as it is.
    pub fn is_empty(&self) -> bool {
        !self.holds() && self.mirrors.is_empty()
    }

    /// Whether a point is held so that no stroke moves it.
    pub fn is_held(&self, point: DVec3) -> bool {
        self.holds() && self.symmetric_factor(&self.mirrors, point).value == 0.0
    }

    /// Whether anything is held, mirrors apart.
    pub(crate) fn holds(&self) -> bool {
        !self.pins.is_empty() || self.vertices.is_some()
    }

    /// The planes that fields are made symmetric about.
    pub(crate) fn mirrors(&self) -> &[MirrorPlane] {
        &self.mirrors
    }

    /// m at those of `points` that are wanted, into their lanes.
    pub(crate) fn evaluate_into(&self, points: &PointBlock, is_wanted: [bool; LANES], out: &mut ScalarBlock) {
        for lane in (0..LANES).filter(|&lane| is_wanted[lane]) {
            let factor = self.symmetric_factor(&self.mirrors, points.get(lane));
            out.value[lane] = factor.value;
            out.gradient.set(lane, factor.gradient);
        }
    }

    /// The smallest length over which m changes.
    pub(crate) fn feature_size(&self) -> f64 {
        let pins = self.pins.iter().map(Pin::support);
        pins.chain(self.vertices.as_ref().map(VertexMask::feature_size)).fold(f64::INFINITY, f64::min)
    }

    /// The smallest length over which m changes in a ball; infinite where m is one all over it.
    pub(crate) fn feature_size_near(&self, center: DVec3, radius: f64) -> f64 {
        let mut size = f64::INFINITY;
        for image in images(&self.mirrors, center) {
            let pins = self.pins.iter().filter(|pin| pin.may_touch(image, radius)).map(Pin::support);
            let vertices = self.vertices.iter().filter(|mask| mask.may_touch(image, radius));
            size = pins.chain(vertices.map(VertexMask::feature_size)).fold(size, f64::min);
        }
        size
    }

    /// Points where m changes, to look for the speed that a field gets there.
    pub(crate) fn probes(&self) -> Vec<DVec3> {
        let probes = self.pins.iter().flat_map(Pin::probes);
        let probes = probes.chain(self.vertices.iter().flat_map(VertexMask::probes));
        probes.flat_map(|probe| images(&self.mirrors, probe)).collect()
    }

    /// The product over all mirror images of `point`.
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

/// Why a mask cannot be.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum MaskError {
    /// A number is infinite or not a number.
    #[error("{0} must be finite")]
    NotFinite(&'static str),
    /// The radius of a pin is negative.
    #[error("the radius of a pin must not be negative, as {0} is")]
    Radius(f64),
    /// A pin has no room to fade.
    #[error("the support of a pin must be a positive length, not {0}")]
    Support(f64),
    /// A mirror plane has no direction.
    #[error("the normal of a mirror plane must have a length")]
    ZeroNormal,
    /// Reflections about planes at other angles make more planes, without end for most angles.
    #[error("mirror planes {first} and {second}, counted from 0, are not perpendicular to each other")]
    NotPerpendicular {
        /// Index of the first plane.
        first: usize,
        /// Index of the second plane.
        second: usize,
    },
    /// There is not one weight for each vertex.
    #[error("there are {found} weights for {expected} vertices")]
    WeightCount {
        /// Weights given.
        found: usize,
        /// Vertices of the mesh.
        expected: usize,
    },
    /// A weight beyond its range.
    #[error("the weight of vertex {vertex} is {weight}, not a number from 0, free, to 1, held")]
    Weight {
        /// Index of the vertex.
        vertex: usize,
        /// Its weight.
        weight: f64,
    },
    /// The vertex mask has no room to fade.
    #[error("the fade of a vertex mask must be a positive length, not {0}")]
    Fade(f64),
    /// Without edges there is no length to fade over.
    #[error("the mesh has no edges to take the fade of its vertex mask from; give the fade as a length")]
    NoEdges,
    /// The fade is so short that too many samples would have to stand for the surface.
    #[error("a fade of {fade} needs more than {most} samples of the surface; choose a longer one")]
    TooManySamples {
        /// The fade.
        fade: f64,
        /// The most samples there may be.
        most: usize,
    },
    /// The mesh has an index out of range or a coordinate that is not finite.
    #[error("the mesh of a vertex mask has an index out of range or a coordinate that is not finite")]
    Mesh,
}

#[cfg(test)]
pub(crate) mod tests;
