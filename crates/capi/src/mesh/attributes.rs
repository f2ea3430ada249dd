//! Attributes of corners, vertices and triangles. Setters copy arrays; getters expose memory of the
//! mesh.

use std::{ffi::c_char, sync::Arc};

use bytemuck::cast_slice;
use glam::Vec3;
use isochore_mesh::TriMesh;

use super::Mesh;
use crate::{
    error::{Failure, Status, guarded},
    memory::{array, finite_values, hand_over_text, put_slice, reference, reference_mut, text},
};

/// Sets texture coordinates: u, v of the three corners of each triangle. Sets are numbered from 0.
/// An existing set is replaced; the number after the last set adds a set.
///
/// Returns `ISOCHORE_STATUS_ARGUMENT` if a coordinate is not finite or if `set` would leave a gap.
///
/// Preconditions: `mesh` is a handle. `uvs` has 6 values for each triangle.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn isochore_mesh_set_uvs(mesh: *mut Mesh, set: usize, uvs: *const f32) -> Status {
    guarded(|| {
        // SAFETY: the caller guarantees it.
        let mesh = unsafe { reference_mut("mesh", mesh) }?;
        // SAFETY: the caller guarantees it.
        let uvs = unsafe { finite_values("uvs", uvs, 6, mesh.mesh.triangles.len(), f32::is_finite) }?;
        let sets = &mut Arc::make_mut(&mut mesh.mesh).corner.uvs;
        match (set, sets.len()) {
            (set, count) if set < count => sets[set] = uvs,
            (set, count) if set == count => sets.push(uvs),
            (set, count) => {
                return Err(Failure::argument(format!(
                    "set {set} is out of range: the mesh has {count} sets, so the next one is set {count}"
                )));
            }
        }
        Ok(())
    })
}

/// Gets the texture coordinates of a set, u, v of the three corners of each triangle. `count`
/// receives the number of values: 6 per triangle, or 0 if the set does not exist. The array belongs
/// to the mesh.
///
/// Preconditions: `mesh` is a handle. `uvs` and `count` are writable.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn isochore_mesh_uvs(
    mesh: *const Mesh,
    set: usize,
    uvs: *mut *const f32,
    count: *mut usize,
) -> Status {
    // SAFETY: the caller guarantees it.
    guarded(|| unsafe {
        let sets = &reference("mesh", mesh)?.mesh.corner.uvs;
        put_slice("uvs", uvs, count, cast_slice(sets.get(set).map_or(&[], Vec::as_slice)))
    })
}

/// Sets shading normals: x, y, z of the three corners of each triangle, of any nonzero length. They
/// rotate with the surface.
///
/// Returns `ISOCHORE_STATUS_ARGUMENT` if a normal is zero or not finite.
///
/// Preconditions: `mesh` is a handle. `normals` has 9 values for each triangle.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn isochore_mesh_set_normals(mesh: *mut Mesh, normals: *const f32) -> Status {
    guarded(|| {
        // SAFETY: the caller guarantees it.
        let mesh = unsafe { reference_mut("mesh", mesh) }?;
        // SAFETY: the caller guarantees it.
        let normals: Vec<[Vec3; 3]> =
            unsafe { finite_values("normals", normals, 9, mesh.mesh.triangles.len(), f32::is_finite) }?;
        let normals: Vec<_> = normals.into_iter().map(|corners| corners.map(|normal| normal.as_dvec3())).collect();
        Arc::make_mut(&mut mesh.mesh).corner.set_normals(&normals).map_err(Failure::argument)
    })
}

/// Gets the shading normals, x, y, z of unit length for the three corners of each triangle. `count`
/// receives the number of values: 9 per triangle, or 0 if the mesh has no normals. The array
/// belongs to the mesh.
///
/// Preconditions: `mesh` is a handle. `normals` and `count` are writable.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn isochore_mesh_normals(
    mesh: *const Mesh,
    normals: *mut *const f32,
    count: *mut usize,
) -> Status {
    // SAFETY: the caller guarantees it.
    guarded(|| unsafe {
        put_slice("normals", normals, count, cast_slice(&reference("mesh", mesh)?.mesh.corner.normals))
    })
}

/// Sets vertex colors: linear red, green, blue and alpha of each vertex, from 0 to 1.
///
/// Returns `ISOCHORE_STATUS_ARGUMENT` if a value is not finite.
///
/// Preconditions: `mesh` is a handle. `colors` has 4 values for each vertex.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn isochore_mesh_set_vertex_colors(mesh: *mut Mesh, colors: *const f64) -> Status {
    guarded(|| {
        // SAFETY: the caller guarantees it.
        let mesh = unsafe { reference_mut("mesh", mesh) }?;
        // SAFETY: the caller guarantees it.
        let colors = unsafe { finite_values("colors", colors, 4, mesh.mesh.positions.len(), f64::is_finite) }?;
        Arc::make_mut(&mut mesh.mesh).vertex.colors = colors;
        Ok(())
    })
}

