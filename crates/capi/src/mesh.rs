//! Triangle meshes.

mod attributes;

use std::{ffi::c_char, sync::Arc};

use bytemuck::cast_slice;
use glam::DVec3;
use isochore_mesh::{ClosedMesh, TriMesh, io};

use crate::{
    error::{Failure, Status, guarded},
    memory::{array, fill, free, hand_over, put, reference, reference_mut, text},
};

pub use attributes::{
    isochore_mesh_corner_colors, isochore_mesh_material_name, isochore_mesh_normals, isochore_mesh_set_corner_colors,
    isochore_mesh_set_materials, isochore_mesh_set_normals, isochore_mesh_set_uvs, isochore_mesh_set_vertex_colors,
    isochore_mesh_triangle_materials, isochore_mesh_uvs, isochore_mesh_vertex_colors,
};

/// A triangle mesh.
#[derive(Debug)]
pub struct Mesh {
    pub(crate) mesh: Arc<TriMesh>,
}

/// Copies a mesh out of arrays: x, y, z of each vertex, and three vertex indices of each triangle, counter-clockwise seen from
/// outside.
///
/// # Safety
/// The arrays have 3 × `vertex_count` and 3 × `triangle_count` values; `mesh` can be written to.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn isochore_mesh_new(
    positions: *const f64,
    vertex_count: usize,
    triangles: *const u32,
    triangle_count: usize,
    mesh: *mut *mut Mesh,
) -> Status {
    guarded(|| {
        // SAFETY: as the caller promises.
        let (positions, triangles) = unsafe {
            (
                array("positions", positions.cast::<[f64; 3]>(), vertex_count)?,
                array("triangles", triangles.cast::<[u32; 3]>(), triangle_count)?,
            )
        };
        let positions: &[DVec3] = cast_slice(positions);
        let made = TriMesh::new(positions.to_vec(), triangles.to_vec());
        made.check_valid()?;
        // SAFETY: as the caller promises.
        unsafe { hand_over("mesh", mesh, Mesh { mesh: made.into() }) }
    })
}

/// Reads a mesh file: .obj .gltf .glb .ply .stl .off.
///
/// # Safety
/// `path` is a text; `mesh` can be written to.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn isochore_mesh_read(path: *const c_char, mesh: *mut *mut Mesh) -> Status {
    guarded(|| {
        // SAFETY: as the caller promises.
        let path = unsafe { text("path", path) }?;
        let read = io::read(path)?;
        // SAFETY: as the caller promises.
        unsafe { hand_over("mesh", mesh, Mesh { mesh: read.into() }) }
    })
}

/// Writes a mesh file in the format of its extension, whole or not at all.
///
/// # Safety
/// `mesh` is a handle, `path` a text.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn isochore_mesh_write(mesh: *const Mesh, path: *const c_char) -> Status {
    guarded(|| {
        // SAFETY: as the caller promises.
        let (mesh, path) = unsafe { (reference("mesh", mesh)?, text("path", path)?) };
        Ok(io::write(path, &mesh.mesh)?)
    })
}

/// Number of vertices; 0 of NULL.
///
/// # Safety
/// `mesh` is NULL or a handle.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn isochore_mesh_vertex_count(mesh: *const Mesh) -> usize {
    // SAFETY: as the caller promises.
    unsafe { mesh.as_ref() }.map_or(0, |mesh| mesh.mesh.positions.len())
}

/// Number of triangles; 0 of NULL.
///
/// # Safety
/// `mesh` is NULL or a handle.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn isochore_mesh_triangle_count(mesh: *const Mesh) -> usize {
    // SAFETY: as the caller promises.
    unsafe { mesh.as_ref() }.map_or(0, |mesh| mesh.mesh.triangles.len())
}

/// x, y, z of each vertex: the mesh's own memory. NULL of NULL.
///
/// # Safety
/// `mesh` is NULL or a handle.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn isochore_mesh_positions(mesh: *const Mesh) -> *const f64 {
    // SAFETY: as the caller promises.
    unsafe { mesh.as_ref() }.map_or(std::ptr::null(), |mesh| cast_slice(&mesh.mesh.positions).as_ptr())
}

/// Three vertex indices of each triangle, counter-clockwise seen from outside: the mesh's own memory. NULL of NULL.
///
/// # Safety
/// `mesh` is NULL or a handle.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn isochore_mesh_triangles(mesh: *const Mesh) -> *const u32 {
    // SAFETY: as the caller promises.
    unsafe { mesh.as_ref() }.map_or(std::ptr::null(), |mesh| mesh.mesh.triangles.as_flattened().as_ptr())
}

/// Signed volume of a closed mesh, cubic model units; an open mesh is an error.
///
/// # Safety
/// `mesh` is a handle; `volume` can be written to.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn isochore_mesh_volume(mesh: *const Mesh, volume: *mut f64) -> Status {
    guarded(|| {
        // SAFETY: as the caller promises.
        let mesh = unsafe { reference("mesh", mesh) }?;
        let enclosed = ClosedMesh::new(&mesh.mesh)?.volume();
        // SAFETY: as the caller promises.
        unsafe { put("volume", volume, enclosed) }
    })
}

/// Takes skin weights: `per_vertex` joints of each vertex and as many weights, which are divided by the sum of each vertex'. Weight
/// zero is for places that are not used.
///
/// # Safety
/// `mesh` is a handle; the arrays have `per_vertex` values for each vertex.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn isochore_mesh_set_skin(
    mesh: *mut Mesh,
    per_vertex: usize,
    joints: *const u32,
    weights: *const f64,
) -> Status {
    guarded(|| {
        // SAFETY: as the caller promises.
        let mesh = unsafe { reference_mut("mesh", mesh) }?;
        let vertices = mesh.mesh.positions.len();
        let count = vertices.checked_mul(per_vertex);
        let count = count.ok_or_else(|| Failure::argument(format!("{per_vertex} influences are too many")))?;
        // SAFETY: as the caller promises.
        let (joints, weights) = unsafe { (array("joints", joints, count)?, array("weights", weights, count)?) };
        let attributes = &mut Arc::make_mut(&mut mesh.mesh).vertex;
        attributes.set_skin_table(vertices, per_vertex, joints, weights).map_err(Failure::argument)
    })
}

/// The most joints that move any vertex; 0 where there is no skin, and of NULL.
///
/// # Safety
/// `mesh` is NULL or a handle.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn isochore_mesh_skin_influences(mesh: *const Mesh) -> usize {
    // SAFETY: as the caller promises.
    unsafe { mesh.as_ref() }.map_or(0, |mesh| mesh.mesh.vertex.skin.iter().map(Vec::len).max().unwrap_or(0))
}

/// Copies the skin: for each vertex as many joints, and weights that sum to one, as `isochore_mesh_skin_influences` says; weight zero
/// where there are fewer.
///
/// # Safety
/// `mesh` is a handle; so many values can be written to each array.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn isochore_mesh_skin(mesh: *const Mesh, joints: *mut u32, weights: *mut f64) -> Status {
    guarded(|| {
        // SAFETY: as the caller promises.
        let table = unsafe { reference("mesh", mesh) }?.mesh.vertex.skin_table();
        // SAFETY: as the caller promises.
        unsafe {
            fill("joints", joints, &table.joints)?;
            fill("weights", weights, &table.weights)
        }
    })
}

/// Gives a mesh back.
///
/// # Safety
/// `mesh` is NULL or a handle that was not given back yet.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn isochore_mesh_free(mesh: *mut Mesh) {
    // SAFETY: as the caller promises.
    unsafe { free(mesh) }
}
