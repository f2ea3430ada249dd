//! Triangle meshes.

use std::{path::PathBuf, sync::Arc};

use bytemuck::{allocation::cast_vec, cast_slice};
use glam::Vec2;
use isochore_mesh::{
    ClosedMesh, SelfIntersections, SkinTable, TriMesh,
    io::{self, Format, SplitVertices},
};
use numpy::{IntoPyArray, PyArray1, PyArray2, PyArrayMethods};
use pyo3::{
    prelude::*,
    types::{PyBytes, PyType},
};

use crate::{
    arrays::{contiguous, points, points_to_array, triangles, view},
    attributes,
    error::Failure,
    pickled::PickledMesh,
    watch::watched,
};

/// An immutable triangle mesh. Its arrays are read-only views that keep it alive.
#[pyclass(frozen, module = "isochore")]
#[derive(Debug)]
pub(crate) struct Mesh {
    pub(crate) mesh: Arc<TriMesh>,
}

#[pymethods]
impl Mesh {
    #[new]
    #[pyo3(signature = (
        positions, triangles, *, uvs = None, normals = None, colors = None, corner_colors = None, skin = None,
        materials = None, triangle_materials = None
    ))]
    #[expect(clippy::too_many_arguments, reason = "they are keyword arguments in Python")]
    fn new(
        positions: &Bound<'_, PyAny>,
        triangles: &Bound<'_, PyAny>,
        uvs: Option<Vec<Bound<'_, PyAny>>>,
        normals: Option<&Bound<'_, PyAny>>,
        colors: Option<&Bound<'_, PyAny>>,
        corner_colors: Option<&Bound<'_, PyAny>>,
        skin: Option<(Bound<'_, PyAny>, Bound<'_, PyAny>)>,
        materials: Option<Vec<String>>,
        triangle_materials: Option<&Bound<'_, PyAny>>,
    ) -> Result<Self, Failure> {
        let mut mesh = geometry(positions, triangles)?;
        uvs.iter().flatten().try_for_each(|uvs| attributes::add_uvs(&mut mesh, uvs))?;
        if let Some(normals) = normals {
            attributes::set_normals(&mut mesh, normals)?;
        }
        if let Some(colors) = colors {
            attributes::set_colors(&mut mesh, colors)?;
        }
        if let Some(colors) = corner_colors {
            attributes::set_corner_colors(&mut mesh, colors)?;
        }
        if let Some((joints, weights)) = skin {
            attributes::set_skin(&mut mesh, &joints, &weights)?;
        }
        match (materials.unwrap_or_default(), triangle_materials) {
            (names, Some(indices)) => attributes::set_materials(&mut mesh, names, indices)?,
            (names, None) if names.is_empty() => {}
            (_, None) => {
                return Err(Failure::Argument(
                    "materials require triangle_materials, the material index of each triangle".into(),
                ));
            }
        }
        Ok(Self { mesh: mesh.into() })
    }

    /// Reads a mesh file: .obj, .gltf, .glb, .ply, .stl or .off.
    #[classmethod]
    fn read(_class: &Bound<'_, PyType>, py: Python<'_>, path: PathBuf) -> Result<Self, Failure> {
        let mesh = py.detach(|| io::read(path))?;
        Ok(Self { mesh: mesh.into() })
    }

    /// Reads the content of a mesh file. `format` is its extension, such as "ply".
    #[classmethod]
    fn from_bytes(_class: &Bound<'_, PyType>, py: Python<'_>, data: &[u8], format: &str) -> Result<Self, Failure> {
        let format = parse_format(format)?;
        let mesh = py.detach(|| io::read_bytes(format, data)).map_err(Failure::input)?;
        Ok(Self { mesh: mesh.into() })
    }

    /// Converts a `trimesh.Trimesh`, or any object with `vertices` and `faces`.
    #[classmethod]
    fn from_trimesh(_class: &Bound<'_, PyType>, mesh: &Bound<'_, PyAny>) -> Result<Self, Failure> {
        Ok(Self { mesh: mesh_of(mesh)? })
    }

    /// Converts to a `trimesh.Trimesh` of the same surface.
    fn to_trimesh<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        slf.py().import("isochore._trimesh")?.call_method1("to_trimesh", (slf,))
    }

    /// Returns the same surface with the coincident vertices of open edges merged.
    fn welded(&self, py: Python<'_>) -> Self {
        Self { mesh: py.detach(|| TriMesh::clone(&self.mesh).welded_at_boundary().into()) }
    }

    /// Splits vertices so that each has one combination of attributes. Returns the mesh vertex of
    /// each split vertex, and triangles of split vertices.
    fn split_at_seams<'py>(&self, py: Python<'py>) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyAny>)> {
        let SplitVertices { vertices, triangles, .. } = py.detach(|| SplitVertices::of(&self.mesh));
        let count = triangles.len();
        let triangles = cast_vec::<[u32; 3], u32>(triangles).into_pyarray(py).reshape([count, 3])?;
        Ok((vertices.into_pyarray(py).into_any(), triangles.into_any()))
    }

    /// Writes a mesh file in the format that the extension selects.
    fn write(&self, py: Python<'_>, path: PathBuf) -> Result<(), Failure> {
        Ok(py.detach(|| io::write(path, &self.mesh))?)
    }

    /// Returns the content of a mesh file. `format` is its extension, such as "ply".
    fn to_bytes<'py>(&self, py: Python<'py>, format: &str) -> Result<Bound<'py, PyBytes>, Failure> {
        let format = parse_format(format)?;
        let mut bytes = Vec::new();
        py.detach(|| io::write_to(format, &self.mesh, &mut bytes))?;
        Ok(PyBytes::new(py, &bytes))
    }

    #[getter]
    fn positions<'py>(slf: &Bound<'py, Self>) -> Bound<'py, PyAny> {
        let positions = &slf.get().mesh.positions;
        view::<f64>(slf.clone().into_any(), cast_slice(positions), &[positions.len(), 3])
    }

    #[getter]
    fn triangles<'py>(slf: &Bound<'py, Self>) -> Bound<'py, PyAny> {
        let triangles = &slf.get().mesh.triangles;
        view(slf.clone().into_any(), triangles.as_flattened(), &[triangles.len(), 3])
    }

    #[getter]
    fn uvs<'py>(slf: &Bound<'py, Self>) -> Vec<Bound<'py, PyAny>> {
        let set = |uvs: &Vec<[Vec2; 3]>| {
            view::<f32>(slf.clone().into_any(), cast_slice(uvs.as_flattened()), &[uvs.len(), 3, 2])
        };
        slf.get().mesh.corner.uvs.iter().map(set).collect()
    }

    #[getter]
    fn normals<'py>(slf: &Bound<'py, Self>) -> Option<Bound<'py, PyAny>> {
        let normals = &slf.get().mesh.corner.normals;
        let owner = slf.clone().into_any();
        (!normals.is_empty()).then(|| view::<f32>(owner, cast_slice(normals.as_flattened()), &[normals.len(), 3, 3]))
    }

    #[getter]
    fn colors<'py>(slf: &Bound<'py, Self>) -> Option<Bound<'py, PyAny>> {
        let colors = &slf.get().mesh.vertex.colors;
        let owner = slf.clone().into_any();
        (!colors.is_empty()).then(|| view::<f64>(owner, cast_slice(colors), &[colors.len(), 4]))
    }

    #[getter]
    fn corner_colors<'py>(slf: &Bound<'py, Self>) -> Option<Bound<'py, PyAny>> {
        let colors = &slf.get().mesh.corner.colors;
        let owner = slf.clone().into_any();
        (!colors.is_empty()).then(|| view::<f64>(owner, cast_slice(colors.as_flattened()), &[colors.len(), 3, 4]))
    }

    #[getter]
    fn materials(&self) -> Vec<&str> {
        self.mesh.materials.iter().map(String::as_str).collect()
    }

    #[getter]
    fn triangle_materials<'py>(slf: &Bound<'py, Self>) -> Option<Bound<'py, PyAny>> {
        let numbers = &slf.get().mesh.triangle_materials;
        (!numbers.is_empty()).then(|| view(slf.clone().into_any(), numbers, &[numbers.len()]))
    }

    #[getter]
    fn skin<'py>(&self, py: Python<'py>) -> PyResult<Option<(Bound<'py, PyAny>, Bound<'py, PyAny>)>> {
        let SkinTable { per_vertex, joints, weights } = py.detach(|| self.mesh.vertex.skin_table());
        if per_vertex == 0 {
            return Ok(None);
        }
        let shape = [self.mesh.positions.len(), per_vertex];
        Ok(Some((
            joints.into_pyarray(py).reshape(shape)?.into_any(),
            weights.into_pyarray(py).reshape(shape)?.into_any(),
        )))
    }

    #[getter]
    fn volume(&self, py: Python<'_>) -> f64 {
        py.detach(|| self.mesh.volume())
    }

    #[getter]
    fn area(&self, py: Python<'_>) -> f64 {
        py.detach(|| self.mesh.area())
    }

    #[getter]
    fn bounds<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let bounds = py.detach(|| self.mesh.bounds());
        points_to_array(py, vec![bounds.min, bounds.max])
    }

    #[getter]
    fn is_closed(&self, py: Python<'_>) -> bool {
        py.detach(|| ClosedMesh::new(&self.mesh).is_ok())
    }

    /// Returns the indices of the triangles that intersect other triangles.
    #[pyo3(signature = (*, progress = None))]
    fn self_intersections<'py>(
        &self,
        py: Python<'py>,
        progress: Option<&Bound<'py, PyAny>>,
    ) -> Result<Bound<'py, PyArray1<u32>>, Failure> {
        let found = watched(py, progress, |monitor| Ok(SelfIntersections::of(&self.mesh, monitor)?))?;
        Ok(found.triangles().to_vec().into_pyarray(py))
    }

    /// Returns the mesh itself, because it is immutable.
    fn __copy__(slf: PyRef<'_, Self>) -> PyRef<'_, Self> {
        slf
    }

    fn __deepcopy__<'py>(slf: PyRef<'py, Self>, _memo: &Bound<'_, PyAny>) -> PyRef<'py, Self> {
        slf
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<(Bound<'py, PyAny>, (PickledMesh,))> {
        let restore = py.get_type::<Self>().getattr("_restored")?;
        Ok((restore, (py.detach(|| PickledMesh::of(&self.mesh)),)))
    }

    #[classmethod]
    fn _restored(_class: &Bound<'_, PyType>, py: Python<'_>, pickled: PickledMesh) -> Result<Self, Failure> {
        Ok(Self { mesh: py.detach(|| pickled.restored())?.into() })
    }

    fn __repr__(&self) -> String {
        format!("Mesh({} vertices, {} triangles)", self.mesh.positions.len(), self.mesh.triangles.len())
    }
}

/// Returns the mesh of `object`, which may belong to another library.
pub(crate) fn mesh_of(object: &Bound<'_, PyAny>) -> Result<Arc<TriMesh>, Failure> {
    if let Ok(mesh) = object.cast::<Mesh>() {
        return Ok(Arc::clone(&mesh.get().mesh));
    }
    let read = object.py().import("isochore._trimesh")?.call_method1("from_trimesh", (object,))?;
    let mesh = read.cast::<Mesh>().map_err(PyErr::from)?;
    Ok(Arc::clone(&mesh.get().mesh))
}

fn geometry(positions: &Bound<'_, PyAny>, indices: &Bound<'_, PyAny>) -> Result<TriMesh, Failure> {
    let positions = contiguous::<f64>(positions)?;
    let mesh = TriMesh::new(points("positions", &positions)?.to_vec(), triangles(indices)?);
    positions.py().detach(|| mesh.check_valid())?;
    Ok(mesh)
}

fn parse_format(name: &str) -> Result<Format, Failure> {
    Format::of_extension(name.trim_start_matches('.'))
        .ok_or_else(|| Failure::Argument(format!("`{name}` is not a mesh format; use obj, gltf, glb, ply, stl or off")))
}
