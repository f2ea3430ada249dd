use glam::DVec3;

use crate::bvh::OnTriangle;
use crate::{Bvh, Feature, Topology};

/// Normals of faces, edges and vertices. The normal of the nearest feature decides on which side of
/// the surface a point is.
///
/// The normal of an edge is the sum of the unit normals of its two faces. The normal of a vertex is
/// the sum of the adjacent face normals, weighted by their angles at the vertex (J. Bærentzen and
/// H. Aanæs, *Signed Distance Computation Using the Angle Weighted Pseudonormal*, 2005). The method
/// is valid for closed, oriented manifolds without self-intersections. Lengths of the normals do
/// not matter.
#[derive(Debug, Clone)]
pub(crate) struct PseudoNormals {
    /// In leaf order.
    faces: Vec<DVec3>,
    edges: Vec<DVec3>,
    vertices: Vec<DVec3>,
    topology: Topology,
}

impl PseudoNormals {
    /// Computes the normals of a surface with `vertices` vertices.
    pub(crate) fn new(bvh: &Bvh, vertices: usize) -> Self {
        let topology = Topology::of_triangles(bvh.triangles(), vertices);
        let faces: Vec<DVec3> = (0..bvh.triangles().len() as u32)
            .map(|slot| bvh.corners(slot))
            .map(|[a, b, c]| (b - a).cross(c - a).normalize_or_zero())
            .collect();
        let mut normals = Self {
            edges: vec![DVec3::ZERO; topology.edges.len()],
            vertices: vec![DVec3::ZERO; vertices],
            faces,
            topology,
        };
        for (slot, triangle) in bvh.triangles().iter().enumerate() {
            let corners = bvh.corners(slot as u32);
            let normal = normals.faces[slot];
            for edge in normals.topology.triangle_edges(slot) {
                normals.edges[edge as usize] += normal;
            }
            for k in 0..3 {
                let (to_next, to_last) = (corners[(k + 1) % 3] - corners[k], corners[(k + 2) % 3] - corners[k]);
                let angle = libm::atan2(to_next.cross(to_last).length(), to_next.dot(to_last));
                normals.vertices[triangle[k] as usize] += normal * angle;
            }
        }
        normals
    }

    /// Whether a point of the unit frame is inside, given its nearest triangle and nearest point.
    pub(crate) fn is_inside(&self, bvh: &Bvh, point: DVec3, slot: u32, nearest: &OnTriangle) -> bool {
        let corners = bvh.corners(slot);
        let slot = slot as usize;
        match nearest.feature {
            // Relative to a corner, because close to the surface the offset from the nearest point
            // is mostly rounding.
            Feature::Face => self.faces[slot].dot(point - corners[0]) < 0.0,
            Feature::Edge(k) => {
                let edge = self.topology.triangle_edges(slot)[k as usize];
                self.edges[edge as usize].dot(point - nearest.point) < 0.0
            }
            Feature::Vertex(k) => {
                let vertex = bvh.triangles()[slot][k as usize];
                self.vertices[vertex as usize].dot(point - nearest.point) < 0.0
            }
        }
    }
}
