//! Sculpting sessions.

mod query;
mod receipt;

use std::sync::Arc;

use isochore_field::Pose;
use isochore_sculpt::{
    recipe::{Key, VertexWeights},
    session::{self, DirtyRange, InteractiveRefinement, NormalWeights},
};
use js_sys::{Float32Array, Uint32Array};
use wasm_bindgen::prelude::*;

use receipt::{History, MoveReceipt, StrokeReceipt};

use crate::{
    error::thrown,
    mesh::Mesh,
    options::{SessionOptions, StrokeOptions, count, keys, numbers, options},
    tool::Tool,
};

/// A mesh that strokes deform one after another, with undo and redo.
///
/// Arrays are views of the memory of the module. They are valid until the next call that changes
/// the session or grows that memory.
#[wasm_bindgen]
#[derive(Debug)]
pub struct Session {
    session: session::Session,
}

/// Changed rows of the buffers, as pairs of the first row and one past the last row.
#[wasm_bindgen]
#[derive(Debug)]
pub struct Changes {
    changes: session::Changes,
}

#[wasm_bindgen]
impl Session {
    /// Opens a session on a manifold, consistently oriented mesh. Throws if the mesh or an option
    /// cannot be used.
    #[wasm_bindgen(constructor)]
    pub fn new(mesh: &Mesh, options: Option<SessionOptions>) -> Result<Session, JsError> {
        let known = ["step", "undoBytes", "normals", "lock", "weights", "mask"];
        let options = self::options(options, &known)?;
        let mut chosen = session::SessionOptions::default();
        chosen.step = options.step().unwrap_or(chosen.step);
        chosen.undo_bytes = count("undoBytes", options.undo_bytes(), chosen.undo_bytes)?;
        chosen.lock = options.lock().unwrap_or(chosen.lock);
        chosen.normals = match options.normals().as_deref() {
            None | Some("area") => NormalWeights::Area,
            Some("angle") => NormalWeights::Angle,
            Some(other) => return Err(thrown(format!("normals must be \"area\" or \"angle\", not {other:?}"))),
        };
        if let Some(mask) = options.mask() {
            chosen.mask = keys("mask", &mask)?;
        }
        if let Some(weights) = options.weights() {
            chosen.mask.vertices = Some(VertexWeights::Values(weights));
        }
        let session = session::Session::open(Arc::clone(&mesh.mesh), chosen).map_err(thrown)?;
        Ok(Self { session })
    }

    /// Excludes the edges at the given vertices from splits, collapses and flips. The vertices
    /// replace those of the previous call and may include inserted ones. Throws if one is out of
    /// range.
    #[wasm_bindgen(js_name = freezeEdges)]
    pub fn freeze_edges(&mut self, vertices: &[u32]) -> Result<(), JsError> {
        self.session.freeze_edges(vertices).map_err(thrown)
    }

    /// Begins a stroke. The first pose only places the tool; later ones move it. Throws if a stroke
    /// is in progress.
    #[wasm_bindgen(js_name = beginStroke)]
    pub fn begin_stroke(&mut self, tool: &Tool, options: Option<StrokeOptions>) -> Result<(), JsError> {
        let options = self::options(options, &["refine", "longestEdge", "deviation", "maxTriangles", "keep"])?;
        let default = InteractiveRefinement::default();
        let balls = options.keep().unwrap_or_default();
        let (balls, rest) = balls.as_chunks::<4>();
        if !rest.is_empty() {
            return Err(thrown("the length of keep must be a multiple of 4: x, y, z and radius of each ball"));
        }
        let refinement = InteractiveRefinement {
            longest: options.longest_edge(),
            deviation: options.deviation(),
            max_triangles: count("maxTriangles", options.max_triangles(), default.max_triangles)?,
            keep: balls.iter().map(|&[x, y, z, radius]| ([x, y, z].into(), radius)).collect(),
            ..default
        };
        let refine = options.refine().unwrap_or(true).then_some(refinement);
        self.session.begin_stroke(&tool.tool, session::StrokeOptions { refine }).map_err(thrown)
    }

    /// Moves the tool to a pose along a screw motion. `at` is x, y, z in model units. `rotate` is
    /// the axis x, y, z and the angle in degrees, relative to the unrotated tool. `time` is the
    /// time of the host in seconds and affects only the receipt.
    ///
    /// Throws if no stroke is in progress, a number is not finite, the axis is zero, or `time`
    /// decreases.
    #[wasm_bindgen(js_name = moveTo)]
    pub fn move_to(&mut self, at: &[f64], rotate: Option<Vec<f64>>, time: Option<f64>) -> Result<MoveReceipt, JsError> {
        let receipt = self.session.move_to_key(&key(at, rotate)?, time.unwrap_or(0.0)).map_err(thrown)?;
        Ok(MoveReceipt { receipt })
    }

    /// Ends the stroke in progress and applies the volume lock.
    #[wasm_bindgen(js_name = endStroke)]
    pub fn end_stroke(&mut self) -> Result<StrokeReceipt, JsError> {
        Ok(StrokeReceipt { receipt: self.session.end_stroke().map_err(thrown)? })
    }

    /// Whether a stroke is in progress.
    #[wasm_bindgen(getter, js_name = isStrokeUnderWay)]
    pub fn is_stroke_under_way(&self) -> bool {
        self.session.is_stroke_under_way()
    }

