//! Triangle meshes.

use std::ffi::c_char;

use bytemuck::cast_slice;
use glam::DVec3;
use isochore_mesh::{ClosedMesh, TriMesh, io};

use crate::{
    error::{Status, guarded},
    memory::{array, free, hand_over, put, reference, text},
};

/// A triangle mesh, which does not change.
#[derive(Debug)]
pub struct Mesh {
    pub(crate) mesh: TriMesh,
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
        unsafe { hand_over("mesh", mesh, Mesh { mesh: made }) }
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
        unsafe { hand_over("mesh", mesh, Mesh { mesh: read }) }
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

/// Gives a mesh back.
///
/// # Safety
/// `mesh` is NULL or a handle that was not given back yet.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn isochore_mesh_free(mesh: *mut Mesh) {
    // SAFETY: as the caller promises.
    unsafe { free(mesh) }
}
