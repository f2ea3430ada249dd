//! Tools of sessions.

use std::sync::Arc;

use isochore_mesh::NoProgress;
use isochore_sculpt::{Meshes, recipe, session::SessionTool};
use wasm_bindgen::prelude::*;

use crate::{error::thrown, mesh::Mesh, options::keys};

#[wasm_bindgen(typescript_custom_section)]
const TYPES: &str = r#"
/** What a recipe says of a tool. */
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

/// A tool ready to work, made once and shared between strokes and sessions.
#[wasm_bindgen]
#[derive(Debug)]
pub struct Tool {
    pub(crate) tool: Arc<SessionTool>,
}

#[wasm_bindgen]
impl Tool {
    /// Makes a tool from what a recipe says of one: `{shape: {kind: "sphere", radius: 0.1}, support: 0.1}`. `name` is what the log
    /// calls it; `mesh` is the mesh of a shape of that kind, whose distance is sampled now.
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

    /// What the log calls it.
    #[wasm_bindgen(getter)]
    pub fn name(&self) -> String {
        self.tool.name().to_owned()
    }

    /// What there is to know about how the description was understood.
    #[wasm_bindgen(getter)]
    pub fn warnings(&self) -> Vec<String> {
        self.tool.warnings().to_vec()
    }
}
