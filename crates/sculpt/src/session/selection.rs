//! What a move touches: sets of triangles and vertices, in ascending order so that no bit depends on how they were found.

use isochore_mesh::Aabb;

use super::surface::Surface;

impl Surface {
    /// The triangles whose own boxes touch a box: which leaves of the tree they are in, which depends on its history, plays no part.
    pub(super) fn triangles_in(&mut self, bounds: Aabb) -> Vec<u32> {
        let (triangles, positions) = (self.topology.triangles(), self.positions.items());
        let touches = |triangle: u32| {
            let triangle = &triangles[triangle as usize];
            triangle.is_alive() && {
                let own = Aabb::of(triangle.vertices.map(|vertex| positions[vertex as usize]));
                own.min.cmple(bounds.max).all() && own.max.cmpge(bounds.min).all()
            }
        };
        let marks = &mut self.triangle_marks;
        marks.clear();
        marks.resize(self.corners.items().len());
        self.tree.visit_box(bounds, |triangle| {
            if touches(triangle) {
                marks.insert(triangle);
            }
        });
        marks.sorted()
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
        let marks = &mut self.triangle_marks;
        marks.clear();
        marks.resize(self.corners.items().len());
        for &vertex in vertices {
            marks.extend(self.topology.fan(vertex).map(|half_edge| half_edge / 3));
        }
        marks.extend(others.iter().copied());
        marks.sorted()
    }
}
