//! The sculpting session: a host deforms a mesh stroke by stroke at interactive rates.
//!
//! Terms:
//!
//! - A *stroke* extends from [`begin_stroke`](Session::begin_stroke) to
//!   [`end_stroke`](Session::end_stroke). Each [`move_to`](Session::move_to) in between moves the
//!   tool along a screw from the last pose to the next, so that a fast stroke leaves no separate
//!   dabs. The cost of a move is proportional to the part of the surface that the tool touches.
//! - A *vertex* is a point of the surface. Vertices of the mesh as opened keep their numbers and
//!   move exactly with the flow; inserted vertices follow them. If a collapse removes an inserted
//!   vertex, a later stroke may reuse its number. The same applies to triangles, so the buffers do
//!   not grow with the number of strokes. [`vertex_map`](Session::vertex_map) returns the vertices
//!   that replace collapsed vertices of the mesh as opened.
//! - A *render vertex* is a vertex as seen by the triangles on one side of a seam. The
//!   [buffers](Session::buffers) contain render vertices.
//! - The *origin* of a render vertex is the point of the mesh as opened that its attributes are
//!   taken from.
//! - The *log* is a [recipe](crate::Recipe) of all strokes, which can be
//!   [replayed](crate::replay()) on any mesh or point set.
//!
//! ```
//! use std::sync::Arc;
//!
//! use glam::DVec3;
//! use isochore_field::Pose;
//! use isochore_mesh::{NoProgress, primitives::icosphere};
//! use isochore_sculpt::{Meshes, recipe, session::{Session, SessionOptions, SessionTool, StrokeOptions}};
//!
//! let mut session = Session::open(icosphere(1.0, 4), SessionOptions::default())?;
//! let shape = recipe::ToolShape::Sphere(recipe::Sphere { radius: 0.2 });
//! let brush = recipe::Tool { shape, support: 0.3, profile: recipe::Profile::Quintic, free_form: 0.0 };
//! let brush = Arc::new(SessionTool::new("brush", brush, &Meshes::new(), &NoProgress)?);
//!
//! session.begin_stroke(&brush, StrokeOptions::default())?;
//! for step in 0..5 {
//!     session.move_to(&Pose::at(DVec3::new(0.0, 0.0, 1.0 + 0.05 * f64::from(step))), f64::from(step) / 60.0)?;
//!     let changes = session.take_changes();
//!     let buffers = session.buffers();
//!     assert!(changes.positions.iter().all(|range| range.end as usize <= buffers.positions.len()));
//! }
//! let receipt = session.end_stroke()?;
//! // The change by the method itself, before any lock.
//! assert!(receipt.volume.unwrap().bare().abs() < 1e-3 * session.volume().unwrap());
//! assert!(session.undo()?);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod advection;
mod base_points;
mod buffers;
mod certificate;
mod editing;
mod error;
mod export;
mod history;
mod locking;
mod log;
mod marks;
mod opening;
mod options;
mod origin;
mod path;
mod query;
mod receipt;
mod refinement;
mod sculpting;
mod selection;
mod shading;
mod stroke;
mod supplies;
mod surface;
mod tool;
mod volume;

use std::sync::Arc;

use isochore_field as field;
use isochore_mesh::{Aabb, ClosedMesh, CompensatedSum, NONE, TriMesh};

pub use isochore_field::Sheets;

pub use buffers::{Changes, DirtyRange, RenderBuffers};
pub use error::{HostToolError, OpenError, SessionError};
pub use export::Exported;
pub use log::SessionReplayError;
pub use options::{InteractiveRefinement, NormalWeights, SessionOptions, StrokeOptions};
pub use query::{Arrow, Hit};
pub use receipt::{History, LockSkipped, MoveReceipt, MoveSeconds, StrokeReceipt, StrokeVolume};
pub use supplies::Supplies;
pub use tool::SessionTool;
pub use volume::MovedVolume;

