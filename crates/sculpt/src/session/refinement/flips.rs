//! Flips of edges between badly shaped triangles.

use glam::DVec3;
use isochore_mesh::{NONE, previous_half_edge};

use super::{
    pass::Pass,
    tidying::{LEAST_SHAPE, Tidied, shape},
};

/// Cosine of the angle between a new triangle and the mean of the two that it replaces. Larger refuses
/// curved surface; smaller digs into creases.
const FLAT: f64 = 0.7;

/// Factor by which a flip must improve the [`shape`] of the worse triangle. Nearer to one makes
/// many flips with little effect; larger leaves slivers.
const WORTHWHILE: f64 = 1.2;

/// Most sweeps over edges around those that were flipped. Larger takes more time; smaller leaves
/// slivers that several flips together would remove.
const MOST_SWEEPS: usize = 4;

impl Pass<'_> {
    /// Flips those edges of `triangles` that improve the worse of their two triangles enough, and
    /// then edges of the flipped triangles.
    pub(super) fn flip(&mut self, triangles: &[u32]) -> Tidied {
        let mut tidied = self.sweep_flips(triangles);
        let mut last = tidied.triangles.clone();
        for _ in 1..MOST_SWEEPS {
            let sweep = self.sweep_flips(&last);
            if sweep.flipped_edges == 0 {
                break;
            }
            last.clone_from(&sweep.triangles);
            tidied += sweep;
        }
        tidied
    }

    fn sweep_flips(&mut self, triangles: &[u32]) -> Tidied {
        let mut tidied = Tidied::default();
        for ends in self.edges_among(triangles, |half_edge| self.is_better_flipped(half_edge)) {
            let Some(half_edge) = self.editable(ends) else { continue };
            if !self.is_better_flipped(half_edge) {
                continue;
            }
            let pair = self.surface.triangles_beside(half_edge);
            tidied.volumes.push(self.surface.flip(half_edge));
            tidied.flipped_edges += 1;
            tidied.triangles.extend(pair);
            self.surface.update_tree(&pair);
        }
        tidied
    }

    fn is_better_flipped(&self, half_edge: u32) -> bool {
        let surface = &*self.surface;
        let topology = &surface.topology;
        let twin = topology.twin(half_edge);
        let is_chosen = |half_edge: u32| surface.triangle_marks.contains(half_edge / 3);
        if twin == NONE || !(is_chosen(half_edge) || is_chosen(twin)) {
            return false;
        }
        let [a, b] = [half_edge, twin].map(|side| surface.position(topology.start(side)));
        let [c, d] = [half_edge, twin].map(|side| surface.position(topology.start(previous_half_edge(side))));
        let is_frozen = |side: u32| surface.is_frozen(topology.start(previous_half_edge(side)));
        if c.distance(d) > self.limits.longest || is_frozen(half_edge) || is_frozen(twin) {
            return false;
        }
        let (before, after) = ([[a, b, c], [b, a, d]], [[a, d, c], [b, c, d]]);
        let worst = |triangles: [[DVec3; 3]; 2]| shape(triangles[0]).min(shape(triangles[1]));
        let is_better = worst(after) > LEAST_SHAPE.max(WORTHWHILE * worst(before));
        if !is_better || gap([a, b], [c, d]) > self.wear() {
            return false;
        }
        if !(surface.is_seamless(half_edge) && topology.can_flip(half_edge)) {
            return false;
        }
        let normal = |[a, b, c]: [DVec3; 3]| (b - a).cross(c - a);
        let [one, other] = before.map(normal);
        let mean = one + other;
        after.map(normal).iter().all(|after| after.dot(mean) > FLAT * after.length() * mean.length())
            && !self.would_fold(&after, &[half_edge / 3, twin / 3])
            && !self.would_cross(&after, &[half_edge / 3, twin / 3])
    }
}

/// Distance between the lines through two pairs of points; zero for parallel lines.
fn gap([a, b]: [DVec3; 2], [c, d]: [DVec3; 2]) -> f64 {
    (c - a).dot((b - a).cross(d - c).normalize_or_zero()).abs()
}
