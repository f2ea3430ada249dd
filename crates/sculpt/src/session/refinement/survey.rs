//! Search for edges to split.

use glam::DVec3;
use rayon::prelude::*;

use super::pass::Pass;
use crate::session::surface::Surface;

/// Triangles that one task examines. Larger leaves threads idle; smaller spends time on scheduling.
const CHUNK: usize = 2048;

/// A vertex has moved noticeably if it has by this fraction of the allowed deviation. Larger leaves long
/// edges at the rim of the tool's reach; smaller splits edges where rounding moves vertices.
const MOVED: f64 = 1e-3;

/// Tests whether a triangle with these corners is examined.
pub(super) type MayTouch<'a> = &'a (dyn Fn([DVec3; 3]) -> bool + Sync);

/// Edges that do not meet the limits, by their ends, the smaller first.
#[derive(Debug, Default)]
pub(super) struct Survey {
    /// Edges to split, in ascending order.
    pub(super) bad: Vec<[u32; 2]>,
    /// Edges that are too short in the base to be split.
    pub(super) refused: Vec<[u32; 2]>,
    /// Evaluations of the field.
    pub(super) evaluations: u64,
}

impl Pass<'_> {
    /// Finds those edges of `triangles` that are too long or deviate too much. Without `may_touch`,
    /// only edges with an end that has moved noticeably count as too long: the walks across longest
    /// edges lead to triangles far from the tool.
    pub(super) fn survey(&mut self, triangles: &[u32], may_touch: Option<MayTouch<'_>>) -> Survey {
        let (surface, limits) = (&*self.surface, self.limits);
        let examine = |chunk: &[u32]| -> Vec<[u32; 2]> {
            let long = |&triangle: &u32| surface.edges_longer(triangle, limits.finest, may_touch);
            chunk.iter().flat_map(long).flatten().collect()
        };
        let parts: Vec<Vec<[u32; 2]>> = triangles.par_chunks(CHUNK).map(examine).collect();
        let mut edges = parts.concat();
        edges.sort_unstable();
        edges.dedup();
        edges.retain(|&ends| self.editable(ends).is_some());

        let surface = &*self.surface;
        let mut survey = Survey::default();
        let counts = |ends: [u32; 2]| {
            may_touch.is_some() || ends.iter().any(|&end| surface.has_moved(end, MOVED * limits.deviation))
        };
        let is_too_long = |&ends: &[u32; 2]| surface.length(ends) > limits.longest && counts(ends);
        let (mut bad, doubtful): (Vec<_>, Vec<_>) = edges.into_iter().partition(is_too_long);
        let followed = self.midpoints.follow(surface, self.path, &doubtful);
        survey.evaluations = followed.evaluations;
        let deviates = |(ends, image): &([u32; 2], DVec3)| {
            distance_to_segment(*image, ends.map(|end| surface.position(end))) > limits.deviation
        };
        bad.extend(doubtful.into_iter().zip(followed.images).filter(deviates).map(|(ends, _)| ends));
        bad.sort_unstable();
        (survey.bad, survey.refused) = bad.into_iter().partition(|&ends| self.is_divisible(ends));
        survey
    }

    /// Whether an edge is long enough in the base to be split.
    pub(super) fn is_divisible(&self, ends: [u32; 2]) -> bool {
        let [a, b] = ends.map(|end| self.surface.base(end));
        a.distance(b) >= self.limits.least_in_base
    }
}

impl Surface {
    /// Whether a vertex is farther than `distance` from its position on the base.
    fn has_moved(&self, vertex: u32, distance: f64) -> bool {
        self.base(vertex).distance_squared(self.position(vertex)) > distance * distance
    }

    /// Length of the edge between two vertices.
    pub(super) fn length(&self, [a, b]: [u32; 2]) -> f64 {
        self.position(a).distance(self.position(b))
    }

    /// Edges of a triangle that are longer than `least`, none if the triangle does not pass
    /// `may_touch`.
    fn edges_longer(&self, triangle: u32, least: f64, may_touch: Option<MayTouch<'_>>) -> [Option<[u32; 2]>; 3] {
        let Some(corners) = self.corners_of(triangle) else { return [None; 3] };
        let is_long = [0, 1, 2].map(|side| corners[side].distance_squared(corners[(side + 1) % 3]) > least * least);
        if is_long == [false; 3] || may_touch.is_some_and(|may_touch| !may_touch(corners)) {
            return [None; 3];
        }
        let edges = self.edges_of(triangle);
        [0, 1, 2].map(|side| is_long[side].then_some(edges[side]))
    }
}

/// Distance of a point from the segment between two points.
pub(in crate::session) fn distance_to_segment(point: DVec3, [a, b]: [DVec3; 2]) -> f64 {
    let along = (point - a).dot(b - a) / (b - a).length_squared();
    let along = if along.is_finite() { along.clamp(0.0, 1.0) } else { 0.0 };
    point.distance(a.lerp(b, along))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn measures_the_distance_to_the_nearest_point_of_a_segment() {
        let ends = [DVec3::ZERO, 2.0 * DVec3::X];
        assert_eq!(distance_to_segment(DVec3::new(0.3, 4.0, 3.0), ends), 5.0);
        assert_eq!(distance_to_segment(DVec3::new(5.0, 4.0, 0.0), ends), 5.0);
        assert_eq!(distance_to_segment(DVec3::new(0.0, 4.0, 3.0), [DVec3::ZERO; 2]), 5.0);
    }
}
