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

use std::f64::consts::FRAC_1_SQRT_2;

use glam::{DVec3, DVec4};

use crate::bernstein::{product, raise};
use crate::frame::{FrameError, orthogonal_reference};
use crate::{Curve, CurveJet, Frame, PhCubic, PhCubicError, perpendicular};

mod spline;

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

/// The inversion about a center f that fixes the point `anchor`. The formulas remain valid if f is
/// infinitely far; the inversion is then a reflection in a plane.
#[derive(Debug, Clone, Copy, PartialEq)]
struct AnchoredInversion {
    anchor: DVec3,
    /// Unit vector from f to the anchor.
    direction: DVec3,
    /// One over the distance from f to the anchor.
    nearness: f64,
}

impl AnchoredInversion {
    /// Numerator and denominator of image − anchor, with w = point − anchor.
    fn quotient(&self, w: DVec3) -> (DVec3, f64) {
        let (e, k) = (self.direction, self.nearness);
        let along = e.dot(w);
        let squared = w.dot(w);
        (w - e * (2.0 * along + k * squared), 1.0 + k * (2.0 * along + k * squared))
    }

    fn point(&self, point: DVec3) -> DVec3 {
        let (numerator, denominator) = self.quotient(point - self.anchor);
        self.anchor + numerator / denominator
    }

    /// Applies the normalized differential at `point`: a reflection along the ray from f.
    fn vector(&self, point: DVec3, vector: DVec3) -> DVec3 {
        let ray = self.direction + (point - self.anchor) * self.nearness;
        vector - ray * (2.0 * ray.dot(vector) / ray.length_squared())
    }
}

/// A candidate for f in the bisecting plane of the chord: `direction` from the midpoint of the
/// chord, one over the distance from it, and the normal of the image plane of the sphere.
#[derive(Debug, Clone, Copy)]
struct Center {
    direction: DVec3,
    nearness: f64,
    normal: DVec3,
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
        let opposite = ends.opposite_center();
        if tilt == Tilt::Never {
            return ends.segment(&opposite);
        }
        let mut centers = vec![opposite];
        let turning = ends.turning(&opposite).abs();
        // If the planar tangents turn less than the chord on the sphere, the data are near an
        // inflection.
        if turning < ends.length * ends.curvature {
            let tilted = ends.tilted_centers(FRAC_1_SQRT_2);
            // Prefer more turning: it is farther from an inflection.
            let first = usize::from(ends.turning(&tilted[1]).abs() > ends.turning(&tilted[0]).abs());
            centers.insert(0, tilted[first]);
            centers.insert(1, tilted[1 - first]);
        }
        // On a nearly flat sphere, a tilted center changes the turning too little. A center near
        // the chord always changes it.
        for distance in [4.0, 2.0, 1.0] {
            centers.extend(ends.near_centers(distance));
        }
        let mut failure = None;
        for center in &centers {
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
        let anchor = self.inversion.anchor;
        let (e, k) = (self.inversion.direction, self.inversion.nearness);
        let w: Vec<DVec3> = self.image.control_points().iter().map(|&point| point - anchor).collect();
        let along: Vec<f64> = raise(&w.iter().map(|&w| e.dot(w)).collect::<Vec<_>>(), 3);
        let squared = product(&w, &w, |a, b| a.dot(b));
        let w = raise(&w, 3);
        std::array::from_fn(|i| {
            let weight = 1.0 + k * (2.0 * along[i] + k * squared[i]);
            let offset = w[i] - e * (2.0 * along[i] + k * squared[i]);
            (anchor * weight + offset).extend(weight)
        })
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
        let jet = self.image.jet(u);
        let (e, k) = (self.inversion.direction, self.inversion.nearness);
        let w = jet.position - self.inversion.anchor;
        // x = n/q with n = w − e m, q = 1 + k m and m = 2 e·w + k w·w. The derivatives follow from
        // the quotient rule.
        let m = [
            2.0 * e.dot(w) + k * w.dot(w),
            2.0 * e.dot(jet.first) + 2.0 * k * w.dot(jet.first),
            2.0 * e.dot(jet.second) + 2.0 * k * (jet.first.dot(jet.first) + w.dot(jet.second)),
            2.0 * e.dot(jet.third) + 2.0 * k * (3.0 * jet.first.dot(jet.second) + w.dot(jet.third)),
        ];
        let q = 1.0 + k * m[0];
        let x0 = (w - e * m[0]) / q;
        let x1 = (jet.first - e * m[1] - x0 * (k * m[1])) / q;
        let x2 = (jet.second - e * m[2] - x1 * (2.0 * k * m[1]) - x0 * (k * m[2])) / q;
        let x3 = (jet.third - e * m[3] - x2 * (3.0 * k * m[1]) - x1 * (3.0 * k * m[2]) - x0 * (k * m[3])) / q;
        CurveJet { position: self.inversion.anchor + x0, first: x1, second: x2, third: x3 }
    }
}

