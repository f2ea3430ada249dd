//! The sculpting session: a mesh that a host deforms stroke by stroke, at the pace of a frame.
//!
//! Terms used throughout:
//!
//! - A *stroke* goes from [`begin_stroke`](Session::begin_stroke) to [`end_stroke`](Session::end_stroke). Each
//!   [`move_to`](Session::move_to) in between carries the tool along a screw from the last pose to the next, so that a fast stroke
//!   leaves no separate dabs. All work is in proportion to what the tool touches, whatever the size of the mesh.
//! - A *vertex* is a point of the surface. Vertices of the mesh as opened keep their numbers and go exactly where the flow takes
//!   them; inserted ones follow. A number changes its meaning in one case: where a collapse removed an inserted vertex, a later
//!   stroke may give its number to another. So it is with triangles, and buffers are as long as strokes need, not their history.
//!   What became of those that collapses removed of the mesh as opened, [`vertex_map`](Session::vertex_map) tells.
//! - A *render vertex* is a vertex as the triangles on one side of a seam see it: what [buffers](Session::buffers) hold.
//! - The *origin* of a render vertex is the point of the mesh as opened that it takes its attributes from.
//! - The *log* is a [recipe](crate::Recipe) of all strokes, which can be [replayed](crate::replay) on any mesh or point set.
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
//! // The bare method, without any lock.
//! assert!(receipt.volume.unwrap().bare().abs() < 1e-3 * session.volume().unwrap());
//! assert!(session.undo()?);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod advection;
mod buffers;
mod editing;
mod error;
mod export;
mod history;
mod inserted;
mod locking;
mod log;
mod marks;
mod opening;
mod options;
mod origin;
mod query;
mod receipt;
mod refinement;
mod selection;
mod shading;
mod stroke;
mod surface;
mod tool;
mod volume;

use std::sync::Arc;

use isochore_field as field;
use isochore_mesh::{Aabb, ClosedMesh, CompensatedSum, NONE, TriMesh};

pub use buffers::{Changes, DirtyRange, RenderBuffers};
pub use error::{OpenError, SessionError};
pub use export::Exported;
pub use log::SessionReplayError;
pub use options::{InteractiveRefinement, NormalWeights, SessionOptions, StrokeOptions};
pub use query::{Arrow, Hit};
pub use receipt::{History, LockSkipped, MoveReceipt, MoveSeconds, StrokeReceipt, StrokeVolume};
pub use tool::SessionTool;
pub use volume::MovedVolume;

use crate::{
    recipe::{Integrate, Key, Mask, RecipeError},
    scene,
};
use history::{Step, Steps};
use locking::Locked;
use log::LoggedStroke;
use stroke::{ActiveStroke, Segment};
use surface::Surface;

/// A mesh under the hands of a host.
///
/// It is `Send`: a binding may keep it behind a handle and call it from any one thread at a time. Results have the same bits for any
/// number of threads, and for any history of undone and canceled strokes.
#[derive(Debug, Clone)]
pub struct Session {
    options: SessionOptions,
    surface: Surface,
    /// Vertices without triangles, in ascending order.
    loose: Vec<u32>,
    opened_bounds: Aabb,
    /// None where the surface is open.
    opened_volume: Option<f64>,
    mask: Option<Arc<field::Mask>>,
    stroke: Option<ActiveStroke>,
    steps: Steps,
}

impl Session {
    /// Opens a session on `mesh`, which must be an oriented surface without branches, closed or open.
    ///
    /// Takes time and memory in proportion to the mesh, once: about 400 bytes a triangle.
    ///
    /// # Errors
    /// [`OpenError`], naming the edge, vertex or option that is wrong.
    pub fn open(mesh: impl Into<Arc<TriMesh>>, options: SessionOptions) -> Result<Self, OpenError> {
        let mesh = mesh.into();
        mesh.check_valid()?;
        check(&options)?;
        let mask = match options.mask == Mask::default() {
            true => None,
            false => Some(Arc::new(scene::mask::mask(&options.mask, Some(&mesh))?)),
        };
        let opened_bounds = mesh.bounds();
        let opened_volume = ClosedMesh::new(&mesh).ok().map(|closed| closed.volume());
        let surface = Surface::open(mesh, options.normals)?;
        let loose =
            (0..surface.topology.vertex_count() as u32).filter(|&vertex| surface.topology.outgoing(vertex) == NONE);
        let loose = loose.collect();
        Ok(Self { options, surface, loose, opened_bounds, opened_volume, mask, stroke: None, steps: Steps::default() })
    }

