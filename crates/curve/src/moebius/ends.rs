//! End points and tangents of a segment, their sphere, and the candidates for the center of
//! inversion.

use std::f64::consts::FRAC_1_SQRT_2;

use glam::DVec3;

use super::{MoebiusSegment, Tilt, anchored_inversion::AnchoredInversion};
use crate::{PhCubic, PhCubicError, perpendicular};

/// A candidate for the center of inversion f, in the bisecting plane of the chord.
#[derive(Debug, Clone, Copy)]
pub(super) struct Center {
    /// Unit vector from the midpoint of the chord to f.
    direction: DVec3,
    /// One over the distance from the midpoint to f.
    nearness: f64,
    /// Unit normal of the plane to which the inversion maps the sphere.
    pub(super) normal: DVec3,
}

/// Hermite data with the sphere that they determine.
#[derive(Debug, Clone, Copy)]
pub(super) struct Ends {
    start: DVec3,
    end: DVec3,
    /// Unit tangents at the start and the end.
    tangents: [DVec3; 2],
    /// Unit vector along the chord.
    pub(super) chord: DVec3,
    /// Length of the chord.
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
    /// Finds the sphere through the ends with these tangents.
    ///
    /// # Errors
    /// [`PhCubicError::NotFinite`], [`PhCubicError::RepeatedPoint`] or [`PhCubicError::ZeroTangent`].
    pub(super) fn new(
        start: DVec3,
        end: DVec3,
        start_tangent: DVec3,
        end_tangent: DVec3,
    ) -> Result<Self, PhCubicError> {
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

    /// The centers that `tilt` allows, in the order in which to try them.
    pub(super) fn centers(&self, tilt: Tilt) -> Vec<Center> {
        let opposite = self.opposite_center();
        let mut centers = vec![opposite];
        if tilt == Tilt::Never {
            return centers;
        }
        let turning = self.turning(&opposite).abs();
        // If the planar tangents turn less than the chord on the sphere, the data are near an
        // inflection.
        if turning < self.length * self.curvature {
            let tilted = self.tilted_centers(FRAC_1_SQRT_2);
            // Prefer more turning: it is farther from an inflection.
            let first = usize::from(self.turning(&tilted[1]).abs() > self.turning(&tilted[0]).abs());
            centers.insert(0, tilted[first]);
            centers.insert(1, tilted[1 - first]);
        }
        // On a nearly flat sphere, a tilted center changes the turning too little. A center near
        // the chord always changes it.
        for distance in [4.0, 2.0, 1.0] {
            centers.extend(self.near_centers(distance));
        }
        centers
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

    /// The center with this direction and nearness. `relative_depth` is the distance from the
    /// midpoint to the center of the sphere over that from the midpoint to f.
    fn center_at(&self, direction: DVec3, nearness: f64, relative_depth: f64) -> Center {
        let normal = (direction - self.toward_center * relative_depth).normalize_or_zero();
        Center { direction, nearness, normal }
    }

    /// The f farthest from the ends, as published.
    pub(super) fn opposite_center(&self) -> Center {
        self.center(1.0, 0.0)
    }

    /// The two f whose rays from the midpoint make this angle with the direction to the center.
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

    /// The inversion about `center` that fixes the start.
    fn inversion(&self, center: &Center) -> AnchoredInversion {
        let ray = -(center.direction + self.chord * (0.5 * self.length * center.nearness));
        let size = ray.length();
        AnchoredInversion { anchor: self.start, direction: ray / size, nearness: center.nearness / size }
    }

    /// Unit tangents of the planar data.
    pub(super) fn image_tangents(&self, center: &Center) -> [DVec3; 2] {
        let inversion = self.inversion(center);
        [inversion.vector(self.start, self.tangents[0]), inversion.vector(self.end, self.tangents[1])]
            .map(|tangent| tangent.reject_from_normalized(center.normal).normalize_or_zero())
    }

    /// Signed angle between the planar tangents.
    fn turning(&self, center: &Center) -> f64 {
        let [start, end] = self.image_tangents(center);
        libm::atan2(center.normal.dot(start.cross(end)), start.dot(end))
    }

    /// The segment for one center.
    ///
    /// # Errors
    /// The planar data have no cubic.
    pub(super) fn segment(&self, center: &Center) -> Result<MoebiusSegment, PhCubicError> {
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
