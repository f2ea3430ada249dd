//! Triangle meshes.

mod attributes;

use std::{ffi::c_char, sync::Arc};

use bytemuck::cast_slice;
use glam::DVec3;
use isochore_mesh::{ClosedMesh, TriMesh, io};

use crate::{
    error::{Failure, Status, guarded},
    memory::{array, copy_into, free, hand_over, put, reference, reference_mut, text},
};

pub use attributes::{
    isochore_mesh_corner_colors, isochore_mesh_material_name, isochore_mesh_normals, isochore_mesh_set_corner_colors,
    isochore_mesh_set_materials, isochore_mesh_set_normals, isochore_mesh_set_uvs, isochore_mesh_set_vertex_colors,
    isochore_mesh_triangle_materials, isochore_mesh_uvs, isochore_mesh_vertex_colors,
};

/// A triangle mesh with its attributes.
#[derive(Debug)]
pub struct Mesh {
    pub(crate) mesh: Arc<TriMesh>,
}

/// Creates a mesh from copies of the arrays. `positions` holds x, y, z of each vertex in model
/// units. `triangles` holds three vertex indices per triangle, counter-clockwise as seen from
/// outside.
///
/// Returns `ISOCHORE_STATUS_MESH` if an index is out of range or a coordinate is not finite.
///
/// Preconditions: `positions` has 3 × `vertex_count` values. `triangles` has 3 × `triangle_count`
/// values. `mesh` is writable. Free the mesh with `isochore_mesh_free`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn isochore_mesh_new(
    positions: *const f64,
    vertex_count: usize,
    triangles: *const u32,
    triangle_count: usize,
    mesh: *mut *mut Mesh,
) -> Status {
    guarded(|| {
        // SAFETY: the caller guarantees it.
        let (positions, triangles) = unsafe {
            (
                array("positions", positions.cast::<[f64; 3]>(), vertex_count)?,
                array("triangles", triangles.cast::<[u32; 3]>(), triangle_count)?,
            )
        };
        let positions: &[DVec3] = cast_slice(positions);
        let built = TriMesh::new(positions.to_vec(), triangles.to_vec());
        built.check_valid()?;
        // SAFETY: the caller guarantees it.
        unsafe { hand_over("mesh", mesh, Mesh { mesh: built.into() }) }
    })
}

/// Reads a mesh file. The extension selects the format: .obj, .gltf, .glb, .ply, .stl or .off.
///
/// Returns `ISOCHORE_STATUS_FILE` if the file cannot be read and `ISOCHORE_STATUS_MESH` if its
/// content is invalid.
///
/// Preconditions: `path` is a string. `mesh` is writable. Free the mesh with `isochore_mesh_free`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn isochore_mesh_read(path: *const c_char, mesh: *mut *mut Mesh) -> Status {
    guarded(|| {
        // SAFETY: the caller guarantees it.
        let path = unsafe { text("path", path) }?;
        let read = io::read(path)?;
        // SAFETY: the caller guarantees it.
        unsafe { hand_over("mesh", mesh, Mesh { mesh: read.into() }) }
    })
}

/// Writes a mesh file in the format that the extension selects. The file is replaced only when the
/// new one is complete.
///
/// Returns `ISOCHORE_STATUS_FILE` if the file cannot be written and `ISOCHORE_STATUS_MESH` if the
/// format cannot represent the mesh.
///
/// Preconditions: `mesh` is a handle. `path` is a string.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn isochore_mesh_write(mesh: *const Mesh, path: *const c_char) -> Status {
    guarded(|| {
        // SAFETY: the caller guarantees it.
        let (mesh, path) = unsafe { (reference("mesh", mesh)?, text("path", path)?) };
        Ok(io::write(path, &mesh.mesh)?)
    })
}

/// Returns the number of vertices, or 0 if `mesh` is NULL.
///
/// Preconditions: `mesh` is NULL or a handle.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn isochore_mesh_vertex_count(mesh: *const Mesh) -> usize {
    // SAFETY: the caller guarantees it.
    unsafe { mesh.as_ref() }.map_or(0, |mesh| mesh.mesh.positions.len())
}

/// Returns the number of triangles, or 0 if `mesh` is NULL.
///
/// Preconditions: `mesh` is NULL or a handle.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn isochore_mesh_triangle_count(mesh: *const Mesh) -> usize {
    // SAFETY: the caller guarantees it.
    unsafe { mesh.as_ref() }.map_or(0, |mesh| mesh.mesh.triangles.len())
}

