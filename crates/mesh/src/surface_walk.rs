//! Nearest points of a surface, searched from a nearby triangle.
//!
//! Unlike a search of a hierarchy, a walk stays on one sheet of the surface and does not cross
//! edges that the caller forbids, such as seams. It visits a few triangles if it starts nearby.

#[cfg(test)]
mod tests;

use glam::DVec3;

use crate::bvh::closest_on_triangle;
use crate::{EditTriangle, Feature, NONE, next_half_edge, previous_half_edge};

/// Maximum number of times that a walk moves on. Larger: a walk that starts far away takes longer.
/// Smaller: it ends before the nearest point, and the distance is overestimated.
const MOST_STEPS: usize = 256;

/// The result of a walk.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Foot {
    /// The triangle.
    pub triangle: u32,
    /// The point of the triangle that is nearest to the query point, model units.
    pub point: DVec3,
    /// Square of the distance between the two, square model units.
    pub squared: f64,
}

/// A surface to walk on: triangles with their neighbors, and positions of the vertices.
///
/// ```
/// use glam::DVec3;
/// use isochore_mesh::{EditMesh, SurfaceWalk, primitives};
///
/// let ball = primitives::icosphere(1.0, 3);
/// let mesh = EditMesh::new(&ball.triangles, ball.positions.len())?;
/// let walk = SurfaceWalk::new(mesh.triangles(), &ball.positions);
/// let foot = walk.nearest(0, 2.0 * DVec3::Z, |_| false);
/// assert!(foot.point.distance(DVec3::Z) < 0.02);
/// # Ok::<(), isochore_mesh::EditMeshError>(())
/// ```
#[derive(Debug, Clone, Copy)]
pub struct SurfaceWalk<'a> {
    triangles: &'a [EditTriangle],
    positions: &'a [DVec3],
}

impl<'a> SurfaceWalk<'a> {
    /// The surface of `triangles`, whose vertices have these positions.
    pub fn new(triangles: &'a [EditTriangle], positions: &'a [DVec3]) -> Self {
        Self { triangles, positions }
    }

    /// Walks from triangle `start` to neighbors that are nearer to `point` until none is. The
    /// result is the nearest point of the part that surrounds it, not of the whole surface.
    ///
    /// `is_barrier` returns whether the edge of a half-edge must not be crossed. It must give the
    /// same answer for both half-edges of an edge.
    ///
    /// # Panics
    /// If `start` is removed or out of range.
    pub fn nearest(&self, start: u32, point: DVec3, is_barrier: impl Fn(u32) -> bool) -> Foot {
        let (mut best, mut feature) = self.foot_in(start, point);
        for _ in 0..MOST_STEPS {
            let found = match feature {
                Feature::Face => break,
                Feature::Edge(side) => self.across(3 * best.triangle + u32::from(side), &is_barrier),
                Feature::Vertex(side) => self.around(3 * best.triangle + u32::from(side), point, &is_barrier),
            };
            let Some(found) = found.map(|triangle| self.foot_in(triangle, point)) else { break };
            if found.0.squared >= best.squared {
                break;
            }
            (best, feature) = found;
        }
        best
    }

    fn foot_in(&self, triangle: u32, point: DVec3) -> (Foot, Feature) {
        let corners = self.triangles[triangle as usize].vertices.map(|vertex| self.positions[vertex as usize]);
        let (nearest, squared) = closest_on_triangle(point, &corners);
        (Foot { triangle, point: nearest.point, squared }, nearest.feature)
    }

    fn twin(&self, half_edge: u32) -> u32 {
        self.triangles[half_edge as usize / 3].twins[half_edge as usize % 3]
    }

    /// The triangle on the other side of an edge, if the edge may be crossed.
    fn across(&self, half_edge: u32, is_barrier: &impl Fn(u32) -> bool) -> Option<u32> {
        let twin = self.twin(half_edge);
        (twin != NONE && !is_barrier(half_edge)).then_some(twin / 3)
    }

    /// The triangle nearest to `point` among the others at the start of a half-edge, up to barriers
    /// on both sides.
    fn around(&self, outgoing: u32, point: DVec3, is_barrier: &impl Fn(u32) -> bool) -> Option<u32> {
        let mut best: Option<(f64, u32)> = None;
        let mut note = |triangle: u32| {
            let squared = self.foot_in(triangle, point).0.squared;
            if best.is_none_or(|(known, _)| squared < known) {
                best = Some((squared, triangle));
            }
        };
        // Counter-clockwise, until the circle closes.
        let mut current = outgoing;
        loop {
            let edge = previous_half_edge(current);
            current = self.twin(edge);
            if current == outgoing {
                return best.map(|(_, triangle)| triangle);
            }
            if current == NONE || is_barrier(edge) {
                break;
            }
            note(current / 3);
        }
        // Clockwise.
        let mut edge = outgoing;
        while let Some(triangle) = self.across(edge, is_barrier) {
            note(triangle);
            edge = next_half_edge(self.twin(edge));
        }
        best.map(|(_, triangle)| triangle)
    }
}
