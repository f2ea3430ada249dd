//! Spine curves and the frames that move along them.
//!
//! Terms used throughout:
//!
//! - A [`Curve`] is a formula: it gives a [`CurveJet`], position and derivatives, at a *parameter*. [`CubicSpline`],
//!   [`Bezier`], [`TrigonometricCurve`] and any [closure](FunctionCurve) are curves.
//! - A [`Spine`] is samples: points with unit tangents at *stations*, joined by *segments*, open or closed.
//! - A [`Frame`] (r, s, t) is right-handed and orthonormal, with the tangent t and s = t × r; r is its *reference
//!   vector*.
//! - A frame is *rotation-minimizing* where it does not turn about the tangent. *Twist* is what is added to that, in
//!   radians.
//! - A *profile* is a planar curve with coordinates along r and s; swept along a spine it makes a surface, given here
//!   as a [`PointGrid`] or as an exact [`RationalPatch`].
//!
//! Lengths are in model units, coordinates are `f64`. Nothing here starts a thread, and the same input gives the same
//! bits on every machine.
//!
//! # Frames along a curve
//!
//! ```
//! use isochore_curve::{FrameMethod, Spine, TrigonometricCurve};
//! use isochore_curve::{close_frames, closing_angle, rotation_minimizing_frames};
//!
//! let spine = Spine::sample(&TrigonometricCurve::torus_knot(), 256)?;
//! let reference = spine.default_reference();
//! let frames = rotation_minimizing_frames(&spine, reference, FrameMethod::DoubleReflection, Default::default())?;
//! assert!((closing_angle(&frames.stations) + 2.8757).abs() < 1e-4);
//! // The least twist that closes them, evenly along the curve.
//! let closed = close_frames(&spine, &frames.stations, Default::default(), 0);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Curves through points
//!
//! ```
//! use glam::DVec3;
//! use isochore_curve::{ClosestPoint, CubicSpline, EndCondition, Parametrization};
//!
//! let points = [DVec3::ZERO, DVec3::new(1.0, 1.0, 0.0), DVec3::new(2.0, 0.0, 1.0)];
//! let spline = CubicSpline::open(&points, Parametrization::Centripetal, EndCondition::Natural)?;
//! let nearest = ClosestPoint::new(&spline).closest(DVec3::new(1.0, 1.2, 0.0));
//! assert!(nearest.distance < 0.2);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Rational curves and surfaces
//!
//! ```
//! use glam::DVec2;
//! use isochore_curve::{PhSpline, RationalPatch, RationalCrossSection, RationalRotation, TrigonometricCurve};
//!
//! let spline = PhSpline::follow(&TrigonometricCurve::torus_knot(), 1e-3)?;
//! let profile = RationalCrossSection::polynomial(&[DVec2::new(-0.1, 0.05), DVec2::new(0.1, 0.05)]);
//! let cubic = &spline.segments()[0];
//! let patch = RationalPatch::sweep(cubic, &RationalRotation::symmetric(cubic), &profile, 0.0);
//! assert!(patch.jet(0.5, 0.5).orthogonality().abs() < 1e-6);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # What is not promised
//!
//! Sampled frames are exact on spheres and planes only; elsewhere double reflection is of fourth order in the spacing.
//! Estimated tangents are of fourth order for five points or more. [`ClosestPoint::branches`] may miss a pair of minima
//! that have just split beyond the center of curvature; [`ClosestPoint::closest`] then still returns one of them.
//! [`reach`] is an estimate from above.

mod analytic;
mod arc_length;
mod batch;
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
mod profile_surface;
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
pub use batch::{BATCH_SIZE, BatchError, ReferenceBatch, SpineBatch};
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
pub use moebius::{MoebiusSegment, MoebiusSpline, Tilt};
pub use ph_cubic::{HermiteError, PhCubic, PhCubicError, PhSpline, PhSplineError, RationalRotation};
pub use profile_surface::{
    PointGrid, CrossSectionJet, RationalPatch, RationalCrossSection, SurfaceJet, profile_surface_curvature, regularity,
    safe_cross_section_radius, sweep, sweep_varying,
};
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
    meet_end_direction, spread, total_angular_speed, total_squared_angular_speed, twist_fractions,
};