/// Gets the vertex colors. `count` receives the number of values: 4 per vertex, or 0 if the mesh
/// has no vertex colors. The array belongs to the mesh.
///
/// Preconditions: `mesh` is a handle. `colors` and `count` are writable.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn isochore_mesh_vertex_colors(
    mesh: *const Mesh,
    colors: *mut *const f64,
    count: *mut usize,
) -> Status {
    // SAFETY: the caller guarantees it.
    guarded(|| unsafe { put_slice("colors", colors, count, cast_slice(&reference("mesh", mesh)?.mesh.vertex.colors)) })
}

/// Sets corner colors, which may differ across seams: linear red, green, blue and alpha of the
/// three corners of each triangle, from 0 to 1.
///
/// Returns `ISOCHORE_STATUS_ARGUMENT` if a value is not finite.
///
/// Preconditions: `mesh` is a handle. `colors` has 12 values for each triangle.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn isochore_mesh_set_corner_colors(mesh: *mut Mesh, colors: *const f64) -> Status {
    guarded(|| {
        // SAFETY: the caller guarantees it.
        let mesh = unsafe { reference_mut("mesh", mesh) }?;
        // SAFETY: the caller guarantees it.
        let colors = unsafe { finite_values("colors", colors, 12, mesh.mesh.triangles.len(), f64::is_finite) }?;
        Arc::make_mut(&mut mesh.mesh).corner.colors = colors;
        Ok(())
    })
}

/// Gets the corner colors. `count` receives the number of values: 12 per triangle, or 0 if the mesh
/// has no corner colors. The array belongs to the mesh.
///
/// Preconditions: `mesh` is a handle. `colors` and `count` are writable.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn isochore_mesh_corner_colors(
    mesh: *const Mesh,
    colors: *mut *const f64,
    count: *mut usize,
) -> Status {
    // SAFETY: the caller guarantees it.
    guarded(|| unsafe { put_slice("colors", colors, count, cast_slice(&reference("mesh", mesh)?.mesh.corner.colors)) })
}

/// Sets the material index of each triangle and the names of all materials. An empty name means no
/// material.
///
/// Returns `ISOCHORE_STATUS_ARGUMENT` if an index is not less than `count`.
///
/// Preconditions: `mesh` is a handle. `triangle_materials` has one value for each triangle. `names`
/// has `count` strings.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn isochore_mesh_set_materials(
    mesh: *mut Mesh,
    triangle_materials: *const u32,
    names: *const *const c_char,
    count: usize,
) -> Status {
    guarded(|| {
        // SAFETY: the caller guarantees it.
        let mesh = unsafe { reference_mut("mesh", mesh) }?;
        // SAFETY: the caller guarantees it.
        let indices = unsafe { array("triangle_materials", triangle_materials, mesh.mesh.triangles.len()) }?;
        // SAFETY: the caller guarantees it.
        let names = unsafe { array("names", names, count) }?;
        // SAFETY: the caller guarantees it.
        let names = names.iter().map(|&name| unsafe { text("names", name) }.map(str::to_owned));
        let names = names.collect::<Result<_, _>>()?;
        Arc::make_mut(&mut mesh.mesh).set_materials(names, indices.to_vec()).map_err(Failure::argument)
    })
}

/// Gets the material index of each triangle. `count` receives the number of values: 1 per triangle,
/// or 0 if the mesh has no materials. The array belongs to the mesh.
///
/// Preconditions: `mesh` is a handle. `triangle_materials` and `count` are writable.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn isochore_mesh_triangle_materials(
    mesh: *const Mesh,
    triangle_materials: *mut *const u32,
    count: *mut usize,
) -> Status {
    // SAFETY: the caller guarantees it.
    guarded(|| unsafe {
        put_slice("triangle_materials", triangle_materials, count, &reference("mesh", mesh)?.mesh.triangle_materials)
    })
}

/// Gets a copy of the name of a material. Free it with `isochore_text_free`.
///
/// Returns `ISOCHORE_STATUS_ARGUMENT` if `material` is out of range.
///
/// Preconditions: `mesh` is a handle. `name` is writable.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn isochore_mesh_material_name(
    mesh: *const Mesh,
    material: usize,
    name: *mut *mut c_char,
) -> Status {
    guarded(|| {
        // SAFETY: the caller guarantees it.
        let mesh: &TriMesh = &unsafe { reference("mesh", mesh) }?.mesh;
        let count = mesh.materials.len();
        let known = mesh.materials.get(material).ok_or_else(|| {
            Failure::argument(format!("material {material} is out of range: the mesh has {count} materials"))
        })?;
        // SAFETY: the caller guarantees it.
        unsafe { hand_over_text("name", name, known) }
    })
}
