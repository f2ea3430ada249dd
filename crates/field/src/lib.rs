//! Divergence-free velocity fields of moving tools, their flows, and the deformation of meshes by them.
//!
//! Terms used throughout:
//!
//! - A [`Tool`] is a shape with a *support* around its surface; a [`Profile`] says how its field fades over the support.
//! - A field is the curl of a *vector potential*, so it is divergence-free; its *flow map* keeps every volume.
//! - A [`Stroke`] is one motion that deforms: a tool that moves, or a twist or bend of all space.
//! - The *rest* of a mesh is the mesh as read, the *image* what the flow map makes of it. Between vertices the image of a
//!   flat triangle is curved; the volume between it and the flat triangle that replaces it is the *facet error*.

mod balance;
mod deform;
mod facet_error;
mod field;
#[cfg(test)]
mod finite_differences;
mod flow;
#[cfg(test)]
mod flux;
mod gauge;
mod guard;
#[cfg(test)]
mod identities;
mod jacobian;
mod jointed_tool;
mod lock;
mod mask;
mod masked_field;
mod mirrored_field;
mod moving_tool;
mod pose;
mod press;
mod profile;
mod receipt;
mod refine;
mod region;
mod rigid_field;
mod rigid_gauge;
mod ring;
mod rk4;
mod scalar_block;
mod strip;
mod stroke;
mod swirl_field;
mod tessellation;
mod tool;

pub use deform::{DeformError, DeformOptions, Deformed, deform};
pub use field::{Field, FieldBlock, MovingField, NO_CORE};
pub use flow::{AdvectError, advect_points};
pub use jacobian::JacobianRange;
pub use jointed_tool::{Bone, JointedTool, JointedToolError, Posture};
pub use lock::{Lock, lock_part, lock_volume};
pub use mask::{Mask, MaskError, MirrorPlane, Pin, VertexMask};
pub use moving_tool::MovingTool;
pub use pose::{BodyTwist, Pose, rotation_from_vector};
pub use press::StampError;
pub use profile::{Profile, UnknownProfile};
pub use receipt::{Note, Receipt, StageSeconds, StrokeReceipt};
pub use refine::RefineOptions;
pub use region::{Region, RegionMotion};
pub use rigid_field::{RigidField, VelocityBlock};
pub use rigid_gauge::RigidGauge;
pub use ring::{Ring, RingError, RingShape};
pub use scalar_block::ScalarBlock;
pub use strip::{Strip, StripError, StripMotion, StripShape, StripSpine};
pub use stroke::{Bend, FieldStroke, Move, Stamp, Stroke, StrokeError, Twist};
pub use tool::{Tool, ToolError};
