//! Flips of edges between badly shaped triangles.

use glam::DVec3;
use isochore_mesh::previous_half_edge;

use super::{edits::Edits, pass::Pass};

/// Cosine of the angle between two triangles that may exchange their edge. Larger refuses curved
/// surface; smaller digs into creases.
const FLAT: f64 = 0.95;

/// Factor by which a flip must improve the [`shape`] of the worse triangle. Nearer to one,
/// edges flip to and fro with every move of a brush that rubs; larger leaves slivers.
pub(super) const FOR_SHAPE: f64 = 1.6;

/// The same factor for an edge that is too long. It cannot flip back before the flow makes it short
/// again, so any gain suffices. Larger splits edges that a flip would have fixed; smaller makes
/// slivers.
pub(super) const FOR_LENGTH: f64 = 1.0;

/// Area of a triangle over the sum of its squared sides: largest if they are equal, zero if it is
/// flat, NaN for a point (R. Bank, *PLTMG*, 1998, section 2.2, up to a factor).
fn shape([a, b, c]: [DVec3; 3]) -> f64 {
    let sides = a.distance_squared(b) + b.distance_squared(c) + c.distance_squared(a);
    0.5 * (b - a).cross(c - a).length() / sides
}

/// Result of flipping edges.
#[derive(Debug, Default)]
pub(super) struct Flips {
    /// The two triangles at each flipped edge.
    pub(super) triangles: Vec<u32>,
    /// Volume that each flip adds.
    pub(super) volumes: Vec<f64>,
}

impl From<Flips> for Edits {
    fn from(flips: Flips) -> Self {
        Self {
            triangles: flips.triangles,
            flipped_edges: flips.volumes.len(),
            remeshing_volumes: flips.volumes,
            ..Self::default()
        }
    }
}

impl Pass<'_> {
    /// Flips those edges that improve the worse of their two triangles by more than the factor
    /// `worthwhile`.
    pub(super) fn flip(&mut self, mut edges: Vec<[u32; 2]>, worthwhile: f64) -> Flips {
        let mut flips = Flips::default();
        edges.sort_unstable();
        edges.dedup();
        for edge in edges {
            let Some(half_edge) = self.editable(edge) else { continue };
            if !self.is_better_flipped(half_edge, worthwhile) {
                continue;
            }
            let triangles = [half_edge / 3, self.surface.topology.twin(half_edge) / 3];
            flips.volumes.push(self.surface.flip(half_edge));
            flips.triangles.extend(triangles);
        }
        flips
    }

    fn is_better_flipped(&self, half_edge: u32, worthwhile: f64) -> bool {
        let surface = &*self.surface;
        let topology = &surface.topology;
        if !(surface.is_seamless(half_edge) && topology.can_flip(half_edge)) {
            return false;
        }
        let twin = topology.twin(half_edge);
        let [a, b] = [half_edge, twin].map(|side| surface.position(topology.start(side)));
        let [c, d] = [half_edge, twin].map(|side| surface.position(topology.start(previous_half_edge(side))));
        let is_frozen = |side: u32| surface.is_frozen(topology.start(previous_half_edge(side)));
        if c.distance_squared(d) > self.limits.longest2 || is_frozen(half_edge) || is_frozen(twin) {
            return false;
        }
        let (before, after) = ([[a, b, c], [b, a, d]], [[a, d, c], [b, c, d]]);
        let worst = |triangles: [[DVec3; 3]; 2]| shape(triangles[0]).min(shape(triangles[1]));
        let is_better = worst(after) > worthwhile * worst(before);
        if !is_better {
            return false;
        }
        let normal = |[a, b, c]: [DVec3; 3]| (b - a).cross(c - a).normalize_or_zero();
        let [before, after] = [before, after].map(|triangles| triangles.map(normal));
        before[0].dot(before[1]) > FLAT
            && after.iter().all(|after| before.iter().all(|before| before.dot(*after) > FLAT))
    }
}
