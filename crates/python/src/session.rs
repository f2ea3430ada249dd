//! Sculpting sessions.

mod dicts;

use std::{
    ops::Range,
    sync::{
        Arc, Mutex, MutexGuard, PoisonError,
        atomic::{AtomicUsize, Ordering},
    },
};

use bytemuck::Pod;
use glam::DVec3;
use isochore_field::Pose;
use isochore_mesh::{NONE, Origin};
use isochore_sculpt::{
    recipe::Key,
    session::{self, InteractiveRefinement, NormalWeights, RenderBuffers, SessionError, SessionOptions, StrokeOptions},
};
use numpy::{Element, IntoPyArray};
use pyo3::{exceptions::PyBufferError, prelude::*, sync::MutexExt, types::PyDict};

use crate::{
    arrays::{index, indices, numbers, points_to_array, view},
    error::Failure,
    keys,
    mesh::{Mesh, mesh_of},
    tool::Tool,
};

/// A mesh that strokes deform one after another, with undo and redo.
#[pyclass(frozen, module = "isochore")]
#[derive(Debug)]
pub(crate) struct Session {
    session: Mutex<session::Session>,
    /// Number of buffer views that NumPy holds.
    views: Arc<AtomicUsize>,
}

/// Owner of a buffer view. While one is alive, the session cannot change.
#[pyclass(frozen)]
#[derive(Debug)]
struct Hold {
    _session: Py<Session>,
    views: Arc<AtomicUsize>,
}

impl Drop for Hold {
    fn drop(&mut self) {
        self.views.fetch_sub(1, Ordering::Release);
    }
}

#[pymethods]
impl Session {
    #[new]
    #[pyo3(signature = (mesh, *, step = None, undo_bytes = None, normals = "area", mask = None, lock = true))]
    fn new(
        py: Python<'_>,
        mesh: &Bound<'_, PyAny>,
        step: Option<f64>,
        undo_bytes: Option<usize>,
        normals: &str,
        mask: Option<&Bound<'_, PyAny>>,
        lock: bool,
    ) -> Result<Self, Failure> {
        let mesh = mesh_of(mesh)?;
        let default = SessionOptions::default();
        let options = SessionOptions {
            step: step.unwrap_or(default.step),
            undo_bytes: undo_bytes.unwrap_or(default.undo_bytes),
            normals: match normals {
                "area" => NormalWeights::Area,
                "angle" => NormalWeights::Angle,
                other => {
                    return Err(Failure::Argument(format!("normals must be \"area\" or \"angle\", not {other:?}")));
                }
            },
            mask: mask.map_or(Ok(default.mask), |mask| keys::mask(mask, mesh.positions.len()))?,
            lock,
            target: default.target,
        };
        let session = py.detach(|| session::Session::open(mesh, options)).map_err(Failure::input)?;
        Ok(Self { session: Mutex::new(session), views: Arc::default() })
    }

    #[expect(clippy::too_many_arguments, reason = "they are keyword arguments in Python")]
    #[pyo3(signature = (tool, *, refine = true, longest_edge = None, deviation = None, max_triangles = None, keep = Vec::new()))]
    fn begin_stroke(
        &self,
        py: Python<'_>,
        tool: &Bound<'_, Tool>,
        refine: bool,
        longest_edge: Option<f64>,
        deviation: Option<f64>,
        max_triangles: Option<usize>,
        keep: Vec<([f64; 3], f64)>,
    ) -> Result<(), Failure> {
        let default = InteractiveRefinement::default();
        let refinement = InteractiveRefinement {
            longest: longest_edge,
            deviation,
            max_triangles: max_triangles.unwrap_or(default.max_triangles),
            keep: keep.into_iter().map(|(center, radius)| (center.into(), radius)).collect(),
            ..default
        };
        let options = StrokeOptions { refine: refine.then_some(refinement) };
        let tool = &tool.get().tool;
        self.change(py, |session| session.begin_stroke(tool, options).map_err(Failure::input))
    }

