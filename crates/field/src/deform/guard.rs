//! The guard: remedies for a deformation that would miss its tolerances.
//!
//! Each remedy starts from a measurement, not from an a priori bound. The Jacobian of the flow map
//! of a stroke sets its time step. The measured volume decides whether refinement continues.
//! Each remedy has a bounded number of rounds; the receipt reports the remaining defect.

use isochore_mesh::{Cancelled, Monitor};

use super::{
    refine::{Criteria, refine},
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
pub(super) const WORTHWHILE: f64 = 0.7;

/// Most rounds of finer refinement for the volume.
const MAX_ROUNDS: usize = 3;

/// Each round for the volume allows this fraction of the facet error of the round before.
const FINER: f64 = 0.25;

/// The time step of a stroke after [`choose_step`].
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(crate) struct StepChoice {
    /// How often the step was halved.
    pub(crate) halvings: u32,
    /// Determinants of the flow map at some of the vertices that the stroke moves, or `None` if it moves none.
    pub(crate) jacobian: Option<JacobianRange>,
}

impl StepChoice {
    /// `stroke` with half the step, and the choice of that step. `None` if the step cannot be halved
    /// again.
    pub(crate) fn halved(&self, stroke: &Stroke) -> Option<(Stroke, Self)> {
        let finer = (self.halvings < MAX_HALVINGS).then(|| stroke.with_half_step()).flatten()?;
        Some((finer, Self { halvings: self.halvings + 1, ..*self }))
    }

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
        if !(gained.abs() > criteria.allowed_facet_error(mesh) && is_facets) {
            break;
        }
        finer = finer.with_finer_facets(FINER);
        let refined = refine(mesh, strokes, &finer, monitor)?;
        facet_error = refined.facet_error;
        if refined.refinement.inserted == 0 {
            break;
        }
    }
    Ok(facet_error)
}

#[cfg(test)]
mod tests;
