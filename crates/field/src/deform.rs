//! The deformation of a mesh by strokes: advect, refine, stamp, lock.

mod balance;
mod curved_triangle;
mod guard;
mod lock;
mod passage;
mod passes;
mod press;
mod receipt;
mod refine;
mod tessellation;

use isochore_mesh::{Cancelled, ClosedMesh, MeshError, Monitor, Topology, TriMesh, signed_volume};

pub use lock::{Lock, lock_part, lock_volume};
pub use press::PressError;
pub use receipt::{Note, Receipt, StageSeconds, StrokeReceipt};
pub use refine::RefineOptions;

use crate::flow::Stroke;
use guard::prepare_lock;
use passage::{Context, Passage};
use passes::{Locked, Passes, Unlocked};
use refine::Criteria;
use tessellation::Tessellation;

/// How to deform.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DeformOptions {
    /// When to split triangles; none to keep them as they are.
    pub refine: Option<RefineOptions>,
    /// Whether the exact final correction gives back the volume at rest.
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
    /// The strokes, in time steps as fine as they had to be.
    pub strokes: Vec<Stroke>,
    /// What was done.
    pub receipt: Receipt,
}

/// Why a deformation gave nothing.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum DeformError {
    /// The monitor stopped it.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
    /// The mesh has an index out of range or a coordinate that is not finite.
    #[error(transparent)]
    Mesh(#[from] MeshError),
    /// A coordinate left the range of numbers.
    #[error("vertex {vertex} is carried out of the range of numbers; coordinates or strokes are too large")]
    Overflow {
        /// Index of the vertex, inserted ones included.
        vertex: usize,
    },
    /// A stamp cannot be pressed.
    #[error("stroke {stroke}: {source}")]
    Stamp {
        /// Index of the stroke, from 0.
        stroke: usize,
        /// Why not.
        source: PressError,
    },
    /// The volume of the mesh as given is no number.
    #[error("the volume is beyond the range of numbers; coordinates are too large")]
    VolumeOverflow,
}

/// Deforms `mesh` by the strokes, one after the other.
///
/// Every vertex, inserted ones included, follows the flow from where it lies on the mesh as given, or on the mesh that a stamp
/// left: what follows a stamp takes its flat triangles for the true surface. The flow keeps volumes up
/// to the error of the time step (order four); flat triangles do up to the facet error, which refinement holds below
/// [`RefineOptions::volume`] by an estimate; the lock gives back what is left. A volume is kept only where the mesh is closed,
/// and self-intersections of the mesh as given stay.
///
/// The result has the same bits for any number of threads.
///
/// # Errors
/// [`DeformError`].
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

    let context = Context { criteria: criteria.as_ref(), volume, monitor };
    let passage = Passage::through(&mut surface, &mut strokes, &context)?;
    check_range(&surface)?;
    let lock = match volume.filter(|_| options.lock) {
        Some(volume) => {
            Some(prepare_lock(&mut surface, since_last_stamp(&strokes), criteria.as_ref(), volume, monitor)?)
        }
        None => None,
    };
    let unlocked = Unlocked::measure(&mut surface, mesh, volume);
    let lock = lock.map(|prepared| Locked::apply(prepared, &mut surface));

    let passes = Passes { context, is_lock_asked: options.lock, passage, unlocked, lock };
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

/// The strokes that the base of the flow still has before it.
fn since_last_stamp(strokes: &[Stroke]) -> &[Stroke] {
    let last = strokes.iter().rposition(|stroke| matches!(stroke, Stroke::Stamp(_)));
    &strokes[last.map_or(0, |last| last + 1)..]
}

#[cfg(test)]
mod tests;
