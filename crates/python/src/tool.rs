//! Tools of sessions.

use std::sync::Arc;

use isochore_sculpt::{Meshes, recipe, session::SessionTool};
use pyo3::prelude::*;

use crate::{error::Failure, keys::keys, mesh::mesh_of, watch::watched};

/// A prepared tool. It can be used by any number of strokes and sessions.
#[pyclass(frozen, module = "isochore")]
#[derive(Debug)]
pub(crate) struct Tool {
    pub(crate) tool: Arc<SessionTool>,
}

#[pymethods]
impl Tool {
    #[new]
    #[pyo3(signature = (description, *, name = "tool", mesh = None, progress = None))]
    fn new(
        py: Python<'_>,
        description: &Bound<'_, PyAny>,
        name: &str,
        mesh: Option<&Bound<'_, PyAny>>,
        progress: Option<&Bound<'_, PyAny>>,
    ) -> Result<Self, Failure> {
        let description: recipe::Tool = keys(&format!("tools.{name}"), description)?;
        let mut meshes = Meshes::new();
        if let (recipe::ToolShape::Mesh(shape), Some(mesh)) = (&description.shape, mesh) {
            meshes.insert(shape.mesh.clone(), mesh_of(mesh)?);
        }
        let tool = watched(py, progress, |monitor| Ok(SessionTool::new(name, description, &meshes, monitor)?))?;
        Ok(Self { tool: Arc::new(tool) })
    }

    #[getter]
    fn name(&self) -> &str {
        self.tool.name()
    }

    #[getter]
    fn warnings(&self) -> Vec<String> {
        self.tool.warnings().to_vec()
    }

    fn __repr__(&self) -> String {
        format!("Tool({:?}, support {})", self.tool.name(), self.tool.tool().support())
    }
}
