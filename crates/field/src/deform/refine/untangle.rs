//! Splits flat triangles that cross although the surface does not.

use isochore_mesh::{Cancelled, Monitor};
use rustc_hash::FxHashMap;

use super::{criteria::Criteria, refinement::Refinement};
use crate::{
    deform::tessellation::{ChosenEdges, Tessellation},
    flow::Stroke,
};

/// Rounds of splitting triangles that cross: each halves the edges there, so this many divide them by four thousand. It only
/// ends what the other limits would keep going.
const MAX_UNTANGLING_ROUNDS: usize = 12;

/// Splitting triangles that cross may add this share of the triangles there are. Larger spends most of the mesh on sheets that
/// a profile without a rigid core squeezes ever thinner; smaller gives up on long creases.
const UNTANGLING_GROWTH: f64 = 1.0;

/// Triangles as long as this share of one that crosses, within the same triangle as read, are split with it. Larger lets folds
/// wander along rows of slivers; smaller splits what is fine already.
const AS_COARSE: f64 = 0.75;

/// Splitting goes on while two rounds leave at most this share of the area that crosses. Nearer to one it chases the error of the
/// time step; smaller gives up on sheets that take several rounds.
const WORTHWHILE: f64 = 0.9;

/// Splits triangles whose images cross although those in the base do not, as long as that helps.
///
/// The exact image of a surface that does not cross itself does not either, so what crosses are flat triangles that cut
/// through a neighboring sheet, or the error of the time step, which splitting does not mend.
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
        // Compared over two rounds: the first split of a sliver may only turn its fold over.
        if crossing.is_empty() || area > WORTHWHILE * areas[0] {
            break;
        }
        areas = [areas[1], area];
        // With all that is as coarse in the same triangles as read: at the end of a split row of slivers the next one folds.
        let mut coarsest: FxHashMap<u32, f64> = FxHashMap::default();
        for &index in &crossing {
            let length = coarsest.entry(mesh.parent(index as usize)).or_insert(0.0);
            *length = length.max(mesh.longest_base_edge(index as usize));
        }
        let is_wanted = |index: usize| {
            let coarsest = coarsest.get(&mesh.parent(index));
            coarsest.is_some_and(|&length| mesh.longest_base_edge(index) > AS_COARSE * length)
        };
        let wanted: Vec<usize> = (0..mesh.triangles.len()).filter(|&index| is_wanted(index)).collect();
        let mut chosen = ChosenEdges::default();
        for half_edge in wanted.into_iter().flat_map(|index| 3 * index as u32..3 * index as u32 + 3) {
            chosen.choose(mesh, half_edge);
        }
        let limit = criteria.with_max_triangles(most);
        if refinement.split(mesh, strokes, chosen, &limit, monitor)?.is_none() {
            break;
        }
    }
    Ok(refinement)
}
