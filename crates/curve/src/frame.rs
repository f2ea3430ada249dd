//! Orthonormal frames along a spine, and the methods that carry them from sample to sample.

use glam::DVec3;

use crate::Spine;
use crate::double_reflection::reflect_twice;
use crate::projection::project_along_chord;
use crate::rotation::rotate_minimally;
use crate::tangents_only::chord_from_tangents;

/// A right-handed orthonormal frame: s = t × r, r × s = t.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Frame {
    /// Reference vector, normal to the curve.
    pub r: DVec3,
    /// The second normal vector.
    pub s: DVec3,
    /// Tangent.
    pub t: DVec3,
}

impl Frame {
    /// The frame with reference vector `r` and tangent `t`, which are orthonormal.
    pub fn new(r: DVec3, t: DVec3) -> Self {
        Self { r, s: t.cross(r), t }
    }

    /// This frame turned about its tangent by `angle` radians, right-handed.
    pub fn turned(&self, angle: f64) -> Self {
        let (sin, cos) = libm::sincos(angle);
        Self { r: self.r * cos + self.s * sin, s: self.s * cos - self.r * sin, t: self.t }
    }

    /// Where `offset` = (along r, along s) lies from the spine point.
    pub fn offset(&self, offset: glam::DVec2) -> DVec3 {
        self.r * offset.x + self.s * offset.y
    }

    /// Angle about the tangent from this frame's reference vector to `direction`, in (−π, π]. Zero for a direction
    /// along the tangent.
    pub fn angle_to(&self, direction: DVec3) -> f64 {
        libm::atan2(self.s.dot(direction), self.r.dot(direction))
    }
}

/// How frames are carried along a [`Spine`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum FrameMethod {
    /// Double reflection (Wang et al. 2008): fourth order, exact on spheres and planes, needs no threshold.
    #[default]
    DoubleReflection,
    /// Projection along the chord into the next normal plane (Klok 1986): second order.
    Projection,
    /// Smallest rotation between the tangents (Bloomenthal 1990): second order.
    Rotation,
    /// Double reflection with chords estimated from the tangents of uniform samples (equation 17): fourth order,
    /// without points.
    TangentsOnly,
}

/// What happens on a segment whose data determine no rotation.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum DegenerateSegment {
    /// An error names the segment.
    #[default]
    Refuse,
    /// The frame takes the smallest rotation between the tangents there, and the segment is listed.
    Rotate,
}

/// Frames at the stations of a [`Spine`].
#[derive(Debug, Clone, PartialEq)]
pub struct Frames {
    /// One frame a station, one more than segments: on a closed spine the last is the frame that arrives back at the
    /// first point.
    pub stations: Vec<Frame>,
    /// Segments on which the smallest rotation stood in for the method: repeated points, and degenerate segments on
    /// request.
    pub substituted: Vec<usize>,
}

/// Why a spine has no frames. Indices count from zero.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum FrameError {
    /// The reference vector has no part normal to the first tangent.
    #[error("the reference vector is zero, not finite, or along the first tangent")]
    Reference,
    /// The data of a segment determine no rotation.
    #[error(
        "segment {segment} determines no rotation: one of its tangents is reversed, the curve has a cusp there, or the \
         samples are too coarse"
    )]
    DegenerateSegment {
        /// The segment.
        segment: usize,
    },
    /// The tangents at the ends of a segment are opposite.
    #[error("the tangents at the two ends of segment {segment} are opposite: reversed, a cusp, or too coarse samples")]
    OppositeTangents {
        /// The segment.
        segment: usize,
    },
}

/// Squared sine of the angle between reference vector and tangent at least. Larger: usable vectors are refused.
/// Smaller: the rounding of an almost parallel vector decides where the frame starts.
const SMALLEST_SQUARED_SINE: f64 = 1e-20;

/// The part of `reference` normal to the unit vector `tangent`, as a unit vector.
///
/// # Errors
/// [`FrameError::Reference`] where there is no such part.
pub fn orthogonal_reference(reference: DVec3, tangent: DVec3) -> Result<DVec3, FrameError> {
    let unit = (reference / reference.abs().max_element()).try_normalize().ok_or(FrameError::Reference)?;
    let across = unit.reject_from_normalized(tangent);
    if across.length_squared() < SMALLEST_SQUARED_SINE {
        return Err(FrameError::Reference);
    }
    // A second pass removes what rounding left along the tangent of an almost parallel vector.
    Ok(across.normalize().reject_from_normalized(tangent).normalize())
}

/// Carries a frame along `spine` with the least rotation about the tangent, starting from the part of `reference`
/// normal to the first tangent.
///
/// Two equal neighboring points have no chord; every method then takes the smallest rotation between their tangents,
/// and the segment is listed in [`Frames::substituted`].
///
/// # Errors
/// A reference along the first tangent, and segments that determine no rotation, unless `degenerate` lets them pass;
/// opposite tangents never do where the smallest rotation is asked for.
pub fn rotation_minimizing_frames(
    spine: &Spine,
    reference: DVec3,
    method: FrameMethod,
    degenerate: DegenerateSegment,
) -> Result<Frames, FrameError> {
    let segments = spine.segments();
    let mut r = orthogonal_reference(reference, spine.tangent(0))?;
    let mut stations = Vec::with_capacity(segments + 1);
    let mut substituted = Vec::new();
    stations.push(Frame::new(r, spine.tangent(0)));
    for segment in 0..segments {
        let (start, end) = (spine.tangent(segment), spine.tangent(segment + 1));
        let chord = match method {
            FrameMethod::TangentsOnly => chord_from_tangents(spine, segment),
            _ => spine.point(segment + 1) - spine.point(segment),
        };
        let moved = match method {
            FrameMethod::DoubleReflection | FrameMethod::TangentsOnly => reflect_twice(chord, start, end, r),
            FrameMethod::Projection => project_along_chord(chord, end, r),
            FrameMethod::Rotation => rotate_minimally(start, end, r),
        };
        r = match moved {
            Some(moved) => moved,
            None if degenerate == DegenerateSegment::Rotate || chord == DVec3::ZERO => {
                substituted.push(segment);
                rotate_minimally(start, end, r).ok_or(FrameError::OppositeTangents { segment })?
            }
            None if method == FrameMethod::Rotation => return Err(FrameError::OppositeTangents { segment }),
            None => return Err(FrameError::DegenerateSegment { segment }),
        };
        stations.push(Frame::new(r, end));
    }
    Ok(Frames { stations, substituted })
}