    #[pyo3(signature = (at, *, rotate = [0.0, 0.0, 1.0, 0.0], time = 0.0))]
    fn move_to<'py>(
        &self,
        py: Python<'py>,
        at: [f64; 3],
        rotate: [f64; 4],
        time: f64,
    ) -> Result<Bound<'py, PyDict>, Failure> {
        let key = Key { at, rotate };
        let receipt = self.change(py, |session| {
            session.move_to_key(&key, time).map_err(|error| match error {
                SessionError::Pose(error) => Failure::Argument(error.to_string()),
                error => Failure::input(error),
            })
        })?;
        Ok(dicts::move_receipt(py, &receipt)?)
    }

    fn end_stroke<'py>(&self, py: Python<'py>) -> Result<Bound<'py, PyDict>, Failure> {
        let receipt = self.change(py, |session| session.end_stroke().map_err(Failure::input))?;
        Ok(dicts::stroke_receipt(py, &receipt)?)
    }

    fn cancel_stroke(&self, py: Python<'_>) -> Result<(), Failure> {
        self.change(py, |session| session.cancel_stroke().map_err(Failure::input))
    }

    fn undo(&self, py: Python<'_>) -> Result<bool, Failure> {
        self.change(py, |session| session.undo().map_err(Failure::input))
    }

    fn redo(&self, py: Python<'_>) -> Result<bool, Failure> {
        self.change(py, |session| session.redo().map_err(Failure::input))
    }

    /// Excludes the edges at the given vertices from splits, collapses and flips.
    fn freeze_edges(&self, py: Python<'_>, vertices: &Bound<'_, PyAny>) -> Result<(), Failure> {
        let vertices = indices("vertices", vertices)?;
        let vertices = numbers("vertices", &vertices)?.iter().map(|&vertex| index("vertices", vertex));
        let vertices: Vec<u32> = vertices.collect::<Result<_, _>>()?;
        self.change(py, |session| {
            session.freeze_edges(&vertices).map_err(|error| Failure::Argument(format!("vertices: {error}")))
        })
    }

    /// Returns the strokes that are in effect as a recipe.
    fn log<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let text = self.ask(py, |session| session.log().to_json());
        py.import("json")?.call_method1("loads", (text,))
    }

    /// Returns the surface as a mesh and the session vertex of each of its vertices.
    #[pyo3(signature = (*, lock = true))]
    fn export<'py>(&self, py: Python<'py>, lock: bool) -> PyResult<(Mesh, Bound<'py, PyAny>)> {
        let exported = self.ask(py, |session| session.export(lock));
        let vertices = exported.vertices.into_pyarray(py).into_any();
        Ok((Mesh { mesh: exported.mesh.into() }, vertices))
    }

    #[getter]
    fn positions<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        Self::rows(slf, |buffers| buffers.positions)
    }

    #[getter]
    fn normals<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        Self::rows(slf, |buffers| buffers.normals)
    }

    #[getter]
    fn uvs<'py>(slf: &Bound<'py, Self>) -> PyResult<Vec<Bound<'py, PyAny>>> {
        let sets = slf.get().ask(slf.py(), |session| session.buffers().uvs.len());
        (0..sets).map(|set| Self::rows(slf, |buffers| buffers.uvs[set].as_slice())).collect()
    }

    #[getter]
    fn colors<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        Self::rows(slf, |buffers| buffers.colors)
    }

    #[getter]
    fn triangles<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        Self::rows(slf, |buffers| buffers.indices)
    }

    /// Returns the buffer ranges that have changed since the previous call.
    fn take_changes<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let changes = py.detach(|| self.lock().take_changes());
        dicts::changes(py, changes)
    }

    fn pick<'py>(
        &self,
        py: Python<'py>,
        origin: [f64; 3],
        direction: [f64; 3],
    ) -> PyResult<Option<Bound<'py, PyDict>>> {
        let hit = self.ask(py, |session| session.pick(origin.into(), direction.into()));
        hit.map(|hit| dicts::hit(py, &hit)).transpose()
    }

    fn closest_point<'py>(&self, py: Python<'py>, point: [f64; 3]) -> PyResult<Option<Bound<'py, PyDict>>> {
        let hit = self.ask(py, |session| session.closest_point(point.into()));
        hit.map(|hit| dicts::hit(py, &hit)).transpose()
    }

    /// Returns the vertices within the support of a tool at a pose.
    #[pyo3(signature = (tool, at, *, rotate = [0.0, 0.0, 1.0, 0.0]))]
    fn vertices_in_reach<'py>(
        &self,
        py: Python<'py>,
        tool: &Bound<'_, Tool>,
        at: [f64; 3],
        rotate: [f64; 4],
    ) -> Result<Bound<'py, PyAny>, Failure> {
        let (tool, pose) = (&tool.get().tool, pose(at, rotate)?);
        let vertices = self.ask(py, |session| {
            let mut vertices = Vec::new();
            session.vertices_in_reach(tool, &pose, &mut vertices);
            vertices
        });
        Ok(vertices.into_pyarray(py).into_any())
    }

    /// Returns points around a tool and their displacements by a move.
    #[pyo3(signature = (
        tool, start, end, *, start_rotate = [0.0, 0.0, 1.0, 0.0], end_rotate = [0.0, 0.0, 1.0, 0.0], per_side = 12
    ))]
    #[expect(clippy::too_many_arguments, reason = "they are keyword arguments in Python")]
    fn preview<'py>(
        &self,
        py: Python<'py>,
        tool: &Bound<'_, Tool>,
        start: [f64; 3],
        end: [f64; 3],
        start_rotate: [f64; 4],
        end_rotate: [f64; 4],
        per_side: usize,
    ) -> Result<(Bound<'py, PyAny>, Bound<'py, PyAny>), Failure> {
        let (start, end) = (pose(start, start_rotate)?, pose(end, end_rotate)?);
        let tool = &tool.get().tool;
        let arrows = self.ask(py, |session| session.preview(tool, &start, &end, per_side)).map_err(Failure::input)?;
        let (points, shifts): (Vec<DVec3>, Vec<DVec3>) =
            arrows.into_iter().map(|arrow| (arrow.point, arrow.shift)).unzip();
        Ok((points_to_array(py, points)?.into_any(), points_to_array(py, shifts)?.into_any()))
    }

    /// Volumes that the stroke in progress has moved outward and inward.
    #[getter]
    fn moved_volume(&self, py: Python<'_>) -> (f64, f64) {
        let moved = self.ask(py, session::Session::moved_volume);
        (moved.outward, moved.inward)
    }

    #[getter]
    fn is_stroke_under_way(&self, py: Python<'_>) -> bool {
        self.ask(py, session::Session::is_stroke_under_way)
    }

    #[getter]
    fn volume(&self, py: Python<'_>) -> Option<f64> {
        self.ask(py, session::Session::volume)
    }

    #[getter]
    fn history<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let history = self.ask(py, session::Session::history);
        dicts::history(py, &history)
    }

    /// Returns, for each vertex of the opened mesh, the vertex that represents it.
    fn vertex_map<'py>(&self, py: Python<'py>) -> Bound<'py, PyAny> {
        self.ask(py, session::Session::vertex_map).into_pyarray(py).into_any()
    }

    /// Returns the vertex of each render vertex.
    fn vertices_of_render_vertices<'py>(&self, py: Python<'py>) -> Bound<'py, PyAny> {
        let vertices: Vec<u32> =
            self.ask(py, |session| render_vertices(session).map(|render| session.vertex_of(render)).collect());
        vertices.into_pyarray(py).into_any()
    }

    /// Returns, for each render vertex, the triangle of the opened mesh that provides its
    /// attributes, and barycentric coordinates.
    fn origins<'py>(&self, py: Python<'py>) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyAny>)> {
        let no_origin = Origin { triangle: NONE, weights: DVec3::ZERO };
        let (triangles, weights): (Vec<u32>, Vec<DVec3>) = self.ask(py, |session| {
            let origins = render_vertices(session).map(|render| session.origin_of(render).unwrap_or(no_origin));
            origins.map(|origin| (origin.triangle, origin.weights)).unzip()
        });
        Ok((triangles.into_pyarray(py).into_any(), points_to_array(py, weights)?.into_any()))
    }

    fn __repr__(&self, py: Python<'_>) -> String {
        let (vertices, triangles) = self.ask(py, |session| (session.vertex_count(), session.triangle_count()));
        format!("Session({vertices} vertices, {triangles} triangles)")
    }
}

