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

/// An immutable triangle mesh.
#[wasm_bindgen]
#[derive(Debug)]
pub struct Mesh {
    pub(crate) mesh: Arc<TriMesh>,
}

/// Joints and weights of all vertices, in rows of `perVertex` entries. Copies.
#[wasm_bindgen]
#[derive(Debug)]
pub struct Skin {
    table: SkinTable,
}

#[wasm_bindgen]
impl Mesh {
    /// Copies the arrays. `positions` has x, y, z of each vertex in model units. `triangles` has
    /// three vertex indices per triangle, counter-clockwise as seen from outside.
    ///
    /// Throws if an index is out of range, a coordinate is not finite, or an attribute has the
    /// wrong length.
    #[wasm_bindgen(constructor)]
    pub fn new(positions: &[f64], triangles: &[u32], attributes: Option<MeshAttributes>) -> Result<Mesh, JsError> {
        let attributes = options(attributes, &attributes::KEYS)?;
        let (points, rest) = positions.as_chunks::<3>();
        let (triangles, left) = triangles.as_chunks::<3>();
        if !rest.is_empty() || !left.is_empty() {
            return Err(thrown("the lengths of positions and triangles must be multiples of 3"));
        }
        let mut mesh = TriMesh::new(points.iter().map(|point| DVec3::from(*point)).collect(), triangles.to_vec());
        mesh.check_valid().map_err(thrown)?;
        attributes::set(&mut mesh, &attributes)?;
        Ok(Self { mesh: mesh.into() })
    }

    /// Reads the content of a mesh file. `format` is its extension: obj, glb, ply, stl or off.
    ///
    /// Throws if the format is unknown or the content is invalid.
    #[wasm_bindgen(js_name = fromBytes)]
    pub fn from_bytes(bytes: &[u8], format: &str) -> Result<Mesh, JsError> {
        let mesh = io::read_bytes(parse_format(format)?, bytes).map_err(thrown)?;
        Ok(Self { mesh: mesh.into() })
    }

    /// Returns the content of a mesh file. `format` is its extension: obj, glb, ply, stl or off.
    #[wasm_bindgen(js_name = toBytes)]
    pub fn to_bytes(&self, format: &str) -> Result<Vec<u8>, JsError> {
        let mut bytes = Vec::new();
        io::write_to(parse_format(format)?, &self.mesh, &mut bytes).map_err(thrown)?;
        Ok(bytes)
    }

    /// x, y, z of each vertex, model units. A view of the memory of the module, valid until that
    /// memory grows.
    #[wasm_bindgen(getter)]
    pub fn positions(&self) -> Float64Array {
        // SAFETY: the mesh is immutable. The documentation states when the view becomes invalid.
        unsafe { Float64Array::view(cast_slice(&self.mesh.positions)) }
    }

    /// Three vertex indices of each triangle. A view of the memory of the module, valid until that
    /// memory grows.
    #[wasm_bindgen(getter)]
    pub fn triangles(&self) -> Uint32Array {
        // SAFETY: as above.
        unsafe { Uint32Array::view(self.mesh.triangles.as_flattened()) }
    }

    /// The skin, or undefined if the mesh has none.
    #[wasm_bindgen(getter)]
    pub fn skin(&self) -> Option<Skin> {
        Some(Skin { table: self.mesh.vertex.skin_table() }).filter(|skin| skin.table.per_vertex > 0)
    }

    /// Signed volume, cubic model units. Throws if the mesh is open.
    #[wasm_bindgen(getter)]
    pub fn volume(&self) -> Result<f64, JsError> {
        Ok(ClosedMesh::new(&self.mesh).map_err(thrown)?.volume())
    }
}

#[wasm_bindgen]
impl Skin {
    /// Number of entries per row: the largest number of joints of any vertex.
    #[wasm_bindgen(getter, js_name = perVertex)]
    pub fn per_vertex(&self) -> usize {
        self.table.per_vertex
    }

    /// Joint indices.
    #[wasm_bindgen(getter)]
    pub fn joints(&self) -> Vec<u32> {
        self.table.joints.clone()
    }

    /// Weights. Each row sums to 1, or to 0 for a vertex without joints.
    #[wasm_bindgen(getter)]
    pub fn weights(&self) -> Vec<f64> {
        self.table.weights.clone()
    }
}

fn parse_format(name: &str) -> Result<Format, JsError> {
    Format::of_extension(name)
        .ok_or_else(|| thrown(format!("`{name}` is not a mesh format; use obj, glb, ply, stl or off")))
}
