//! Untangling: splits flat triangles that cross although the curved surface does not.

use isochore_mesh::{Cancelled, Monitor};
use rustc_hash::FxHashMap;

use super::{criteria::Criteria, refinement::Refinement};
use crate::{
    deform::tessellation::{ChosenEdges, Tessellation},
    flow::Stroke,
};

/// Most rounds. Each halves the edges of crossing triangles, so this many divide them by four thousand.
/// The limit only ends a loop that the other limits keep alive.
const MAX_UNTANGLING_ROUNDS: usize = 12;

/// Untangling may add this fraction of the existing triangles. A larger value spends most of the mesh on
/// sheets that a profile without a rigid core makes ever thinner; a smaller value gives up on long
/// creases.
const UNTANGLING_GROWTH: f64 = 1.0;

/// A triangle is split with a crossing one of the same input triangle if it is at least this fraction as
/// long. A larger value lets folds move along rows of slivers; a smaller value splits triangles that
/// are already fine.
const AS_COARSE: f64 = 0.75;

/// The rounds go on while two of them reduce the crossing area to this fraction. A larger value tries to
/// correct the error of the time step, which splits cannot; a smaller value gives up on sheets that
/// take several rounds.
const WORTHWHILE: f64 = 0.9;

/// Splits triangles whose images cross although those in the base do not, while that reduces the
/// crossing area.
///
/// A flow map does not make a surface cross itself. New crossings are therefore flat triangles that
/// cut through a neighboring sheet, or an error of the time step, which splits cannot correct.
pub(crate) fn untangle(
    mesh: &mut Tessellation,
    strokes: &[Stroke],
    criteria: &Criteria,
    monitor: &dyn Monitor,
) -> Result<Refinement, Cancelled> {
    let mut refinement = Refinement::default();
    let mut areas = [f64::INFINITY; 2];
    let most = mesh.triangles.len() + (UNTANGLING_GROWTH * mesh.triangles.len() as f64) as usize;
    for round in 0..MAX_UNTANGLING_ROUNDS {
        monitor.check("untangle", round as f64 / MAX_UNTANGLING_ROUNDS as f64)?;
        let crossing = mesh.new_crossings(&mesh.image, monitor)?;
        let area = mesh.image_area(&crossing);
        // Compared over two rounds, because the first split of a sliver may only flip its fold.
        if crossing.is_empty() || area > WORTHWHILE * areas[0] {
            break;
        }
        areas = [areas[1], area];
        // All triangles of similar length in the same input triangles are split too. Otherwise the
        // sliver next to the split ones folds in the next round.
        let mut coarsest: FxHashMap<u32, f64> = FxHashMap::default();
        for &index in &crossing {
            let length = coarsest.entry(mesh.parent(index as usize)).or_insert(0.0);
            *length = length.max(mesh.longest_base_edge(index as usize));
        }
        let is_chosen = |index: usize| {
            let coarsest = coarsest.get(&mesh.parent(index));
            coarsest.is_some_and(|&length| mesh.longest_base_edge(index) > AS_COARSE * length)
        };
        let coarse: Vec<usize> = (0..mesh.triangles.len()).filter(|&index| is_chosen(index)).collect();
        let mut chosen = ChosenEdges::default();
        for half_edge in coarse.into_iter().flat_map(|index| 3 * index as u32..3 * index as u32 + 3) {
            chosen.choose(mesh, half_edge);
        }
        let limit = criteria.with_max_triangles(most);
        if refinement.split(mesh, strokes, chosen, &limit, monitor)?.is_none() {
            break;
        }
    }
    Ok(refinement)
}
