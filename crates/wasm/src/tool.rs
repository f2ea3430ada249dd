//! Tools of sessions.

use std::sync::Arc;

use isochore_mesh::NoProgress;
use isochore_sculpt::{Meshes, recipe, session::SessionTool};
use wasm_bindgen::prelude::*;

use crate::{error::thrown, mesh::Mesh, options::keys};

#[wasm_bindgen(typescript_custom_section)]
const TYPES: &str = r#"
/** Description of a tool, as in a recipe. */
export interface ToolDescription {
  shape: { kind: string; [key: string]: unknown };
  support: number;
  profile?: string;
  [key: string]: unknown;
}
"#;

#[wasm_bindgen]
unsafe extern "C" {
    #[wasm_bindgen(typescript_type = "ToolDescription")]
    pub type ToolDescription;
}

/// A prepared tool. It can be used by any number of strokes and sessions.
#[wasm_bindgen]
#[derive(Debug)]
pub struct Tool {
    pub(crate) tool: Arc<SessionTool>,
}

#[wasm_bindgen]
impl Tool {
    /// Creates a tool from its description in a recipe: `{shape: {kind: "sphere", radius: 0.1},
    /// support: 0.1}`. `name` identifies the tool in the log of a session. `mesh` is the mesh of a
    /// shape of kind `mesh`, whose distance is sampled during this call.
    ///
    /// Throws if the description is invalid.
    #[wasm_bindgen(constructor)]
    pub fn new(name: &str, description: &ToolDescription, mesh: Option<Mesh>) -> Result<Tool, JsError> {
        let description: recipe::Tool = keys(&format!("tools.{name}"), description)?;
        let mut meshes = Meshes::new();
        if let (recipe::ToolShape::Mesh(shape), Some(mesh)) = (&description.shape, mesh) {
            meshes.insert(shape.mesh.clone(), mesh.mesh);
        }
        let tool = SessionTool::new(name, description, &meshes, &NoProgress).map_err(thrown)?;
        Ok(Self { tool: Arc::new(tool) })
    }

    /// Name of the tool in the log of a session.
    #[wasm_bindgen(getter)]
    pub fn name(&self) -> String {
        self.tool.name().to_owned()
    }

    /// Warnings about the description.
    #[wasm_bindgen(getter)]
    pub fn warnings(&self) -> Vec<String> {
        self.tool.warnings().to_vec()
    }
}
