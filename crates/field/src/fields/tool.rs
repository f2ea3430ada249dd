//! Tools: shapes with a support around their surface.
//!
//! A tool consists of the signed distance d of its shape, the support R and the profile g. Its
//! field is V = curl(g(d/R) A), where A is the vector potential of its rigid motion; see
//! [`RigidField`] for the formula and its source.

pub(crate) mod gauge;
mod moving_tool;
mod rigid_field;

use std::sync::Arc;

use glam::DVec3;
use isochore_mesh::{Aabb, Distance};

use crate::fields::Profile;
use gauge::Gauge;
pub use moving_tool::MovingTool;
pub use rigid_field::{RigidField, VelocityBlock};

/// A shape that moves the material near it; by its profile, the motion fades over the support
/// around its surface.
///
/// # Examples
/// ```
/// use std::sync::Arc;
///
/// use isochore_field::{Profile, Tool, ToolError};
/// use isochore_mesh::Sphere;
///
/// let ball = Arc::new(Sphere::new(0.4).unwrap());
/// let tool = Tool::new(ball.clone(), 0.3, Profile::Quintic)?;
/// assert_eq!(tool.feature_size(), 0.3);
///
/// let error = Tool::new(ball, 0.0, Profile::Quintic).unwrap_err();
/// assert_eq!(error.to_string(), "the support must be a positive length, not 0");
/// # Ok::<(), ToolError>(())
/// ```
#[derive(Debug, Clone)]
pub struct Tool {
    distance: Arc<dyn Distance>,
    support: f64,
    profile: Profile,
    center: DVec3,
    gauge: Option<Box<Gauge>>,
    reference: Option<Aabb>,
    support_bounds: Aabb,
}

impl Tool {
    /// A tool with the signed `distance` of its shape, in tool coordinates. Its field reaches
    /// `support` beyond the surface, model units.
    ///
    /// The field is as smooth as the distance. For a mesh, use a
    /// [`SmoothDistance`](isochore_mesh::SmoothDistance) of the same support: the distance to a
    /// concave shape has kinks outside, where the field of the tool would jump.
    ///
    /// # Errors
    /// - [`ToolError::Support`] if the support is not a positive length.
    /// - [`ToolError::Reach`] if the distance is not known that far outside.
    /// - [`ToolError::Empty`] if the shape has no volume.
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
        let support_bounds = distance.bounds_within(support);
        Ok(Self { distance, support, profile, center, gauge: None, reference: None, support_bounds })
    }

    /// Signed distance of the shape, in tool coordinates.
    pub fn distance(&self) -> &dyn Distance {
        &*self.distance
    }

    /// Support R, model units: the field ends where the distance is R. A
    /// [`SmoothDistance`](isochore_mesh::SmoothDistance) is smaller than the exact distance over
    /// grooves of the shape; there the field reaches up to about 1.1 R from the surface.
    pub fn support(&self) -> f64 {
        self.support
    }

    /// Profile by which the field fades over the support.
    pub fn profile(&self) -> Profile {
        self.profile
    }

    /// Center of the vector potential, in tool coordinates: the volume centroid of the shape. Any
    /// other center gives the same speed normal to the surface and a stronger return flow around
    /// the tool.
    pub fn center(&self) -> DVec3 {
        self.center
    }

    /// Length over which the field varies: the support, or half the shortest extent of the shape if
    /// that is smaller.
    pub fn feature_size(&self) -> f64 {
        self.support.min(0.5 * self.distance.bounds().size().min_element())
    }

    /// The same tool with the free-form gauge: the `fraction`, from 0 to 1, of gradients of cubic
    /// polynomials is added to the potential. The polynomials are fitted to the surface so that the
    /// flow around the tool is slow and even.
    ///
    /// The core and the speed normal to the surface do not change. Displaced material takes the
    /// short path around the tool. Around an elongated tool that moves sideways, it no longer flows
    /// over the ends: a fraction of 1 halves both the peak speed of the flow and the path length of
    /// the material. It also cuts sharper grooves, which need several times the refinement.
    ///
    /// # Errors
    /// [`ToolError::FreeForm`] if the fraction is not from 0 to 1 or the shape is unbounded.
    pub fn with_free_form(mut self, fraction: f64) -> Result<Self, ToolError> {
        if !((0.0..=1.0).contains(&fraction) && self.distance.bounds().size().is_finite()) {
            return Err(ToolError::FreeForm(fraction));
        }
        self.gauge = (fraction > 0.0).then(|| Box::new(Gauge::fitted(&*self.distance, self.center, fraction)));
        Ok(self)
    }

    /// The same tool with another center of the potential and another gauge.
    pub(crate) fn with_gauge(self, center: DVec3, gauge: Option<Gauge>) -> Self {
        Self { center, gauge: gauge.map(Box::new), ..self }
    }

    /// The same tool with its speed measured in the box `reference`, in tool coordinates, instead
    /// of the bounds of its shape.
    pub(crate) fn with_reference(self, reference: Aabb) -> Self {
        Self { reference: Some(reference), ..self }
    }

    /// Gauge that is added to the vector potential, if any.
    pub(crate) fn gauge(&self) -> Option<&Gauge> {
        self.gauge.as_deref()
    }

    /// Box over which the speed of the tool is measured.
    pub(crate) fn reference(&self) -> Aabb {
        self.reference.unwrap_or(self.distance.bounds())
    }

    /// Moves the center of the potential.
    #[cfg(test)]
    pub(crate) fn shift_center(&mut self, shift: DVec3) {
        self.center += shift;
    }

    /// Box of the support, the points whose distance is below [`support`](Self::support), in tool
    /// coordinates. It may be slightly too large.
    pub fn support_bounds(&self) -> Aabb {
        self.support_bounds
    }
}

/// Errors when constructing a [`Tool`] or a [`Region`](crate::Region).
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum ToolError {
    /// The support is not a positive, finite length.
    #[error("the support must be a positive length, not {0}")]
    Support(f64),
    /// The sampled distance ends inside the support.
    #[error(
        "the support {support} exceeds the reach of the sampled distance, {reach}; reduce the support or sample farther"
    )]
    Reach {
        /// Support given.
        support: f64,
        /// Reach of the samples beyond the surface.
        reach: f64,
    },
    /// The fraction of the free-form gauge is out of range, or the shape is unbounded.
    #[error("the free-form gauge needs a fraction from 0 to 1 and a bounded shape; the fraction is {0}")]
    FreeForm(f64),
    /// The profile of a region has a kink and hence no square.
    #[error("the profile `{0}` has a kink, which the field of a region cannot have; choose another")]
    NoSquare(Profile),
    /// The shape has no volume, hence no centroid.
    #[error("the shape of the tool has no volume")]
    Empty,
}
