//! Motion of vertices along the surface to even out the triangles.

use glam::{DMat3, DVec3};
use isochore_mesh::{Cancelled, Monitor};
use rayon::prelude::*;

use super::{remesher::Remesher, shape::area_normal};

/// Vertices that one task moves. Larger leaves threads idle; smaller spends time on scheduling.
const CHUNK: usize = 256;

/// Weight of the height above the planes of the triangles, relative to the allowed deviation. Larger:
/// vertices hardly move across ridges. Smaller: their steps are refused.
const FEATURES: f64 = 4.0;

/// A vertex with its new position and target length.
struct Step {
    vertex: u32,
    position: DVec3,
    length: f64,
}

/// Paths of a vertex from which a step is chosen.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Path {
    /// Along the surface.
    Tangential,
    /// Along ridges and valleys only.
    AlongFeatures,
}

impl Remesher<'_> {
    /// Moves all free vertices towards the centers of the triangles around them, along the surface.
    /// Those that may not move there move along ridges and valleys.
    pub(super) fn relax(&mut self, monitor: &dyn Monitor) -> Result<(), Cancelled> {
        let mut rest = self.free_vertices();
        for path in [Path::Tangential, Path::AlongFeatures] {
            let steps: Vec<Vec<Step>> = rest
                .par_chunks(CHUNK)
                .map(|chunk| chunk.iter().filter_map(|&vertex| self.step(vertex, path)).collect())
                .collect();
            let before = self.surface.positions.items().to_vec();
            let mut moved = Vec::with_capacity(rest.len());
            for Step { vertex, position, length } in steps.into_iter().flatten() {
                self.surface.positions.set(vertex, position);
                self.lengths[vertex as usize] = length;
                moved.push(vertex);
            }
            rest = self.settle(&moved, &before, monitor)?;
        }
        Ok(())
    }

    /// The step of a vertex to the mean center of its triangles, weighted by area and density.
    fn step(&self, vertex: u32, path: Path) -> Option<Step> {
        let topology = &self.surface.topology;
        let position = self.surface.position(vertex);
        let (mut center, mut weights, mut normal) = (DVec3::ZERO, 0.0, DVec3::ZERO);
        let (mut tilts, mut areas) = (DMat3::ZERO, 0.0);
        for outgoing in topology.fan(vertex) {
            let vertices = topology.triangles()[outgoing as usize / 3].vertices;
            let corners = vertices.map(|corner| self.surface.position(corner));
            let lengths: f64 = vertices.iter().map(|&corner| self.lengths[corner as usize]).sum();
            let area = area_normal(&corners);
            let size = area.length();
            let weight = size / (lengths * lengths);
            center += weight * ((corners[0] + corners[1] + corners[2]) / 3.0 - position);
            weights += weight;
            normal += area;
            if path == Path::AlongFeatures && size > 0.0 {
                let unit = area / size;
                tilts += DMat3::from_cols(unit * area.x, unit * area.y, unit * area.z);
                areas += size;
            }
        }
        // The normal is the gradient of the volume.
        let normal = normal.normalize_or_zero();
        let mut step = center / weights;
        step -= normal * normal.dot(step);
        if path == Path::AlongFeatures {
            // A compromise between the step and the heights above the planes of the triangles.
            let stiffness = FEATURES / self.allowance2 * step.length_squared() / areas;
            step = (DMat3::IDENTITY + stiffness * tilts).inverse() * step;
        }
        let target = position + step;
        let foot = self.reference.foot(self.anchors[topology.outgoing(vertex) as usize / 3], target);
        if !(foot.squared <= self.allowance2 && foot.point != position) {
            return None;
        }
        let length = self.reference.interpolate(&self.reference_lengths, &foot);
        Some(Step { vertex, position: foot.point, length })
    }
}
