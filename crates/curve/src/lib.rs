//! Spine curves and the frames that move along them.

mod analytic;
mod arc_length;
mod bezier;
mod closest_point;
mod curve;
mod quadrature;
mod reach;
mod spline;

pub use analytic::{FunctionCurve, TrigonometricCurve, TrigonometricTerm};
pub use arc_length::{ArcLength, length, total_curvature, total_squared_curvature, total_torsion};
pub use bezier::Bezier;
pub use closest_point::{ClosestPoint, CurveProjection};
pub use curve::{Curve, CurveJet};
pub use reach::{Reach, reach};
pub use spline::{CubicSpline, EndCondition, Parametrization, SplineError};
