//! A spine at one instant: the nearest point of the spine to a point of space, and its derivatives.
//!
//! The parameter u of the nearest point satisfies (x − c(u)) · c′(u) = 0, so its gradient in space
//! is c′/(|c′|² − (x − c) · c″).

use glam::DVec3;
use isochore_curve::{
    ArcLength, ClosestPoint, CubicSpline, Curve, DegenerateSegment, EndCondition, FrameMethod, Spine, perpendicular,
    rotate_minimally, rotation_minimizing_frames,
};
use isochore_mesh::Aabb;

use super::spine_curve::SpineCurve;

/// Number of frames per smooth piece of the spine. Double reflection is of fourth order. Larger: no
/// visible change. Smaller: the cross-section rotates slightly about the spine.
const FRAMES_PER_PIECE: usize = 16;

/// Lower bound on the denominator of the parameter's gradient, relative to |c′|²; the denominator
/// vanishes at the center of curvature. Strips within the reach of their spine have five hundred
/// times as much. The bound keeps values finite for spines that bend too far between two checked
/// instants. Larger: changes valid fields. Smaller: allows larger velocities for such spines.
const LEAST_STRETCH: f64 = 1e-4;

/// A spine at one instant.
#[derive(Debug, Clone)]
pub(super) struct SpineInstant {
    search: ClosestPoint<SpineCurve>,
    /// Parameter, arc length up to it and parametric speed, in ascending order.
    lengths: Vec<[f64; 3]>,
    /// Reference vectors of rotation-minimizing frames by the parameter, if a cross-section needs
    /// them.
    references: Option<CubicSpline>,
}

/// Reference vector and tangent at the start of the spine at time 0.
#[derive(Debug, Clone, Copy)]
pub(super) struct StartFrame {
    pub(super) reference: DVec3,
    pub(super) tangent: DVec3,
}

/// The point of the spine nearest to a point of space.
#[derive(Debug, Clone, Copy)]
pub(super) struct Station {
    pub(super) parameter: f64,
    /// Vector from the spine to the point.
    pub(super) offset: DVec3,
    /// Unit tangent.
    pub(super) tangent: DVec3,
    /// Derivative of the unit tangent by the parameter.
    pub(super) tangent_derivative: DVec3,
    /// Parametric speed.
    pub(super) speed: f64,
    /// Gradient of the parameter in space; zero beyond an end, where the parameter is constant.
    pub(super) parameter_gradient: DVec3,
    /// Distance along the tangent by which the point is beyond an end of an open spine; zero
    /// between the ends.
    pub(super) beyond: f64,
}

/// A unit normal of the spine and its derivative by the parameter.
#[derive(Debug, Clone, Copy)]
pub(super) struct Normal {
    pub(super) vector: DVec3,
    pub(super) derivative: DVec3,
}

impl SpineInstant {
    /// Prepares `curve` for queries, with frames only if a start frame is given.
    pub(super) fn new(curve: SpineCurve, start_frame: Option<StartFrame>) -> Self {
        let references = start_frame.and_then(|start| references(&curve, start));
        let table = ArcLength::new(&curve);
        let lengths =
            table.table().map(|(parameter, length)| [parameter, length, curve.jet(parameter).speed()]).collect();
        Self { search: ClosestPoint::new(curve), lengths, references }
    }

    pub(super) fn curve(&self) -> &SpineCurve {
        self.search.curve()
    }

    pub(super) fn is_closed(&self) -> bool {
        self.curve().is_closed()
    }

    /// Length of the spine.
    pub(super) fn length(&self) -> f64 {
        self.lengths[self.lengths.len() - 1][1]
    }

    /// Bounding box of the spine.
    pub(super) fn bounds(&self) -> Aabb {
        let (min, max) = self.search.bounds();
        Aabb { min, max }
    }

    /// Distance from the spine.
    pub(super) fn distance(&self, point: DVec3) -> f64 {
        self.search.closest(point).distance
    }