use crate::{
    recipe::{Integrate, InvalidRecipe, Mask, RecipeError},
    scene,
};
use history::Steps;
use log::LoggedStroke;
use stroke::ActiveStroke;
use surface::Surface;

/// A mesh that a host sculpts.
///
/// A session is `Send`: a binding may keep it behind a handle and call it from any one thread at a
/// time. Results have the same bits for any number of threads, and for any history of undone and
/// canceled strokes.
///
/// ```
/// use isochore_mesh::primitives::icosphere;
/// use isochore_sculpt::session::{Session, SessionOptions};
///
/// let session = Session::open(icosphere(1.0, 2), SessionOptions::default())?;
/// assert_eq!((session.vertex_count(), session.triangle_count()), (162, 320));
/// # Ok::<(), isochore_sculpt::session::OpenError>(())
/// ```
#[derive(Debug, Clone)]
pub struct Session {
    options: SessionOptions,
    surface: Surface,
    /// Vertices without triangles, in ascending order.
    loose: Vec<u32>,
    opened_bounds: Aabb,
    /// `None` if the surface is open.
    opened_volume: Option<f64>,
    mask: Option<Arc<field::Mask>>,
    stroke: Option<ActiveStroke>,
    steps: Steps,
}

impl Session {
    /// Opens a session on `mesh`, which must be an oriented manifold surface, closed or open.
    ///
    /// Takes time and memory proportional to the mesh, once: about 400 bytes per triangle.
    ///
    /// # Errors
    /// [`OpenError`], which names the invalid edge, vertex or option.
    pub fn open(mesh: impl Into<Arc<TriMesh>>, options: SessionOptions) -> Result<Self, OpenError> {
        let mesh = mesh.into();
        mesh.check_valid()?;
        check(&options)?;
        let mask = if options.mask == Mask::default() {
            None
        } else {
            Some(Arc::new(scene::mask::mask(&options.mask, Some(&mesh))?))
        };
        let opened_bounds = mesh.bounds();
        let opened_volume = ClosedMesh::new(&mesh).ok().map(|closed| closed.volume());
        let surface = Surface::open(mesh, options.normals)?;
        let loose =
            (0..surface.topology.vertex_count() as u32).filter(|&vertex| surface.topology.outgoing(vertex) == NONE);
        let loose = loose.collect();
        Ok(Self { options, surface, loose, opened_bounds, opened_volume, mask, stroke: None, steps: Steps::default() })
    }

    /// The mesh as opened.
    pub fn opened(&self) -> &TriMesh {
        &self.surface.opened
    }

