//! The part of the surface that a lock may displace.

use glam::DVec3;
use isochore_field::lock_part;
use isochore_mesh::CompensatedSum;

use crate::session::{
    certificate::{Pair, triangles_of},
    surface::Surface,
};

/// Rings of vertices over which the weight rises from a held vertex to the full lock. Larger holds
/// more of the surface; smaller makes a step beside the held vertices.
const RAMP: usize = 4;

/// Most rounds in which offsets of earlier locks are removed where they would cross. Each removes
/// them at all crossings, so a few suffice; the limit only ends a loop that a defect would keep
/// alive.
const MAX_RELEASES: usize = 20;

/// The triangles that a stroke has touched, and their vertices.
pub(super) struct Part {
    /// Triangles of the surface, and those whose offsets were removed.
    touched: Vec<u32>,
    /// Vertices of the surface, in ascending order.
    vertices: Vec<u32>,
    /// Existing triangles, as indices into `vertices`.
    triangles: Vec<[u32; 3]>,
    /// Shown positions at the beginning of the stroke.
    rest: Vec<DVec3>,
    /// Offsets by earlier locks.
    offsets: Vec<DVec3>,
    /// Whether the stroke has moved the vertex.
    is_moved: Vec<bool>,
    /// Whether a triangle at the vertex has crossed.
    has_crossed: Vec<bool>,
    /// Fractions of the lock that displace the vertices.
    weights: Vec<f64>,
}

impl Part {
    /// The part of some triangles.
    pub(super) fn new(surface: &mut Surface, touched: &[u32]) -> Self {
        let vertices = surface.vertices_of(touched);
        let number = |vertex: u32| vertices.partition_point(|&other| other < vertex) as u32;
        let records = touched.iter().map(|&triangle| &surface.topology.triangles()[triangle as usize]);
        let alive = records.filter(|triangle| triangle.is_alive());
        let triangles = alive.map(|triangle| triangle.vertices.map(number)).collect();
        let offsets: Vec<DVec3> = vertices.iter().map(|&vertex| surface.offsets.get(vertex)).collect();
        let count = vertices.len();
        Self {
            touched: touched.to_vec(),
            triangles,
            rest: vertices.iter().zip(&offsets).map(|(&vertex, &offset)| surface.start(vertex) + offset).collect(),
            is_moved: vertices.iter().map(|&vertex| surface.start(vertex) != surface.position(vertex)).collect(),
            vertices,
            offsets,
            has_crossed: vec![false; count],
            weights: vec![1.0; count],
        }
    }

    /// Sets the offsets of moved vertices to the weighted offsets by earlier locks.
    pub(super) fn reset(&self, surface: &mut Surface) {
        for index in (0..self.vertices.len()).filter(|&index| self.is_moved[index]) {
            surface.offsets.set(self.vertices[index], self.weights[index] * self.offsets[index]);
        }
    }

    /// Displaces moved vertices so that the shown volume is `size`, and returns the longest
    /// displacement. `None`, and nothing is displaced, if none has this effect.
    pub(super) fn shift(&self, surface: &mut Surface, excess: f64, size: f64) -> Option<f64> {
        let gain = -(excess + self.shown_change(surface));
        // The same sums as in `rest`, so that the two are equal for a vertex that has not moved.
        let unlocked = |&vertex: &u32| surface.position(vertex) + surface.offsets.get(vertex);
        let mut image: Vec<DVec3> = self.vertices.iter().map(unlocked).collect();
        let lock = lock_part(&self.rest, &mut image, &self.triangles, &self.weights, gain, size)?;
        for index in (0..self.vertices.len()).filter(|&index| self.is_moved[index]) {
            let vertex = self.vertices[index];
            surface.offsets.set(vertex, image[index] - surface.position(vertex));
        }
        surface.update_tree(&self.touched);
        Some(lock.max_shift)
    }

    /// New crossings of the shown surface, without those in `known`, which is in ascending order.
    pub(super) fn crossings(&self, surface: &mut Surface, known: &[Pair]) -> Vec<Pair> {
        let mut crossing = surface.new_crossings(&self.touched, Surface::shown);
        crossing.retain(|pair| known.binary_search(pair).is_err());
        crossing
    }

    /// Reduces the weights to zero within `held` rings of triangles that cross or have crossed, and
    /// in steps in the rings around them.
    pub(super) fn hold(&mut self, surface: &Surface, crossing: &[Pair], held: usize) {
        for triangle in triangles_of(crossing) {
            for vertex in surface.topology.triangles()[triangle as usize].vertices {
                if let Ok(index) = self.vertices.binary_search(&vertex) {
                    self.has_crossed[index] = true;
                }
            }
        }
        let mut is_within = self.has_crossed.clone();
        for ring in 0..held + RAMP {
            let weight = ring.saturating_sub(held) as f64 / RAMP as f64;
            // Inner rings come first, so their smaller weights are kept.
            let within = self.weights.iter_mut().zip(&is_within).filter(|(_, is_within)| **is_within);
            within.for_each(|(own, _)| *own = own.min(weight));
            let mut next = is_within.clone();
            for triangle in &self.triangles {
                if triangle.iter().any(|&vertex| is_within[vertex as usize]) {
                    triangle.iter().for_each(|&vertex| next[vertex as usize] = true);
                }
            }
            is_within = next;
        }
    }

    /// Removes offsets, also of vertices that the stroke has not moved, where they make triangles
    /// cross. The surface without offsets is certified. Updates the tree.
    pub(super) fn release(&mut self, surface: &mut Surface, known: &[Pair]) {
        for round in 0..MAX_RELEASES {
            surface.update_tree(&self.touched);
            let mut crossing = triangles_of(&self.crossings(surface, known));
            // Later rounds release the vertices around too, so that few of them are needed.
            for _ in 0..round {
                let vertices = surface.vertices_of(&crossing);
                crossing = surface.triangles_around(&vertices, &[]);
            }
            let mut vertices = surface.vertices_of(&crossing);
            vertices.retain(|&vertex| surface.offsets.get(vertex) != DVec3::ZERO);
            if vertices.is_empty() {
                break;
            }
            vertices.iter().for_each(|&vertex| surface.offsets.set(vertex, DVec3::ZERO));
            let touched = std::mem::take(&mut self.touched);
            self.touched = surface.triangles_around(&vertices, &touched);
        }
    }

    /// Updates the buffers. Returns the change of the shown volume by the stroke.
    pub(super) fn finish(&self, surface: &mut Surface) -> f64 {
        let vertices = surface.vertices_of(&self.touched);
        surface.write_buffers(&vertices, std::iter::empty());
        self.shown_change(surface)
    }

    /// Change of the shown volume since the beginning of the stroke.
    fn shown_change(&self, surface: &Surface) -> f64 {
        let journal = surface.topology.journal();
        let before = |vertex: u32| {
            let offset = surface.offsets.original(vertex).unwrap_or(DVec3::ZERO);
            surface.start(vertex) + offset
        };
        // Any origin gives the same sum; a near one keeps rounding small.
        let origin = self.touched.iter().find_map(|&triangle| surface.shown_corners(triangle));
        let origin = origin.map_or(DVec3::ZERO, |corners| corners[0]);
        let mut sum = CompensatedSum::default();
        let mut add = |corners: [DVec3; 3], sign: f64| {
            let [a, b, c] = corners.map(|corner| corner - origin);
            sum.add(sign * a.dot(b.cross(c)) / 6.0);
        };
        for &triangle in &self.touched {
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
