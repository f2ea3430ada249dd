//! The guard: what is done where a run would not keep what it set out to keep.
//!
//! It works on measures of its own and never looks at promises: the Jacobian of a stroke's flow map decides the time step, the
//! measured volume decides whether refinement goes on, and crossings that the lock would add decide whether it is given less to
//! do. Each cure has a bounded number of rounds; what is left is told in the receipt.

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

/// Farthest from one that the Jacobian of a flow map may be before the time step is halved. Larger lets coarse steps squeeze
/// and swell material that the flow would not; smaller takes finer steps where the volume is dominated by facets anyway.
const JACOBIAN_TOLERANCE: f64 = 0.1;

/// A step is halved this often at most: from the largest allowed to below the default.
const MAX_HALVINGS: u32 = 4;

/// Half the step must leave this share of the deviation at most, or it is not the step that is at fault. Order four leaves a
/// sixteenth; jumps of the velocity leave all.
const WORTHWHILE: f64 = 0.7;

/// Rounds of finer refinement at most, for the volume and for the lock.
const MAX_ROUNDS: usize = 3;

/// Share of the facet error allowed so far that the next round allows where the volume was missed.
const FINER: f64 = 0.25;

/// The same where the lock made sheets cross: its shift goes with the facet error.
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

/// Refines on where the measured change since the base, whose volume is `volume`, is beyond what was asked for and facets
/// account for it. Returns the facet error in the end.
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
        // What the flat triangles lack must be what is missing, or the time step is at fault, which refinement does not mend.
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

/// The lock, and what had to be done so that it does no harm.
#[derive(Debug, Clone, Default)]
pub(crate) struct LockPreparation {
    /// The facet error after refinement, if any was needed.
    pub(crate) facet_error: Option<f64>,
    /// Triangles that the lock makes cross all the same.
    pub(crate) crossing: usize,
    /// Where the vertices go; none where the volume cannot be given back.
    pub(crate) locked: Option<(Vec<DVec3>, Lock)>,
    /// Wall time, seconds.
    pub(crate) seconds: f64,
}

/// Refines until giving back `volume` makes nothing cross that did not: the shift of the lock can be more than the thickness of
/// a thin sheet, and is the smaller the less volume the facets have lost.
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

/// The number of triangles that cross where the `locked` vertices are, and do not before.
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
