//! What corners, vertices and triangles carry: arrays in, the mesh's own memory out.

use std::{ffi::c_char, sync::Arc};

use bytemuck::cast_slice;
use glam::Vec3;
use isochore_mesh::TriMesh;

use super::Mesh;
use crate::{
    error::{Failure, Status, guarded},
    memory::{array, finite_values, hand_over_text, put_slice, reference, reference_mut, text},
};

/// Copies texture coordinates: u, v of the three corners of each triangle. Sets are numbered from 0; the one after the last is added.
///
/// # Safety
/// `mesh` is a handle; `uvs` has 6 values for each triangle.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn isochore_mesh_set_uvs(mesh: *mut Mesh, set: usize, uvs: *const f32) -> Status {
    guarded(|| {
        // SAFETY: as the caller promises.
        let mesh = unsafe { reference_mut("mesh", mesh) }?;
        // SAFETY: as the caller promises.
        let uvs = unsafe { finite_values("uvs", uvs, 6, mesh.mesh.triangles.len(), f32::is_finite) }?;
        let sets = &mut Arc::make_mut(&mut mesh.mesh).corner.uvs;
        match (set, sets.len()) {
            (set, count) if set < count => sets[set] = uvs,
            (set, count) if set == count => sets.push(uvs),
            (set, count) => return Err(Failure::argument(format!("set {set} would leave a gap after {count} sets"))),
        }
        Ok(())
    })
}

/// Tells where the texture coordinates of a set lie, and how many numbers they are: six a triangle, none where there is no such set.
///
/// # Safety
/// `mesh` is a handle; `uvs` and `count` can be written to.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn isochore_mesh_uvs(
    mesh: *const Mesh,
    set: usize,
    uvs: *mut *const f32,
    count: *mut usize,
) -> Status {
    // SAFETY: as the caller promises.
    guarded(|| unsafe {
        let sets = &reference("mesh", mesh)?.mesh.corner.uvs;
        put_slice("uvs", uvs, count, cast_slice(sets.get(set).map_or(&[], Vec::as_slice)))
    })
}

/// Copies shading normals: x, y, z, of any length, of the three corners of each triangle. They turn with the surface.
///
/// # Safety
/// `mesh` is a handle; `normals` has 9 values for each triangle.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn isochore_mesh_set_normals(mesh: *mut Mesh, normals: *const f32) -> Status {
    guarded(|| {
        // SAFETY: as the caller promises.
        let mesh = unsafe { reference_mut("mesh", mesh) }?;
        // SAFETY: as the caller promises.
        let normals: Vec<[Vec3; 3]> =
            unsafe { finite_values("normals", normals, 9, mesh.mesh.triangles.len(), f32::is_finite) }?;
        let normals: Vec<_> = normals.into_iter().map(|corners| corners.map(|normal| normal.as_dvec3())).collect();
        Arc::make_mut(&mut mesh.mesh).corner.set_normals(&normals).map_err(Failure::argument)
    })
}

/// Tells where the shading normals lie, and how many numbers they are: nine a triangle, or none.
///
/// # Safety
/// `mesh` is a handle; `normals` and `count` can be written to.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn isochore_mesh_normals(
    mesh: *const Mesh,
    normals: *mut *const f32,
    count: *mut usize,
) -> Status {
    // SAFETY: as the caller promises.
    guarded(|| unsafe {
        put_slice("normals", normals, count, cast_slice(&reference("mesh", mesh)?.mesh.corner.normals))
    })
}

/// Copies colors: linear red, green, blue and alpha of each vertex, 0 to 1.
///
/// # Safety
/// `mesh` is a handle; `colors` has 4 values for each vertex.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn isochore_mesh_set_vertex_colors(mesh: *mut Mesh, colors: *const f64) -> Status {
    guarded(|| {
        // SAFETY: as the caller promises.
        let mesh = unsafe { reference_mut("mesh", mesh) }?;
        // SAFETY: as the caller promises.
        let colors = unsafe { finite_values("colors", colors, 4, mesh.mesh.positions.len(), f64::is_finite) }?;
        Arc::make_mut(&mut mesh.mesh).vertex.colors = colors;
        Ok(())
    })
}

