//! Triangle meshes.

mod attributes;

use std::sync::Arc;

use bytemuck::cast_slice;
use glam::DVec3;
use isochore_mesh::{
    ClosedMesh, SkinTable, TriMesh,
    io::{self, Format},
};
use js_sys::{Float64Array, Uint32Array};
use wasm_bindgen::prelude::*;

use crate::{
    error::thrown,
    options::{MeshAttributes, options},
};

/// A triangle mesh, which does not change.
#[wasm_bindgen]
#[derive(Debug)]
pub struct Mesh {
    pub(crate) mesh: Arc<TriMesh>,
}

/// The joints that move each vertex, and their weights: as many for each, row by row. Copies, which stay.
#[wasm_bindgen]
#[derive(Debug)]
pub struct Skin {
    table: SkinTable,
}

#[wasm_bindgen]
impl Mesh {
    /// Copies a mesh out of arrays: x, y, z of each vertex, model units, and three vertex indices of each triangle, counter-clockwise
    /// seen from outside.
    #[wasm_bindgen(constructor)]
    pub fn new(positions: &[f64], triangles: &[u32], attributes: Option<MeshAttributes>) -> Result<Mesh, JsError> {
        let given = options(attributes, &attributes::KEYS)?;
        let (points, rest) = positions.as_chunks::<3>();
        let (triangles, left) = triangles.as_chunks::<3>();
        if !rest.is_empty() || !left.is_empty() {
            return Err(thrown("positions and triangles have three numbers each"));
        }
        let mut mesh = TriMesh::new(points.iter().map(|point| DVec3::from(*point)).collect(), triangles.to_vec());
        mesh.check_valid().map_err(thrown)?;
        attributes::set(&mut mesh, &given)?;
        Ok(Self { mesh: mesh.into() })
    }

    /// Reads the bytes of a mesh file; `format` is its extension: obj, glb, ply, stl, off.
    #[wasm_bindgen(js_name = fromBytes)]
    pub fn from_bytes(bytes: &[u8], format: &str) -> Result<Mesh, JsError> {
        let mesh = io::read_bytes(parse_format(format)?, bytes).map_err(thrown)?;
        Ok(Self { mesh: mesh.into() })
    }

    /// The bytes of a mesh file; `format` is its extension.
    #[wasm_bindgen(js_name = toBytes)]
    pub fn to_bytes(&self, format: &str) -> Result<Vec<u8>, JsError> {
        let mut bytes = Vec::new();
        io::write_to(parse_format(format)?, &self.mesh, &mut bytes).map_err(thrown)?;
        Ok(bytes)
    }

    /// x, y, z of each vertex, model units: a view of the module's memory, until that grows.
    #[wasm_bindgen(getter)]
    pub fn positions(&self) -> Float64Array {
        // SAFETY: the mesh does not change; that a view dies when memory grows is JavaScript's own affair, and said above.
        unsafe { Float64Array::view(cast_slice(&self.mesh.positions)) }
    }

    /// Three vertex indices of each triangle: a view of the module's memory, until that grows.
    #[wasm_bindgen(getter)]
    pub fn triangles(&self) -> Uint32Array {
        // SAFETY: as above.
        unsafe { Uint32Array::view(self.mesh.triangles.as_flattened()) }
    }

    /// The skin; undefined where the mesh has none.
    #[wasm_bindgen(getter)]
    pub fn skin(&self) -> Option<Skin> {
        Some(Skin { table: self.mesh.vertex.skin_table() }).filter(|skin| skin.table.per_vertex > 0)
    }

    /// Signed volume, cubic model units; an open mesh is an error.
    #[wasm_bindgen(getter)]
    pub fn volume(&self) -> Result<f64, JsError> {
        Ok(ClosedMesh::new(&self.mesh).map_err(thrown)?.volume())
    }
}

#[wasm_bindgen]
impl Skin {
    /// Joints in each row: the most that move any vertex.
    #[wasm_bindgen(getter, js_name = perVertex)]
    pub fn per_vertex(&self) -> usize {
        self.table.per_vertex
    }

    /// The joints.
    #[wasm_bindgen(getter)]
    pub fn joints(&self) -> Vec<u32> {
        self.table.joints.clone()
    }

    /// Their weights; those of a row sum to one, or to zero where no joint moves the vertex.
    #[wasm_bindgen(getter)]
    pub fn weights(&self) -> Vec<f64> {
        self.table.weights.clone()
    }
}

fn parse_format(name: &str) -> Result<Format, JsError> {
    Format::of_extension(name).ok_or_else(|| thrown(format!("`{name}` is no format of meshes")))
}
