//! Volume changes, summed over the triangles that a stroke has touched.

use glam::DVec3;
use isochore_mesh::CompensatedSum;

use super::{StrokeVolume, stroke::ActiveStroke, surface::Surface};

/// Relative rounding error of one signed volume (six products of three differences) and of adding
/// it to a sum, as a multiple of the product of the three lengths. About a dozen roundings occur.
/// Smaller, and correct sums would exceed their bound; larger makes the bound less sharp.
const ROUNDING: f64 = 16.0 * f64::EPSILON;

/// Volume that a stroke has moved through the surface, cubic model units.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct MovedVolume {
    /// Volume swept by parts of the surface that moved outward.
    pub outward: f64,
    /// Volume swept by parts of the surface that moved inward.
    pub inward: f64,
}

impl ActiveStroke {
    /// Change of the volume so far.
    pub(super) fn volume(&self, surface: &Surface) -> StrokeVolume {
        let journal = surface.topology.journal();
        // Old and new triangles together are closed, so any origin gives the same sum. A near one
        // keeps rounding small.
        let touched = self.touched.items();
        let corners = touched.iter().find_map(|&triangle| surface.corners_of(triangle));
        let origin = corners.map_or(DVec3::ZERO, |corners| corners[0]);
        let mut total = CompensatedSum::default();
        let mut size = self.remeshed;
        let mut add = |corners: [DVec3; 3], sign: f64| {
            let [a, b, c] = corners.map(|corner| corner - origin);
            total.add(sign * a.dot(b.cross(c)) / 6.0);
            size += a.length() * b.length() * c.length();
        };
        for &triangle in touched {
            if let Some(before) = journal.original(triangle).filter(|before| before.is_alive()) {
                add(before.vertices.map(|vertex| surface.start(vertex)), -1.0);
            }
            if let Some(after) = surface.corners_of(triangle) {
                add(after, 1.0);
            }
        }
        let (splits, remeshing) = (self.splits.value(), self.remeshing.value());
        StrokeVolume { flow: total.value() - splits - remeshing, splits, remeshing, rounding: ROUNDING * size }
    }

    /// Volume moved so far: for each triangle, the mean displacement of its corners along its mean
    /// normal. Motion to and fro counts by the net displacement since the base was made.
    pub(super) fn moved_volume(&self, surface: &Surface) -> MovedVolume {
        let mut moved = self.moved_before;
        for &triangle in self.phase.triangles.items() {
            let record = surface.topology.triangles()[triangle as usize];
            if !record.is_alive() {
                continue;
            }
            let before = record.vertices.map(|vertex| surface.base(vertex));
            let after = record.vertices.map(|vertex| surface.position(vertex));
            let normal = |[a, b, c]: [DVec3; 3]| (b - a).cross(c - a) / 2.0;
            let shift = (0..3).map(|side| after[side] - before[side]).sum::<DVec3>() / 3.0;
            let swept = 0.5 * (normal(before) + normal(after)).dot(shift);
            if swept > 0.0 {
                moved.outward += swept;
            } else {
                moved.inward -= swept;
            }
        }
        moved
    }
}
