//! Rational curves with rational rotation-minimizing frames: images of planar Pythagorean-hodograph
//! cubics under an inversion.
//!
//! Source: M. Bartoň, B. Jüttler, W. Wang, Construction of rational curves with rational
//! rotation-minimizing frames via Möbius transformations, 2009. The end points and tangents of a
//! segment determine a sphere. An inversion about a point f of the sphere maps it to a plane. In
//! the plane, a Pythagorean-hodograph cubic interpolates the mapped data, and the normal of the
//! plane is a rotation-minimizing vector. The same inversion maps the cubic and its frame to a
//! curve of degree six on the sphere.
//!
//! The paper chooses the f farthest from the ends. The planar data can then require an inflection,
//! which the cubic does not have; on a circular helix, they always do. Such segments
//! [tilt](Tilt::WhenNeeded): f moves sideways on the sphere. This changes the planar data but not
//! the frames at the joints, which are those of double reflection.

use glam::{DVec3, DVec4};

use crate::frame::{FrameError, orthogonal_reference};
use crate::{Curve, CurveJet, Frame, PhCubic, PhCubicError};

mod anchored_inversion;
mod ends;
mod spline;

use anchored_inversion::AnchoredInversion;
use ends::Ends;
pub use spline::MoebiusSpline;

/// Position of the center of inversion on the sphere.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Tilt {
    /// The center moves sideways if the planar data turn so little that the cubic does not exist or
    /// is inaccurate.
    #[default]
    WhenNeeded,
    /// The center stays opposite to the ends, as published. For comparison.
    Never,
}

/// A rational curve of degree six on a sphere, with a rational rotation-minimizing frame, over [0,
/// 1].
///
/// # Examples
/// ```
/// use isochore_curve::{Curve, MoebiusSegment, Tilt, TrigonometricCurve};
///
/// let helix = TrigonometricCurve::helix(1.0, 0.5, (0.0, 0.5));
/// let [start, end] = [helix.jet(0.0), helix.jet(0.5)];
/// let segment =
///     MoebiusSegment::hermite(start.position, end.position, start.first, end.first, Tilt::WhenNeeded)?;
/// assert!(segment.position(1.0).distance(end.position) < 1e-14);
/// assert!(segment.tangent(0.0).distance(start.tangent()) < 1e-14);
/// # Ok::<(), isochore_curve::PhCubicError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MoebiusSegment {
    image: PhCubic,
    /// Unit normal of the plane of `image`. The inversion maps it to a normal of the sphere.
    normal: DVec3,
    inversion: AnchoredInversion,
}

impl MoebiusSegment {
    /// Interpolates two end points and the directions of their tangents.
    ///
    /// # Errors
    /// - [`PhCubicError::NotFinite`], [`PhCubicError::RepeatedPoint`] or
    ///   [`PhCubicError::ZeroTangent`] if the input is invalid.
    /// - Another [`PhCubicError`] if the planar data have no cubic for any center of inversion that
    ///   `tilt` allows.
    pub fn hermite(
        start: DVec3,
        end: DVec3,
        start_tangent: DVec3,
        end_tangent: DVec3,
        tilt: Tilt,
    ) -> Result<Self, PhCubicError> {
        let ends = Ends::new(start, end, start_tangent, end_tangent)?;
        let mut failure = None;
        for center in &ends.centers(tilt) {
            match ends.segment(center) {
                Ok(segment) => return Ok(segment),
                Err(error) => failure = failure.or(Some(error)),
            }
        }
        Err(failure.unwrap_or(PhCubicError::WrongDirection))
    }

    /// The planar cubic whose image under the inversion is this curve.
    pub fn image(&self) -> &PhCubic {
        &self.image
    }

    /// Rotation-minimizing frames at `parameters`. The reference vector at 0 is the component of
    /// `reference` normal to the tangent.
    ///
    /// The frames are rational: the reference vector is the reflection of a combination, with
    /// constant coefficients, of the normal of the plane and its cross product with the tangent.
    ///
    /// # Errors
    /// [`FrameError::Reference`] if `reference` is zero, not finite, or parallel to the first
    /// tangent.
    pub fn frames(&self, parameters: &[f64], reference: DVec3) -> Result<Vec<Frame>, FrameError> {
        let start = orthogonal_reference(reference, self.tangent(0.0))?;
        let first = self.image.jet(0.0);
        let in_plane = self.inversion.vector(first.position, start);
        let (along, across) =
            (in_plane.dot(self.normal), in_plane.dot(first.tangent().cross(self.normal).normalize_or_zero()));
        Ok(parameters
            .iter()
            .map(|&u| {
                let jet = self.image.jet(u);
                let r = self.normal * along + jet.tangent().cross(self.normal).normalize_or_zero() * across;
                // An inversion reverses orientation. Recompute the second normal vector instead of
                // mapping it.
                let t = self.inversion.vector(jet.position, jet.tangent());
                let r = self.inversion.vector(jet.position, r).reject_from_normalized(t).normalize_or_zero();
                Frame::new(r, t)
            })
            .collect())
    }

    /// Unit tangent at `u`.
    pub fn tangent(&self, u: f64) -> DVec3 {
        let jet = self.image.jet(u);
        self.inversion.vector(jet.position, jet.tangent())
    }

    /// The seven homogeneous control points (w x, w y, w z, w).
    pub fn control_points(&self) -> [DVec4; 7] {
        self.inversion.control_points(&self.image.control_points())
    }
}

impl Curve for MoebiusSegment {
    fn domain(&self) -> (f64, f64) {
        (0.0, 1.0)
    }

    fn position(&self, u: f64) -> DVec3 {
        self.inversion.point(self.image.position(u))
    }

    fn jet(&self, u: f64) -> CurveJet {
        self.inversion.jet(&self.image.jet(u))
    }
}

#[cfg(test)]
mod tests;
