//! Results of a session as Python dictionaries.

use isochore_sculpt::session::{Changes, DirtyRange, History, Hit, LockSkipped, MoveReceipt, StrokeReceipt};
use pyo3::{
    prelude::*,
    types::{IntoPyDict, PyDict},
};

/// Result of one move.
pub(super) fn move_receipt<'py>(py: Python<'py>, receipt: &MoveReceipt) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    dict.set_item("moved_vertices", receipt.moved_vertices)?;
    dict.set_item("inserted_vertices", receipt.inserted_vertices)?;
    dict.set_item("is_limited", receipt.is_limited)?;
    dict.set_item("refused_splits", receipt.refused_splits)?;
    dict.set_item("is_stopped", receipt.is_stopped)?;
    dict.set_item("seconds", receipt.seconds.total())?;
    Ok(dict)
}

/// Result of one stroke.
pub(super) fn stroke_receipt<'py>(py: Python<'py>, receipt: &StrokeReceipt) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    dict.set_item("moves", receipt.moves)?;
    dict.set_item("touched_vertices", receipt.touched_vertices)?;
    dict.set_item("inserted_vertices", receipt.inserted_vertices)?;
    dict.set_item("removed_vertices", receipt.removed_vertices)?;
    dict.set_item("flipped_edges", receipt.flipped_edges)?;
    dict.set_item("is_limited", receipt.is_limited)?;
    dict.set_item("refused_splits", receipt.refused_splits)?;
    let volume = receipt.volume.map(|volume| {
        let parts = [
            ("flow", volume.flow),
            ("splits", volume.splits),
            ("remeshing", volume.remeshing),
            ("rounding", volume.rounding),
        ];
        parts.into_py_dict(py)
    });
    dict.set_item("volume", volume.transpose()?)?;
    dict.set_item("lock_max_shift", receipt.lock_max_shift)?;
    dict.set_item("lock_skipped", receipt.lock_skipped.map(LockSkipped::name))?;
    dict.set_item("stopped_at", receipt.stopped_at)?;
    let sheets = receipt.sheets.map(|sheets| {
        let dict = PyDict::new(py);
        dict.set_item("gap", sheets.gap)?;
        dict.set_item("at", sheets.at.to_array())?;
        PyResult::Ok(dict)
    });
    dict.set_item("sheets", sheets.transpose()?)?;
    dict.set_item("crossings", receipt.crossings)?;
    dict.set_item("undo_bytes", receipt.undo_bytes)?;
    dict.set_item("forgotten_strokes", receipt.forgotten_strokes)?;
    dict.set_item("certificate_seconds", receipt.certificate_seconds)?;
    dict.set_item("seconds", receipt.seconds.total())?;
    Ok(dict)
}

/// Changed rows of each buffer.
pub(super) fn changes(py: Python<'_>, changes: Changes) -> PyResult<Bound<'_, PyDict>> {
    let ranges = |ranges: Vec<DirtyRange>| -> Vec<(u32, u32)> {
        ranges.into_iter().map(|range| (range.start, range.end)).collect()
    };
    let dict = PyDict::new(py);
    dict.set_item("generation", changes.generation)?;
    dict.set_item("positions", ranges(changes.positions))?;
    dict.set_item("normals", ranges(changes.normals))?;
    dict.set_item("attributes", ranges(changes.attributes))?;
    dict.set_item("triangles", ranges(changes.indices))?;
    Ok(dict)
}

/// Size of the undo history.
pub(super) fn history<'py>(py: Python<'py>, history: &History) -> PyResult<Bound<'py, PyDict>> {
    [
        ("undoable", history.undoable),
        ("redoable", history.redoable),
        ("forgotten", history.forgotten),
        ("bytes", history.bytes),
    ]
    .into_py_dict(py)
}

/// A point of the surface.
pub(super) fn hit<'py>(py: Python<'py>, hit: &Hit) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    dict.set_item("triangle", hit.triangle)?;
    dict.set_item("vertices", hit.vertices)?;
    dict.set_item("point", hit.point.to_array())?;
    dict.set_item("weights", hit.weights.to_array())?;
    dict.set_item("normal", hit.normal.to_array())?;
    dict.set_item("distance", hit.distance)?;
    Ok(dict)
}
