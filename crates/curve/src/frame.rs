//! Orthonormal frames along a spine, and the methods that move them from sample to sample.

use glam::DVec3;

use crate::Spine;
use crate::double_reflection::reflect_twice;
use crate::projection::project_along_chord;
use crate::rotation::rotate_minimally;
use crate::tangents_only::chord_from_tangents;

/// A right-handed orthonormal frame: s = t × r, r × s = t.
///
/// # Examples
/// ```
/// use glam::{DVec2, DVec3};
/// use isochore_curve::Frame;
///
/// let frame = Frame::new(DVec3::X, DVec3::Z);
/// assert_eq!(frame.s, DVec3::Y);
/// assert_eq!(frame.offset(DVec2::new(2.0, 3.0)), DVec3::new(2.0, 3.0, 0.0));
/// let turned = frame.turned(0.5);
/// assert!((frame.angle_to(turned.r) - 0.5).abs() < 1e-15);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Frame {
    /// Reference vector, normal to the curve.
    pub r: DVec3,
    /// Second normal vector.
    pub s: DVec3,
    /// Tangent.
    pub t: DVec3,
}

impl Frame {
    /// Creates a frame from its reference vector `r` and tangent `t`, which must be orthonormal.
    pub fn new(r: DVec3, t: DVec3) -> Self {
        Self { r, s: t.cross(r), t }
    }

    /// Rotates the frame about its tangent by `angle` radians, right-handed.
    pub fn turned(&self, angle: f64) -> Self {
        let (sin, cos) = libm::sincos(angle);
        Self { r: self.r * cos + self.s * sin, s: self.s * cos - self.r * sin, t: self.t }
    }

    /// Vector from the spine point to the point with coordinates `offset` along r and s.
    pub fn offset(&self, offset: glam::DVec2) -> DVec3 {
        self.r * offset.x + self.s * offset.y
    }

    /// Angle about the tangent from the reference vector to `direction`, in (−π, π]. Zero if
    /// `direction` is parallel to the tangent.
    pub fn angle_to(&self, direction: DVec3) -> f64 {
        libm::atan2(self.s.dot(direction), self.r.dot(direction))
    }
}

/// Method that moves frames along a [`Spine`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum FrameMethod {
    /// Double reflection (Wang et al. 2008): fourth order, exact on spheres and planes.
    #[default]
    DoubleReflection,
    /// Projection along the chord into the next normal plane (Klok 1986): second order.
    Projection,
    /// Smallest rotation between the tangents (Bloomenthal 1990): second order.
    Rotation,
    /// Double reflection with chords estimated from the tangents of uniform samples (equation 17):
    /// fourth order. It does not use the points.
    TangentsOnly,
}

/// Treatment of segments whose data do not determine a rotation.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum DegenerateSegment {
    /// Return an error that names the segment.
    #[default]
    Refuse,
    /// Use the smallest rotation between the tangents, and list the segment in
    /// [`Frames::substituted`].
    Rotate,
}

/// Frames at the stations of a [`Spine`].
#[derive(Debug, Clone, PartialEq)]
pub struct Frames {
    /// One frame per station, one more than segments. On a closed spine, the last frame is the one
    /// that arrives back at the first point.
    pub stations: Vec<Frame>,
    /// Segments on which the smallest rotation replaced the method: repeated points, and degenerate
    /// segments with [`DegenerateSegment::Rotate`].
    pub substituted: Vec<usize>,
}

/// Errors when computing frames. Indices count from zero.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum FrameError {
    /// The reference vector has no component normal to the first tangent.
    #[error(
        "the reference vector is zero, not finite, or parallel to the first tangent; choose one across the tangent"
    )]
    Reference,
    /// The data of a segment do not determine a rotation.
    #[error(
        "segment {segment} does not determine a rotation: one of its tangents is reversed, the curve has a cusp, or \
         the samples are too coarse"
    )]
    DegenerateSegment {
        /// The segment.
        segment: usize,
    },
    /// The tangents at the ends of a segment are opposite.
    #[error(
        "the tangents at the ends of segment {segment} are opposite: one of them is reversed, the curve has a cusp, or \
         the samples are too coarse"
    )]
    OppositeTangents {
        /// The segment.
        segment: usize,
    },
}

/// Smallest squared sine of the angle between reference vector and tangent. Larger: usable vectors
/// are rejected. Smaller: the rounding of an almost parallel vector determines the first frame.
const SMALLEST_SQUARED_SINE: f64 = 1e-20;

/// The component of `reference` normal to the unit vector `tangent`, normalized.
///
/// # Errors
/// [`FrameError::Reference`] if `reference` is zero, not finite, or parallel to `tangent`.
///
/// # Examples
/// ```
/// use glam::DVec3;
/// use isochore_curve::orthogonal_reference;
///
/// assert_eq!(orthogonal_reference(DVec3::new(3.0, 0.0, 5.0), DVec3::Z)?, DVec3::X);
/// assert!(orthogonal_reference(DVec3::Z, DVec3::Z).is_err());
/// # Ok::<(), isochore_curve::FrameError>(())
/// ```
pub fn orthogonal_reference(reference: DVec3, tangent: DVec3) -> Result<DVec3, FrameError> {
    let unit = (reference / reference.abs().max_element()).try_normalize().ok_or(FrameError::Reference)?;
    let across = unit.reject_from_normalized(tangent);
    if across.length_squared() < SMALLEST_SQUARED_SINE {
        return Err(FrameError::Reference);
    }
    // If the vectors are almost parallel, rounding leaves a component along the tangent. A second
    // pass removes it.
    Ok(across.normalize().reject_from_normalized(tangent).normalize())
}

/// Computes rotation-minimizing frames along `spine`. The first reference vector is the component
/// of `reference` normal to the first tangent.
///
/// Two equal neighboring points have no chord. Every method then uses the smallest rotation between
/// their tangents and lists the segment in [`Frames::substituted`].
///
/// # Errors
/// - [`FrameError::Reference`] if `reference` is zero, not finite, or parallel to the first
///   tangent.
/// - [`FrameError::DegenerateSegment`] if a segment does not determine a rotation and `degenerate`
///   is [`DegenerateSegment::Refuse`].
/// - [`FrameError::OppositeTangents`] if the smallest rotation is used between opposite tangents.
///
/// # Examples
/// ```
/// use glam::DVec3;
/// use isochore_curve::{DegenerateSegment, FrameMethod, Spine, TrigonometricCurve, rotation_minimizing_frames};
///
/// // A planar curve keeps the normal of its plane.
/// let circle = TrigonometricCurve::helix(1.0, 0.0, (0.0, 3.0));
/// let spine = Spine::sample(&circle, 30)?;
/// let frames = rotation_minimizing_frames(
///     &spine,
///     DVec3::Z,
///     FrameMethod::DoubleReflection,
///     DegenerateSegment::Refuse,
/// )?;
/// assert_eq!(frames.stations.len(), 31);
/// assert!(frames.stations.iter().all(|frame| frame.r.distance(DVec3::Z) < 1e-14));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
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
