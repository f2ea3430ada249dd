//! Spine curves and the frames that move along them.

mod analytic;
mod arc_length;
mod bernstein;
mod bezier;
mod closest_point;
mod curve;
mod double_reflection;
mod frame;
mod frenet;
mod gauge_quadrature;
mod inversion;
mod moebius;
mod ph_cubic;
mod projection;
mod quadrature;
mod reach;
mod rotation;
mod runge_kutta;
mod spine;
mod spline;
mod tangents;
mod tangents_only;
mod twist;

pub use analytic::{FunctionCurve, TrigonometricCurve, TrigonometricTerm};
pub use arc_length::{ArcLength, length, total_curvature, total_squared_curvature, total_torsion};
pub use bezier::Bezier;
pub use closest_point::{ClosestPoint, CurveProjection};
pub use curve::{Curve, CurveJet};
pub use double_reflection::{AxisAngle, reflect_twice};
pub use frame::{
    DegenerateSegment, Frame, FrameError, FrameMethod, Frames, orthogonal_reference, rotation_minimizing_frames,
};
pub use frenet::{FrenetError, frenet_frames};
pub use gauge_quadrature::exact_frames;
pub use inversion::Inversion;
pub use moebius::{MoebiusSegment, MoebiusSpline, MoebiusSplineError, Tilt};
pub use ph_cubic::{PhCubic, PhCubicError, PhSpline, PhSplineError, RationalRotation};
pub use projection::project_along_chord;
pub use reach::{Reach, reach};
pub use rotation::rotate_minimally;
pub use runge_kutta::runge_kutta_frames;
pub use spine::{Spine, SpineError, perpendicular, uniform_parameters};
pub use spline::{CubicSpline, EndCondition, Parametrization, SplineError};
pub use tangents::{TangentError, TangentRule};
pub use tangents_only::chord_from_tangents;
pub use twist::{
    TwistConstraint, TwistError, TwistLaw, TwistedFrames, close_frames, closing_angle, meet_constraints,
    meet_end_direction, spread, total_angular_speed, total_squared_angular_speed, twist_shares,
};
