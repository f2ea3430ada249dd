//! Edges of a mesh as flat arrays.

use crate::TriMesh;

/// Edges and the half-edges along them.
///
/// Half-edge `3 t + k` runs from vertex `k` to vertex `k + 1` (modulo three) of triangle `t`.
///
/// ```
/// use isochore_mesh::{Topology, primitives};
///
/// let topology = Topology::of(&primitives::icosphere(1.0, 0));
/// assert_eq!(topology.edges.len(), 30);
/// // Every edge of a closed surface has two half-edges.
/// assert!((0..30).all(|edge| topology.half_edges(edge).len() == 2));
/// ```
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Topology {
    /// End vertices of each edge, the smaller first; edges in ascending order.
    pub edges: Vec<[u32; 2]>,
    /// The edge of each half-edge.
    pub edge_of_half_edge: Vec<u32>,
    /// Half-edges grouped by edge, ascending in each group.
    half_edges: Vec<u32>,
    /// Start of each edge's group in `half_edges`, and the end of the last group.
    starts: Vec<u32>,
}

impl Topology {
    /// Edges of `mesh`, in linear time: half-edges are bucketed by their smaller vertex.
    ///
    /// # Panics
    /// If an index is out of range, or the mesh has more than 2³²/3 triangles.
    pub fn of(mesh: &TriMesh) -> Self {
        Self::of_triangles(&mesh.triangles, mesh.positions.len())
    }

    /// Edges of `triangles` over `vertices` vertices.
    ///
    /// # Panics
    /// As [`of`](Self::of).
    pub fn of_triangles(triangles: &[[u32; 3]], vertices: usize) -> Self {
        assert!(triangles.len() <= u32::MAX as usize / 3, "half-edges are numbered in 32 bits");
        let ends = |half_edge: u32| {
            let triangle = triangles[half_edge as usize / 3];
            let (from, to) = (triangle[half_edge as usize % 3], triangle[(half_edge as usize + 1) % 3]);
            [from.min(to), from.max(to)]
        };
        let mut bucket_starts = vec![0_u32; vertices + 1];
        let half_edge_count = 3 * triangles.len() as u32;
        for half_edge in 0..half_edge_count {
            bucket_starts[ends(half_edge)[0] as usize + 1] += 1;
        }
        for vertex in 0..vertices {
            bucket_starts[vertex + 1] += bucket_starts[vertex];
        }
        let mut next = bucket_starts.clone();
        let mut bucketed = vec![(0_u32, 0_u32); half_edge_count as usize];
        for half_edge in 0..half_edge_count {
            let [smaller, larger] = ends(half_edge);
            let slot = &mut next[smaller as usize];
            bucketed[*slot as usize] = (larger, half_edge);
            *slot += 1;
        }

        let mut topology = Self {
            edges: Vec::with_capacity(bucketed.len() / 2),
            edge_of_half_edge: vec![0; bucketed.len()],
            half_edges: Vec::with_capacity(bucketed.len()),
            starts: Vec::with_capacity(bucketed.len() / 2 + 1),
        };
        for smaller in 0..vertices {
            let bucket = &mut bucketed[bucket_starts[smaller] as usize..bucket_starts[smaller + 1] as usize];
            bucket.sort_unstable();
            for group in bucket.chunk_by(|a, b| a.0 == b.0) {
                topology.starts.push(topology.half_edges.len() as u32);
                for &(_, half_edge) in group {
                    topology.edge_of_half_edge[half_edge as usize] = topology.edges.len() as u32;
                    topology.half_edges.push(half_edge);
                }
                topology.edges.push([smaller as u32, group[0].0]);
            }
        }
        topology.starts.push(half_edge_count);
        topology
    }

    /// The half-edges along `edge`: one at a boundary, two inside a manifold surface.
    ///
    /// # Panics
    /// If the index of the edge is out of range.
    pub fn half_edges(&self, edge: usize) -> &[u32] {
        &self.half_edges[self.starts[edge] as usize..self.starts[edge + 1] as usize]
    }

    /// The three edges of `triangle`, the first from its first to its second vertex.
    ///
    /// # Panics
    /// If the index of the triangle is out of range.
    pub fn triangle_edges(&self, triangle: usize) -> [u32; 3] {
        std::array::from_fn(|side| self.edge_of_half_edge[3 * triangle + side])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn edges_of_two_triangles() {
        let topology = Topology::of_triangles(&[[0, 1, 2], [2, 1, 3]], 5);
        assert_eq!(topology.edges, [[0, 1], [0, 2], [1, 2], [1, 3], [2, 3]]);
        let half_edges: Vec<&[u32]> = (0..5).map(|edge| topology.half_edges(edge)).collect();
        assert_eq!(half_edges, [&[0][..], &[2], &[1, 3], &[4], &[5]]);
        assert_eq!(topology.triangle_edges(0), [0, 2, 1]);
        assert_eq!(topology.triangle_edges(1), [2, 3, 4]);
        assert_eq!(Topology::of_triangles(&[], 0).edges.len(), 0);
    }
}
