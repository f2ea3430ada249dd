//! Triangle meshes whose arrays NumPy sees without copies.

use std::path::PathBuf;

use bytemuck::cast_slice;
use glam::{DVec2, DVec4};
use isochore_mesh::{
    ClosedMesh, SelfIntersections, TriMesh,
    io::{self, Format},
};
use numpy::{IntoPyArray, PyArray1, PyUntypedArrayMethods};
use pyo3::{
    prelude::*,
    types::{IntoPyDict, PyBytes, PyType},
};

use crate::{
    arrays::{check_shape, contiguous, finite_numbers, points, triangles, view},
    error::Failure,
    watch::watched,
};

/// A triangle mesh. It never changes: its arrays are read-only views, which keep it alive.
#[pyclass(frozen, module = "isochore")]
#[derive(Debug)]
pub(crate) struct Mesh {
    pub(crate) mesh: TriMesh,
}

#[pymethods]
impl Mesh {
    #[new]
    #[pyo3(signature = (positions, triangles, *, uvs = None, colors = None))]
    fn new(
        positions: &Bound<'_, PyAny>,
        triangles: &Bound<'_, PyAny>,
        uvs: Option<Vec<Bound<'_, PyAny>>>,
        colors: Option<&Bound<'_, PyAny>>,
    ) -> Result<Self, Failure> {
        let mut mesh = geometry(positions, triangles)?;
        for uvs in uvs.unwrap_or_default() {
            let uvs = contiguous::<f64>(&uvs)?;
            check_shape("uvs", uvs.shape(), &[Some(mesh.triangles.len()), Some(3), Some(2)])?;
            mesh.corner.uvs.push(cast_slice::<f64, [DVec2; 3]>(finite_numbers("uvs", &uvs)?).to_vec());
        }
        if let Some(colors) = colors {
            let colors = contiguous::<f64>(colors)?;
            check_shape("colors", colors.shape(), &[Some(mesh.positions.len()), Some(4)])?;
            mesh.vertex.colors =
                finite_numbers("colors", &colors)?.as_chunks::<4>().0.iter().map(|c| DVec4::from(*c)).collect();
        }
        Ok(Self { mesh })
    }

    /// Reads a mesh file: .obj .gltf .glb .ply .stl .off.
    #[classmethod]
    fn read(_class: &Bound<'_, PyType>, py: Python<'_>, path: PathBuf) -> Result<Self, Failure> {
        let mesh = py.detach(|| io::read(path))?;
        Ok(Self { mesh })
    }

    /// Reads a mesh from the bytes of a file in `format`: "obj", "glb", ….
    #[classmethod]
    fn from_bytes(_class: &Bound<'_, PyType>, py: Python<'_>, data: &[u8], format: &str) -> Result<Self, Failure> {
        let format = parse_format(format)?;
        let mesh = py.detach(|| io::read_bytes(format, data)).map_err(Failure::input)?;
        Ok(Self { mesh })
    }

    /// The mesh in an object that has `vertices` and `faces`, such as a `trimesh.Trimesh`.
    #[classmethod]
    fn from_trimesh(_class: &Bound<'_, PyType>, mesh: &Bound<'_, PyAny>) -> Result<Self, Failure> {
        Ok(Self { mesh: geometry(&mesh.getattr("vertices")?, &mesh.getattr("faces")?)? })
    }

    /// A `trimesh.Trimesh` with the same vertices and faces in the same order.
    fn to_trimesh<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        let py = slf.py();
        let options = [("process", false)].into_py_dict(py)?;
        let arrays = (Self::positions(slf), Self::triangles(slf));
        py.import("trimesh")?.getattr("Trimesh")?.call(arrays, Some(&options))
    }

    /// Writes a mesh file in the format of its extension, whole or not at all.
    fn write(&self, py: Python<'_>, path: PathBuf) -> Result<(), Failure> {
        Ok(py.detach(|| io::write(path, &self.mesh))?)
    }

    /// The bytes of a file in `format`: "obj", "glb", ….
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
        let set = |uvs: &Vec<[DVec2; 3]>| {
            view::<f64>(slf.clone().into_any(), cast_slice(uvs.as_flattened()), &[uvs.len(), 3, 2])
        };
        slf.get().mesh.corner.uvs.iter().map(set).collect()
    }

    #[getter]
    fn colors<'py>(slf: &Bound<'py, Self>) -> Option<Bound<'py, PyAny>> {
        let colors = &slf.get().mesh.vertex.colors;
        let owner = slf.clone().into_any();
        (!colors.is_empty()).then(|| view::<f64>(owner, cast_slice(colors), &[colors.len(), 4]))
    }

    #[getter]
    fn volume(&self) -> f64 {
        self.mesh.volume()
    }

    #[getter]
    fn area(&self) -> f64 {
        self.mesh.area()
    }

    #[getter]
    fn bounds(&self) -> [[f64; 3]; 2] {
        let bounds = self.mesh.bounds();
        [bounds.min.to_array(), bounds.max.to_array()]
    }

    #[getter]
    fn is_closed(&self) -> bool {
        ClosedMesh::new(&self.mesh).is_ok()
    }

    /// Indices of the triangles that intersect others, exactly.
    #[pyo3(signature = (*, progress = None))]
    fn self_intersections<'py>(
        &self,
        py: Python<'py>,
        progress: Option<&Bound<'py, PyAny>>,
    ) -> Result<Bound<'py, PyArray1<u32>>, Failure> {
        let found = watched(py, progress, |monitor| Ok(SelfIntersections::of(&self.mesh, monitor)?))?;
        Ok(found.triangles().to_vec().into_pyarray(py))
    }

    fn __repr__(&self) -> String {
        format!("Mesh({} vertices, {} triangles)", self.mesh.positions.len(), self.mesh.triangles.len())
    }
}

/// The mesh that `object` is, or that its `vertices` and `faces` make.
pub(crate) fn mesh_of(object: &Bound<'_, PyAny>) -> Result<TriMesh, Failure> {
    if let Ok(mesh) = object.cast::<Mesh>() {
        return Ok(mesh.get().mesh.clone());
    }
    geometry(&object.getattr("vertices")?, &object.getattr("faces")?)
}

fn geometry(positions: &Bound<'_, PyAny>, indices: &Bound<'_, PyAny>) -> Result<TriMesh, Failure> {
    let positions = contiguous::<f64>(positions)?;
    let mesh = TriMesh::new(points("positions", &positions)?.to_vec(), triangles(indices)?);
    mesh.check_valid()?;
    Ok(mesh)
}

fn parse_format(name: &str) -> Result<Format, Failure> {
    Format::of_extension(name.trim_start_matches('.')).ok_or_else(|| {
        Failure::Argument(format!("`{name}` is no format of meshes: take one of obj, gltf, glb, ply, stl, off"))
    })
}
