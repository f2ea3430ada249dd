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

/// A mesh that strokes deform one after the other, with undo and redo.
///
/// Arrays that it gives are views of the module's memory. They hold until the next call that changes the session or grows that memory.
#[wasm_bindgen]
#[derive(Debug)]
pub struct Session {
    session: session::Session,
}

/// Rows of the buffers that have changed: pairs of start and end.
#[wasm_bindgen]
#[derive(Debug)]
pub struct Changes {
    changes: session::Changes,
}

#[wasm_bindgen]
impl Session {
    /// Opens a session on a manifold, oriented mesh.
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
            Some(other) => return Err(thrown(format!("normals are by \"area\" or \"angle\", not {other:?}"))),
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

    /// Keeps the edges at some vertices, inserted ones included, from being split, collapsed or flipped from now on, and frees all
    /// others.
    #[wasm_bindgen(js_name = freezeEdges)]
    pub fn freeze_edges(&mut self, vertices: &[u32]) -> Result<(), JsError> {
        self.session.freeze_edges(vertices).map_err(thrown)
    }

    /// Begins a stroke; nothing moves before the second pose.
    #[wasm_bindgen(js_name = beginStroke)]
    pub fn begin_stroke(&mut self, tool: &Tool, options: Option<StrokeOptions>) -> Result<(), JsError> {
        let options = self::options(options, &["refine", "longestEdge", "maxTriangles", "keep"])?;
        let usual = InteractiveRefinement::default();
        let balls = options.keep().unwrap_or_default();
        let (balls, rest) = balls.as_chunks::<4>();
        if !rest.is_empty() {
            return Err(thrown("keep has four numbers for each ball"));
        }
        let refinement = InteractiveRefinement {
            longest: options.longest_edge(),
            max_triangles: count("maxTriangles", options.max_triangles(), usual.max_triangles)?,
            keep: balls.iter().map(|&[x, y, z, radius]| ([x, y, z].into(), radius)).collect(),
            ..usual
        };
        let refine = options.refine().unwrap_or(true).then_some(refinement);
        self.session.begin_stroke(&tool.tool, session::StrokeOptions { refine }).map_err(thrown)
    }

    /// Moves the tool along a screw to a pose: x, y, z, model units, and optionally axis x, y, z and angle in degrees, absolute.
    /// `time` is the host's, in seconds.
    #[wasm_bindgen(js_name = moveTo)]
    pub fn move_to(&mut self, at: &[f64], rotate: Option<Vec<f64>>, time: Option<f64>) -> Result<MoveReceipt, JsError> {
        let receipt = self.session.move_to(&pose(at, rotate)?, time.unwrap_or(0.0)).map_err(thrown)?;
        Ok(MoveReceipt { receipt })
    }

    /// Ends the stroke.
    #[wasm_bindgen(js_name = endStroke)]
    pub fn end_stroke(&mut self) -> Result<StrokeReceipt, JsError> {
        Ok(StrokeReceipt { receipt: self.session.end_stroke().map_err(thrown)? })
    }

    /// Whether a stroke has begun and not ended.
    #[wasm_bindgen(getter, js_name = isStrokeUnderWay)]
    pub fn is_stroke_under_way(&self) -> bool {
        self.session.is_stroke_under_way()
    }

    /// Takes back the stroke under way.
    #[wasm_bindgen(js_name = cancelStroke)]
    pub fn cancel_stroke(&mut self) -> Result<(), JsError> {
        self.session.cancel_stroke().map_err(thrown)
    }

    /// Takes back the last stroke, to the bit; false where there is none.
    pub fn undo(&mut self) -> Result<bool, JsError> {
        self.session.undo().map_err(thrown)
    }

    /// Does again what was undone last, to the bit; false where there is nothing.
    pub fn redo(&mut self) -> Result<bool, JsError> {
        self.session.redo().map_err(thrown)
    }

    /// What can be undone and redone.
    #[wasm_bindgen(getter)]
    pub fn history(&self) -> History {
        History { history: self.session.history() }
    }

    /// x, y, z of each render vertex, model units.
    #[wasm_bindgen(getter)]
    pub fn positions(&self) -> Float32Array {
        floats(self.session.buffers().positions.as_flattened())
    }

