//! Divergence-free velocity fields and the masks that restrict them.
//!
//! Terms:
//!
//! - The *full motion* is the velocity that a shape imposes on the material inside it.
//! - The *support* is the layer around a shape in which its field is nonzero.
//! - The *weight* s is the fraction of the full motion: one in the core, zero beyond the support.
//! - The *gauge* is the choice among the potentials A that have the full motion as their curl.
//!
//! Every field is the curl of a vector potential s A, so it is divergence-free:
//!
//! ```text
//! V = curl(s A) = s curl A + ∇s × A
//! ```
//!
//! A [`Field`] is evaluated at one instant; a [`MovingField`] supplies it for times from 0 to 1.
//! Sources are named in the module of each field.

pub(crate) mod field;
pub(crate) mod jointed_tool;
pub(crate) mod mask;
pub(crate) mod pose;
mod profile;
pub(crate) mod region;
pub(crate) mod rigid_motion;
pub(crate) mod ring;
mod steady_field;
pub(crate) mod strip;
pub(crate) mod swirl_field;
pub(crate) mod tool;

pub use field::{Field, FieldBlock, MovingField, NO_CORE, ScalarBlock, WeightedPotential};
pub use jointed_tool::{Bone, JointedTool, JointedToolError, Posture};
pub use mask::{Mask, MaskError, MirrorPlane, Pin, VertexMask};
pub use pose::{BodyTwist, Pose, rotation_from_vector};
pub use profile::{Profile, UnknownProfile};
pub use region::Region;
pub use ring::{Ring, RingError, RingShape};
pub use steady_field::SteadyField;
pub use strip::{Strip, StripError, StripMotion, StripShape, StripSpine};
pub use tool::{MovingTool, RigidField, Tool, ToolError, VelocityBlock};
