//! Volume-preserving deformation of triangle meshes through divergence-free vector fields.
//!
//! A tool is a solid given by its signed distance d. Around its motion, isochore builds the velocity field
//!
//! ```text
//! v = curl(s A) = s curl A + ∇s × A,   s = g(d / R)
//! ```
//!
//! where A is a vector potential of the tool's rigid motion, g a falloff profile and R the support radius. A curl has zero
//! divergence, so the flow of v preserves every volume, whatever the shape of the tool. Mesh vertices are advected along
//! that flow, the mesh is refined where flat triangles no longer follow the curved image, and a final correction restores
//! the volume to the last digit.
//!
//! # A first deformation
//!
//! This program presses a ball into a sphere of clay. `isochore` is its only dependency.
//!
//! ```
//! use isochore::field::{DeformOptions, Move, Pose, Profile, Stroke, Tool, deform};
//! use isochore::glam::DVec3;
//! use isochore::mesh::{NoProgress, Sphere, primitives::icosphere};
//!
//! fn main() -> Result<(), Box<dyn std::error::Error>> {
//!     let clay = icosphere(1.0, 4);
//!     let ball = Tool::new(std::sync::Arc::new(Sphere::new(0.4)?), 0.3, Profile::Quintic)?;
//!     let path = vec![Pose::at(DVec3::new(0.0, 0.0, 1.8)), Pose::at(DVec3::new(0.0, 0.0, 1.0))];
//!     let press = Stroke::Move(Move::new(ball.into(), path, 0.125)?);
//!     let pressed = deform(&clay, &[press], &DeformOptions::default(), &NoProgress)?;
//!     assert!((pressed.mesh.volume() / clay.volume() - 1.0).abs() < 1e-12);
//!     println!("{} vertices moved", pressed.receipt.moved_vertices);
//!     Ok(())
//! }
//! ```
//!
//! # Modules and features
//!
//! Each module is a crate of its own, which can also be used directly.
//!
//! | module | crate | feature | contents |
//! |---|---|---|---|
//! | [`mesh`] | `isochore-mesh` | always | triangle meshes with attributes, checks, measures, signed distance |
//! | `mesh::io` | `isochore-mesh` | `io` (default) | OBJ, glTF, PLY, STL, OFF |
//! | [`field`] | `isochore-field` | always | tools, fields, strokes, masks, [`field::deform`] |
#![cfg_attr(
    feature = "curve",
    doc = "| [`curve`] | `isochore-curve` | `curve` (default) | spines, rotation-minimizing frames, swept surfaces |"
)]
#![cfg_attr(
    feature = "session",
    doc = "| [`sculpt`] | `isochore-sculpt` | `session` (default) | recipes, replay, reports, interactive sessions |"
)]
#![cfg_attr(
    feature = "picture",
    doc = "| [`picture`] | `isochore-picture` | `picture` | software rendering of meshes to PNG |"
)]
//!
//! Without default features, no file format and no recipe parser is compiled. [`glam`] is re-exported because its vectors
//! are part of every signature.
//!
//! # Limits
//!
//! - The exact flow preserves volume and keeps distinct points distinct. A computed flow has a time-step error of order
//!   four, and flat triangles only approximate the curved image. [`field::Receipt`] reports both.
//! - A closed mesh regains its volume through the final correction. An open mesh has no volume to preserve.
//! - Deep or repeated strokes can leave triangles that cross. Check the result with [`mesh::SelfIntersections`].

pub use glam;
#[cfg(feature = "curve")]
pub use isochore_curve as curve;
pub use isochore_field as field;
pub use isochore_mesh as mesh;
#[cfg(feature = "picture")]
pub use isochore_picture as picture;
#[cfg(feature = "session")]
pub use isochore_sculpt as sculpt;

#[cfg(all(doctest, feature = "session"))]
#[doc = include_str!("../../../README.md")]
struct Readme;

#[cfg(all(doctest, feature = "session"))]
#[doc = include_str!("../../../docs/src/rust.md")]
struct Guide;
