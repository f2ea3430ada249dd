//! Inversions in spheres, applied to points, vectors and frames.
//!
//! Inversions generate the Möbius transformations. They preserve rotation-minimizing frames, and
//! double reflection commutes with them. Source: M. Bartoň, B. Jüttler, W. Wang, Construction of
//! rational curves with rational rotation-minimizing frames via Möbius transformations, 2009,
//! section 2.

use glam::DVec3;

use crate::{Frame, Spine};

/// Inversion in a sphere. It exchanges inside and outside along rays from the center, and it is its
/// own inverse.
///
/// # Examples
/// ```
/// use glam::DVec3;
/// use isochore_curve::Inversion;
///
/// let inversion = Inversion { center: DVec3::ZERO, squared_radius: 4.0 };
/// assert_eq!(inversion.point(DVec3::X), Some(4.0 * DVec3::X));
/// assert_eq!(inversion.point(DVec3::ZERO), None);
/// assert_eq!(inversion.vector(DVec3::X, DVec3::X), -DVec3::X);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Inversion {
    /// Center of the sphere.
    pub center: DVec3,
    /// Square of the radius.
    pub squared_radius: f64,
}

impl Inversion {
    /// Image of a point. Returns `None` for the center, whose image is at infinity.
    pub fn point(&self, point: DVec3) -> Option<DVec3> {
        let offset = point - self.center;
        let squared = offset.length_squared();
        (squared > 0.0).then(|| self.center + offset * (self.squared_radius / squared))
    }

    /// Image of a vector at `point` under the normalized differential, which preserves lengths: a
    /// reflection along the ray from the center (equation 12). Zero at the center, where it is
    /// undefined.
    pub fn vector(&self, point: DVec3, vector: DVec3) -> DVec3 {
        let offset = point - self.center;
        let squared = offset.length_squared();
        if squared > 0.0 { vector - offset * (2.0 * vector.dot(offset) / squared) } else { DVec3::ZERO }
    }

    /// Image of a frame at `point`.
    ///
    /// An inversion reverses orientation. Therefore only r and t are mapped, and s follows from
    /// them. Mapping all three (equation 18) would give a left-handed frame.
    pub fn frame(&self, point: DVec3, frame: &Frame) -> Frame {
        Frame::new(self.vector(point, frame.r), self.vector(point, frame.t))
    }

    /// Image of a spine with its tangents. Returns `None` if one of its points is the center or is
    /// mapped beyond the largest coordinate of a [`Spine`].
    pub fn spine(&self, spine: &Spine) -> Option<Spine> {
        let points = spine.points().iter().map(|&point| self.point(point)).collect::<Option<Vec<_>>>()?;
        let tangents =
            spine.points().iter().zip(spine.tangents()).map(|(&point, &tangent)| self.vector(point, tangent)).collect();
        Spine::new(points, tangents, spine.is_closed()).ok()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const INVERSION: Inversion = Inversion { center: DVec3::new(0.3, -0.2, 0.5), squared_radius: 2.0 };

    #[test]
    fn an_inversion_is_its_own_inverse() {
        let point = DVec3::new(1.0, 2.0, -0.5);
        let image = INVERSION.point(point).unwrap();
        assert!(INVERSION.point(image).unwrap().distance(point) < 1e-15);
        let vector = DVec3::new(0.1, 0.7, -0.3);
        assert!(INVERSION.vector(image, INVERSION.vector(point, vector)).distance(vector) < 1e-15);
        assert_eq!(INVERSION.point(INVERSION.center), None);
    }

    #[test]
    fn the_differential_matches_differences_of_points() {
        let (point, direction, step) = (DVec3::new(1.0, 2.0, -0.5), DVec3::new(0.6, 0.0, 0.8), 1e-6);
        let difference =
            INVERSION.point(point + direction * step).unwrap() - INVERSION.point(point - direction * step).unwrap();
        // Error of central differences: step² and rounding/step.
        assert!(difference.normalize().distance(INVERSION.vector(point, direction)) < 1e-9);
    }

    #[test]
    fn frames_stay_right_handed() {
        let frame = INVERSION.frame(DVec3::ONE, &Frame::new(DVec3::X, DVec3::Z));
        assert!((frame.r.cross(frame.s) - frame.t).length() < 1e-15);
    }
}
