//! A tool: a shape with a support around it.

use std::sync::Arc;

use glam::DVec3;
use isochore_mesh::{Aabb, Distance};

use crate::Profile;

/// A shape that pushes what is near: its field fades, by a profile, over the support around its surface.
#[derive(Debug, Clone)]
pub struct Tool {
    distance: Arc<dyn Distance>,
    support: f64,
    profile: Profile,
    center: DVec3,
}

impl Tool {
    /// A tool with the signed `distance` of its shape, in tool coordinates, whose field reaches `support` beyond the surface.
    ///
    /// # Errors
    /// [`ToolError`] when the support is not a positive length, or when the distance is not known that far out.
    pub fn new(distance: Arc<dyn Distance>, support: f64, profile: Profile) -> Result<Self, ToolError> {
        if !(support > 0.0 && support.is_finite()) {
            return Err(ToolError::Support(support));
        }
        if distance.reach() < support {
            return Err(ToolError::Reach { support, reach: distance.reach() });
        }
        let center = distance.centroid();
        if !center.is_finite() {
            return Err(ToolError::Empty);
        }
        Ok(Self { distance, support, profile, center })
    }

    /// The signed distance of the shape, in tool coordinates.
    pub fn distance(&self) -> &dyn Distance {
        &*self.distance
    }

    /// R: how far beyond the surface the field reaches, model units.
    pub fn support(&self) -> f64 {
        self.support
    }

    /// How the field fades over the support.
    pub fn profile(&self) -> Profile {
        self.profile
    }

    /// Origin of the gauge of the vector potential: the volume centroid of the shape, in tool coordinates. Any other origin
    /// gives the same speed normal to the surface and a stronger return flow around it.
    pub fn center(&self) -> DVec3 {
        self.center
    }

    /// Length over which the field changes: the support, or half the shape's shortest extent where that is less.
    pub fn feature_size(&self) -> f64 {
        self.support.min(0.5 * self.distance.bounds().size().min_element())
    }

    /// Puts the origin of the gauge elsewhere.
    #[cfg(test)]
    pub(crate) fn shift_center(&mut self, shift: DVec3) {
        self.center += shift;
    }

    /// Box that holds the support.
    pub(crate) fn support_bounds(&self) -> Aabb {
        self.distance.bounds().expanded(self.support)
    }
}

/// Why a shape cannot be a [`Tool`].
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum ToolError {
    /// The support is not a positive, finite length.
    #[error("the support must be a positive length, not {0}")]
    Support(f64),
    /// The sampled distance ends inside the support.
    #[error("the support {support} goes beyond the sampled distance, which reaches {reach}")]
    Reach {
        /// Support asked for.
        support: f64,
        /// Where the samples end.
        reach: f64,
    },
    /// The shape has no volume, hence no centroid.
    #[error("the tool's shape is empty")]
    Empty,
}