    /// The nearest point of the spine to `point`.
    pub(super) fn station(&self, point: DVec3) -> Station {
        let parameter = self.search.closest(point).parameter;
        let curve = self.curve();
        let jet = curve.jet(parameter);
        let offset = point - jet.position;
        let tangent = jet.tangent();
        let squared_speed = jet.first.length_squared();
        let along = offset.dot(tangent);
        let (first, last) = curve.domain();
        let is_beyond = !curve.is_closed() && (parameter <= first && along < 0.0 || parameter >= last && along > 0.0);
        // From the implicit equation (x − c(u)) · c′(u) = 0.
        let stretch = (squared_speed - jet.second.dot(offset)).max(LEAST_STRETCH * squared_speed);
        Station {
            parameter,
            offset,
            tangent,
            tangent_derivative: jet.tangent_derivative(),
            speed: squared_speed.sqrt(),
            parameter_gradient: if is_beyond { DVec3::ZERO } else { jet.first / stretch },
            beyond: if is_beyond { along.abs() } else { 0.0 },
        }
    }

    /// Arc length from the start of the spine to a station, and its derivative by the parameter.
    ///
    /// The length is interpolated; its error is of fourth order in a sixteenth of a piece. The
    /// derivative is that of the interpolant.
    pub(super) fn length_to(&self, station: &Station) -> (f64, f64) {
        let last = self.lengths.len() - 1;
        let index = self.lengths[1..last].partition_point(|entry| entry[0] <= station.parameter);
        let [[start, low, start_speed], [end, high, end_speed]] = [self.lengths[index], self.lengths[index + 1]];
        let width = end - start;
        let t = ((station.parameter - start) / width).clamp(0.0, 1.0);
        let rest = 1.0 - t;
        let [b, c] = [low + start_speed * width / 3.0, high - end_speed * width / 3.0];
        let length = rest * rest * (rest * low + 3.0 * t * b) + t * t * (3.0 * rest * c + t * high);
        let slope = 3.0 * (rest * rest * (b - low) + 2.0 * rest * t * (c - b) + t * t * (high - c));
        (length, slope / width)
    }

    /// The rotation-minimizing normal at a station, or zero without frames.
    pub(super) fn normal(&self, station: &Station) -> Normal {
        let Some(references) = &self.references else {
            return Normal { vector: DVec3::ZERO, derivative: DVec3::ZERO };
        };
        let jet = references.jet(station.parameter);
        let Station { tangent, tangent_derivative, .. } = *station;
        // The interpolant of unit normals is neither exactly unit nor exactly normal. The
        // correction is differentiated with it.
        let along = jet.position.dot(tangent);
        let across = jet.position - along * tangent;
        let along_derivative = jet.first.dot(tangent) + jet.position.dot(tangent_derivative);
        let across_derivative = jet.first - along_derivative * tangent - along * tangent_derivative;
        let length = across.length();
        let inverse = if length > 0.0 { 1.0 / length } else { 0.0 };
        let vector = across * inverse;
        Normal { vector, derivative: (across_derivative - vector * vector.dot(across_derivative)) * inverse }
    }
}

/// Default direction of a cross-section's x axis at the start of `curve`: along the curvature.
pub(super) fn default_reference(curve: &SpineCurve) -> DVec3 {
    let jet = curve.jet(curve.domain().0);
    jet.normal().unwrap_or_else(|| perpendicular(jet.tangent()))
}

/// C² interpolant of the reference vectors of rotation-minimizing frames, by double reflection.
fn references(curve: &SpineCurve, start: StartFrame) -> Option<CubicSpline> {
    let mut parameters = Vec::new();
    for pair in curve.breaks().windows(2) {
        let step = (pair[1] - pair[0]) / FRAMES_PER_PIECE as f64;
        parameters.extend((0..FRAMES_PER_PIECE).map(|index| pair[0] + step * index as f64));
    }
    parameters.push(curve.domain().1);
    let tangent = curve.jet(parameters[0]).tangent();
    // At later times the start frame follows the tangent by the smallest rotation.
    let first = rotate_minimally(start.tangent, tangent, start.reference).unwrap_or_else(|| perpendicular(tangent));
    // A curve with positive reach has frames.
    let spine = Spine::from_jets(parameters.iter().map(|&parameter| curve.jet(parameter)), false).ok()?;
    let frames =
        rotation_minimizing_frames(&spine, first, FrameMethod::DoubleReflection, DegenerateSegment::Rotate).ok()?;
    let vectors: Vec<DVec3> = frames.stations.iter().map(|frame| frame.r).collect();
    CubicSpline::open_at(&vectors, &parameters, EndCondition::NotAKnot).ok()
}
