//! The volume lock at the end of a stroke: a small displacement of the moved vertices, stored
//! separately from the flow.

use glam::DVec3;
use isochore_field::lock_part;
use isochore_mesh::CompensatedSum;

use super::{LockSkipped, stroke::ActiveStroke, surface::Surface};

/// Result of the lock of a stroke.
pub(super) struct Locked {
    /// Longest displacement, model units, or the reason why the lock was skipped.
    pub(super) max_shift: Result<f64, LockSkipped>,
    /// Change of the shown volume by the stroke, after the lock.
    pub(super) shown_change: f64,
}

impl ActiveStroke {
    /// Adjusts the offsets of the vertices that the stroke has moved so that the shown volume is
    /// `size` again. `excess` is its deviation at the beginning of the stroke. Takes time
    /// proportional to the part that the stroke touched.
    pub(super) fn lock(&self, surface: &mut Surface, excess: f64, size: f64) -> Locked {
        let touched: Vec<u32> = self.touched(surface).collect();
        let change = self.shown_change(surface, &touched);
        let alive: Vec<[u32; 3]> = touched
            .iter()
            .map(|&triangle| &surface.topology.triangles()[triangle as usize])
            .filter(|triangle| triangle.is_alive())
            .map(|triangle| triangle.vertices)
            .collect();
        let vertices = surface.vertices_of(&touched);
        let number = |vertex: u32| vertices.partition_point(|&other| other < vertex) as u32;
        let triangles: Vec<[u32; 3]> = alive.iter().map(|triangle| triangle.map(number)).collect();
        let rest: Vec<DVec3> =
            vertices.iter().map(|&vertex| surface.base(vertex) + surface.offsets.get(vertex)).collect();
        // The same sum as in `rest`, so that the two are equal for a vertex that has not moved.
        let flow = |&vertex: &u32| surface.position(vertex) + surface.offsets.get(vertex);
        let mut image: Vec<DVec3> = vertices.iter().map(flow).collect();
        let Some(lock) = lock_part(&rest, &mut image, &triangles, -(excess + change), size) else {
            return Locked { max_shift: Err(LockSkipped::NoHold), shown_change: change };
        };
        for ((&vertex, rest), locked) in vertices.iter().zip(rest).zip(image) {
            let position = surface.position(vertex);
            if rest != position + surface.offsets.get(vertex) {
                surface.offsets.set(vertex, locked - position);
            }
        }
        surface.update_tree(&touched);
        surface.write_buffers(&vertices, std::iter::empty());
        Locked { max_shift: Ok(lock.max_shift), shown_change: self.shown_change(surface, &touched) }
    }

    /// Change of the shown volume since the beginning of the stroke.
    fn shown_change(&self, surface: &Surface, touched: &[u32]) -> f64 {
        let journal = surface.topology.journal();
        let before = |vertex: u32| {
            let offset = surface.offsets.original(vertex).unwrap_or(DVec3::ZERO);
            surface.base(vertex) + offset
        };
        // Any origin gives the same sum; a near one keeps rounding small.
        let origin = touched.iter().find_map(|&triangle| surface.shown_corners(triangle));
        let origin = origin.map_or(DVec3::ZERO, |corners| corners[0]);
        let mut sum = CompensatedSum::default();
        let mut add = |corners: [DVec3; 3], sign: f64| {
            let [a, b, c] = corners.map(|corner| corner - origin);
            sum.add(sign * a.dot(b.cross(c)) / 6.0);
        };
        for &triangle in touched {
            if let Some(old) = journal.original(triangle).filter(|old| old.is_alive()) {
                add(old.vertices.map(before), -1.0);
            }
            if let Some(corners) = surface.shown_corners(triangle) {
                add(corners, 1.0);
            }
        }
        sum.value()
    }
}
