//! The guard: remedies for a deformation that would miss its tolerances.
//!
//! Each remedy starts from a measurement, not from an a priori bound. The Jacobian of the flow map
//! of a stroke sets its time step. The measured volume decides whether refinement continues.
//! Crossings that the lock would add cause more refinement, which leaves the lock less to correct.
//! Each remedy has a bounded number of rounds; the receipt reports the remaining defect.

use glam::DVec3;
use isochore_mesh::{Cancelled, Monitor};
use rustc_hash::FxHashSet;
use web_time::Instant;

use super::{
    lock::{Lock, lock_volume},
    refine::{Criteria, estimate_facet_error, refine, untangle},
    tessellation::Tessellation,
};
use crate::flow::{JacobianRange, Stroke};

/// Deviation of the Jacobian from one at which the time step is halved. A larger value lets coarse
/// steps compress and expand material; a smaller value takes finer steps although the facet error
/// dominates the volume.
const JACOBIAN_TOLERANCE: f64 = 0.1;

/// Most halvings of a step: enough to get from the largest allowed step to less than the default.
const MAX_HALVINGS: u32 = 4;

/// Half the step must reduce the deviation to this fraction, or the step is not the cause. Order
/// four leaves a sixteenth of the deviation; a discontinuous velocity leaves all of it. A larger
/// value halves in vain; a smaller value gives up on steps that are merely coarse.
const WORTHWHILE: f64 = 0.7;

/// Most rounds of finer refinement, for the volume and for the lock.
const MAX_ROUNDS: usize = 3;

/// Each round for the volume allows this fraction of the facet error of the round before.
const FINER: f64 = 0.25;

/// Each round for the lock allows this fraction: the shift of the lock is proportional to the facet error.
const FINER_FOR_LOCK: f64 = 0.1;

/// The time step of a stroke after [`choose_step`].
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(crate) struct StepChoice {
    /// How often the step was halved.
    pub(crate) halvings: u32,
    /// Determinants of the flow map at some of the vertices that the stroke moves, or `None` if it moves none.
    pub(crate) jacobian: Option<JacobianRange>,
}

impl StepChoice {
    /// The determinants if they are beyond the tolerance.
    pub(crate) fn excess(&self) -> Option<JacobianRange> {
        self.jacobian.filter(|range| range.deviation() > JACOBIAN_TOLERANCE)
    }
}

/// Halves the time step of `stroke` until its flow map keeps volumes at the vertices of `mesh`.
pub(crate) fn choose_step(
    stroke: &mut Stroke,
    mesh: &Tessellation,
    monitor: &dyn Monitor,
) -> Result<StepChoice, Cancelled> {
    let Some(mut range) = JacobianRange::of(stroke, &mesh.image, monitor)? else { return Ok(StepChoice::default()) };
    let mut halvings = 0;
    while range.deviation() > JACOBIAN_TOLERANCE && halvings < MAX_HALVINGS {
        let Some(finer) = stroke.with_half_step() else { break };
        let Some(next) = JacobianRange::of(&finer, &mesh.image, monitor)? else { break };
        if next.deviation() > WORTHWHILE * range.deviation() {
            break;
        }
        *stroke = finer;
        range = next;
        halvings += 1;
    }
    Ok(StepChoice { halvings, jacobian: Some(range) })
}

/// Refines further if the volume has changed by more than the criteria allow and the facet error
/// explains the change. `volume` is that of the base. Returns the final facet error.
pub(crate) fn refine_to_volume(
    mesh: &mut Tessellation,
    strokes: &[Stroke],
    criteria: &Criteria,
    volume: f64,
    mut facet_error: f64,
    monitor: &dyn Monitor,
) -> Result<f64, Cancelled> {
    let mut finer = *criteria;
    for _ in 0..MAX_ROUNDS {
        let gained = mesh.image_volume() - volume;
        // If the estimated facet error does not explain the change, the time step does, which
        // refinement cannot correct.
        let is_facets = (gained + facet_error).abs() < facet_error.abs();
        if !(gained.abs() > criteria.volume() && is_facets) {
            break;
        }
        finer = finer.with_volume(FINER * finer.volume());
        let refined = refine(mesh, strokes, &finer, monitor)?;
        facet_error = refined.facet_error;
        if refined.refinement.inserted == 0 {
            break;
        }
    }
    Ok(facet_error)
}

/// The lock, computed and not yet applied, and the refinement before it.
#[derive(Debug, Clone, Default)]
pub(crate) struct LockPreparation {
    /// The facet error after refinement, if any was needed.
    pub(crate) facet_error: Option<f64>,
    /// Number of triangles that the lock still makes cross.
    pub(crate) crossing: usize,
    /// Locked positions of the vertices, or `None` if no displacement restores the volume.
    pub(crate) locked: Option<(Vec<DVec3>, Lock)>,
    /// Wall time, seconds.
    pub(crate) seconds: f64,
}

/// Refines until the lock to `volume` adds no crossings. The shift of the lock can exceed the
/// thickness of a thin sheet. It is proportional to the volume that the facets have lost, so
/// refinement reduces it.
pub(crate) fn prepare_lock(
    mesh: &mut Tessellation,
    strokes: &[Stroke],
    criteria: Option<&Criteria>,
    volume: f64,
    monitor: &dyn Monitor,
) -> Result<LockPreparation, Cancelled> {
    let begin = Instant::now();
    let mut preparation = LockPreparation::default();
    let mut finer = criteria.copied();
    for round in 0..=MAX_ROUNDS {
        let mut image = mesh.image.clone();
        let lock = lock_volume(&mesh.rest, &mut image, &mesh.triangles, volume);
        preparation.crossing = if lock.is_some() { crossings_by_lock(mesh, &image, monitor)? } else { 0 };
        preparation.locked = lock.map(|lock| (image, lock));
        let Some(criteria) = finer.filter(|_| preparation.crossing > 0 && round < MAX_ROUNDS) else { break };
        let criteria = criteria.with_volume(FINER_FOR_LOCK * criteria.volume());
        finer = Some(criteria);
        let mut inserted = refine(mesh, strokes, &criteria, monitor)?.refinement.inserted;
        inserted += untangle(mesh, strokes, &criteria, monitor)?.inserted;
        if inserted == 0 {
            break;
        }
        preparation.facet_error = Some(estimate_facet_error(mesh, strokes, monitor)?.volume);
    }
    preparation.seconds = begin.elapsed().as_secs_f64();
    Ok(preparation)
}

/// The number of triangles that cross at the `locked` positions and not at the current ones.
fn crossings_by_lock(mesh: &Tessellation, locked: &[DVec3], monitor: &dyn Monitor) -> Result<usize, Cancelled> {
    let locked = mesh.new_crossings(locked, monitor)?;
    if locked.is_empty() {
        return Ok(0);
    }
    let before: FxHashSet<u32> = mesh.new_crossings(&mesh.image, monitor)?.into_iter().collect();
    Ok(locked.into_iter().filter(|triangle| !before.contains(triangle)).count())
}

#[cfg(test)]
mod tests;
