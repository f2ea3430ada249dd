//! Spine curves and the moving frames along them.
//!
//! # Terms
//!
//! - A [`Curve`] is given by a formula that returns a [`CurveJet`] (position and derivatives) at a
//!   *parameter*. [`CubicSpline`], [`Bezier`], [`TrigonometricCurve`] and any
//!   [closure](FunctionCurve) are curves.
//! - A [`Spine`] is a sampled curve: points with unit tangents at *stations*, joined by *segments*,
//!   open or closed.
//! - A [`Frame`] (r, s, t) is right-handed and orthonormal. t is the tangent, r the *reference
//!   vector*, and s = t × r.
//! - A frame is *rotation-minimizing* if it does not rotate about the tangent. *Twist* is an
//!   additional rotation about the tangent, in radians.
//! - A *cross-section* is a planar curve with coordinates along r and s. Sweeping it along a spine
//!   gives a surface: a [`PointGrid`], or an exact [`RationalPatch`].
//!
//! Lengths are in model units and coordinates are `f64`. No function starts a thread, and the same
//! input gives the same bits on every machine.
//!
//! # Formula
//!
//! The reference vector of a rotation-minimizing frame satisfies r′ = −(r · t′) t: its derivative
//! is parallel to the tangent. The default method, *double reflection*, moves r from station i to
//! station i + 1 by two reflections v ↦ v − 2 n (n · v) / (n · n). The first has the chord as its
//! vector, n₁ = xᵢ₊₁ − xᵢ. It maps rᵢ to r̃ and tᵢ to t̃. The second has n₂ = tᵢ₊₁ − t̃. It maps t̃
//! to tᵢ₊₁ and r̃ to rᵢ₊₁. Source: W. Wang, B. Jüttler, D. Zheng, Y. Liu, Computation of rotation
//! minimizing frames, ACM Transactions on Graphics 27(1), 2008.
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
//! # Ok::<(), isochore_curve::SplineError>(())
//! ```
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
//! // The smallest twist that closes the frames, spread evenly along the curve.
//! let closed = close_frames(&spine, &frames.stations, Default::default(), 0);
//! assert!(closing_angle(&closed.stations).abs() < 1e-12);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Swept surfaces
//!
//! ```
//! use glam::DVec2;
//! use isochore_curve::{Spine, TrigonometricCurve, rotation_minimizing_frames, sweep};
//!
//! let spine = Spine::sample(&TrigonometricCurve::helix(1.0, 0.3, (0.0, 6.0)), 40)?;
//! let frames =
//!     rotation_minimizing_frames(&spine, spine.default_reference(), Default::default(), Default::default())?;
//! let stations: Vec<_> = spine.points().iter().copied().zip(frames.stations).collect();
//! let grid = sweep(&stations, &[DVec2::new(-0.1, 0.0), DVec2::new(0.1, 0.0)]);
//! assert_eq!((grid.rows, grid.columns), (41, 2));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Rational curves and surfaces
//!
//! ```
//! use glam::DVec2;
//! use isochore_curve::{PhSpline, RationalCrossSection, RationalPatch, RationalRotation, TrigonometricCurve};
//!
//! let spline = PhSpline::follow(&TrigonometricCurve::torus_knot(), 1e-3)?;
//! let line = RationalCrossSection::polynomial(&[DVec2::new(-0.1, 0.05), DVec2::new(0.1, 0.05)]);
//! let cubic = &spline.segments()[0];
//! let patch = RationalPatch::sweep(cubic, &RationalRotation::symmetric(cubic), &line, 0.0);
//! assert!(patch.jet(0.5, 0.5).orthogonality().abs() < 1e-6);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Limits
//!
//! - Frames of sampled spines are exact only on spheres and planes. On other curves, the error of
//!   double reflection is of fourth order in the spacing.
//! - Estimated tangents are of fourth order if there are at least five points.
//! - [`ClosestPoint::branches`] can miss a pair of minima that have just separated beyond the
//!   center of curvature. [`ClosestPoint::closest`] still returns one of the two.
//! - [`reach()`] overestimates the reach of a curve; the error is of second order in the spacing.
//! - Not every curve has a [`PhCubic`] or [`MoebiusSegment`] between two samples. Their
//!   constructors return an error that names the segment or parameter.

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
mod projection;
mod quadrature;
mod reach;
mod rotation;
mod runge_kutta;
mod spine;
mod spline;
mod swept_surface;
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
pub use projection::project_along_chord;
pub use reach::{Reach, reach};
pub use rotation::rotate_minimally;
pub use runge_kutta::runge_kutta_frames;
pub use spine::{Spine, SpineError, perpendicular, uniform_parameters};
pub use spline::{CubicSpline, EndCondition, Parametrization, SplineError};
pub use swept_surface::{
    CrossSectionJet, PointGrid, RationalCrossSection, RationalPatch, SurfaceJet, regularity, safe_cross_section_radius,
    sweep, sweep_varying, swept_surface_curvature,
};
pub use tangents::{TangentError, TangentRule};
pub use tangents_only::chord_from_tangents;
pub use twist::{
    TwistConstraint, TwistError, TwistLaw, TwistedFrames, close_frames, closing_angle, meet_constraints,
    meet_end_direction, spread, total_angular_speed, total_squared_angular_speed, twist_fractions,
};
