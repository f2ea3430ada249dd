use glam::DVec3;
use isochore_mesh::previous_half_edge;

use super::{InteractiveRefinement, Limits, Pass};

/// A triangle is looked at when the square of its longest side is this multiple of the sum of the others': with equal short sides,
/// an angle of 120°. Nearer to one, meshes with good triangles are cut anew wherever a tool passes; larger leaves slivers.
pub(super) const OBTUSE: f64 = 1.5;

/// Cosine of the angle between two triangles that may exchange their edge. Larger refuses curved surface; smaller digs into creases.
const FLAT: f64 = 0.95;

/// By how much the [shape](shape) of the worse triangle must become better. Nearer to one, edges flip to and fro with every move of a
/// brush that rubs; larger leaves slivers.
pub(super) const FOR_SHAPE: f64 = 1.6;

/// The same for an edge that is too long, which cannot come back before the flow makes it short again: any gain will do. Larger
/// splits where a flip would have done; smaller makes slivers.
pub(super) const FOR_LENGTH: f64 = 1.0;

/// Area of a triangle over the sum of the squares of its sides: largest where these are equal, zero where it is flat (R. Bank,
/// *PLTMG*, 1998, section 2.2, up to a factor). No number for a point.
fn shape([a, b, c]: [DVec3; 3]) -> f64 {
    let sides = a.distance_squared(b) + b.distance_squared(c) + c.distance_squared(a);
    0.5 * (b - a).cross(c - a).length() / sides
}

impl Pass<'_> {
    /// Turns edges where that makes better triangles of the two, by the factor `worthwhile` at least.
    pub(super) fn flip(
        &mut self,
        mut edges: Vec<[u32; 2]>,
        worthwhile: f64,
        options: &InteractiveRefinement,
        limits: &Limits,
    ) {
        edges.sort_unstable();
        edges.dedup();
        for edge in edges {
            let Some(half_edge) = self.editable(edge, options) else { continue };
            if !self.is_better_flipped(half_edge, worthwhile, limits) {
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

    fn is_better_flipped(&self, half_edge: u32, worthwhile: f64, limits: &Limits) -> bool {
        let surface = &*self.surface;
        let topology = &surface.topology;
        if !(surface.is_seamless(half_edge) && topology.can_flip(half_edge)) {
            return false;
        }
        let twin = topology.twin(half_edge);
        let [a, b] = [half_edge, twin].map(|side| surface.position(topology.start(side)));
        let [c, d] = [half_edge, twin].map(|side| surface.position(topology.start(previous_half_edge(side))));
        let is_frozen = |side: u32| surface.is_frozen(topology.start(previous_half_edge(side)));
        if c.distance_squared(d) > limits.longest2 || is_frozen(half_edge) || is_frozen(twin) {
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
