//! Positions and normals of render vertices, recomputed only at vertices that have changed.

use glam::DVec3;
use isochore_mesh::{NONE, previous_half_edge};
use rayon::prelude::*;

use super::{NormalWeights, surface::Surface};

/// Vertices that one task shades. Larger leaves threads idle; smaller spends time on scheduling.
const CHUNK: usize = 1024;

/// Buffer entries of a render vertex.
struct Shaded {
    render: u32,
    position: [f32; 3],
    normal: [f32; 3],
}

impl Surface {
    /// Recomputes positions and normals of all render vertices of `vertices`.
    pub(super) fn shade(&mut self, vertices: &[u32]) {
        let shaded: Vec<Vec<Shaded>> = vertices
            .par_chunks(CHUNK)
            .map(|chunk| {
                let mut shaded = Vec::with_capacity(chunk.len());
                let mut fan = Vec::new();
                for &vertex in chunk {
                    self.shade_vertex(vertex, &mut fan, &mut shaded);
                }
                shaded
            })
            .collect();
        for Shaded { render, position, normal } in shaded.into_iter().flatten() {
            self.set_render_position(render, position);
            self.set_normal(render, normal);
        }
    }

    /// Appends the render vertices of `vertex`. Triangles between two hard edges have a common
    /// normal; shading is smooth across other seams.
    fn shade_vertex(&self, vertex: u32, fan: &mut Vec<u32>, shaded: &mut Vec<Shaded>) {
        let first = self.topology.outgoing(vertex);
        if first == NONE {
            return;
        }
        let position = self.shown(vertex).as_vec3().to_array();
        fan.clear();
        fan.extend(self.topology.fan(vertex));
        // A fan of an interior vertex is rotated so that it begins at a hard edge. A fan of a
        // boundary vertex begins at the boundary.
        if self.has_hard_edges && !self.topology.is_boundary(vertex) {
            let hard = fan.iter().position(|&half_edge| self.is_hard(half_edge));
            fan.rotate_left(hard.unwrap_or(0));
        }
        let mut start = 0;
        while start < fan.len() {
            let length = fan[start + 1..].iter().take_while(|&&half_edge| !self.is_hard(half_edge)).count() + 1;
            let sector = &fan[start..start + length];
            let sum = sector.iter().map(|&half_edge| self.weighted_normal(half_edge)).sum::<DVec3>();
            let normal = sum.normalize_or_zero().as_vec3().to_array();
            let mut last = NONE;
            for &half_edge in sector {
                let render = self.corner(half_edge);
                if render != last {
                    shaded.push(Shaded { render, position, normal });
                }
                last = render;
            }
            start += length;
        }
    }

    /// Whether shading is discontinuous across the edge of a half-edge.
    pub(super) fn is_hard(&self, half_edge: u32) -> bool {
        self.has_hard_edges && self.patches.items()[half_edge as usize / 3].hard >> (half_edge % 3) & 1 == 1
    }

    /// The normal of the triangle of a half-edge, weighted for the vertex at the start of the
    /// half-edge.
    #[inline]
    fn weighted_normal(&self, half_edge: u32) -> DVec3 {
        let triangle = &self.topology.triangles()[half_edge as usize / 3];
        let [a, b, c] = triangle.vertices.map(|vertex| self.shown(vertex));
        let normal = (b - a).cross(c - a);
        match self.weights {
            NormalWeights::Area => normal,
            NormalWeights::Angle => {
                let at = |half_edge: u32| [a, b, c][half_edge as usize % 3];
                let corner = at(half_edge);
                let behind = at(previous_half_edge(half_edge)) - corner;
                let ahead = at(isochore_mesh::next_half_edge(half_edge)) - corner;
                normal.normalize_or_zero() * libm::atan2(ahead.cross(behind).length(), ahead.dot(behind))
            }
        }
    }
}
