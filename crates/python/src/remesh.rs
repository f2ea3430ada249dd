//! Remeshing.

use isochore_sculpt::{
    RemeshError,
    session::{LockSkipped, RemeshOptions, RemeshReceipt, SessionError},
};
use pyo3::{prelude::*, types::PyDict};

use crate::{
    error::Failure,
    mesh::{Mesh, mesh_of},
    watch::watched,
};

/// Replaces the triangles of a mesh by even ones on the same surface. Returns the mesh and a receipt.
#[pyfunction]
#[pyo3(signature = (mesh, *, edge_length = None, deviation = None, max_triangles = None, progress = None))]
pub(crate) fn remesh<'py>(
    py: Python<'py>,
    mesh: &Bound<'_, PyAny>,
    edge_length: Option<f64>,
    deviation: Option<f64>,
    max_triangles: Option<usize>,
    progress: Option<&Bound<'_, PyAny>>,
) -> Result<(Mesh, Bound<'py, PyDict>), Failure> {
    let (mesh, options) = (mesh_of(mesh)?, options(edge_length, deviation, max_triangles));
    let done = watched(py, progress, |monitor| {
        isochore_sculpt::remesh(mesh, &options, monitor).map_err(|error| match error {
            RemeshError::Mesh(error) => Failure::input(error),
            RemeshError::Options(error) => error.into(),
            RemeshError::Cancelled(cancelled) => cancelled.into(),
        })
    })?;
    let receipt = receipt(py, &done.receipt)?;
    Ok((Mesh { mesh: done.mesh.into() }, receipt))
}

/// Options from keyword arguments.
pub(crate) fn options(
    edge_length: Option<f64>,
    deviation: Option<f64>,
    max_triangles: Option<usize>,
) -> RemeshOptions {
    let default = RemeshOptions::default();
    RemeshOptions { edge_length, deviation, max_triangles: max_triangles.unwrap_or(default.max_triangles) }
}

/// Result of a remesh.
pub(crate) fn receipt<'py>(py: Python<'py>, receipt: &RemeshReceipt) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    dict.set_item("triangles_before", receipt.triangles_before)?;
    dict.set_item("triangles_after", receipt.triangles_after)?;
    dict.set_item("splits", receipt.splits)?;
    dict.set_item("collapses", receipt.collapses)?;
    dict.set_item("flips", receipt.flips)?;
    dict.set_item("is_limited", receipt.is_limited)?;
    dict.set_item("allowance", receipt.allowance)?;
    dict.set_item("unlocked_volume_change", receipt.unlocked_volume_change)?;
    dict.set_item("volume_change", receipt.volume_change)?;
    dict.set_item("lock_max_shift", receipt.lock_max_shift)?;
    dict.set_item("lock_skipped", receipt.lock_skipped.map(LockSkipped::name))?;
    dict.set_item("undo_bytes", receipt.undo_bytes)?;
    dict.set_item("forgotten_strokes", receipt.forgotten_strokes)?;
    dict.set_item("seconds", receipt.seconds)?;
    Ok(dict)
}

impl From<SessionError> for Failure {
    fn from(error: SessionError) -> Self {
        match error {
            SessionError::Cancelled(cancelled) => cancelled.into(),
            SessionError::Remesh(_) => Self::Argument(error.to_string()),
            error => Self::input(error),
        }
    }
}