    /// The mesh as it was opened.
    pub fn opened(&self) -> &TriMesh {
        &self.surface.opened
    }

    /// Begins a stroke. Nothing moves before the second pose.
    ///
    /// # Errors
    /// [`SessionError::StrokeUnderWay`], [`SessionError::Refinement`].
    pub fn begin_stroke(&mut self, tool: &Arc<SessionTool>, options: StrokeOptions) -> Result<(), SessionError> {
        if self.stroke.is_some() {
            return Err(SessionError::StrokeUnderWay);
        }
        options.refine.as_ref().map_or(Ok(()), InteractiveRefinement::check)?;
        let alive = self.surface.begin();
        self.stroke = Some(ActiveStroke::new(Arc::clone(tool), options.refine, alive));
        Ok(())
    }

    /// Moves the tool to `pose` (world from tool), and with it what it touches.
    ///
    /// Poses are joined by constant body twists: screws of less than half a turn. `time`, in seconds of the host, may not run
    /// backward; it is told in the receipt, and what is carried where does not depend on it.
    ///
    /// # Errors
    /// [`SessionError`]; the tool is then still at the last pose, and the stroke goes on from there.
    pub fn move_to(&mut self, pose: &field::Pose, time: f64) -> Result<MoveReceipt, SessionError> {
        if !(pose.translation.is_finite() && pose.rotation.is_finite()) {
            return Err(field::StrokeError::Move(field::MoveError::NotFinite).into());
        }
        // What the log will say, so that replaying it gives the same bits.
        self.move_to_key(log::key(pose), time)
    }

    fn move_to_key(&mut self, key: Key, time: f64) -> Result<MoveReceipt, SessionError> {
        let pose = key.pose()?;
        let stroke = self.stroke.as_ref().ok_or(SessionError::NoStroke)?;
        let last = stroke.times.last().copied().unwrap_or(f64::NEG_INFINITY);
        if !(time.is_finite() && time >= last) {
            return Err(SessionError::Time { time, last });
        }
        let mut done = MoveReceipt::default();
        if let Some(last) = stroke.pose {
            let segment = self.segment(&stroke.tool, [last, pose])?;
            let carried = self.advect(segment, &mut done);
            if let Some(stroke) = &mut self.stroke {
                // Edges that were split before the move was refused stay so.
                stroke.note_edits(&done);
            }
            carried?;
        }
        if let Some(stroke) = &mut self.stroke {
            stroke.receipt.moves += usize::from(stroke.pose.is_some());
            stroke.keys.push(key);
            stroke.times.push(time);
            stroke.pose = Some(pose);
        }
        Ok(done)
    }

    /// The way of a tool between two poses.
    fn segment(&self, tool: &SessionTool, poses: [field::Pose; 2]) -> Result<Segment, field::StrokeError> {
        let way = field::Move::new(Arc::clone(tool.tool()), poses.to_vec(), self.options.step)?;
        let mut stroke = field::Stroke::Move(way);
        if let Some(mask) = &self.mask {
            stroke = stroke.masked(mask, self.opened_bounds, self.options.step)?;
        }
        Ok(Segment::new(stroke))
    }

    /// Ends the stroke, which can then be undone and is in the log. A stroke of fewer than two poses did nothing and leaves nothing.
    ///
    /// Then the volume lock acts, if the session has one: it moves what the host sees, and not what the next stroke sets out from. The
    /// change told is that of the bare method.
    ///
    /// # Errors
    /// [`SessionError::NoStroke`].
    pub fn end_stroke(&mut self) -> Result<StrokeReceipt, SessionError> {
        let stroke = self.stroke.take().ok_or(SessionError::NoStroke)?;
        let mut receipt = stroke.receipt;
        if let [first, .., last] = stroke.times[..] {
            receipt.duration = last - first;
        }
        let inserted = &self.surface.inserted;
        receipt.touched_vertices = self.surface.positions.edited().filter(|&vertex| !inserted.contains(vertex)).count();
        receipt.volume = self.opened_volume.map(|_| stroke.volume(&self.surface));
        let locked = self.lock(&stroke);
        (receipt.lock_max_shift, receipt.lock_skipped) = (locked.max_shift.ok(), locked.max_shift.err());
        let mut delta = self.surface.finish(stroke.alive);
        if stroke.keys.len() < 2 {
            self.surface.swap(&mut delta);
            return Ok(receipt);
        }
        let volume_change = receipt.volume.map(|volume| volume.total());
        let stroke =
            LoggedStroke { tool: stroke.tool, keys: stroke.keys, volume_change, shown_change: locked.shown_change };
        let step = Step { stroke, delta };
        receipt.undo_bytes = step.bytes();
        receipt.forgotten_strokes = self.steps.push(step, self.options.undo_bytes);
        Ok(receipt)
    }