    /// Unit normals of the render vertices.
    #[wasm_bindgen(getter)]
    pub fn normals(&self) -> Float32Array {
        floats(self.session.buffers().normals.as_flattened())
    }

    /// u, v of each render vertex in a set of texture coordinates, the first unless said otherwise; empty where there is no such set.
    pub fn uvs(&self, set: Option<u32>) -> Float32Array {
        floats(self.session.buffers().uvs.get(set.unwrap_or(0) as usize).map_or(&[], |uvs| uvs.as_flattened()))
    }

    /// Linear red, green, blue, alpha of each render vertex; empty where the mesh has none.
    #[wasm_bindgen(getter)]
    pub fn colors(&self) -> Float32Array {
        floats(self.session.buffers().colors.as_flattened())
    }

    /// Three render vertices of each triangle; those removed are three times zero.
    #[wasm_bindgen(getter)]
    pub fn indices(&self) -> Uint32Array {
        // SAFETY: as for floats.
        unsafe { Uint32Array::view(self.session.buffers().indices.as_flattened()) }
    }

    /// What has changed in the buffers since the last call: at first, everything.
    #[wasm_bindgen(js_name = takeChanges)]
    pub fn take_changes(&mut self) -> Changes {
        Changes { changes: self.session.take_changes() }
    }

    /// All strokes that are done and not undone, as the JSON text of a recipe.
    pub fn log(&self) -> String {
        self.session.log().to_json()
    }

    /// The surface as a mesh of its own, as `positions` show it: with what the lock has added at the end of each stroke. With `lock`
    /// false, where the flow alone has taken it, to the bits that the log gives elsewhere.
    pub fn export(&self, lock: Option<bool>) -> Mesh {
        Mesh { mesh: self.session.export(lock.unwrap_or(true)).mesh.into() }
    }

    /// Number in the session of each vertex of what `export` gives now, in ascending order: those that were not removed.
    #[wasm_bindgen(getter, js_name = exportedVertices)]
    pub fn exported_vertices(&self) -> Vec<u32> {
        self.session.vertices().collect()
    }

    /// For each vertex of the mesh as opened the vertex that stands in its place: itself, or the one that collapses have merged it
    /// into.
    #[wasm_bindgen(js_name = vertexMap)]
    pub fn vertex_map(&self) -> Vec<u32> {
        self.session.vertex_map()
    }
}

#[wasm_bindgen]
impl Changes {
    /// Grows whenever a buffer has moved in memory.
    #[wasm_bindgen(getter)]
    pub fn generation(&self) -> f64 {
        self.changes.generation as f64
    }

    /// Of positions.
    #[wasm_bindgen(getter)]
    pub fn positions(&self) -> Vec<u32> {
        pairs(&self.changes.positions)
    }

    /// Of normals.
    #[wasm_bindgen(getter)]
    pub fn normals(&self) -> Vec<u32> {
        pairs(&self.changes.normals)
    }

    /// Of texture coordinates, colors and origins.
    #[wasm_bindgen(getter)]
    pub fn attributes(&self) -> Vec<u32> {
        pairs(&self.changes.attributes)
    }

    /// Of indices, in triangles.
    #[wasm_bindgen(getter)]
    pub fn indices(&self) -> Vec<u32> {
        pairs(&self.changes.indices)
    }
}

fn floats(values: &[f32]) -> Float32Array {
    // SAFETY: nothing is allocated before JavaScript has the view; what happens to it later is said where views are given.
    unsafe { Float32Array::view(values) }
}

fn pairs(ranges: &[DirtyRange]) -> Vec<u32> {
    ranges.iter().flat_map(|range| [range.start, range.end]).collect()
}

/// A pose from x, y, z and an axis x, y, z with an angle in degrees; without these, not turned.
fn pose(at: &[f64], rotate: Option<Vec<f64>>) -> Result<Pose, JsError> {
    let rotate = rotate.as_deref().unwrap_or(&[0.0, 0.0, 1.0, 0.0]);
    Key { at: numbers(at)?, rotate: numbers(rotate)? }.pose().map_err(thrown)
}
