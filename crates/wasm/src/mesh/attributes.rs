//! Attributes of corners, vertices and triangles. Input arrays are copied; getters return views of
//! the memory of the mesh.

use bytemuck::{Pod, cast_slice};
use glam::{DVec3, Vec2};
use isochore_mesh::TriMesh;
use js_sys::{Float32Array, Float64Array, Uint32Array};
use wasm_bindgen::prelude::*;

use super::Mesh;
use crate::{error::thrown, options::MeshAttributes};

/// Keys of [`MeshAttributes`].
pub(super) const KEYS: [&str; 8] =
    ["uvs", "normals", "colors", "cornerColors", "materials", "triangleMaterials", "joints", "weights"];

/// Sets the attributes of a mesh.
pub(super) fn set(mesh: &mut TriMesh, attributes: &MeshAttributes) -> Result<(), JsError> {
    let (vertices, triangles) = (mesh.positions.len(), mesh.triangles.len());
    for uvs in attributes.uvs().unwrap_or_default() {
        let uvs = Float32Array::new(&uvs).to_vec();
        mesh.corner.uvs.push(rows::<_, [Vec2; 3]>("uvs", &uvs, triangles)?);
    }
    if let Some(normals) = attributes.normals() {
        let normals: Vec<[DVec3; 3]> = rows("normals", &normals, triangles)?;
        mesh.corner.set_normals(&normals).map_err(thrown)?;
    }
    if let Some(colors) = attributes.colors() {
        mesh.vertex.colors = rows("colors", &colors, vertices)?;
    }
    if let Some(colors) = attributes.corner_colors() {
        mesh.corner.colors = rows("cornerColors", &colors, triangles)?;
    }
    match (attributes.materials(), attributes.triangle_materials()) {
        (None, None) => {}
        (Some(names), Some(indices)) => mesh.set_materials(names, indices).map_err(thrown)?,
        _ => return Err(thrown("materials and triangleMaterials must be given together")),
    }
    let (joints, weights) = (attributes.joints(), attributes.weights());
    if joints.is_some() || weights.is_some() {
        let (joints, weights) = (joints.unwrap_or_default(), weights.unwrap_or_default());
        let per_vertex = joints.len().checked_div(vertices).unwrap_or(0);
        mesh.vertex.set_skin_table(vertices, per_vertex, &joints, &weights).map_err(thrown)?;
    }
    Ok(())
}

/// One row for each of so many elements, made of finite numbers.
fn rows<N: Pod + Into<f64>, T: Pod>(name: &str, numbers: &[N], elements: usize) -> Result<Vec<T>, JsError> {
    let each = size_of::<T>() / size_of::<N>();
    let (expected, found) = (each * elements, numbers.len());
    if found != expected {
        return Err(thrown(format!("{name}: expected {expected} numbers, not {found}")));
    }
    match numbers.iter().position(|&number| !number.into().is_finite()) {
        Some(bad) => Err(thrown(format!("{name}: number {} of element {} is not finite", bad % each, bad / each))),
        None => Ok(cast_slice(numbers).to_vec()),
    }
}

#[wasm_bindgen]
impl Mesh {
    /// u, v of the three corners of each triangle in a set of texture coordinates, by default the
    /// first. Empty if the set does not exist. A view of the memory of the module, valid until that
    /// memory grows.
    pub fn uvs(&self, set: Option<u32>) -> Float32Array {
        let set = self.mesh.corner.uvs.get(set.unwrap_or(0) as usize);
        // SAFETY: the mesh is immutable. The documentation states when the view becomes invalid.
        unsafe { Float32Array::view(cast_slice(set.map_or(&[], Vec::as_slice))) }
    }

    /// Shading normals: x, y, z of unit length for the three corners of each triangle. Empty if the
    /// mesh has none. A view.
    #[wasm_bindgen(getter)]
    pub fn normals(&self) -> Float32Array {
        // SAFETY: as above.
        unsafe { Float32Array::view(cast_slice(&self.mesh.corner.normals)) }
    }

    /// Linear red, green, blue and alpha of each vertex, 0 to 1. Empty if the mesh has no vertex
    /// colors. A view.
    #[wasm_bindgen(getter)]
    pub fn colors(&self) -> Float64Array {
        // SAFETY: as above.
        unsafe { Float64Array::view(cast_slice(&self.mesh.vertex.colors)) }
    }

    /// Linear red, green, blue and alpha of the three corners of each triangle, 0 to 1. Empty if
    /// the mesh has no corner colors. A view.
    #[wasm_bindgen(getter, js_name = cornerColors)]
    pub fn corner_colors(&self) -> Float64Array {
        // SAFETY: as above.
        unsafe { Float64Array::view(cast_slice(&self.mesh.corner.colors)) }
    }

    /// Names of the materials. An empty name means no material.
    #[wasm_bindgen(getter)]
    pub fn materials(&self) -> Vec<String> {
        self.mesh.materials.clone()
    }

    /// Material index of each triangle. Empty if the mesh has no materials. A view.
    #[wasm_bindgen(getter, js_name = triangleMaterials)]
    pub fn triangle_materials(&self) -> Uint32Array {
        // SAFETY: as above.
        unsafe { Uint32Array::view(&self.mesh.triangle_materials) }
    }
}
