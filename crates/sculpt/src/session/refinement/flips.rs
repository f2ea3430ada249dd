use glam::DVec3;
use isochore_mesh::previous_half_edge;

use super::{InteractiveRefinement, Limits, Pass};

/// A triangle is looked at when the square of its longest side is this multiple of the sum of the others': at two, with equal short
/// sides, an angle of 120°. Nearer to one, meshes with good triangles are cut anew wherever a tool passes; larger leaves slivers.
pub(super) const OBTUSE: f64 = 1.5;

/// Cosine of the angle between two triangles that may exchange their edge. Larger refuses curved surface; smaller digs into creases.
const FLAT: f64 = 0.95;

/// The sum of the cotangents of the two angles opposite to an edge is below zero where the flip makes the smallest angle larger (the
/// criterion of Delaunay). Nearer to zero, edges of squares flip to and fro; farther below, less is mended.
const WORTHWHILE: f64 = -0.4;

impl Pass<'_> {
    /// Turns edges opposite to obtuse angles where that makes better triangles of the two.
    pub(super) fn flip(&mut self, mut edges: Vec<[u32; 2]>, options: &InteractiveRefinement, limits: &Limits) {
        edges.sort_unstable();
        edges.dedup();
        for edge in edges {
            let Some(half_edge) = self.editable(edge, options) else { continue };
            if !self.is_better_flipped(half_edge, limits) {
                continue;
            }
            let triangles = [half_edge / 3, self.surface.topology.twin(half_edge) / 3];
            let gained = self.surface.flip(half_edge);
            self.stroke.remeshing.add(gained);
            self.stroke.remeshed += gained.abs();
            self.edited.extend(triangles);
            self.done.flipped_edges += 1;
        }
    }

    fn is_better_flipped(&self, half_edge: u32, limits: &Limits) -> bool {
        let surface = &*self.surface;
        let topology = &surface.topology;
        if !(surface.is_seamless(half_edge) && topology.can_flip(half_edge)) {
            return false;
        }
        let twin = topology.twin(half_edge);
        let [a, b] = [half_edge, twin].map(|side| surface.position(topology.start(side)));
        let [c, d] = [half_edge, twin].map(|side| surface.position(topology.start(previous_half_edge(side))));
        let is_frozen = |side: u32| {
            let apex = topology.start(previous_half_edge(side));
            self.frozen.get(apex as usize).copied().unwrap_or(false)
        };
        if c.distance_squared(d) > limits.longest2 || is_frozen(half_edge) || is_frozen(twin) {
            return false;
        }
        let cotangent = |apex: DVec3| (a - apex).dot(b - apex) / (a - apex).cross(b - apex).length();
        // Without area the sum is no number, and nothing is known about which way is better.
        let gain = cotangent(c) + cotangent(d);
        if gain.is_nan() || gain > WORTHWHILE {
            return false;
        }
        let normal = |[a, b, c]: [DVec3; 3]| (b - a).cross(c - a).normalize_or_zero();
        let before = [normal([a, b, c]), normal([b, a, d])];
        let after = [normal([a, d, c]), normal([b, c, d])];
        before[0].dot(before[1]) > FLAT
            && after.iter().all(|after| before.iter().all(|before| before.dot(*after) > FLAT))
    }
}