/// Returns x, y, z of each vertex in model units, or NULL if `mesh` is NULL. The array belongs to
/// the mesh.
///
/// Preconditions: `mesh` is NULL or a handle.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn isochore_mesh_positions(mesh: *const Mesh) -> *const f64 {
    // SAFETY: the caller guarantees it.
    unsafe { mesh.as_ref() }.map_or(std::ptr::null(), |mesh| cast_slice(&mesh.mesh.positions).as_ptr())
}

/// Returns three vertex indices per triangle, counter-clockwise as seen from outside, or NULL if
/// `mesh` is NULL. The array belongs to the mesh.
///
/// Preconditions: `mesh` is NULL or a handle.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn isochore_mesh_triangles(mesh: *const Mesh) -> *const u32 {
    // SAFETY: the caller guarantees it.
    unsafe { mesh.as_ref() }.map_or(std::ptr::null(), |mesh| mesh.mesh.triangles.as_flattened().as_ptr())
}

/// Computes the signed volume of a closed mesh, in cubic model units.
///
/// Returns `ISOCHORE_STATUS_MESH` if the mesh is open or not consistently oriented.
///
/// Preconditions: `mesh` is a handle. `volume` is writable.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn isochore_mesh_volume(mesh: *const Mesh, volume: *mut f64) -> Status {
    guarded(|| {
        // SAFETY: the caller guarantees it.
        let mesh = unsafe { reference("mesh", mesh) }?;
        let enclosed_volume = ClosedMesh::new(&mesh.mesh)?.volume();
        // SAFETY: the caller guarantees it.
        unsafe { put("volume", volume, enclosed_volume) }
    })
}

/// Sets the skin weights. `joints` and `weights` hold `per_vertex` entries for each vertex. The
/// weights of each vertex are normalized to sum to 1. Use weight 0 for unused entries.
///
/// Returns `ISOCHORE_STATUS_ARGUMENT` if `per_vertex` is 0 or too large, or if a weight is negative
/// or not finite.
///
/// Preconditions: `mesh` is a handle. `joints` and `weights` have `per_vertex` values for each
/// vertex.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn isochore_mesh_set_skin(
    mesh: *mut Mesh,
    per_vertex: usize,
    joints: *const u32,
    weights: *const f64,
) -> Status {
    guarded(|| {
        // SAFETY: the caller guarantees it.
        let mesh = unsafe { reference_mut("mesh", mesh) }?;
        let vertices = mesh.mesh.positions.len();
        let count = vertices.checked_mul(per_vertex);
        let count = count.ok_or_else(|| Failure::argument(format!("{per_vertex} influences are too many")))?;
        // SAFETY: the caller guarantees it.
        let (joints, weights) = unsafe { (array("joints", joints, count)?, array("weights", weights, count)?) };
        let attributes = &mut Arc::make_mut(&mut mesh.mesh).vertex;
        attributes.set_skin_table(vertices, per_vertex, joints, weights).map_err(Failure::argument)
    })
}

/// Returns the largest number of joints of any vertex, or 0 if the mesh has no skin or `mesh` is
/// NULL.
///
/// Preconditions: `mesh` is NULL or a handle.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn isochore_mesh_skin_influences(mesh: *const Mesh) -> usize {
    // SAFETY: the caller guarantees it.
    unsafe { mesh.as_ref() }.map_or(0, |mesh| mesh.mesh.vertex.skin.iter().map(Vec::len).max().unwrap_or(0))
}

/// Copies the skin weights. Each vertex has `isochore_mesh_skin_influences` joints and as many
/// weights, which sum to 1. Unused entries have weight 0.
///
/// Preconditions: `mesh` is a handle. `joints` and `weights` have space for
/// `isochore_mesh_skin_influences` values for each vertex.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn isochore_mesh_skin(mesh: *const Mesh, joints: *mut u32, weights: *mut f64) -> Status {
    guarded(|| {
        // SAFETY: the caller guarantees it.
        let table = unsafe { reference("mesh", mesh) }?.mesh.vertex.skin_table();
        // SAFETY: the caller guarantees it.
        unsafe {
            copy_into("joints", joints, &table.joints)?;
            copy_into("weights", weights, &table.weights)
        }
    })
}

/// Frees a mesh. Sessions opened on it remain valid.
///
/// Preconditions: `mesh` is NULL or a handle that has not been freed.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn isochore_mesh_free(mesh: *mut Mesh) {
    // SAFETY: the caller guarantees it.
    unsafe { free(mesh) }
}
