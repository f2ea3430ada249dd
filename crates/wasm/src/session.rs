//! Sculpting sessions.

use std::sync::Arc;

use glam::DVec3;
use isochore_mesh::Silent;
use isochore_sculpt::{
    Meshes,
    recipe::{self, Key},
    session::{self, DirtyRange, Hit as SurfaceHit, InteractiveRefinement, SessionOptions, SessionTool, StrokeOptions},
};
use js_sys::{Float32Array, Uint32Array};
use wasm_bindgen::prelude::*;

use crate::{error::thrown, mesh::Mesh};

/// A tool ready to work, made once and shared between strokes and sessions.
#[wasm_bindgen]
#[derive(Debug)]
pub struct Tool {
    tool: Arc<SessionTool>,
}

#[wasm_bindgen]
impl Tool {
    /// Makes a tool from what a recipe says of one, in JSON. `name` is what the log calls it; `mesh` is the mesh of a shape of that
    /// kind, whose distance is sampled now.
    #[wasm_bindgen(constructor)]
    pub fn new(name: &str, description: &str, mesh: Option<Mesh>) -> Result<Tool, JsError> {
        let description: recipe::Tool = serde_json::from_str(description).map_err(thrown)?;
        let mut meshes = Meshes::new();
        if let (recipe::ToolShape::Mesh(shape), Some(mesh)) = (&description.shape, mesh) {
            meshes.insert(shape.mesh.clone(), mesh.mesh);
        }
        let tool = SessionTool::new(name, description, &meshes, &Silent).map_err(thrown)?;
        Ok(Self { tool: Arc::new(tool) })
    }
}

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

/// A point of the surface that a query found.
#[wasm_bindgen]
#[derive(Debug)]
pub struct Hit {
    hit: SurfaceHit,
}

#[wasm_bindgen]
impl Session {
    /// Opens a session on a manifold, oriented mesh. `weights` holds its vertices, by a number for each from 0, free, to 1, held, a
    /// `Float64Array` or a `Float32Array`; `mask` is what else a recipe says under that key, in JSON:
    /// `{"pins": […], "mirror": […], "fade": 0.1}`.
    #[wasm_bindgen(constructor)]
    pub fn new(mesh: &Mesh, weights: Option<Vec<f64>>, mask: Option<String>) -> Result<Session, JsError> {
        let mut options = SessionOptions::default();
        if let Some(mask) = mask {
            options.mask = serde_json::from_str(&mask).map_err(|error| thrown(format!("mask: {error}")))?;
        }
        if let Some(weights) = weights {
            options.mask.vertices = Some(recipe::VertexWeights::Values(weights));
        }
        let session = session::Session::open(Arc::clone(&mesh.mesh), options).map_err(thrown)?;
        Ok(Self { session })
    }

    /// Keeps the edges at some vertices of the mesh as opened from being split, collapsed or flipped from now on, and frees all
    /// others.
    #[wasm_bindgen(js_name = freezeEdges)]
    pub fn freeze_edges(&mut self, vertices: &[u32]) -> Result<(), JsError> {
        let opened = self.session.opened().positions.len();
        if let Some(beyond) = vertices.iter().find(|vertex| **vertex as usize >= opened) {
            return Err(thrown(format!("{beyond} is none of the {opened} vertices of the mesh as opened")));
        }
        self.session.freeze_edges(vertices);
        Ok(())
    }

    /// Begins a stroke; nothing moves before the second pose. `refine` lets edges in the tool's reach be split, those longer than
    /// `longest_edge` where it is given (model units), up to `max_triangles`, and collapsed and flipped.
    #[wasm_bindgen(js_name = beginStroke)]
    pub fn begin_stroke(
        &mut self,
        tool: &Tool,
        refine: bool,
        longest_edge: Option<f64>,
        max_triangles: Option<u32>,
    ) -> Result<(), JsError> {
        let usual = InteractiveRefinement::default();
        let refinement = InteractiveRefinement {
            longest: longest_edge,
            max_triangles: max_triangles.map_or(usual.max_triangles, |most| most as usize),
            ..usual
        };
        let options = StrokeOptions { refine: refine.then_some(refinement) };
        self.session.begin_stroke(&tool.tool, options).map_err(thrown)
    }

    /// Moves the tool along a screw to a pose: x, y, z, model units, and optionally axis x, y, z and angle in degrees, absolute.
    /// `time` is the host's, in seconds. Returns how many vertices moved.
    #[wasm_bindgen(js_name = moveTo)]
    pub fn move_to(&mut self, at: &[f64], rotate: Option<Vec<f64>>, time: f64) -> Result<u32, JsError> {
        let rotate = rotate.as_deref().unwrap_or(&[0.0, 0.0, 1.0, 0.0]);
        let key = Key { at: numbers(at)?, rotate: numbers(rotate)? };
        Ok(self.session.move_to(&key.pose(), time).map_err(thrown)?.moved_vertices as u32)
    }

    /// Ends the stroke. Returns the change of volume by it, cubic model units; undefined where the surface is open.
    #[wasm_bindgen(js_name = endStroke)]
    pub fn end_stroke(&mut self) -> Result<Option<f64>, JsError> {
        Ok(self.session.end_stroke().map_err(thrown)?.volume.map(|volume| volume.total()))
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

    /// u, v of each render vertex, the first set; empty where the mesh has none.
    #[wasm_bindgen(getter)]
    pub fn uvs(&self) -> Float32Array {
        floats(self.session.buffers().uvs.first().map_or(&[], |uvs| uvs.as_flattened()))
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

    /// The first point of the surface on a ray.
    pub fn pick(&self, origin: &[f64], direction: &[f64]) -> Result<Option<Hit>, JsError> {
        let [origin, direction] = [DVec3::from(numbers(origin)?), DVec3::from(numbers(direction)?)];
        Ok(self.session.pick(origin, direction).map(|hit| Hit { hit }))
    }

    /// Volume inside the surface without the stroke under way; undefined where it is open.
    #[wasm_bindgen(getter)]
    pub fn volume(&self) -> Option<f64> {
        self.session.volume()
    }

    /// All strokes that are done and not undone, as the JSON text of a recipe.
    pub fn log(&self) -> String {
        self.session.log().to_json()
    }

    /// The surface as a mesh of its own; `lock` gives back the volume of the mesh as opened.
    pub fn export(&self, lock: bool) -> Mesh {
        Mesh { mesh: self.session.export(lock).mesh.into() }
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

    /// Of texture coordinates and colors.
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

#[wasm_bindgen]
impl Hit {
    /// x, y, z, model units.
    #[wasm_bindgen(getter)]
    pub fn point(&self) -> Vec<f64> {
        self.hit.point.to_array().to_vec()
    }

    /// Unit normal of the triangle.
    #[wasm_bindgen(getter)]
    pub fn normal(&self) -> Vec<f64> {
        self.hit.normal.to_array().to_vec()
    }

    /// Distance from where the ray begins.
    #[wasm_bindgen(getter)]
    pub fn distance(&self) -> f64 {
        self.hit.distance
    }
}

fn floats(values: &[f32]) -> Float32Array {
    // SAFETY: nothing is allocated before JavaScript has the view; what happens to it later is said where views are given.
    unsafe { Float32Array::view(values) }
}

fn pairs(ranges: &[DirtyRange]) -> Vec<u32> {
    ranges.iter().flat_map(|range| [range.start, range.end]).collect()
}

fn numbers<const N: usize>(values: &[f64]) -> Result<[f64; N], JsError> {
    values.try_into().map_err(|_| thrown(format!("{N} numbers are wanted, not {}", values.len())))
}
