//! Tools by name, as the log of a session tells of them.

use std::sync::Arc;

use isochore_field as field;
use isochore_mesh::Monitor;

use crate::{
    recipe,
    scene::{BuildToolError, Meshes, build_tool},
};

/// A tool ready to work, with the plain data that the log writes down. Made once and shared between strokes and sessions.
#[derive(Debug, Clone)]
pub struct SessionTool {
    name: String,
    description: recipe::Tool,
    tool: Arc<field::Tool>,
    warnings: Vec<String>,
}

impl SessionTool {
    /// Makes the tool that a recipe describes, whose mesh is one of `meshes`. For a mesh, its distance is sampled on a grid,
    /// which takes from milliseconds to seconds.
    ///
    /// # Errors
    /// [`BuildToolError`], with the key as in a recipe that calls the tool `name`.
    pub fn new(
        name: &str,
        description: recipe::Tool,
        meshes: &Meshes,
        monitor: &dyn Monitor,
    ) -> Result<Self, BuildToolError> {
        let (tool, warnings) = build_tool(name, &description, meshes, monitor)?;
        Ok(Self { name: name.to_owned(), description, tool: Arc::new(tool), warnings })
    }

    /// Its name in the log.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// What it was made from.
    pub fn description(&self) -> &recipe::Tool {
        &self.description
    }

    /// The tool itself.
    pub fn tool(&self) -> &Arc<field::Tool> {
        &self.tool
    }

    /// What the user should know about how the description was understood.
    pub fn warnings(&self) -> &[String] {
        &self.warnings
    }
}
