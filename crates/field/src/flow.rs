//! The flow maps of the fields: strokes, the integrator, and points advected by them.

pub(crate) mod advection;
mod axis;
mod bend;
mod field_stroke;
mod jacobian;
mod movement;
mod region_stroke;
mod rk4;
mod stamp;
pub(crate) mod stroke;
mod twist;

pub use advection::{AdvectError, advect_points};
pub use axis::AxisError;
pub use bend::Bend;
pub use field_stroke::{FieldStroke, FieldStrokeError};
pub use jacobian::JacobianRange;
pub use movement::{Move, MoveError};
pub use region_stroke::{RegionMotion, RegionMotionError};
pub use stamp::{Stamp, StampError};
pub use stroke::{MaskedError, Stroke, StrokeError};
pub use twist::Twist;
