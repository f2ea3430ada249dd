//! Collapses of squeezed edges.

use std::cmp::Reverse;

use glam::DVec3;
use isochore_mesh::{NONE, nearest_on_triangle, previous_half_edge};

use super::{
    pass::Pass,
    tidying::{GOOD_SHAPE, LEAST_SHAPE, Tidied, shape},
};

/// An edge is collapsed only if the stroke has squeezed it below this fraction of its length at the
/// beginning of the stroke. Larger destroys detail of a mesh that is merely finer than the tool;
/// smaller leaves slivers.
const SQUEEZED: f64 = 0.5;

/// Cosine of the angle by which a collapse may turn a triangle. Larger refuses collapses of curved
/// surface; smaller allows folds.
const MOST_TURN: f64 = 0.7;

/// Vertices that strokes have inserted are removed if that makes no edge longer than this fraction of
/// the longest allowed one. Larger coarsens where the next stroke refines again; smaller leaves
/// triangles that nothing needs.
const SUPERFLUOUS: f64 = 0.5;

impl Pass<'_> {
    /// Collapses those edges of `triangles` that the stroke has squeezed, and edges at inserted
    /// vertices that the shape does not need. Shortest first.
    pub(super) fn collapse(&mut self, triangles: &[u32]) -> Tidied {
        let mut tidied = Tidied::default();
        if self.limits.shortest == 0.0 {
            return tidied;
        }
        let edges = self.edges_among(triangles, |half_edge| self.may_collapse(half_edge)).into_iter();
        let mut short: Vec<(f64, [u32; 2])> = edges.map(|ends| (self.surface.length(ends), ends)).collect();
        short.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        for (_, ends) in short {
            let Some(half_edge) = self.harmless_collapse(ends) else { continue };
            let topology = &self.surface.topology;
            let fan: Vec<u32> = topology.fan(topology.start(half_edge)).map(|outgoing| outgoing / 3).collect();
            tidied.volumes.push(self.surface.collapse(half_edge));
            tidied.removed_vertices += 1;
            self.surface.update_tree(&fan);
            tidied.triangles.extend(fan);
        }
        tidied
    }

    /// Whether an edge is short enough, and its collapse is harmless before any other edit.
    fn may_collapse(&self, half_edge: u32) -> bool {
        let topology = &self.surface.topology;
        let ends = [topology.start(half_edge), topology.end(half_edge)];
        let is_short = self.surface.length(ends) < SUPERFLUOUS * self.limits.longest || self.is_squeezed(ends);
        is_short && self.harmless_collapse(ends).is_some()
    }

    fn is_squeezed(&self, ends: [u32; 2]) -> bool {
        let [start, end] = ends.map(|vertex| self.surface.start(vertex));
        let now = self.surface.length(ends);
        now < self.limits.shortest && now < SQUEEZED * start.distance(end)
    }

    /// The half-edge whose start can be merged into its end. Inserted vertices, which have larger
    /// numbers, are removed first.
    fn harmless_collapse(&self, ends: [u32; 2]) -> Option<u32> {
        let half_edge = self.editable(ends)?;
        let is_squeezed = self.is_squeezed(ends);
        let topology = &self.surface.topology;
        let mut directions = [half_edge, topology.twin(half_edge)];
        directions.sort_by_key(|&half_edge| Reverse(if half_edge == NONE { 0 } else { topology.start(half_edge) }));
        directions.into_iter().find(|&half_edge| self.is_harmless(half_edge, is_squeezed))
    }

    /// Whether the start of a half-edge can be merged into its end without a fold, a crossing, a
    /// torn seam, or an edge that is too long. If the edge is not squeezed, the start must be an
    /// inserted vertex, and the worst triangle must not become worse unless all stay good.
    fn is_harmless(&self, half_edge: u32, is_squeezed: bool) -> bool {
        if half_edge == NONE {
            return false;
        }
        let surface = &*self.surface;
        let topology = &surface.topology;
        let (removed, kept) = (topology.start(half_edge), topology.end(half_edge));
        let is_inserted = removed as usize >= surface.opened.positions.len();
        if !(surface.is_free(removed) && (is_squeezed || is_inserted)) {
            return false;
        }
        let [old, new] = [removed, kept].map(|vertex| surface.position(vertex));
        if self.mask.is_some_and(|mask| mask.is_held(old)) {
            return false;
        }
        let longest = if is_squeezed { self.limits.longest } else { SUPERFLUOUS * self.limits.longest };
        let reach = topology.fan(removed).map(|outgoing| old.distance(surface.position(topology.end(outgoing))));
        let longest = reach.fold(longest, f64::max);
        let mut fan = Vec::new();
        let mut remaining = Vec::new();
        for outgoing in topology.fan(removed) {
            fan.push(outgoing / 3);
            let [b, c] = [topology.end(outgoing), topology.start(previous_half_edge(outgoing))];
            // The two triangles at the edge vanish.
            if b == kept || c == kept {
                continue;
            }
            let [b, c] = [b, c].map(|vertex| surface.position(vertex));
            let normal = |a: DVec3| (b - a).cross(c - a);
            let (before, after) = (normal(old), normal(new));
            let is_upright = before.dot(after) > MOST_TURN * before.length() * after.length();
            if !is_upright || new.distance(b) > longest || new.distance(c) > longest {
                return false;
            }
            remaining.push([new, b, c]);
        }
        let worst = |shapes: &mut dyn Iterator<Item = [DVec3; 3]>| shapes.map(shape).fold(f64::INFINITY, f64::min);
        let before = worst(&mut fan.iter().filter_map(|&triangle| surface.corners_of(triangle)));
        let after = worst(&mut remaining.iter().copied());
        if after < LEAST_SHAPE || (!is_squeezed && after < before.min(GOOD_SHAPE)) {
            return false;
        }
        let squared = remaining.iter().map(|corners| nearest_on_triangle(old, corners).1).fold(f64::INFINITY, f64::min);
        squared.sqrt() <= self.wear()
            && topology.can_collapse(half_edge)
            && !self.would_fold(&remaining, &fan)
            && !self.would_cross(&remaining, &fan)
    }
}