/// Hermite data with the sphere that they determine.
#[derive(Debug, Clone, Copy)]
struct Ends {
    start: DVec3,
    end: DVec3,
    tangents: [DVec3; 2],
    /// Unit vector along the chord.
    chord: DVec3,
    length: f64,
    /// One over the radius of the sphere. Zero for a plane, never negative.
    curvature: f64,
    /// Unit vector from the chord's midpoint toward the center of the sphere.
    toward_center: DVec3,
    /// Unit vector normal to the chord and to `toward_center`.
    sideways: DVec3,
    /// Distance from the midpoint to the center, in radii.
    depth: f64,
}

impl Ends {
    fn new(start: DVec3, end: DVec3, start_tangent: DVec3, end_tangent: DVec3) -> Result<Self, PhCubicError> {
        if [start, end, start_tangent, end_tangent].iter().any(|vector| !vector.is_finite()) {
            return Err(PhCubicError::NotFinite);
        }
        let difference = end - start;
        let length = difference.length();
        let chord = difference.try_normalize().ok_or(PhCubicError::RepeatedPoint)?;
        let t0 = start_tangent.try_normalize().ok_or(PhCubicError::ZeroTangent)?;
        let t1 = end_tangent.try_normalize().ok_or(PhCubicError::ZeroTangent)?;
        // A reflection in the bisecting plane of the chord maps the tangent plane of the sphere at
        // the end to that at the start. Both tangents then span the tangent plane at the start.
        let reflected = t1 - chord * (2.0 * t1.dot(chord));
        let sphere_normal = cross_of_independent(t0, reflected)
            .or_else(|| cross_of_independent(t0, chord))
            .unwrap_or_else(|| perpendicular(chord));
        let signed = 2.0 * sphere_normal.dot(chord) / length;
        let curvature = signed.abs().min(2.0 / length);
        let toward_inside = if signed < 0.0 { -sphere_normal } else { sphere_normal };
        let toward_center = (toward_inside - chord * (0.5 * curvature * length))
            .reject_from_normalized(chord)
            .try_normalize()
            .unwrap_or_else(|| perpendicular(chord));
        let half = 0.5 * curvature * length;
        Ok(Self {
            start,
            end,
            tangents: [t0, t1],
            chord,
            length,
            curvature,
            toward_center,
            sideways: chord.cross(toward_center),
            depth: (1.0 - half * half).max(0.0).sqrt(),
        })
    }

    /// The far intersection of the sphere with a ray from the midpoint. `cosine` is that of the
    /// angle between the ray and the direction to the center; the sign of `side` selects one of the
    /// two rays.
    fn center(&self, cosine: f64, side: f64) -> Center {
        let direction = self.toward_center * cosine + self.sideways * (side * (1.0 - cosine * cosine).max(0.0).sqrt());
        let along = cosine * self.depth;
        let half = 0.5 * self.curvature * self.length;
        let distance = along + libm::hypot(half, along); // from the midpoint, in radii
        self.center_at(direction, self.curvature / distance, self.depth / distance)
    }

    fn center_at(&self, direction: DVec3, nearness: f64, relative_depth: f64) -> Center {
        let normal = (direction - self.toward_center * relative_depth).normalize_or_zero();
        Center { direction, nearness, normal }
    }

