//! Divergence-free velocity fields of moving tools, their flows, and the deformation of meshes by them.
//!
//! Terms used throughout:
//!
//! - A [`Tool`] is a shape with a *support* around its surface; a [`Profile`] says how its field fades over the support.
//! - A field is the curl of a *vector potential*, so it is divergence-free; its *flow map* keeps every volume.
//! - A [`Stroke`] is one motion that deforms: a tool that moves, or a twist or bend of all space.
//! - The *rest* of a mesh is the mesh as read, the *image* what the flow map makes of it. Between vertices the image of a
//!   flat triangle is curved; the volume between it and the flat triangle that replaces it is the *facet error*.

mod deform;
mod fields;
mod flow;

pub use deform::{
    DeformError, DeformOptions, Deformed, Lock, Note, PressError, Receipt, RefineOptions, StageSeconds, StrokeReceipt,
    deform, lock_part, lock_volume,
};
pub use fields::{
    BodyTwist, Bone, Field, FieldBlock, JointedTool, JointedToolError, Mask, MaskError, MirrorPlane, MovingField,
    MovingTool, NO_CORE, Pin, Pose, Posture, Profile, Region, RigidField, Ring, RingError, RingShape, ScalarBlock,
    Strip, StripError, StripMotion, StripShape, StripSpine, Tool, ToolError, UnknownProfile, VelocityBlock, VertexMask,
    WeightedPotential, rotation_from_vector,
};
pub use flow::{
    AdvectError, AxisError, Bend, FieldStroke, FieldStrokeError, JacobianRange, MaskedError, Move, MoveError,
    RegionMotion, RegionMotionError, Stamp, StampError, Stroke, StrokeError, Twist, advect_points,
};
