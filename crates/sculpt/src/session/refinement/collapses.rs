use glam::DVec3;
use isochore_mesh::previous_half_edge;

use super::{InteractiveRefinement, Limits, Pass};

/// Only edges that the stroke has squeezed below this share of their length when it began are collapsed. Larger eats detail of the
/// mesh that is merely finer than the tool; smaller leaves slivers.
const SQUEEZED: f64 = 0.5;

/// Cosine of the angle by which a collapse may turn a triangle. Larger refuses collapses of curved surface; smaller lets folds in.
const MOST_TURN: f64 = 0.7;

impl Pass<'_> {
    /// Collapses edges that the stroke has squeezed, shortest first.
    pub(super) fn collapse(
        &mut self,
        mut short: Vec<(f64, [u32; 2])>,
        options: &InteractiveRefinement,
        limits: &Limits,
    ) {
        short.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        short.dedup_by_key(|(_, edge)| *edge);
        for (_, [a, b]) in short {
            let length2 = |ends: [DVec3; 2]| ends[0].distance_squared(ends[1]);
            let now = length2([a, b].map(|vertex| self.surface.position(vertex)));
            let before = length2([a, b].map(|vertex| self.surface.base(vertex)));
            if now >= limits.shortest2 || now >= SQUEEZED * SQUEEZED * before {
                continue;
            }
            let Some(half_edge) = self.editable([a, b], options) else { continue };
            let twin = self.surface.topology.twin(half_edge);
            // What was inserted goes first.
            let mut ways = [half_edge, twin];
            ways.sort_by_key(|&way| {
                std::cmp::Reverse(if way == isochore_mesh::NONE { 0 } else { self.surface.topology.start(way) })
            });
            let Some(way) = ways.into_iter().find(|&way| self.is_harmless(way, limits)) else { continue };
            let removed = self.surface.topology.start(way);
            self.edited.extend(self.surface.topology.fan(removed).map(|leaving| leaving / 3));
            let gained = self.surface.collapse(way);
            self.stroke.remeshing.add(gained);
            self.stroke.remeshed += gained.abs();
            self.done.removed_vertices += 1;
        }
    }

    /// Whether the start of a half-edge can be merged into its end without a fold, a seam torn, or an edge that is too long.
    fn is_harmless(&self, half_edge: u32, limits: &Limits) -> bool {
        if half_edge == isochore_mesh::NONE {
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
        topology.fan(removed).all(|leaving| {
            let [b, c] = [topology.end(leaving), topology.start(previous_half_edge(leaving))];
            if b == kept || c == kept {
                return true;
            }
            let [b, c] = [b, c].map(|vertex| surface.position(vertex));
            let normal = |a: DVec3| (b - a).cross(c - a);
            let (before, after) = (normal(old), normal(new));
            let is_upright = before.dot(after) > MOST_TURN * before.length() * after.length();
            is_upright && new.distance_squared(b) <= limits.longest2 && new.distance_squared(c) <= limits.longest2
        })
    }
}
