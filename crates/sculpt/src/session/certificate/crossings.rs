//! Triangles that cross and did not cross in the mesh as opened.

use glam::DVec3;
use isochore_mesh::{NoProgress, SelfIntersections, TriMesh, triangles_intersect};

use crate::session::surface::Surface;

/// Two triangles that cross, the smaller number first.
pub(in crate::session) type Pair = [u32; 2];

/// Triangles that crossed as opened may cross in parts that are larger by this factor, measured on
/// the mesh as opened. Larger overlooks new crossings beside old ones; smaller reports old ones whose
/// triangles were exchanged for others.
const GROWTH: f64 = 1.01;

impl Surface {
    /// The new pairs of crossing triangles of which at least one is in `triangles`, in ascending
    /// order, if each vertex is in the position `at`. The tree must contain these positions.
    pub(in crate::session) fn new_crossings(&mut self, triangles: &[u32], at: fn(&Self, u32) -> DVec3) -> Vec<Pair> {
        let mut pairs = self.crossings(triangles, at);
        // By the opened triangles that contain them.
        pairs.sort_unstable_by_key(|&pair| (self.parents(pair), pair));
        let mut new: Vec<Pair> = pairs
            .chunk_by(|&one, &other| self.parents(one) == self.parents(other))
            .filter(|pairs| self.are_new(pairs))
            .flatten()
            .copied()
            .collect();
        new.sort_unstable();
        new
    }

    /// The pairs of crossing triangles of which at least one is in `triangles`.
    fn crossings(&mut self, triangles: &[u32], at: fn(&Self, u32) -> DVec3) -> Vec<Pair> {
        let mut near = self.tree.triangles_near(triangles);
        near.retain(|&triangle| self.topology.triangles()[triangle as usize].is_alive());
        if near.is_empty() {
            return Vec::new();
        }
        let part = self.part(&near, at);
        // All triangles of a session are valid.
        let Ok(found) = SelfIntersections::of(&part, &NoProgress) else { return Vec::new() };
        let marks = &mut self.triangle_marks;
        marks.clear();
        marks.resize(self.corners.items().len());
        marks.extend(triangles.iter().copied());
        let pairs = found.pairs().iter().map(|pair| pair.map(|index| near[index as usize]));
        pairs.filter(|pair| pair.iter().any(|&triangle| self.triangle_marks.contains(triangle))).collect()
    }

    /// The mesh of some triangles.
    fn part(&mut self, triangles: &[u32], at: fn(&Self, u32) -> DVec3) -> TriMesh {
        let count = self.positions.items().len();
        let mut numbers = std::mem::take(&mut self.numbers);
        numbers.resize(count, 0);
        let mut vertices: Vec<u32> = Vec::new();
        let mut number = |vertex: u32| {
            // An entry is valid only if `vertices` confirms it.
            let known = &mut numbers[vertex as usize];
            if vertices.get(*known as usize) != Some(&vertex) {
                *known = vertices.len() as u32;
                vertices.push(vertex);
            }
            *known
        };
        let records = self.topology.triangles();
        let corners = triangles.iter().map(|&triangle| records[triangle as usize].vertices.map(&mut number)).collect();
        self.numbers = numbers;
        TriMesh::new(vertices.into_iter().map(|vertex| at(self, vertex)).collect(), corners)
    }

    /// The opened triangles that contain those of a pair, in ascending order.
    fn parents(&self, pair: Pair) -> Pair {
        let [a, b] = pair.map(|triangle| self.patches.get(triangle).parent);
        [a.min(b), a.max(b)]
    }

    /// Whether pairs of triangles of the same two opened triangles are new.
    fn are_new(&self, pairs: &[Pair]) -> bool {
        let parents = self.parents(pairs[0]);
        let [one, other] = parents.map(|parent| self.opened.corners(parent as usize));
        let were_in_contact = triangles_intersect(one, other) || self.touch_at_twins(parents);
        if parents[0] == parents[1] || !were_in_contact {
            return true;
        }
        let now: f64 = triangles_of(pairs).into_iter().map(|triangle| self.opened_area(triangle)).sum();
        now > GROWTH * (area(one) + area(other))
    }

    /// Whether two opened triangles have different vertices at the same position. They touch there
    /// without crossing, but their parts may cross: if only one of two edges in the same place is
    /// split, the new vertex is on the other edge.
    fn touch_at_twins(&self, parents: Pair) -> bool {
        let [one, other] = parents.map(|parent| self.opened.triangles[parent as usize]);
        let at = |vertex: u32| self.opened.positions[vertex as usize];
        one.iter().any(|&a| other.iter().any(|&b| a != b && at(a) == at(b)))
    }

    /// Area of the part of the mesh as opened that a triangle represents.
    fn opened_area(&self, triangle: u32) -> f64 {
        let point = |render: u32| self.render.get(render).origin.map(|origin| self.opened.point_at(&origin));
        match self.corners.get(triangle).map(point) {
            [Some(a), Some(b), Some(c)] => area([a, b, c]),
            _ => 0.0,
        }
    }
}

/// The triangles of some pairs, in ascending order.
pub(in crate::session) fn triangles_of(pairs: &[Pair]) -> Vec<u32> {
    let mut triangles: Vec<u32> = pairs.iter().flatten().copied().collect();
    triangles.sort_unstable();
    triangles.dedup();
    triangles
}

/// Area of a triangle.
pub(super) fn area([a, b, c]: [DVec3; 3]) -> f64 {
    0.5 * (b - a).cross(c - a).length()
}
