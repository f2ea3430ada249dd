//! Divergence-free velocity fields: tools, jointed tools, rings, strips and regions, and the masks over them.

pub(crate) mod field;
pub(crate) mod jointed_tool;
pub(crate) mod mask;
pub(crate) mod pose;
mod profile;
pub(crate) mod region;
pub(crate) mod rigid_motion;
pub(crate) mod ring;
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
pub use strip::{Strip, StripError, StripMotion, StripShape, StripSpine};
pub use tool::{MovingTool, RigidField, Tool, ToolError, VelocityBlock};
