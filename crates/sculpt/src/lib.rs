//! The stroke log, which is the recipe, and its replay on meshes and points.
//!
//! Terms used throughout:
//!
//! - A [`Recipe`] says what to deform, with which tools and strokes. It is plain data that is written and read back without loss,
//!   and so serves as the log of a session as well.
//! - A [`Scene`] holds the objects that a recipe describes: meshes, distances, tools, strokes.
//! - To [`replay`] is to deform the target of a recipe. A [`Report`] tells what came of it, measured on the mesh as written.
//! - A [`session`] deforms a mesh stroke by stroke under the hands of a host, and its log is a recipe.
//! - A [`PointFlow`] carries points that are no mesh, and need not be all there at once.
//!
//! ```
//! use isochore_mesh::NoProgress;
//! use isochore_sculpt::{Meshes, Recipe, recipe::Format, replay};
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
//! "#;
//! let recipe = Recipe::parse(text, Format::Toml, &[])?;
//! let replay = replay(&recipe, &Meshes::new(), &NoProgress)?;
//! assert_eq!(replay.deformed.receipt.strokes.len(), 1);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! Nothing here knows of files: meshes come loaded, by the names that the recipe gives them.

mod point_flow;
pub mod recipe;
mod replay;
mod report;
mod scene;
pub mod schema;
pub mod session;
mod stream_report;

pub use point_flow::{PointFlow, PointReplay, replay_points};
pub use recipe::Recipe;
pub use replay::{Replay, ReplayError, replay};
pub use report::{Bounds, Measures, Report, Seconds, Source, StrokeReport};
pub use scene::{BuildToolError, Meshes, Scene, SceneError, build_tool};
pub use stream_report::{StreamReport, StreamSeconds};
