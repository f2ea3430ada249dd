//! The deformation of a mesh by strokes: advect, refine, stamp, lock.

mod balance;
mod certificate;
mod coarsening;
mod curved_triangle;
mod error;
mod guard;
mod imprint;
mod lock;
mod locking;
mod passage;
mod passes;
mod press;
mod receipt;
mod refine;
mod tessellation;

use isochore_mesh::{ClosedMesh, Monitor, Topology, TriMesh, signed_volume};

pub use certificate::Sheets;
pub use error::DeformError;
pub use lock::{Lock, lock_part, lock_volume};
pub use press::PressError;
pub use receipt::{Note, Receipt, StageSeconds, StrokeReceipt};
pub use refine::{Rebase, RefineOptions};

use crate::flow::Stroke;
use certificate::{Crossings, Input};
use locking::prepare_lock;
use passage::{Context, Passage};
use passes::{Locked, Passes, Unlocked};
use refine::Criteria;
use tessellation::Tessellation;

/// Options of [`deform`].
///
/// ```
/// use isochore_field::{DeformOptions, RefineOptions};
///
/// // The flow alone: neither new triangles nor a volume correction.
/// let bare = DeformOptions { refine: None, lock: false };
/// // A tighter estimate of the facet error than the default.
/// let fine = DeformOptions {
///     refine: Some(RefineOptions { volume: Some(1e-5), ..RefineOptions::default() }),
///     ..DeformOptions::default()
/// };
/// assert!(fine.lock && !bare.lock);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DeformOptions {
    /// Criteria of refinement, or `None` to keep the triangles.
    pub refine: Option<RefineOptions>,
    /// Whether a last small displacement restores the volume at rest exactly.
    pub lock: bool,
}

impl Default for DeformOptions {
    fn default() -> Self {
        Self { refine: Some(RefineOptions::default()), lock: true }
    }
}

/// A deformed mesh.
#[derive(Debug, Clone)]
pub struct Deformed {
    /// The mesh, refined and deformed.
    pub mesh: TriMesh,
    /// The same triangles at rest.
    pub rest: TriMesh,
    /// The strokes, with the time steps that were used.
    pub strokes: Vec<Stroke>,
    /// Measures of the result and of each pass.
    pub receipt: Receipt,
}

/// Deforms `mesh` by the strokes, one after the other.
///
/// Each vertex follows the flow from its position on the input mesh. A vertex that refinement
/// inserts starts from a point of an input triangle. After a stamp, the flow starts from the flat
/// triangles that the stamp left.
///
/// The volume of a closed mesh changes by two errors. The error of the time step has order four.
/// The facet error is that of flat triangles, and refinement keeps its estimate below
/// [`RefineOptions::volume`]. The lock then corrects the remaining change. An open mesh has no
/// volume to keep.
///
/// With refinement no stroke leaves a crossing that the input mesh did not have. Triangles that would
/// cross are split, and a stroke that still makes the surface cross itself ends early:
/// [`StrokeReceipt::stopped_at`]. Without refinement crossings are counted:
/// [`Receipt::new_crossings`]. Self-intersections of the input mesh remain.
///
/// The result has the same bits for any number of threads.
///
/// ```
/// use std::sync::Arc;
///
/// use glam::DVec3;
/// use isochore_field::{DeformOptions, Move, Pose, Profile, Stroke, Tool, deform};
/// use isochore_mesh::{NoProgress, Sphere, primitives};
///
/// let tool = Tool::new(Arc::new(Sphere::new(0.3)?), 0.3, Profile::Quintic)?;
/// let keys = vec![Pose::at(DVec3::Z * 1.6), Pose::at(DVec3::Z * 1.2)];
/// let press = Stroke::Move(Move::new(Arc::new(tool), keys, 0.125)?);
///
/// let mesh = primitives::icosphere(1.0, 3);
/// let deformed = deform(&mesh, &[press], &DeformOptions::default(), &NoProgress)?;
/// let [before, after] = [deformed.receipt.volume_before, deformed.receipt.volume_after].map(Option::unwrap);
/// assert!((after / before - 1.0).abs() < 1e-13);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// - [`DeformError::Cancelled`] if `monitor` cancels.
/// - [`DeformError::Mesh`] if an index is out of range or a coordinate is not finite.
/// - [`DeformError::VolumeOverflow`] and [`DeformError::Overflow`] if coordinates are too large.
/// - [`DeformError::Stamp`] if the mesh is open, or a stamp starts inside the surface or displaces
///   more than the surface around it can take up.
pub fn deform(
    mesh: &TriMesh,
    strokes: &[Stroke],
    options: &DeformOptions,
    monitor: &dyn Monitor,
) -> Result<Deformed, DeformError> {
    mesh.check_valid()?;
    let topology = Topology::of(mesh);
    let volume = closed_volume(mesh, &topology)?;
    check_stamps(strokes, volume)?;
    let mut surface = Tessellation::new(mesh, &topology);
    drop(topology);
    let criteria = options.refine.as_ref().map(|refine| Criteria::new(refine, &surface, volume));
    let mut strokes = strokes.to_vec();

    let input = Input::new(mesh);
    let context = Context { input: &input, criteria: criteria.as_ref(), volume, monitor };
    let passage = Passage::through(&mut surface, &mut strokes, &context)?;
    check_range(&surface)?;
    let lock = match volume.filter(|_| options.lock) {
        Some(volume) => Some(prepare_lock(&surface, volume, &context)?),
        None => None,
    };
    let unlocked = Unlocked::measure(&mut surface, mesh, volume);
    let lock = lock.map(|prepared| Locked::apply(prepared, &mut surface));
    let moved = surface.triangles_with(|vertex| surface.image[vertex] != surface.rest[vertex]);
    let crossings = Crossings::of(&surface, &surface.image, &moved, &context)?;

    let passes = Passes { context, is_lock_asked: options.lock, passage, unlocked, lock, crossings };
    let receipt = passes.receipt(&surface);
    let (mesh, rest) = surface.into_meshes(mesh);
    Ok(Deformed { mesh, rest, strokes, receipt })
}

/// Signed volume of the mesh, or `None` if it is open.
fn closed_volume(mesh: &TriMesh, topology: &Topology) -> Result<Option<f64>, DeformError> {
    if ClosedMesh::with_topology(mesh, topology).is_err() {
        return Ok(None);
    }
    let volume = signed_volume(&mesh.positions, &mesh.triangles);
    if volume.is_finite() { Ok(Some(volume)) } else { Err(DeformError::VolumeOverflow) }
}

/// Refuses stamps on a mesh without a volume.
fn check_stamps(strokes: &[Stroke], volume: Option<f64>) -> Result<(), DeformError> {
    let has_volume = volume.is_some_and(|volume| volume != 0.0);
    match strokes.iter().position(|stroke| matches!(stroke, Stroke::Stamp(_))) {
        Some(stroke) if !has_volume => Err(DeformError::Stamp { stroke, source: PressError::NoVolume }),
        _ => Ok(()),
    }
}

fn check_range(surface: &Tessellation) -> Result<(), DeformError> {
    match surface.image.iter().position(|image| !image.is_finite()) {
        Some(vertex) => Err(DeformError::Overflow { vertex }),
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests;
