//! Selection of the triangles and vertices that a move touches.
//!
//! Selections are sorted, so that results do not depend on the order in which elements are found.

use rayon::prelude::*;

use super::{path::Segment, surface::Surface};

/// Elements that one task examines. Larger leaves threads idle; smaller spends time on scheduling.
const CHUNK: usize = 4096;

impl Surface {
    /// All triangles that a segment may touch, and some that it does not. Their selection and order
    /// depend on the history of the tree, so results must not depend on either.
    pub(super) fn triangles_near(&self, segment: &Segment) -> Vec<u32> {
        let mut near = Vec::new();
        self.tree.visit(|bounds| segment.may_touch_within(bounds), |triangle| near.push(triangle));
        near
    }

    /// The triangles at the vertices `moved`, all of which must be in `near`.
    pub(super) fn triangles_at(&mut self, moved: &[u32], near: &[u32]) -> Vec<u32> {
        let vertices = &mut self.vertex_marks;
        vertices.clear();
        vertices.resize(self.positions.items().len());
        vertices.extend(moved.iter().copied());
        let (vertices, triangles) = (&self.vertex_marks, self.topology.triangles());
        let has_moved = |&triangle: &u32| {
            let triangle = &triangles[triangle as usize];
            triangle.is_alive() && triangle.vertices.iter().any(|&vertex| vertices.contains(vertex))
        };
        let found = near.par_chunks(CHUNK).map(|chunk| chunk.iter().copied().filter(has_moved).collect::<Vec<u32>>());
        let found: Vec<Vec<u32>> = found.collect();
        let marks = &mut self.triangle_marks;
        marks.clear();
        marks.resize(self.corners.items().len());
        marks.extend(found.into_iter().flatten());
        marks.sorted()
    }

    /// The vertices of `triangles`, without removed triangles.
    pub(super) fn vertices_of(&mut self, triangles: &[u32]) -> Vec<u32> {
        let marks = &mut self.vertex_marks;
        marks.clear();
        marks.resize(self.positions.items().len());
        for &triangle in triangles {
            let triangle = &self.topology.triangles()[triangle as usize];
            if triangle.is_alive() {
                marks.extend(triangle.vertices);
            }
        }
        marks.sorted()
    }

    /// The triangles at `vertices`, and `others`.
    pub(super) fn triangles_around(&mut self, vertices: &[u32], others: &[u32]) -> Vec<u32> {
        let topology = &self.topology;
        let around = |chunk: &[u32]| -> Vec<u32> {
            chunk.iter().flat_map(|&vertex| topology.fan(vertex)).map(|half_edge| half_edge / 3).collect()
        };
        let around: Vec<Vec<u32>> = vertices.par_chunks(CHUNK).map(around).collect();
        let marks = &mut self.triangle_marks;
        marks.clear();
        marks.resize(self.corners.items().len());
        marks.extend(around.into_iter().flatten());
        marks.extend(others.iter().copied());
        marks.sorted()
    }
}
