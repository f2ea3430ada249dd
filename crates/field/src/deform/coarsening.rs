//! Coarsening: merges triangles that refinement added and that nothing needs any more.
//!
//! A vertex that refinement inserted is merged into a neighbor where the surface changes by less than a
//! fraction of the allowed deviation. The parts of each input triangle still cover it exactly, so the mesh
//! at rest does not change. Vertices of the input, and inserted vertices on borders and seams, stay.

mod collapse;
mod round;

use isochore_mesh::Cancelled;

use super::{passage::Context, refine::Criteria, tessellation::Tessellation};
use collapse::Limits;
use round::Coarsening;

/// Largest distance between the surfaces before and after, as a fraction of the allowed deviation. A larger
/// value lets repeated rebases wear features down; a smaller value keeps triangles that nobody sees.
const DEVIATION: f64 = 0.25;

/// Largest change of the volume, as a fraction of the allowed facet error. A larger value leaves more for
/// the lock; a smaller value keeps triangles on evenly curved parts.
const VOLUME: f64 = 0.25;

/// Most rounds. Each merges vertices without common triangles, about one in five.
const MAX_ROUNDS: usize = 40;

/// A round that merges less than this fraction of the vertices of the first round is the last. A larger
/// value leaves triangles; a smaller value spends rounds on a few.
const WORTHWHILE: f64 = 0.02;

/// Result of coarsening.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct Coarsened {
    /// Vertices that were removed.
    pub(super) removed: usize,
    /// Bound of the distance between the surfaces before and after, model units.
    pub(super) deviation: f64,
    /// Pairs of triangles that were tested for crossings.
    pub(super) pairs_tested: u64,
}

/// Merges vertices of a frozen surface. `facet_error` is the allowed facet error, cubic model units.
pub(super) fn coarsen(
    mesh: &mut Tessellation,
    criteria: &Criteria,
    facet_error: f64,
    context: &Context<'_>,
) -> Result<Coarsened, Cancelled> {
    let limits = Limits { deviation: DEVIATION * criteria.deviation(), max_edge: criteria.max_edge() };
    let mut coarsening = Coarsening::new(mesh, context.input.vertices(), limits, VOLUME * facet_error);
    let mut first = 0;
    for round in 0..MAX_ROUNDS {
        context.monitor.check("coarsen", round as f64 / MAX_ROUNDS as f64)?;
        let merged = coarsening.round(mesh, context)?;
        first = first.max(merged);
        if merged as f64 <= WORTHWHILE * first as f64 {
            break;
        }
    }
    Ok(coarsening.finish(mesh))
}

#[cfg(test)]
mod tests;
