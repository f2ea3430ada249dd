//! Signed distances to a mesh.

use glam::DVec3;
use isochore_mesh::{Distance, DistanceBlock, DistanceFieldOptions, LANES, Padding, PointBlock};
use numpy::{IntoPyArray, PyArray1, PyArray2};
use pyo3::prelude::*;

use crate::{
    arrays::{contiguous, points, points_to_array, view},
    error::Failure,
    mesh::mesh_of,
    watch::watched,
};

/// Default padding, in cells. The spline reflects at the border of the grid, and the resulting
/// error decays by a factor of 0.27 per cell. A smaller value spoils the gradient at the surface; a
/// larger one costs memory.
const PADDING_CELLS: usize = 8;

/// Signed distances to a mesh on a grid, negative inside, with cubic interpolation.
#[pyclass(frozen, module = "isochore")]
#[derive(Debug)]
pub(crate) struct DistanceField {
    field: isochore_mesh::DistanceField,
}

#[pymethods]
impl DistanceField {
    #[new]
    #[pyo3(signature = (mesh, resolution = 64, *, padding = None, band = f64::INFINITY, progress = None))]
    fn new(
        py: Python<'_>,
        mesh: &Bound<'_, PyAny>,
        resolution: usize,
        padding: Option<f64>,
        band: f64,
        progress: Option<&Bound<'_, PyAny>>,
    ) -> Result<Self, Failure> {
        let mesh = mesh_of(mesh)?;
        let padding = padding.map_or(Padding::Cells(PADDING_CELLS), Padding::Length);
        let options = DistanceFieldOptions { resolution, padding, band, ..Default::default() };
        let field = watched(py, progress, |monitor| Ok(isochore_mesh::DistanceField::new(&mesh, &options, monitor)?))?;
        Ok(Self { field })
    }

    #[getter]
    fn samples<'py>(slf: &Bound<'py, Self>) -> Bound<'py, PyAny> {
        let field = &slf.get().field;
        let [nx, ny, nz] = field.grid().dims;
        view(slf.clone().into_any(), field.samples(), &[nz, ny, nx])
    }

    #[getter]
    fn origin(&self) -> [f64; 3] {
        self.field.grid().origin.to_array()
    }

    #[getter]
    fn cell(&self) -> f64 {
        self.field.grid().cell
    }

    #[getter]
    fn sample_error(&self) -> f64 {
        self.field.sample_error()
    }

    /// Returns distances (N,) and gradients (N, 3) at points (N, 3).
    #[allow(clippy::type_complexity, reason = "two arrays")]
    fn __call__<'py>(
        &self,
        py: Python<'py>,
        array: &Bound<'py, PyAny>,
    ) -> Result<(Bound<'py, PyArray1<f64>>, Bound<'py, PyArray2<f64>>), Failure> {
        let array = contiguous::<f64>(array)?;
        let points = points("points", &array)?;
        let (values, gradients) = py.detach(|| self.sample(points));
        Ok((values.into_pyarray(py), points_to_array(py, gradients)?))
    }

    fn __repr__(&self) -> String {
        let [nx, ny, nz] = self.field.grid().dims;
        format!("DistanceField({nx} × {ny} × {nz} samples, cell {})", self.field.grid().cell)
    }
}

impl DistanceField {
    fn sample(&self, points: &[DVec3]) -> (Vec<f64>, Vec<DVec3>) {
        let mut values = Vec::with_capacity(points.len());
        let mut gradients = Vec::with_capacity(points.len());
        let mut block = DistanceBlock::FAR;
        for chunk in points.chunks(LANES) {
            let mut lanes = PointBlock::splat(chunk[0]);
            chunk.iter().enumerate().for_each(|(lane, &point)| lanes.set(lane, point));
            self.field.sample_into(&lanes, &mut block);
            values.extend_from_slice(&block.value[..chunk.len()]);
            gradients.extend((0..chunk.len()).map(|lane| block.gradient.get(lane)));
        }
        (values, gradients)
    }
}