    /// Locks the volume that the host sees, if the session does and the surface has one.
    fn lock(&mut self, stroke: &ActiveStroke) -> Locked {
        let unlocked = |skipped| Locked { max_shift: Err(skipped), shown_change: 0.0 };
        let Some(volume) = self.opened_volume else { return unlocked(LockSkipped::NeedsClosed) };
        if !self.options.lock {
            return unlocked(LockSkipped::Off);
        }
        let excess = self.shown_volume_change();
        stroke.lock(&mut self.surface, excess, volume.abs())
    }

    /// Takes back the stroke under way, to the bit.
    ///
    /// # Errors
    /// [`SessionError::NoStroke`].
    pub fn cancel_stroke(&mut self) -> Result<(), SessionError> {
        let stroke = self.stroke.take().ok_or(SessionError::NoStroke)?;
        let mut delta = self.surface.finish(stroke.alive);
        self.surface.swap(&mut delta);
        Ok(())
    }

    /// Takes back the last stroke, to the bit. False where there is none, or none that is remembered.
    ///
    /// # Errors
    /// [`SessionError::StrokeUnderWay`].
    pub fn undo(&mut self) -> Result<bool, SessionError> {
        if self.stroke.is_some() {
            return Err(SessionError::StrokeUnderWay);
        }
        let Some(mut step) = self.steps.done.pop_back() else { return Ok(false) };
        self.surface.swap(&mut step.delta);
        self.steps.undone.push(step);
        Ok(true)
    }

    /// Makes the stroke again that was undone last, to the bit. False where there is none, or a new stroke took its place.
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

    /// What can be undone and redone.
    pub fn history(&self) -> History {
        self.steps.history()
    }

    /// Whether a stroke has begun and not ended.
    pub fn is_stroke_under_way(&self) -> bool {
        self.stroke.is_some()
    }

    /// Keeps the edges at some vertices, inserted ones included, from being split, collapsed or flipped from now on, and frees all
    /// others. Vertices that were removed are passed over.
    ///
    /// # Errors
    /// [`SessionError::NoVertex`] for a number of [`vertex_count`](Self::vertex_count) or more; then all stays as it was.
    pub fn freeze_edges(&mut self, vertices: &[u32]) -> Result<(), SessionError> {
        let count = self.vertex_count();
        if let Some(&vertex) = vertices.iter().find(|&&vertex| vertex as usize >= count) {
            return Err(SessionError::NoVertex { vertex, count });
        }
        let there: Vec<u32> = vertices.iter().copied().filter(|&vertex| self.is_alive(vertex)).collect();
        self.surface.freeze(there.into_iter());
        Ok(())
    }

    /// What a renderer draws, in place. Borrowed as long as the session is not changed; see [`RenderBuffers::generation`] for hosts
    /// that keep addresses.
    pub fn buffers(&self) -> RenderBuffers<'_> {
        self.surface.buffers()
    }

    /// What has changed in the buffers since the last call: at first, everything. Ask after each move, undo and redo.
    pub fn take_changes(&mut self) -> Changes {
        self.surface.take_changes()
    }

    /// How much more volume the host sees than the mesh had as opened, without the stroke under way.
    fn shown_volume_change(&self) -> f64 {
        let mut sum = CompensatedSum::default();
        self.logged().for_each(|stroke| sum.add(stroke.shown_change));
        sum.value()
    }

    fn logged(&self) -> impl Iterator<Item = &LoggedStroke> {
        self.steps.forgotten.iter().chain(self.steps.done.iter().map(|step| &step.stroke))
    }
}

/// Checks what the log could not read back.
fn check(options: &SessionOptions) -> Result<(), RecipeError> {
    options.target.validate().map_err(|error| error.inside("target"))?;
    Integrate { step: options.step }.validate().map_err(|error| error.inside("integrate"))?;
    options.mask.validate().map_err(|error| error.inside("mask"))
}
