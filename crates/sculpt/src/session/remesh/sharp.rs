//! The edges of the surface before a remesh that are kept.

use isochore_mesh::{EditTriangle, NONE, next_half_edge};

use super::{lines::Lines, reference::Reference};
use crate::session::surface::Surface;

/// Cosine of the angle between two triangles from which on their edge is sharp and kept, 50°.
/// Larger: noise of scans counts as sharp edges, which are not coarsened. Smaller: edges of
/// technical shapes become ragged within the allowed deviation.
const SHARP: f64 = 0.642_787_609_686_539_4;

/// Smallest height of a triangle over a sharp edge, as a fraction of the allowed deviation. Larger:
/// sharp edges between thin triangles are not kept. Smaller: the arbitrary normals of slivers count.
const LEAST_HEIGHT: f64 = 0.1;

/// Smallest number of connected sharp edges. Larger: short sharp edges are not kept. Smaller: noise
/// of scans counts as sharp edges.
const SHORTEST_CHAIN: usize = 4;

impl Reference {
    /// The kept edges: seams, hard edges, borders of materials, boundaries and sharp edges.
    pub(super) fn find_lines(&self, surface: &Surface, region: &[u32], deviation: f64) -> Lines {
        let half_edges = || 0..3 * region.len() as u32;
        let mut lines = Lines(vec![0; region.len()]);
        let mut sharp = Vec::new();
        for half_edge in half_edges() {
            let of_surface = 3 * region[half_edge as usize / 3] + half_edge % 3;
            if self.twin(half_edge) == NONE || !surface.is_seamless(of_surface) {
                lines.set(half_edge, true);
            } else if half_edge < self.twin(half_edge) && self.is_sharp(half_edge, deviation) {
                sharp.push(half_edge);
            }
        }
        for half_edge in self.long_chains(sharp) {
            lines.set(half_edge, true);
            lines.set(self.twin(half_edge), true);
        }
        lines
    }

    fn twin(&self, half_edge: u32) -> u32 {
        let EditTriangle { twins, .. } = self.triangles[half_edge as usize / 3];
        twins[half_edge as usize % 3]
    }

    fn ends(&self, half_edge: u32) -> [u32; 2] {
        [half_edge, next_half_edge(half_edge)].map(|edge| self.triangles[edge as usize / 3].vertices[edge as usize % 3])
    }

    fn is_sharp(&self, half_edge: u32, deviation: f64) -> bool {
        let triangles = [half_edge, self.twin(half_edge)].map(|edge| edge / 3);
        let [one, other] = triangles.map(|triangle| self.normals[triangle as usize]);
        if one.dot(other) >= SHARP {
            return false;
        }
        let [a, b] = self.ends(half_edge).map(|vertex| self.positions[vertex as usize]);
        let least = LEAST_HEIGHT * deviation * a.distance(b);
        triangles.into_iter().all(|triangle| super::shape::area_normal(&self.corners_of(triangle)).length() > least)
    }

    /// Those of the half-edges that are connected to enough others.
    fn long_chains(&self, half_edges: Vec<u32>) -> Vec<u32> {
        // The smallest vertex of each chain, found by following links to smaller ones.
        let mut links: Vec<u32> = (0..self.positions.len() as u32).collect();
        fn root(links: &mut [u32], mut vertex: u32) -> u32 {
            while links[vertex as usize] != vertex {
                links[vertex as usize] = links[links[vertex as usize] as usize];
                vertex = links[vertex as usize];
            }
            vertex
        }
        for &half_edge in &half_edges {
            let [one, other] = self.ends(half_edge).map(|vertex| root(&mut links, vertex));
            links[one.max(other) as usize] = one.min(other);
        }
        let roots: Vec<u32> = half_edges.iter().map(|&half_edge| root(&mut links, self.ends(half_edge)[0])).collect();
        let mut counts = vec![0; links.len()];
        roots.iter().for_each(|&root| counts[root as usize] += 1);
        let is_long = |root: &u32| counts[*root as usize] >= SHORTEST_CHAIN;
        half_edges.into_iter().zip(roots).filter(|(_, root)| is_long(root)).map(|(half_edge, _)| half_edge).collect()
    }
}
