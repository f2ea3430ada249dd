//! Passes over many edges. Edits are planned in parallel and made one after the other.

use glam::DVec3;
use isochore_mesh::{Aabb, NONE};
use rayon::prelude::*;

use super::{change::Change, remesher::Remesher};

/// Edits that are planned at once. Larger: more of them have to be planned again, because an earlier
/// one is too near. Smaller: threads wait for each other.
const WINDOW: usize = 256;

/// Triangles that one task searches. Larger leaves threads idle; smaller spends time on scheduling.
const CHUNK: usize = 1024;

/// How an edge is edited.
#[derive(Debug, Clone, Copy)]
pub(super) enum Action {
    /// Split in the middle.
    Split,
    /// Replaced by the edge between the apexes.
    Flip,
    /// Its start is merged into its end.
    Collapse {
        /// Position of the end afterwards.
        target: DVec3,
        /// If the start is on a line: its neighbor on the other side, and the slack of the line
        /// afterwards.
        line: Option<(u32, f64)>,
    },
}

/// An edit that is allowed.
#[derive(Debug)]
pub(super) struct Planned {
    pub(super) half_edge: u32,
    pub(super) action: Action,
    pub(super) change: Change,
}

/// Plans the edit of the edge between two vertices. `None` if none is useful and allowed.
pub(super) type Planner = for<'a, 'b, 'c> fn(&'a Remesher<'b>, [u32; 2], &'c mut Change) -> Option<(u32, Action)>;

impl Remesher<'_> {
    /// Edits edges, given by their ends, in this order. Returns the triangles that have changed.
    pub(super) fn edit(&mut self, edges: &[[u32; 2]], plan: Planner) -> Vec<u32> {
        let mut changed = Vec::new();
        for window in edges.chunks(WINDOW) {
            let this = &*self;
            let planned: Vec<Option<Planned>> = window
                .par_iter()
                .map_init(Change::default, |change, &ends| {
                    let (half_edge, action) = plan(this, ends, change)?;
                    Some(Planned { half_edge, action, change: std::mem::take(change) })
                })
                .collect();
            let mut done: Vec<Aabb> = Vec::new();
            for (&ends, planned) in window.iter().zip(planned) {
                let Some(mut planned) = planned else { continue };
                // What a plan depends on is within its bounds.
                if done.iter().any(|&bounds| bounds.overlaps(planned.change.bounds)) {
                    let Some((half_edge, action)) = plan(self, ends, &mut planned.change) else { continue };
                    (planned.half_edge, planned.action) = (half_edge, action);
                }
                if !self.perform(&mut planned) {
                    return changed;
                }
                done.push(planned.change.bounds);
                changed.extend(planned.change.new.iter().map(|new| new.triangle));
            }
        }
        changed.sort_unstable();
        changed.dedup();
        changed
    }

    /// Makes an edit. Returns false if there may be no more triangles.
    fn perform(&mut self, planned: &mut Planned) -> bool {
        let Planned { half_edge, action, change } = planned;
        match *action {
            Action::Split => {
                if self.surface.topology.alive() + 2 > self.max_triangles {
                    self.tally.is_limited = true;
                    return false;
                }
                self.perform_split(*half_edge, change);
            }
            Action::Flip => self.perform_flip(*half_edge),
            Action::Collapse { target, line } => self.perform_collapse(*half_edge, target, line),
        }
        self.note(change);
        true
    }

    /// The edges of `triangles` that have a `priority`, those with the largest first.
    pub(super) fn ranked_edges(
        &self,
        triangles: &[u32],
        priority: impl Fn(u32) -> Option<f64> + Sync,
    ) -> Vec<[u32; 2]> {
        let topology = &self.surface.topology;
        let found: Vec<Vec<(f64, [u32; 2])>> = triangles
            .par_chunks(CHUNK)
            .map(|chunk| {
                let alive = chunk.iter().filter(|&&triangle| topology.triangles()[triangle as usize].is_alive());
                let half_edges = alive.flat_map(|&triangle| 3 * triangle..3 * triangle + 3);
                let ranked = half_edges.filter_map(|edge| {
                    let [start, end] = [topology.start(edge), topology.end(edge)];
                    let twin = topology.twin(edge);
                    // Each edge once, if both of its triangles are searched.
                    let is_first = twin == NONE || start < end || triangles.binary_search(&(twin / 3)).is_err();
                    let rank = if is_first { priority(edge) } else { None };
                    rank.map(|rank| (rank, [start.min(end), start.max(end)]))
                });
                ranked.collect()
            })
            .collect();
        let mut ranked: Vec<(f64, [u32; 2])> = found.into_iter().flatten().collect();
        ranked.par_sort_unstable_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
        ranked.into_iter().map(|(_, ends)| ends).collect()
    }
}