    fn opposite_center(&self) -> Center {
        self.center(1.0, 0.0)
    }

    fn tilted_centers(&self, cosine: f64) -> [Center; 2] {
        [self.center(cosine, 1.0), self.center(cosine, -1.0)]
    }

    /// The two f on the sphere at `distance` chord lengths from the midpoint. Empty if the sphere
    /// is smaller.
    fn near_centers(&self, distance: f64) -> Vec<Center> {
        let reach = distance * self.length;
        // Solve reach = along + √(half² + along²), in radii, for along.
        let along = 0.5 * self.curvature * (reach - 0.25 * self.length * self.length / reach);
        let cosine = along / self.depth;
        if cosine.is_nan() || cosine.abs() >= 1.0 {
            return Vec::new();
        }
        [1.0, -1.0]
            .map(|side| {
                let direction = self.toward_center * cosine + self.sideways * (side * (1.0 - cosine * cosine).sqrt());
                // If the sphere is a plane, its center is infinitely far, and the plane is its own
                // image.
                if self.curvature == 0.0 {
                    Center { direction, nearness: 1.0 / reach, normal: self.toward_center }
                } else {
                    self.center_at(direction, 1.0 / reach, self.depth / (self.curvature * reach))
                }
            })
            .to_vec()
    }

    fn inversion(&self, center: &Center) -> AnchoredInversion {
        let ray = -(center.direction + self.chord * (0.5 * self.length * center.nearness));
        let size = ray.length();
        AnchoredInversion { anchor: self.start, direction: ray / size, nearness: center.nearness / size }
    }

    /// Unit tangents of the planar data.
    fn image_tangents(&self, center: &Center) -> [DVec3; 2] {
        let inversion = self.inversion(center);
        [inversion.vector(self.start, self.tangents[0]), inversion.vector(self.end, self.tangents[1])]
            .map(|tangent| tangent.reject_from_normalized(center.normal).normalize_or_zero())
    }

    /// Signed angle between the planar tangents.
    fn turning(&self, center: &Center) -> f64 {
        let [start, end] = self.image_tangents(center);
        libm::atan2(center.normal.dot(start.cross(end)), start.dot(end))
    }

    fn segment(&self, center: &Center) -> Result<MoebiusSegment, PhCubicError> {
        let [start, end] = self.image_tangents(center);
        let image = PhCubic::hermite(self.start, self.end, start, end)?;
        Ok(MoebiusSegment { image, normal: center.normal, inversion: self.inversion(center) })
    }
}

/// Unit normal of two unit vectors. Returns `None` if they are parallel up to rounding.
fn cross_of_independent(a: DVec3, b: DVec3) -> Option<DVec3> {
    let normal = a.cross(b);
    // Ten thousand times the rounding error. Below it, the direction of the product is noise.
    if normal.length() > 1e-12 { Some(normal.normalize()) } else { None }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::TrigonometricCurve;

    /// Figure 2 of the paper: by the symmetry of a helix segment about its midpoint, the planar
    /// tangents are parallel, and the cubic does not have an inflection.
    #[test]
    fn published_centers_fail_on_every_part_of_a_helix() {
        let helix = TrigonometricCurve::helix(1.0, 0.5, (0.0, std::f64::consts::PI));
        for (start, half_turns) in [(0.0, 0.5), (0.5, 0.5), (0.0, 0.1), (0.2, 0.7)] {
            let [start, end] = [start, start + half_turns].map(|at| helix.jet(std::f64::consts::PI * at));
            let ends = Ends::new(start.position, end.position, start.first, end.first).unwrap();
            let center = ends.opposite_center();
            let angles = ends
                .image_tangents(&center)
                .map(|tangent| libm::atan2(center.normal.dot(ends.chord.cross(tangent)), ends.chord.dot(tangent)));
            assert!((angles[0] - angles[1]).abs() < 1e-13, "parallel: {angles:?}");
            if half_turns == 0.5 {
                // The reference value has nine digits.
                assert!((angles[0] + 0.084_001_077_4).abs() < 5.1e-11, "{angles:?}");
            }
            assert!(ends.segment(&center).is_err());
        }
    }
}
