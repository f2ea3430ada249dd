//! The stroke log, which is the recipe, and its replay on meshes and points.
pub mod recipe;
mod scene;
mod target_mesh;
pub use recipe::Recipe;
