//! Patches over the holes of a mesh, which reduce its signs to integers and a few triangles.

use glam::DVec3;
use petgraph::unionfind::UnionFind;

use crate::{Bvh, BvhError, WindingNumber};

/// Triangles that close a mesh: a fan around the centroid of each connected set of open edges.
///
/// Let w be the winding number of the mesh, W the integer winding number of mesh and patches
/// together. Then the patches alone have the winding number W − w. So w > ½ exactly if the number
/// of the patches is below W − ½. Far from the patches their number is between −½ and ½, and the
/// condition becomes W ≥ 1.
#[derive(Debug)]
pub(super) struct Patches {
    /// Vertices of the mesh keep their indices; the centroids follow them.
    pub(super) triangles: Vec<[u32; 3]>,
    pub(super) positions: Vec<[DVec3; 3]>,
}

impl Patches {
    /// Creates patches for the [open edges](crate::mesh_distance::open_edges) of a mesh with
    /// vertices at `positions`.
    pub(super) fn over(open_edges: &[[u32; 2]], positions: &[DVec3]) -> Self {
        // Number the vertices on open edges from zero, and find connected sets.
        let mut vertices: Vec<u32> = open_edges.iter().flatten().copied().collect();
        vertices.sort_unstable();
        vertices.dedup();
        let number = |vertex: u32| vertices.partition_point(|&other| other < vertex);
        let mut sets = UnionFind::<usize>::new(vertices.len());
        for &[from, to] in open_edges {
            sets.union(number(from), number(to));
        }
        let set_of = sets.into_labeling();
        let mut counts = vec![0.0; vertices.len()];
        for &set in &set_of {
            counts[set] += 1.0;
        }
        let mut centroids = vec![DVec3::ZERO; vertices.len()];
        for (&set, &vertex) in set_of.iter().zip(&vertices) {
            centroids[set] += positions[vertex as usize] / counts[set];
        }
        let (triangles, positions) = (open_edges.iter())
            .map(|&[from, to]| {
                let set = set_of[number(from)];
                let corners = [positions[to as usize], positions[from as usize], centroids[set]];
                ([to, from, (positions.len() + set) as u32], corners)
            })
            .unzip();
        Self { triangles, positions }
    }

    /// Prepares winding numbers with respect to the patches.
    ///
    /// # Errors
    /// Those of [`Bvh::new`]; cannot fail if the mesh itself has a hierarchy.
    pub(super) fn winding_number(&self) -> Result<WindingNumber, BvhError> {
        let triangles: Vec<[u32; 3]> =
            (0..self.positions.len() as u32).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
        Ok(WindingNumber::new(std::sync::Arc::new(Bvh::new(self.positions.as_flattened(), &triangles)?)))
    }
}
