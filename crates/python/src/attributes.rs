//! Mesh attributes from NumPy arrays.

use bytemuck::cast_slice;
use glam::{DVec3, DVec4, Vec2};
use isochore_mesh::TriMesh;
use numpy::{PyReadonlyArrayDyn, PyUntypedArrayMethods};
use pyo3::prelude::*;

use crate::{
    arrays::{check_shape, contiguous, finite_numbers, index, indices, numbers},
    error::Failure,
};

/// Adds a set of texture coordinates, (T, 3, 2).
pub(crate) fn add_uvs(mesh: &mut TriMesh, uvs: &Bound<'_, PyAny>) -> Result<(), Failure> {
    let uvs = contiguous::<f32>(uvs)?;
    check_shape("uvs", uvs.shape(), &[Some(mesh.triangles.len()), Some(3), Some(2)])?;
    mesh.corner.uvs.push(cast_slice::<f32, [Vec2; 3]>(finite_numbers("uvs", &uvs)?).to_vec());
    Ok(())
}

/// Sets shading normals of any nonzero length, (T, 3, 3).
pub(crate) fn set_normals(mesh: &mut TriMesh, normals: &Bound<'_, PyAny>) -> Result<(), Failure> {
    let py = normals.py();
    let normals = contiguous::<f64>(normals)?;
    check_shape("normals", normals.shape(), &[Some(mesh.triangles.len()), Some(3), Some(3)])?;
    let corners: &[[DVec3; 3]] = cast_slice(numbers("normals", &normals)?);
    let set = py.detach(|| mesh.corner.set_normals(corners));
    set.map_err(|error| Failure::Argument(error.to_string()))
}

/// Sets vertex colors, (V, 4).
pub(crate) fn set_colors(mesh: &mut TriMesh, colors: &Bound<'_, PyAny>) -> Result<(), Failure> {
    let colors = contiguous::<f64>(colors)?;
    check_shape("colors", colors.shape(), &[Some(mesh.positions.len()), Some(4)])?;
    mesh.vertex.colors = rgba("colors", &colors)?;
    Ok(())
}

/// Sets corner colors, (T, 3, 4).
pub(crate) fn set_corner_colors(mesh: &mut TriMesh, colors: &Bound<'_, PyAny>) -> Result<(), Failure> {
    let colors = contiguous::<f64>(colors)?;
    check_shape("corner_colors", colors.shape(), &[Some(mesh.triangles.len()), Some(3), Some(4)])?;
    mesh.corner.colors = rgba("corner_colors", &colors)?.as_chunks().0.to_vec();
    Ok(())
}

fn rgba(name: &str, colors: &PyReadonlyArrayDyn<'_, f64>) -> Result<Vec<DVec4>, Failure> {
    Ok(finite_numbers(name, colors)?.as_chunks::<4>().0.iter().map(|c| DVec4::from(*c)).collect())
}

/// Sets joints and weights, (V, K) each.
pub(crate) fn set_skin(
    mesh: &mut TriMesh,
    joints: &Bound<'_, PyAny>,
    weights: &Bound<'_, PyAny>,
) -> Result<(), Failure> {
    let py = joints.py();
    let joints = indices("joints", joints)?;
    let weights = contiguous::<f64>(weights)?;
    check_shape("joints", joints.shape(), &[Some(mesh.positions.len()), None])?;
    check_shape("weights", weights.shape(), &[Some(mesh.positions.len()), Some(joints.shape()[1])])?;
    let columns = joints.shape()[1];
    let (joints, weights) = (numbers("joints", &joints)?, numbers("weights", &weights)?);
    py.detach(|| {
        let joints: Vec<u32> = joints.iter().map(|&joint| index("joints", joint)).collect::<Result<_, _>>()?;
        let set = mesh.vertex.set_skin_table(mesh.positions.len(), columns, &joints, weights);
        set.map_err(|error| Failure::Argument(error.to_string()))
    })
}

/// Sets the names of the materials and the material index of each triangle, (T,).
pub(crate) fn set_materials(
    mesh: &mut TriMesh,
    names: Vec<String>,
    triangle_materials: &Bound<'_, PyAny>,
) -> Result<(), Failure> {
    let triangle_materials = indices("triangle_materials", triangle_materials)?;
    check_shape("triangle_materials", triangle_materials.shape(), &[Some(mesh.triangles.len())])?;
    let checked = |(triangle, &number): (usize, &i64)| match u32::try_from(number) {
        Ok(material) if (material as usize) < names.len() => Ok(material),
        _ => Err(Failure::Argument(format!(
            "triangle_materials: triangle {triangle} has material {number}, but there are {} materials",
            names.len()
        ))),
    };
    let numbers = numbers("triangle_materials", &triangle_materials)?;
    mesh.triangle_materials = numbers.iter().enumerate().map(checked).collect::<Result<_, _>>()?;
    mesh.materials = names;
    Ok(())
}