impl Session {
    /// Locks the session. Call it without the global interpreter lock, which the current owner may
    /// be waiting for.
    fn lock(&self) -> MutexGuard<'_, session::Session> {
        self.session.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Queries the session without the global interpreter lock.
    fn ask<T: Send>(&self, py: Python<'_>, question: impl FnOnce(&session::Session) -> T + Send) -> T {
        py.detach(|| question(&self.lock()))
    }

    /// Changes the session without the global interpreter lock.
    ///
    /// # Errors
    /// `BufferError` if a view of a buffer exists.
    fn change<T: Send>(
        &self,
        py: Python<'_>,
        change: impl FnOnce(&mut session::Session) -> Result<T, Failure> + Send,
    ) -> Result<T, Failure> {
        py.detach(|| {
            let mut session = self.lock();
            if self.views.load(Ordering::Acquire) > 0 {
                return Err(Failure::Raised(PyBufferError::new_err(
                    "views of the session's buffers are still held; copy or delete them before changing the session",
                )));
            }
            change(&mut session)
        })
    }

    /// Creates a view of the rows of a buffer. The session cannot change while the view is alive.
    fn rows<'py, T: Element + Pod, const N: usize>(
        slf: &Bound<'py, Self>,
        buffer: impl for<'a> FnOnce(RenderBuffers<'a>) -> &'a [[T; N]],
    ) -> PyResult<Bound<'py, PyAny>> {
        let this = slf.get();
        let session = this.session.lock_py_attached(slf.py()).unwrap_or_else(PoisonError::into_inner);
        this.views.fetch_add(1, Ordering::AcqRel);
        let hold = Hold { _session: slf.clone().unbind(), views: Arc::clone(&this.views) };
        let rows = buffer(session.buffers());
        Ok(view(Bound::new(slf.py(), hold)?.into_any(), rows.as_flattened(), &[rows.len(), N]))
    }
}

fn render_vertices(session: &session::Session) -> Range<u32> {
    0..session.buffers().positions.len() as u32
}

/// Converts a position and an axis with an angle in degrees to a pose.
fn pose(at: [f64; 3], rotate: [f64; 4]) -> Result<Pose, Failure> {
    Key { at, rotate }.pose().map_err(|error| Failure::Argument(error.to_string()))
}
