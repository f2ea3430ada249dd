//! Options of sessions and strokes.

use std::ffi::c_char;

use isochore_sculpt::recipe::{Mask, VertexWeights};

use crate::{
    error::{Failure, Status},
    memory::{array, text},
};

/// Options of a session. Zero and NULL select the defaults.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct SessionOptions {
    /// Time step, given as the distance that the fastest point of the tool surface travels in one
    /// step. It is a fraction, at most 1, of the support or of half the shortest extent of the
    /// tool, whichever is smaller.
    pub step: f64,
    /// Memory budget of undo and redo, in bytes.
    pub undo_bytes: usize,
    /// Mask weight of each vertex, from 0 (free) to 1 (masked). Vertices of weight 1 keep their
    /// exact positions.
    pub weights: *const f64,
    /// Number of weights.
    pub weight_count: usize,
    /// Weights triangles in vertex normals by angle instead of by area.
    pub angle_normals: bool,
    /// Disables the volume lock, the small displacement at the end of each stroke that restores the
    /// exact volume.
    pub unlocked: bool,
    /// Other keys of the `mask` table of a recipe, as JSON:
    /// `{"pins": [...], "mirror": [...], "fade": 0.1}`.
    pub mask: *const c_char,
}

/// Options of a stroke. Zero and NULL select the defaults.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct StrokeOptions {
    /// Disables refinement. Otherwise edges in reach of the tool are split, some of them are
    /// collapsed or flipped, and crossings of the surface with itself are prevented.
    pub keep_triangles: bool,
    /// Edges longer than this are split, model units.
    pub longest_edge: f64,
    /// Splits stop at this number of triangles.
    pub max_triangles: usize,
    /// Balls in which triangles are not refined: x, y, z and radius of each, model units.
    pub keep: *const f64,
    /// Number of balls.
    pub keep_count: usize,
    /// Edges are split where the curved surface deviates from them by more than this, model units.
    pub deviation: f64,
}
/// Combines the weights and the JSON of the options into one mask.
///
/// # Safety
/// `options.mask` is NULL or a string; `options.weights` has `weight_count` values.
pub(super) unsafe fn mask(options: &SessionOptions) -> Result<Mask, Failure> {
    let mut mask = Mask::default();
    if !options.mask.is_null() {
        // SAFETY: the caller guarantees it.
        let json = unsafe { text("options.mask", options.mask) }?;
        mask = serde_json::from_str(json).map_err(|error| Failure::new(Status::Recipe, format!("mask: {error}")))?;
    }
    if !options.weights.is_null() {
        // SAFETY: the caller guarantees it.
        let weights = unsafe { array("options.weights", options.weights, options.weight_count) }?;
        mask.vertices = Some(VertexWeights::Values(weights.to_vec()));
    }
    Ok(mask)
}