/// Tells where the colors of the vertices lie, and how many numbers they are: four a vertex, or none.
///
/// # Safety
/// `mesh` is a handle; `colors` and `count` can be written to.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn isochore_mesh_vertex_colors(
    mesh: *const Mesh,
    colors: *mut *const f64,
    count: *mut usize,
) -> Status {
    // SAFETY: as the caller promises.
    guarded(|| unsafe { put_slice("colors", colors, count, cast_slice(&reference("mesh", mesh)?.mesh.vertex.colors)) })
}

/// Copies colors: linear red, green, blue and alpha of the three corners of each triangle, 0 to 1, where they differ across seams.
///
/// # Safety
/// `mesh` is a handle; `colors` has 12 values for each triangle.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn isochore_mesh_set_corner_colors(mesh: *mut Mesh, colors: *const f64) -> Status {
    guarded(|| {
        // SAFETY: as the caller promises.
        let mesh = unsafe { reference_mut("mesh", mesh) }?;
        // SAFETY: as the caller promises.
        let colors = unsafe { finite_values("colors", colors, 12, mesh.mesh.triangles.len(), f64::is_finite) }?;
        Arc::make_mut(&mut mesh.mesh).corner.colors = colors;
        Ok(())
    })
}

/// Tells where the colors of the corners lie, and how many numbers they are: twelve a triangle, or none.
///
/// # Safety
/// `mesh` is a handle; `colors` and `count` can be written to.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn isochore_mesh_corner_colors(
    mesh: *const Mesh,
    colors: *mut *const f64,
    count: *mut usize,
) -> Status {
    // SAFETY: as the caller promises.
    guarded(|| unsafe { put_slice("colors", colors, count, cast_slice(&reference("mesh", mesh)?.mesh.corner.colors)) })
}

/// Copies the materials: the number of each triangle's material, and the names of all.
///
/// # Safety
/// `mesh` is a handle; `of_triangles` has a value for each triangle, `names` has `count` texts.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn isochore_mesh_set_materials(
    mesh: *mut Mesh,
    of_triangles: *const u32,
    names: *const *const c_char,
    count: usize,
) -> Status {
    guarded(|| {
        // SAFETY: as the caller promises.
        let mesh = unsafe { reference_mut("mesh", mesh) }?;
        // SAFETY: as the caller promises.
        let (numbers, names) =
            unsafe { (array("of_triangles", of_triangles, mesh.mesh.triangles.len())?, array("names", names, count)?) };
        // SAFETY: as the caller promises.
        let names = names.iter().map(|&name| unsafe { text("names", name) }.map(str::to_owned));
        let names = names.collect::<Result<_, _>>()?;
        Arc::make_mut(&mut mesh.mesh).set_materials(names, numbers.to_vec()).map_err(Failure::argument)
    })
}

/// Tells where the number of each triangle's material lies, and how many they are: one a triangle, or none.
///
/// # Safety
/// `mesh` is a handle; `of_triangles` and `count` can be written to.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn isochore_mesh_triangle_materials(
    mesh: *const Mesh,
    of_triangles: *mut *const u32,
    count: *mut usize,
) -> Status {
    // SAFETY: as the caller promises.
    guarded(|| unsafe {
        put_slice("of_triangles", of_triangles, count, &reference("mesh", mesh)?.mesh.triangle_materials)
    })
}

/// Gives the name of a material, which the caller gives back to `isochore_text_free`.
///
/// # Safety
/// `mesh` is a handle; `name` can be written to.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn isochore_mesh_material_name(
    mesh: *const Mesh,
    material: usize,
    name: *mut *mut c_char,
) -> Status {
    guarded(|| {
        // SAFETY: as the caller promises.
        let mesh: &TriMesh = &unsafe { reference("mesh", mesh) }?.mesh;
        let known = mesh.materials.get(material);
        let known = known
            .ok_or_else(|| Failure::argument(format!("there is no material {material} of {}", mesh.materials.len())))?;
        // SAFETY: as the caller promises.
        unsafe { hand_over_text("name", name, known) }
    })
}
