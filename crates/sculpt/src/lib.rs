//! Recipes of deformations, their replay on meshes and points, and interactive sessions.
//!
//! # Terms
//!
//! - A [`Recipe`] describes a deformation: a target, tools, strokes and outputs. It is plain data
//!   that is written and read without loss.
//! - A [`Scene`] holds the objects that a recipe describes: the target's mesh, tools and strokes.
//! - [`replay()`] deforms the target of a recipe, and a [`Report`] measures the result on the mesh as
//!   written.
//! - A [`PointFlow`] advects points that do not form a mesh and need not fit into memory.
//! - A [`session`] deforms a mesh stroke by stroke for an interactive host. Its log is a recipe.
//!
//! Imports run in one direction: `recipe` is plain data, `scene` builds objects from it, and
//! `replay` applies them.
//!
//! # Parse a recipe and replay it
//!
//! ```
//! use isochore_mesh::NoProgress;
//! use isochore_sculpt::{Meshes, Recipe, Report, Source, recipe::Format, replay};
//!
//! let text = r#"
//!     recipe = 1
//!     [target]
//!     shape = { kind = "icosphere", radius = 1.0, subdivisions = 3 }
//!     [[stroke]]
//!     kind = "twist"
//!     origin = [0, 0, 0]
//!     axis = [0, 0, 1]
//!     degrees_per_unit = 30.0
//!     [promise]
//!     volume = 1e-9
//! "#;
//! let recipe = Recipe::parse(text, Format::Toml, &[])?;
//! let replay = replay(&recipe, &Meshes::new(), &NoProgress)?;
//! assert_eq!(replay.deformed.receipt.strokes.len(), 1);
//!
//! let source = Source { text: text.as_bytes(), overrides: &[] };
//! let report = Report::new(&recipe, source, &replay, &replay.deformed.mesh, &NoProgress)?;
//! assert_eq!(report.missed_promises().count(), 0);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Build a recipe in code and advect points
//!
//! ```
//! use glam::DVec3;
//! use isochore_mesh::NoProgress;
//! use isochore_sculpt::{Meshes, Recipe, recipe::{Format, Stroke, Twist}, replay_points};
//!
//! let mut recipe = Recipe::parse("recipe = 1\ntarget = { mesh = 'points' }", Format::Toml, &[])?;
//! let twist = Twist { origin: [0.0; 3], axis: [0.0, 0.0, 1.0], degrees_per_unit: 90.0 };
//! recipe.strokes.push(Stroke::Twist(twist));
//! let replay = replay_points(&recipe, &Meshes::new(), &[DVec3::new(1.0, 0.0, 1.0)], &NoProgress)?;
//! assert!(replay.points[0].distance(DVec3::new(0.0, 1.0, 1.0)) < 1e-15);
//! assert_eq!(replay.warnings.len(), 1, "points have no volume lock");
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Open a session
//!
//! ```
//! use isochore_mesh::primitives;
//! use isochore_sculpt::session::{Session, SessionOptions};
//!
//! let session = Session::open(primitives::icosphere(1.0, 3), SessionOptions::default())?;
//! assert!(session.log().strokes.is_empty());
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Guarantees
//!
//! The same recipe and the same meshes give the same bits for any number of threads. Writing and
//! parsing a recipe returns an equal recipe. Points move exactly as the vertices of a mesh do
//! before the volume lock, unless a stroke on the mesh ends early.
//!
//! Not guaranteed: refinement changes triangles, so a replay on a finer mesh has different ones. A
//! promise is only checked, not enforced, and a flow can bring parts of a surface closer to each
//! other than the rounding of a file format.
//!
//! The feature `io`, enabled by default, adds the module `files`, which loads the files that a
//! recipe names.

#[cfg(feature = "io")]
pub mod files;
mod point_flow;
pub mod recipe;
mod remesh;
mod replay;
mod report;
mod scene;
pub mod schema;
pub mod session;
mod stream_report;

pub use point_flow::{PointFlow, PointReplay, StreamProblem, replay_points};
pub use recipe::Recipe;
pub use remesh::{RemeshError, Remeshed, remesh};
pub use replay::{Replay, ReplayError, replay};
pub use report::{Bounds, Certificate, Measures, Report, Seconds, SheetsReport, Source, StrokeReport};
pub use scene::{BuildToolError, MaskProblem, Meshes, Scene, SceneError, SceneProblem, ShapeProblem, build_tool};
pub use stream_report::{StreamReport, StreamSeconds};
