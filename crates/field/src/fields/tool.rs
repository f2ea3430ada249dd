//! A tool: a shape with a support around it.

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

/// A shape that pushes what is near: its field fades, by a profile, over the support around its surface.
#[derive(Debug, Clone)]
pub struct Tool {
    distance: Arc<dyn Distance>,
    support: f64,
    profile: Profile,
    center: DVec3,
    gauge: Option<Box<Gauge>>,
    reference: Option<Aabb>,
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
        Ok(Self { distance, support, profile, center, gauge: None, reference: None })
    }

    /// The signed distance of the shape, in tool coordinates.
    pub fn distance(&self) -> &dyn Distance {
        &*self.distance
    }

    /// The signed distance of the shape, to be shared with another tool.
    pub fn shared_distance(&self) -> Arc<dyn Distance> {
        Arc::clone(&self.distance)
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

    /// The same tool with the free-form gauge: polynomials of degree three, fitted to the surface so that the flow around the
    /// tool is slow and even, of which `share`, from 0 to 1, is added to the potential.
    ///
    /// The core and the speed normal to the surface are untouched. Material takes the short way round: on an elongated tool that
    /// moves sideways it no longer escapes over the ends, which at a share of 1 halves the peak of the flow around the tool and
    /// the way of what is pushed aside, but cuts sharper grooves, which ask for several times the refinement.
    ///
    /// # Errors
    /// [`ToolError::FreeForm`] when the share is not from 0 to 1, or the shape has no end.
    pub fn with_free_form(mut self, share: f64) -> Result<Self, ToolError> {
        if !((0.0..=1.0).contains(&share) && self.distance.bounds().size().is_finite()) {
            return Err(ToolError::FreeForm(share));
        }
        self.gauge = (share > 0.0).then(|| Box::new(Gauge::fitted(&*self.distance, self.center, share)));
        Ok(self)
    }

    /// The same tool with another origin of the gauge, and with another gauge.
    pub(crate) fn with_gauge(self, center: DVec3, gauge: Option<Gauge>) -> Self {
        Self { center, gauge: gauge.map(Box::new), ..self }
    }

    /// The same tool with speeds measured in the box `reference`, in tool coordinates, in place of the bounds of its shape.
    pub(crate) fn with_reference(self, reference: Aabb) -> Self {
        Self { reference: Some(reference), ..self }
    }

    /// What is added to the vector potential, if anything.
    pub(crate) fn gauge(&self) -> Option<&Gauge> {
        self.gauge.as_deref()
    }

    /// Box in whose points the speed of the tool is measured.
    pub(crate) fn reference(&self) -> Aabb {
        self.reference.unwrap_or(self.distance.bounds())
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
    /// The share of the free-form gauge is out of range, or the shape has no surface of finite size.
    #[error("the share of the free-form gauge must be from 0 to 1, not {0}, and the shape must have an end")]
    FreeForm(f64),
    /// The profile of a region has a kink, and hence no square.
    #[error("the profile {0} has a kink, which a region's field cannot have; choose another")]
    NoSquare(Profile),
    /// The shape has no volume, hence no centroid.
    #[error("the tool's shape is empty")]
    Empty,
}
