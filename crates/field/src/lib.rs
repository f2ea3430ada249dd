//! Divergence-free velocity fields of moving tools, their flows, and the deformation of meshes by
//! them.
//!
//! # Terms
//!
//! - A *[field](Field)* is a velocity field, the curl of a *vector potential*. Its divergence is zero.
//! - The *flow map* of a field moves points along the field. It preserves volume.
//! - To *advect* a point is to apply the flow map to it.
//! - A *[tool](Tool)* is a shape with a *support*: the distance beyond its surface at which its field
//!   ends. A *[profile](Profile)* is the falloff of the field over the support.
//! - The *core* of a field is the region that moves rigidly with a tool.
//! - A *[stroke](Stroke)* is one motion that deforms: a tool that moves, a field that changes with time,
//!   a twist or a bend of all space, or a stamp.
//! - A *[mask](Mask)* is a scalar function of space that scales vector potentials. Where it is zero, it
//!   holds the material.
//! - The *rest* of a mesh is the input mesh, and the *image* is the deformed mesh.
//! - The *facet error* is the volume between the flat triangles and the curved image of the surface.
//! - The *lock* is a last small displacement that restores the volume of the rest.
//!
//! # Formula
//!
//! With A the vector potential of a rigid motion and s a scalar falloff, every field has the form
//!
//! ```text
//! V = curl(s A) = s curl A + ∇s × A
//! ```
//!
//! Where s = 1, V is the rigid motion curl A. Where s = 0, V is zero. In between, V is a curl and
//! therefore divergence-free. ∇s must be the exact gradient of s: with another gradient, V is not a
//! curl.
//!
//! # Stages
//!
//! **Tool.** A signed distance, a support and a profile make a tool:
//!
//! ```
//! # use std::sync::Arc;
//! # use isochore_field::{Profile, Tool};
//! # use isochore_mesh::Sphere;
//! let tool = Tool::new(Arc::new(Sphere::new(0.3)?), 0.3, Profile::Quintic)?;
//! assert_eq!(tool.support(), 0.3);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! **Stroke.** A tool and its poses make a stroke. Between two poses the tool moves along a screw:
//!
//! ```
//! # use std::sync::Arc;
//! # use glam::DVec3;
//! # use isochore_field::{Move, Pose, Profile, Stroke, Tool};
//! # use isochore_mesh::Sphere;
//! # let tool = Tool::new(Arc::new(Sphere::new(0.3)?), 0.3, Profile::Quintic)?;
//! let keys = vec![Pose::at(DVec3::Z * 1.6), Pose::at(DVec3::Z * 1.2)];
//! let stroke = Stroke::Move(Move::new(Arc::new(tool), keys, 0.125)?);
//! assert!(stroke.may_touch(DVec3::Z, 0.1) && !stroke.may_touch(-DVec3::Z, 0.1));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! **Deform.** [`deform()`] advects the vertices of a mesh, refines it and locks its volume. The
//! [`Receipt`] reports what each pass did:
//!
//! ```
//! # use glam::DVec3;
//! # use isochore_field::{DeformOptions, Stroke, Twist, deform};
//! # use isochore_mesh::{NoProgress, primitives};
//! let twist = Stroke::Twist(Twist::new(DVec3::ZERO, DVec3::Z, 0.8)?);
//! let cube = primitives::box_mesh(DVec3::ONE, [4, 4, 4]);
//! let deformed = deform(&cube, &[twist], &DeformOptions::default(), &NoProgress)?;
//!
//! let receipt = &deformed.receipt;
//! let (before, after) = (receipt.volume_before.unwrap(), receipt.volume_after.unwrap());
//! assert!((after - before).abs() < 1e-12 * before);
//! assert_eq!(deformed.mesh.positions.len(), cube.positions.len() + receipt.inserted_vertices);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! **Points.** [`advect_points`] advects points without a mesh:
//!
//! ```
//! # use glam::DVec3;
//! # use isochore_field::{Bend, Stroke, advect_points};
//! # use isochore_mesh::NoProgress;
//! let bend = Stroke::Bend(Bend::new(DVec3::ZERO, DVec3::Z, 0.5)?);
//! let images = advect_points(&[DVec3::X, DVec3::Z], &[bend], &NoProgress)?;
//! // The axis stays, and a point beside it turns by half a radian.
//! assert_eq!(images[1], DVec3::Z);
//! assert!((images[0].y.atan2(images[0].x) - 0.5).abs() < 1e-15);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! **A field of one's own.** Implement [`Field`], and set each lane from s, ∇s, A and curl A. The library
//! computes the velocity. [`SteadyField`] makes a stroke of a field that does not change with time; for
//! one that does, implement [`MovingField`] too:
//!
//! ```
//! # use std::sync::Arc;
//! use glam::DVec3;
//! use isochore_field::{Field, FieldBlock, FieldStroke, NO_CORE, Profile, SteadyField, Stroke, WeightedPotential};
//! use isochore_mesh::{Aabb, LANES, PointBlock};
//!
//! /// A vortex of radius one about the z axis.
//! #[derive(Debug, Clone, Copy)]
//! struct Vortex;
//!
//! impl Field for Vortex {
//!     fn evaluate_into(&self, points: &PointBlock, out: &mut FieldBlock) {
//!         for lane in 0..LANES {
//!             let arm = points.get(lane).with_z(0.0);
//!             let radius = arm.length();
//!             if radius >= 1.0 {
//!                 out.set_outside(lane, radius - 1.0);
//!                 continue;
//!             }
//!             let (weight, slope) = Profile::Quintic.evaluate(radius);
//!             let product = WeightedPotential {
//!                 weight,
//!                 gradient: slope * arm.normalize_or_zero(),
//!                 potential: -0.5 * arm.length_squared() * DVec3::Z,
//!                 curl: DVec3::Z.cross(arm),
//!             };
//!             out.set_inside(lane, product, NO_CORE);
//!         }
//!     }
//!
//!     fn bounds(&self) -> Aabb {
//!         Aabb { min: DVec3::new(-1.0, -1.0, f64::NEG_INFINITY), max: DVec3::new(1.0, 1.0, f64::INFINITY) }
//!     }
//! }
//!
//! let vortex = SteadyField { field: Vortex, core_speed: 1.0, feature_size: 1.0 };
//! let stroke = Stroke::Field(FieldStroke::new(vec![Arc::new(vortex)], 0.05)?);
//! let mut points = [0.3 * DVec3::X, 2.0 * DVec3::X];
//! stroke.advect(&mut points);
//! assert!(points[0].y > 0.1 && (points[0].length() - 0.3).abs() < 1e-6);
//! assert_eq!(points[1], 2.0 * DVec3::X);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! **Mask.** [`Stroke::masked`] applies pins, a painted mask and mirror planes to a stroke:
//!
//! ```
//! # use std::sync::Arc;
//! # use glam::DVec3;
//! # use isochore_field::{Mask, Pin, Stroke, Twist};
//! # use isochore_mesh::Aabb;
//! # let twist = Stroke::Twist(Twist::new(DVec3::ZERO, DVec3::Z, 0.8)?);
//! let pin = Pin::new(DVec3::ONE, 0.2, 0.4)?;
//! let mask = Arc::new(Mask::new(vec![pin], None, Vec::new())?);
//! let masked = twist.masked(&mask, Aabb { min: DVec3::NEG_ONE, max: DVec3::ONE }, 0.1)?;
//! let mut points = [DVec3::ONE];
//! masked.advect(&mut points);
//! assert_eq!(points, [DVec3::ONE]);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Not guaranteed
//!
//! - The volume inside flat triangles is not exact before the lock. The time step and the facets change
//!   it; the receipt reports by how much.
//! - An open mesh has no volume, and the lock does not apply to it.
//! - A flow map preserves volume and topology, not distances or angles. It may stretch triangles
//!   strongly.
//! - Self-intersections of the input remain. Flat triangles can cross although the curved image does
//!   not. Refinement splits such triangles, up to its limits.
//! - A stamp is not a flow. It preserves the volume of the flat triangles.
//! - A velocity may be discontinuous: if the profile has a kink, or if the profile acts inside a tool
//!   that is too thin for it. The Jacobian of the flow map may then differ from one.
//!
//! # Layout
//!
//! The crate has three wings, whose imports run in one direction: `deform` (meshes) → `flow` (strokes
//! and points) → `fields` (velocities). All public items are at the root.

mod deform;
mod fields;
mod flow;

pub use deform::{
    DeformError, DeformOptions, Deformed, Lock, Note, PressError, Rebase, Receipt, RefineOptions, Sheets, StageSeconds,
    StrokeReceipt, deform, lock_part, lock_volume,
};
pub use fields::{
    BodyTwist, Bone, Field, FieldBlock, JointedTool, JointedToolError, Mask, MaskError, MirrorPlane, MovingField,
    MovingTool, NO_CORE, Pin, Pose, Posture, Profile, Region, RigidField, Ring, RingError, RingShape, ScalarBlock,
    SteadyField, Strip, StripError, StripMotion, StripShape, StripSpine, Tool, ToolError, UnknownProfile,
    VelocityBlock, VertexMask, WeightedPotential, rotation_from_vector,
};
pub use flow::{
    AdvectError, AxisError, Bend, FieldStroke, FieldStrokeError, JacobianRange, MaskedError, Move, MoveError,
    RegionMotion, RegionMotionError, Stamp, StampError, Stroke, StrokeError, Twist, advect_points,
};
