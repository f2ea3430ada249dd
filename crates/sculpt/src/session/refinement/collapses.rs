//! Collapses of squeezed edges.

use std::cmp::Reverse;

use glam::DVec3;
use isochore_mesh::{NONE, previous_half_edge};

use super::{edits::Edits, pass::Pass};

/// An edge is collapsed only if the stroke has squeezed it below this fraction of its length at the
/// beginning of the stroke. Larger destroys detail of a mesh that is merely finer than the tool;
/// smaller leaves slivers.
const SQUEEZED: f64 = 0.5;

/// Cosine of the angle by which a collapse may turn a triangle. Larger refuses collapses of curved
/// surface; smaller allows folds.
const MOST_TURN: f64 = 0.7;

/// Result of collapsing edges.
#[derive(Debug, Default)]
pub(super) struct Collapses {
    /// Triangles at the removed vertices, removed triangles included.
    pub(super) triangles: Vec<u32>,
    /// Volume that each collapse adds.
    pub(super) volumes: Vec<f64>,
}

impl From<Collapses> for Edits {
    fn from(collapses: Collapses) -> Self {
        Self {
            triangles: collapses.triangles,
            removed_vertices: collapses.volumes.len(),
            remeshing_volumes: collapses.volumes,
            ..Self::default()
        }
    }
}

impl Pass<'_> {
    /// Collapses edges that the stroke has squeezed, shortest first.
    pub(super) fn collapse(&mut self, mut short: Vec<(f64, [u32; 2])>) -> Collapses {
        let mut collapses = Collapses::default();
        short.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        short.dedup_by_key(|(_, edge)| *edge);
        for (_, ends) in short {
            let Some(half_edge) = self.is_squeezed(ends).then(|| self.harmless_collapse(ends)).flatten() else {
                continue;
            };
            let removed = self.surface.topology.start(half_edge);
            collapses.triangles.extend(self.surface.topology.fan(removed).map(|outgoing| outgoing / 3));
            collapses.volumes.push(self.surface.collapse(half_edge));
        }
        collapses
    }

    fn is_squeezed(&self, ends: [u32; 2]) -> bool {
        let length2 = |ends: [DVec3; 2]| ends[0].distance_squared(ends[1]);
        let now = length2(ends.map(|vertex| self.surface.position(vertex)));
        let before = length2(ends.map(|vertex| self.surface.base(vertex)));
        now < self.limits.shortest2 && now < SQUEEZED * SQUEEZED * before
    }

    /// The half-edge whose start can be merged into its end. Inserted vertices, which have larger
    /// numbers, are removed first.
    fn harmless_collapse(&self, ends: [u32; 2]) -> Option<u32> {
        let half_edge = self.editable(ends)?;
        let topology = &self.surface.topology;
        let mut directions = [half_edge, topology.twin(half_edge)];
        directions.sort_by_key(|&half_edge| Reverse(if half_edge == NONE { 0 } else { topology.start(half_edge) }));
        directions.into_iter().find(|&half_edge| self.is_harmless(half_edge))
    }

    /// Whether the start of a half-edge can be merged into its end without a fold, a torn seam, or
    /// an edge that is too long.
    fn is_harmless(&self, half_edge: u32) -> bool {
        if half_edge == NONE {
            return false;
        }
        let surface = &*self.surface;
        let topology = &surface.topology;
        let (removed, kept) = (topology.start(half_edge), topology.end(half_edge));
        if !(surface.is_free(removed) && topology.can_collapse(half_edge)) {
            return false;
        }
        let [old, new] = [removed, kept].map(|vertex| surface.position(vertex));
        if self.mask.is_some_and(|mask| mask.is_held(old)) {
            return false;
        }
        topology.fan(removed).all(|outgoing| {
            let [b, c] = [topology.end(outgoing), topology.start(previous_half_edge(outgoing))];
            // The two triangles at the edge vanish.
            if b == kept || c == kept {
                return true;
            }
            let [b, c] = [b, c].map(|vertex| surface.position(vertex));
            let normal = |a: DVec3| (b - a).cross(c - a);
            let (before, after) = (normal(old), normal(new));
            let is_upright = before.dot(after) > MOST_TURN * before.length() * after.length();
            let longest2 = self.limits.longest2;
            is_upright && new.distance_squared(b) <= longest2 && new.distance_squared(c) <= longest2
        })
    }
}
