//! What a move touches: sets of triangles and vertices, in ascending order so that no bit depends on how they were found.

use isochore_mesh::Aabb;

use super::surface::Surface;

impl Surface {
    /// The triangles that may touch a box, and some more.
    pub(super) fn triangles_in(&mut self, bounds: Aabb) -> Vec<u32> {
        let mut found = Vec::new();
        self.tree.visit_box(bounds, |triangle| found.push(triangle));
        found.sort_unstable();
        found
    }

    /// The vertices of `triangles` that lie in a box.
    pub(super) fn vertices_in(&mut self, triangles: &[u32], bounds: Aabb) -> Vec<u32> {
        let mut vertices = self.vertices_of(triangles);
        let positions = self.positions.items();
        vertices.retain(|&vertex| bounds.distance(positions[vertex as usize]) == 0.0);
        vertices
    }

    /// The vertices of those of `triangles` that are there.
    pub(super) fn vertices_of(&mut self, triangles: &[u32]) -> Vec<u32> {
        self.vertex_marks.clear(self.positions.items().len());
        let mut vertices = Vec::with_capacity(triangles.len());
        for &triangle in triangles {
            let triangle = &self.topology.triangles()[triangle as usize];
            if triangle.is_alive() {
                vertices.extend(triangle.vertices.iter().filter(|&&vertex| self.vertex_marks.insert(vertex)));
            }
        }
        vertices.sort_unstable();
        vertices
    }

    /// The triangles at `vertices`.
    pub(super) fn triangles_around(&mut self, vertices: &[u32]) -> Vec<u32> {
        self.triangle_marks.clear(self.corners.items().len());
        let mut triangles = Vec::with_capacity(2 * vertices.len());
        for &vertex in vertices {
            let fan = self.topology.fan(vertex).map(|half_edge| half_edge / 3);
            triangles.extend(fan.filter(|&triangle| self.triangle_marks.insert(triangle)));
        }
        triangles.sort_unstable();
        triangles
    }

    /// Takes `others` into `triangles`, which [`triangles_around`](Self::triangles_around) has just found.
    pub(super) fn include(&mut self, triangles: &mut Vec<u32>, others: &[u32]) {
        self.triangle_marks.resize(self.corners.items().len());
        triangles.extend(others.iter().filter(|&&triangle| self.triangle_marks.insert(triangle)));
    }
}