    /// Undoes the last stroke and restores all bits. Returns false without a stroke to undo,
    /// or undo has forgotten it.
    ///
    /// # Errors
    /// [`SessionError::StrokeUnderWay`].
    ///
    /// ```
    /// # use std::sync::Arc;
    /// # use glam::DVec3;
    /// # use isochore_field::Pose;
    /// # use isochore_mesh::{NoProgress, primitives::icosphere};
    /// # use isochore_sculpt::{Meshes, recipe, session::{Session, SessionOptions, SessionTool, StrokeOptions}};
    /// # let shape = recipe::ToolShape::Sphere(recipe::Sphere { radius: 0.2 });
    /// # let brush = recipe::Tool { shape, support: 0.3, profile: recipe::Profile::Quintic, free_form: 0.0 };
    /// # let brush = Arc::new(SessionTool::new("brush", brush, &Meshes::new(), &NoProgress)?);
    /// let mut session = Session::open(icosphere(1.0, 3), SessionOptions::default())?;
    /// let opened = session.positions().to_vec();
    /// session.begin_stroke(&brush, StrokeOptions::default())?;
    /// session.move_to(&Pose::at(DVec3::Z), 0.0)?;
    /// session.move_to(&Pose::at(1.1 * DVec3::Z), 0.1)?;
    /// session.end_stroke()?;
    /// let sculpted = session.positions().to_vec();
    ///
    /// assert!(session.undo()?);
    /// assert_eq!(session.positions(), opened);
    /// assert!(session.redo()?);
    /// assert_eq!(session.positions(), sculpted);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn undo(&mut self) -> Result<bool, SessionError> {
        if self.stroke.is_some() {
            return Err(SessionError::StrokeUnderWay);
        }
        let Some(mut step) = self.steps.done.pop_back() else { return Ok(false) };
        self.surface.swap(&mut step.delta);
        self.steps.undone.push(step);
        Ok(true)
    }

    /// Redoes the last undone stroke and restores all bits. Returns false if there is none, or a
    /// new stroke has replaced it.
    ///
    /// # Errors
    /// [`SessionError::StrokeUnderWay`].
    pub fn redo(&mut self) -> Result<bool, SessionError> {
        if self.stroke.is_some() {
            return Err(SessionError::StrokeUnderWay);
        }
        let Some(mut step) = self.steps.undone.pop() else { return Ok(false) };
        self.surface.swap(&mut step.delta);
        self.steps.done.push_back(step);
        Ok(true)
    }

    /// Number of strokes that can be undone and redone, and the memory that this takes.
    pub fn history(&self) -> History {
        self.steps.history()
    }

    /// Whether a stroke has begun and not ended.
    pub fn is_stroke_under_way(&self) -> bool {
        self.stroke.is_some()
    }

    /// Freezes the edges at some vertices, inserted ones included: they are not split, collapsed or
    /// flipped from now on. All other edges are released. Removed vertices are ignored.
    ///
    /// # Errors
    /// [`SessionError::NoVertex`] for a number of [`vertex_count`](Self::vertex_count) or more.
    /// Nothing changes then.
    pub fn freeze_edges(&mut self, vertices: &[u32]) -> Result<(), SessionError> {
        let count = self.vertex_count();
        if let Some(&vertex) = vertices.iter().find(|&&vertex| vertex as usize >= count) {
            return Err(SessionError::NoVertex { vertex, count });
        }
        let alive: Vec<u32> = vertices.iter().copied().filter(|&vertex| self.is_alive(vertex)).collect();
        self.surface.freeze(alive.into_iter());
        Ok(())
    }

    /// Buffers for a renderer, in place. Hosts that keep addresses must watch
    /// [`RenderBuffers::generation`].
    pub fn buffers(&self) -> RenderBuffers<'_> {
        self.surface.buffers()
    }

    /// Ranges of the buffers that have changed since the last call. The first call returns all.
    /// Call it after each move, undo and redo.
    ///
    /// ```
    /// # use isochore_mesh::primitives::icosphere;
    /// # use isochore_sculpt::session::{Session, SessionOptions};
    /// let mut session = Session::open(icosphere(1.0, 2), SessionOptions::default())?;
    /// // A host copies these ranges to the graphics card.
    /// let changes = session.take_changes();
    /// assert_eq!(changes.positions.last().unwrap().end, 162);
    /// assert!(session.take_changes().positions.is_empty());
    /// # Ok::<(), isochore_sculpt::session::OpenError>(())
    /// ```
    pub fn take_changes(&mut self) -> Changes {
        self.surface.take_changes()
    }

    /// Volume that the host sees minus the volume as opened, without the stroke under way.
    fn shown_volume_change(&self) -> f64 {
        let mut sum = CompensatedSum::default();
        self.logged().for_each(|stroke| sum.add(stroke.shown_change));
        sum.value()
    }

    fn logged(&self) -> impl Iterator<Item = &LoggedStroke> {
        self.steps.forgotten.iter().chain(self.steps.done.iter().map(|step| &step.stroke))
    }
}

/// Rejects options that the log could not read back.
fn check(options: &SessionOptions) -> Result<(), RecipeError<InvalidRecipe>> {
    options.target.validate().map_err(|error| error.inside("target"))?;
    Integrate { step: options.step }.validate().map_err(|error| error.inside("integrate"))?;
    options.mask.validate().map_err(|error| error.inside("mask"))
}