    /// Discards the stroke in progress.
    #[wasm_bindgen(js_name = cancelStroke)]
    pub fn cancel_stroke(&mut self) -> Result<(), JsError> {
        self.session.cancel_stroke().map_err(thrown)
    }

    /// Undoes the last stroke, bit for bit. Returns false without a stroke to undo.
    pub fn undo(&mut self) -> Result<bool, JsError> {
        self.session.undo().map_err(thrown)
    }

    /// Redoes the last undone stroke, bit for bit. Returns false without a stroke to redo.
    pub fn redo(&mut self) -> Result<bool, JsError> {
        self.session.redo().map_err(thrown)
    }

    /// Size of the undo history.
    #[wasm_bindgen(getter)]
    pub fn history(&self) -> History {
        History { history: self.session.history() }
    }

    /// x, y, z of each render vertex, model units.
    #[wasm_bindgen(getter)]
    pub fn positions(&self) -> Float32Array {
        floats(self.session.buffers().positions.as_flattened())
    }

    /// Unit normal of each render vertex.
    #[wasm_bindgen(getter)]
    pub fn normals(&self) -> Float32Array {
        floats(self.session.buffers().normals.as_flattened())
    }

    /// u, v of each render vertex in a set of texture coordinates, by default the first. Empty if
    /// the set does not exist.
    pub fn uvs(&self, set: Option<u32>) -> Float32Array {
        floats(self.session.buffers().uvs.get(set.unwrap_or(0) as usize).map_or(&[], |uvs| uvs.as_flattened()))
    }

    /// Linear red, green, blue and alpha of each render vertex. Empty if the mesh has no colors.
    #[wasm_bindgen(getter)]
    pub fn colors(&self) -> Float32Array {
        floats(self.session.buffers().colors.as_flattened())
    }

    /// Three render vertices of each triangle, or three zeros for a removed triangle.
    #[wasm_bindgen(getter)]
    pub fn indices(&self) -> Uint32Array {
        // SAFETY: as for floats.
        unsafe { Uint32Array::view(self.session.buffers().indices.as_flattened()) }
    }

    /// Returns the buffer rows that have changed since the previous call. The first call returns
    /// everything.
    #[wasm_bindgen(js_name = takeChanges)]
    pub fn take_changes(&mut self) -> Changes {
        Changes { changes: self.session.take_changes() }
    }

    /// Returns the strokes that are in effect as a recipe in JSON, which names its target `target`.
    pub fn log(&self) -> String {
        self.session.log().to_json()
    }

    /// Copies the surface to a mesh. If `lock` is true (the default), positions include the
    /// displacements of the volume lock, as the buffers do. Otherwise they are those of the flow
    /// alone, which a replay of the log reproduces bit for bit.
    pub fn export(&self, lock: Option<bool>) -> Mesh {
        Mesh { mesh: self.session.export(lock.unwrap_or(true)).mesh.into() }
    }

    /// Session vertex of each vertex of an exported mesh, in ascending order.
    #[wasm_bindgen(getter, js_name = exportedVertices)]
    pub fn exported_vertices(&self) -> Vec<u32> {
        self.session.vertices().collect()
    }

    /// Returns, for each vertex of the opened mesh, the vertex that represents it: the vertex
    /// itself, or the one that collapses have merged it into.
    #[wasm_bindgen(js_name = vertexMap)]
    pub fn vertex_map(&self) -> Vec<u32> {
        self.session.vertex_map()
    }
}

#[wasm_bindgen]
impl Changes {
    /// Increases whenever a buffer has moved in memory.
    #[wasm_bindgen(getter)]
    pub fn generation(&self) -> f64 {
        self.changes.generation as f64
    }

    /// Rows of `positions`.
    #[wasm_bindgen(getter)]
    pub fn positions(&self) -> Vec<u32> {
        pairs(&self.changes.positions)
    }

    /// Rows of `normals`.
    #[wasm_bindgen(getter)]
    pub fn normals(&self) -> Vec<u32> {
        pairs(&self.changes.normals)
    }

    /// Rows of texture coordinates, colors and origins.
    #[wasm_bindgen(getter)]
    pub fn attributes(&self) -> Vec<u32> {
        pairs(&self.changes.attributes)
    }

    /// Rows of `indices`, one per triangle.
    #[wasm_bindgen(getter)]
    pub fn indices(&self) -> Vec<u32> {
        pairs(&self.changes.indices)
    }
}

fn floats(values: &[f32]) -> Float32Array {
    // SAFETY: nothing is allocated before JavaScript receives the view. The documentation states when it becomes invalid.
    unsafe { Float32Array::view(values) }
}

fn pairs(ranges: &[DirtyRange]) -> Vec<u32> {
    ranges.iter().flat_map(|range| [range.start, range.end]).collect()
}

/// Converts a position and an optional rotation, axis and angle in degrees, to a pose.
fn pose(at: &[f64], rotate: Option<Vec<f64>>) -> Result<Pose, JsError> {
    key(at, rotate)?.pose().map_err(thrown)
}

/// The same, as the log records it.
fn key(at: &[f64], rotate: Option<Vec<f64>>) -> Result<Key, JsError> {
    let rotate = rotate.as_deref().unwrap_or(&[0.0, 0.0, 1.0, 0.0]);
    Ok(Key { at: numbers(at)?, rotate: numbers(rotate)? })
}
