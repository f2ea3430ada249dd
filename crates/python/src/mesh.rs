//! Triangle meshes whose arrays NumPy sees without copies.

use std::{path::PathBuf, sync::Arc};

use bytemuck::cast_slice;
use glam::{DVec2, DVec3, DVec4};
use isochore_mesh::{
    ClosedMesh, SelfIntersections, SkinTable, TriMesh,
    io::{self, Format},
};
use numpy::{IntoPyArray, PyArray1, PyArrayMethods, PyUntypedArrayMethods};
use pyo3::{
    exceptions::PyTypeError,
    prelude::*,
    types::{IntoPyDict, PyBytes, PyType},
};

use crate::{
    arrays::{check_shape, contiguous, finite_numbers, index, indices, numbers, points, triangles, view},
    error::Failure,
    watch::watched,
};

/// A triangle mesh. It never changes: its arrays are read-only views, which keep it alive.
#[pyclass(frozen, module = "isochore")]
#[derive(Debug)]
pub(crate) struct Mesh {
    pub(crate) mesh: Arc<TriMesh>,
}

#[pymethods]
impl Mesh {
    #[new]
    #[pyo3(signature = (positions, triangles, *, uvs = None, normals = None, colors = None, skin = None))]
    fn new(
        positions: &Bound<'_, PyAny>,
        triangles: &Bound<'_, PyAny>,
        uvs: Option<Vec<Bound<'_, PyAny>>>,
        normals: Option<&Bound<'_, PyAny>>,
        colors: Option<&Bound<'_, PyAny>>,
        skin: Option<(Bound<'_, PyAny>, Bound<'_, PyAny>)>,
    ) -> Result<Self, Failure> {
        let mut mesh = geometry(positions, triangles)?;
        for uvs in uvs.unwrap_or_default() {
            let uvs = contiguous::<f64>(&uvs)?;
            check_shape("uvs", uvs.shape(), &[Some(mesh.triangles.len()), Some(3), Some(2)])?;
            mesh.corner.uvs.push(cast_slice::<f64, [DVec2; 3]>(finite_numbers("uvs", &uvs)?).to_vec());
        }
        if let Some(normals) = normals {
            let normals = contiguous::<f64>(normals)?;
            check_shape("normals", normals.shape(), &[Some(mesh.triangles.len()), Some(3), Some(3)])?;
            let given: &[[DVec3; 3]] = cast_slice(numbers("normals", &normals)?);
            let unit = |(triangle, corners): (usize, &[DVec3; 3])| match corners.map(DVec3::try_normalize) {
                [Some(a), Some(b), Some(c)] => Ok([a, b, c].map(|normal| normal.as_vec3())),
                _ => Err(Failure::Argument(format!("normals: one of triangle {triangle} has no direction"))),
            };
            mesh.corner.normals = given.iter().enumerate().map(unit).collect::<Result<_, _>>()?;
        }
        if let Some(colors) = colors {
            let colors = contiguous::<f64>(colors)?;
            check_shape("colors", colors.shape(), &[Some(mesh.positions.len()), Some(4)])?;
            mesh.vertex.colors =
                finite_numbers("colors", &colors)?.as_chunks::<4>().0.iter().map(|c| DVec4::from(*c)).collect();
        }
        if let Some((joints, weights)) = skin {
            let joints = indices("joints", &joints)?;
            let weights = contiguous::<f64>(&weights)?;
            check_shape("joints", joints.shape(), &[Some(mesh.positions.len()), None])?;
            check_shape("weights", weights.shape(), &[Some(mesh.positions.len()), Some(joints.shape()[1])])?;
            let columns = joints.shape()[1];
            let joints = numbers("joints", &joints)?.iter().map(|&joint| index("joints", joint));
            let joints: Vec<u32> = joints.collect::<Result<_, _>>()?;
            let weights = numbers("weights", &weights)?;
            let set = mesh.vertex.set_skin_table(mesh.positions.len(), columns, &joints, weights);
            set.map_err(|error| Failure::Argument(error.to_string()))?;
        }
        Ok(Self { mesh: mesh.into() })
    }

    /// Reads a mesh file: .obj .gltf .glb .ply .stl .off.
    #[classmethod]
    fn read(_class: &Bound<'_, PyType>, py: Python<'_>, path: PathBuf) -> Result<Self, Failure> {
        let mesh = py.detach(|| io::read(path))?;
        Ok(Self { mesh: mesh.into() })
    }

    /// Reads a mesh from the bytes of a file in `format`: "obj", "glb", ….
    #[classmethod]
    fn from_bytes(_class: &Bound<'_, PyType>, py: Python<'_>, data: &[u8], format: &str) -> Result<Self, Failure> {
        let format = parse_format(format)?;
        let mesh = py.detach(|| io::read_bytes(format, data)).map_err(Failure::input)?;
        Ok(Self { mesh: mesh.into() })
    }

    /// The mesh in an object that has `vertices` and `faces`, such as a `trimesh.Trimesh`.
    #[classmethod]
    fn from_trimesh(_class: &Bound<'_, PyType>, mesh: &Bound<'_, PyAny>) -> Result<Self, Failure> {
        Ok(Self { mesh: mesh_of(mesh)? })
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
    fn skin<'py>(&self, py: Python<'py>) -> PyResult<Option<(Bound<'py, PyAny>, Bound<'py, PyAny>)>> {
        let SkinTable { per_vertex, joints, weights } = self.mesh.vertex.skin_table();
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
pub(crate) fn mesh_of(object: &Bound<'_, PyAny>) -> Result<Arc<TriMesh>, Failure> {
    if let Ok(mesh) = object.cast::<Mesh>() {
        return Ok(Arc::clone(&mesh.get().mesh));
    }
    let (Ok(vertices), Ok(faces)) = (object.getattr("vertices"), object.getattr("faces")) else {
        let text = format!("a mesh, or what has vertices and faces, is wanted, not {}", object.get_type().name()?);
        return Err(Failure::Raised(PyTypeError::new_err(text)));
    };
    Ok(geometry(&vertices, &faces)?.into())
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
