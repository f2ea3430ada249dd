//! What corners, vertices and triangles carry: arrays in, views of the mesh's own memory out.

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

/// Gives a mesh what its host says that it carries.
pub(super) fn set(mesh: &mut TriMesh, given: &MeshAttributes) -> Result<(), JsError> {
    let (vertices, triangles) = (mesh.positions.len(), mesh.triangles.len());
    for uvs in given.uvs().unwrap_or_default() {
        let uvs = Float32Array::new(&uvs).to_vec();
        mesh.corner.uvs.push(rows::<_, [Vec2; 3]>("uvs", &uvs, triangles)?);
    }
    if let Some(normals) = given.normals() {
        let normals: Vec<[DVec3; 3]> = rows("normals", &normals, triangles)?;
        mesh.corner.set_normals(&normals).map_err(thrown)?;
    }
    if let Some(colors) = given.colors() {
        mesh.vertex.colors = rows("colors", &colors, vertices)?;
    }
    if let Some(colors) = given.corner_colors() {
        mesh.corner.colors = rows("cornerColors", &colors, triangles)?;
    }
    match (given.materials(), given.triangle_materials()) {
        (None, None) => {}
        (Some(names), Some(of_triangles)) => mesh.set_materials(names, of_triangles).map_err(thrown)?,
        _ => return Err(thrown("materials and triangleMaterials need each other")),
    }
    let (joints, weights) = (given.joints(), given.weights());
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
    let (wanted, found) = (each * elements, numbers.len());
    if found != wanted {
        return Err(thrown(format!("{name}: {wanted} numbers are wanted, not {found}")));
    }
    match numbers.iter().position(|&number| !number.into().is_finite()) {
        Some(bad) => Err(thrown(format!("{name}: number {} of element {} is not finite", bad % each, bad / each))),
        None => Ok(cast_slice(numbers).to_vec()),
    }
}

#[wasm_bindgen]
impl Mesh {
    /// u, v of the three corners of each triangle in a set of texture coordinates, the first unless said otherwise; empty where there
    /// is no such set. A view of the module's memory, until that grows.
    pub fn uvs(&self, set: Option<u32>) -> Float32Array {
        let set = self.mesh.corner.uvs.get(set.unwrap_or(0) as usize);
        // SAFETY: the mesh does not change; that a view dies when memory grows is JavaScript's own affair, and said above.
        unsafe { Float32Array::view(cast_slice(set.map_or(&[], Vec::as_slice))) }
    }

    /// Shading normals, x, y, z of unit length for the three corners of each triangle; empty where the mesh has none. A view.
    #[wasm_bindgen(getter)]
    pub fn normals(&self) -> Float32Array {
        // SAFETY: as above.
        unsafe { Float32Array::view(cast_slice(&self.mesh.corner.normals)) }
    }

    /// Linear red, green, blue, alpha of each vertex, 0 to 1; empty where the mesh has none. A view.
    #[wasm_bindgen(getter)]
    pub fn colors(&self) -> Float64Array {
        // SAFETY: as above.
        unsafe { Float64Array::view(cast_slice(&self.mesh.vertex.colors)) }
    }

    /// Linear red, green, blue, alpha of the three corners of each triangle, 0 to 1; empty where the mesh has none. A view.
    #[wasm_bindgen(getter, js_name = cornerColors)]
    pub fn corner_colors(&self) -> Float64Array {
        // SAFETY: as above.
        unsafe { Float64Array::view(cast_slice(&self.mesh.corner.colors)) }
    }

    /// Names of the materials; an empty one stands for triangles without a material.
    #[wasm_bindgen(getter)]
    pub fn materials(&self) -> Vec<String> {
        self.mesh.materials.clone()
    }

    /// For each triangle which of the materials it has; empty where the mesh has none. A view.
    #[wasm_bindgen(getter, js_name = triangleMaterials)]
    pub fn triangle_materials(&self) -> Uint32Array {
        // SAFETY: as above.
        unsafe { Uint32Array::view(&self.mesh.triangle_materials) }
    }
}
