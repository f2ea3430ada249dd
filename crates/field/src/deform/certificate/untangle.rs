//! Untangling: splits triangles that cross although the curved surface does not.

use isochore_mesh::{Cancelled, Monitor};

use super::{Crossings, Verdict};
use crate::{
    deform::{
        curved_triangle::edge_lengths,
        passage::Context,
        refine::{Criteria, LongestEdge},
        tessellation::{ChosenEdges, Tessellation},
    },
    flow::Stroke,
};

/// Most rounds. The limit only ends a loop that the other limits keep alive; up to 34 rounds were
/// needed on deep presses into scans.
const MAX_ROUNDS: usize = 60;

/// Rounds without a new minimum of either the crossing area or the number of crossing triangles,
/// after which untangling gives up. A larger value splits in vain where the time step causes the
/// crossings; a smaller value gives up on films that take several rounds to get thin enough.
const PATIENCE: usize = 8;

/// Fraction of the triangles in reach that untangling may add while it takes its time. Beyond it,
/// every round must reach a new minimum of the crossing area. A larger value spends more on
/// crossings that cannot be removed; a smaller value gives up on long creases.
const SOFT_GROWTH: f64 = 1.0;

/// Fraction of the triangles in reach that untangling may add at most. Larger and smaller values act
/// as for [`SOFT_GROWTH`].
const HARD_GROWTH: f64 = 4.0;

/// A stroke that reaches fewer triangles than this may add as many as if it reached this number. A
/// larger value spends more on coarse meshes; a smaller value gives up there too early.
const LEAST_REACH: usize = 1000;

/// Fraction of the limit on triangles that only untangling may use. A larger value exceeds the limit
/// by more; a smaller value leaves crossings where refinement has spent all triangles.
const RESERVE: f64 = 0.1;

/// An edge of a crossing triangle is split if its midpoint deviates by at least this fraction of the
/// largest deviation in its triangle. A larger value makes slivers; a smaller value also splits edges
/// along a crease.
const SIGNIFICANT: f64 = 0.5;

/// Rounds after which all edges of a triangle that still crosses are split. A larger value lets
/// slivers cross for longer; a smaller value splits more than necessary.
const ALL_EDGES_AFTER: u8 = 4;

/// Rounds after which the closure of the splits follows the longest edges of the base instead of the
/// image. The base is fixed, so its triangles get small in all directions, and untangling ends. A
/// larger value makes more rounds; a smaller value splits stretched triangles lengthwise.
const BASE_CLOSURE_AFTER: usize = 12;

/// Splits the triangles of `verdict.crossings` until none is left or the budget is spent. `reach` is
/// the number of triangles that the stroke has changed.
pub(super) fn untangle(
    mesh: &mut Tessellation,
    strokes: &[Stroke],
    criteria: &Criteria,
    reach: usize,
    verdict: &mut Verdict,
    context: &Context<'_>,
) -> Result<(), Cancelled> {
    let monitor = context.monitor;
    let before = mesh.triangles.len();
    let added = |fraction: f64| before + (fraction * reach.max(LEAST_REACH) as f64) as usize;
    let reserve = criteria.max_triangles().saturating_add((RESERVE * criteria.max_triangles() as f64) as usize);
    let limit = criteria.with_max_triangles(added(HARD_GROWTH).min(reserve));
    let mut progress = Progress::new();
    let mut rounds_crossed = vec![0; before];
    for round in 0..MAX_ROUNDS {
        monitor.check("untangle", round as f64 / MAX_ROUNDS as f64)?;
        let crossing = verdict.crossings.triangles();
        if crossing.is_empty() {
            break;
        }
        let patience = if mesh.triangles.len() > added(SOFT_GROWTH) { 1 } else { PATIENCE };
        if progress.rounds_since_minimum(mesh.area_at(&mesh.image, &crossing), crossing.len()) >= patience {
            break;
        }
        crossing.iter().for_each(|&index| rounds_crossed[index as usize] += 1);
        let chosen = edges_to_split(mesh, strokes, &crossing, &rounds_crossed, verdict, monitor)?;
        let closure = if round < BASE_CLOSURE_AFTER { LongestEdge::OfImage } else { LongestEdge::OfBase };
        let Some(split) = verdict.refinement.split(mesh, strokes, chosen, &limit, closure, monitor)? else { break };
        // A part has crossed for as many rounds as the triangle that it is a part of.
        rounds_crossed.extend(split.sources.iter().map(|&source| rounds_crossed[source as usize]).collect::<Vec<u8>>());
        verdict.crossings = Crossings::of(mesh, &mesh.image, &split.parts, context)?;
        verdict.pairs_tested += verdict.crossings.pairs_tested;
    }
    mesh.take_unchecked();
    Ok(())
}

/// The edges of crossing triangles whose midpoints deviate most.
fn edges_to_split(
    mesh: &mut Tessellation,
    strokes: &[Stroke],
    crossing: &[u32],
    rounds_crossed: &[u8],
    verdict: &mut Verdict,
    monitor: &dyn Monitor,
) -> Result<ChosenEdges, Cancelled> {
    crossing.iter().for_each(|&index| mesh.follow_edges_of(index));
    verdict.refinement.evaluations += mesh.advect_followed(strokes, monitor)?;
    let mut chosen = ChosenEdges::default();
    for &index in crossing {
        let Some(curved) = mesh.curved(index as usize) else { continue };
        let deviations = curved.deviations().map(|deviation| deviation.length());
        let least = SIGNIFICANT * deviations.into_iter().fold(0.0, f64::max);
        let takes_all = rounds_crossed[index as usize] > ALL_EDGES_AFTER;
        // An edge without length cannot be split.
        let lengths = edge_lengths(&mesh.base_of(index as usize));
        for edge in (0..3).filter(|&edge| lengths[edge] > 0.0 && (takes_all || deviations[edge] >= least)) {
            chosen.choose(mesh, 3 * index + edge as u32);
        }
    }
    Ok(chosen)
}

/// The smallest crossing area and number of crossing triangles so far.
#[derive(Debug)]
struct Progress {
    area: f64,
    count: usize,
    rounds: usize,
}

impl Progress {
    fn new() -> Self {
        Self { area: f64::INFINITY, count: usize::MAX, rounds: 0 }
    }

    /// Adds a round and returns the number of rounds since the last minimum.
    fn rounds_since_minimum(&mut self, area: f64, count: usize) -> usize {
        let is_minimum = area < self.area || count < self.count;
        self.rounds = if is_minimum { 0 } else { self.rounds + 1 };
        self.area = self.area.min(area);
        self.count = self.count.min(count);
        self.rounds
    }
}
