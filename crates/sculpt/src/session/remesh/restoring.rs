//! Restoring the volume after all edits: first where it was lost, then the rest everywhere.

use glam::DVec3;
use isochore_mesh::{Cancelled, CompensatedSum, Monitor, NONE, signed_volume};
use rayon::prelude::*;

use super::{lines::Freedom, remesher::Remesher, shape::area_normal};
use crate::session::LockSkipped;

/// Triangles that one task measures. Larger leaves threads idle; smaller spends time on scheduling.
const CHUNK: usize = 256;

/// Number of times that the shifts which restore the volume are averaged with their neighbors.
/// Larger: the volume is restored farther from where it was lost. Smaller: a rougher surface.
const AVERAGINGS: usize = 2;

/// Number of times that the lock distributes the rest of the volume, each time without the vertices
/// that had to move back. Larger: slower. Smaller: a larger error where many vertices move back.
const MOST_ATTEMPTS: usize = 4;

/// Relative error of the volume up to which it counts as restored. Larger: a visible error.
/// Smaller: below the rounding error of the volume.
const EXACT: f64 = 1e-13;

/// Iterations of Newton's method for the size of a shift, whose volume is a cubic polynomial.
const NEWTON_STEPS: usize = 8;

impl Remesher<'_> {
    /// Moves free vertices along their normals so that the surface encloses the volume of the
    /// reference again in every place.
    pub(super) fn restore_locally(&mut self, monitor: &dyn Monitor) -> Result<(), Cancelled> {
        let free = self.free_vertices();
        let before = self.surface.positions.items().to_vec();
        let shifts = self.shifts();
        let directions = self.directions(&free);
        for (&vertex, direction) in free.iter().zip(directions) {
            self.surface.positions.set(vertex, before[vertex as usize] + shifts[vertex as usize] * direction);
        }
        self.settle(&free, &before, monitor)?;
        Ok(())
    }

    /// Moves free vertices along their normals so that the surface, which is closed, encloses
    /// `volume`. Returns the longest displacement.
    pub(super) fn lock(&mut self, volume: f64, monitor: &dyn Monitor) -> Result<Result<f64, LockSkipped>, Cancelled> {
        let mut free = self.free_vertices();
        let unlocked = self.surface.positions.items().to_vec();
        let mut is_exact = false;
        for _ in 0..MOST_ATTEMPTS {
            let gain = volume - self.volume();
            is_exact = gain.abs() <= EXACT * volume.abs();
            if is_exact || free.is_empty() {
                break;
            }
            let before = self.surface.positions.items().to_vec();
            self.grow(&free, gain);
            let back = self.settle(&free, &before, monitor)?;
            free.retain(|vertex| back.binary_search(vertex).is_err());
        }
        let pairs = self.surface.positions.items().iter().zip(&unlocked);
        let longest = pairs.map(|(now, before)| now.distance(*before)).fold(0.0, f64::max);
        Ok(if is_exact || longest > 0.0 { Ok(longest) } else { Err(LockSkipped::NoHold) })
    }

    /// Free vertices that have triangles, in ascending order.
    pub(super) fn free_vertices(&self) -> Vec<u32> {
        let topology = &self.surface.topology;
        let is_free =
            |&vertex: &u32| self.freedoms[vertex as usize] == Freedom::Free && topology.outgoing(vertex) != NONE;
        (0..self.freedoms.len() as u32).filter(is_free).collect()
    }

    /// Signed volume.
    pub(super) fn volume(&self) -> f64 {
        let records = self.surface.topology.triangles();
        let alive: Vec<[u32; 3]> =
            records.iter().filter(|record| record.is_alive()).map(|record| record.vertices).collect();
        signed_volume(self.surface.positions.items(), &alive)
    }

    /// Unit normals of vertices.
    fn directions(&self, vertices: &[u32]) -> Vec<DVec3> {
        let normal = |&vertex: &u32| {
            let triangles =
                self.surface.topology.fan(vertex).filter_map(|outgoing| self.surface.corners_of(outgoing / 3));
            triangles.map(|corners| area_normal(&corners)).sum::<DVec3>().normalize_or_zero()
        };
        vertices.par_iter().with_min_len(CHUNK).map(normal).collect()
    }

    /// For each vertex, the shift along its normal by which the surface encloses the volume of the
    /// reference again.
    fn shifts(&self) -> Vec<f64> {
        let alive = self.alive();
        // The mean at the middles of the edges is exact for a height that is a quadratic function.
        let measure = |&triangle: &u32| -> [f64; 2] {
            let corners = self.surface.corners_of(triangle).unwrap_or_default();
            let normal = area_normal(&corners);
            let (area, direction) = (0.5 * normal.length(), normal.normalize_or_zero());
            let height = |side: usize| {
                let middle = 0.5 * (corners[side] + corners[(side + 1) % 3]);
                direction.dot(self.reference.foot(self.anchors[triangle as usize], middle).point - middle)
            };
            [area, area * (height(0) + height(1) + height(2)) / 3.0]
        };
        let measured: Vec<[f64; 2]> = alive.par_iter().with_min_len(CHUNK).map(measure).collect();
        let mut areas = vec![0.0; self.freedoms.len()];
        let mut volumes = vec![0.0; self.freedoms.len()];
        for (&triangle, [area, volume]) in alive.iter().zip(measured) {
            for vertex in self.surface.topology.triangles()[triangle as usize].vertices {
                areas[vertex as usize] += area / 3.0;
                volumes[vertex as usize] += volume / 3.0;
            }
        }
        let ratio = |(volume, area): (&f64, &f64)| if *area > 0.0 { volume / area } else { 0.0 };
        let mut shifts: Vec<f64> = volumes.iter().zip(&areas).map(ratio).collect();
        for _ in 0..AVERAGINGS {
            let mut sums: Vec<f64> = shifts.iter().zip(&areas).map(|(shift, area)| shift * area).collect();
            let mut weights = areas.clone();
            for &triangle in &alive {
                let vertices =
                    self.surface.topology.triangles()[triangle as usize].vertices.map(|vertex| vertex as usize);
                for side in 0..3 {
                    let (vertex, neighbor) = (vertices[side], vertices[(side + 1) % 3]);
                    sums[vertex] += shifts[neighbor] * areas[neighbor];
                    weights[vertex] += areas[neighbor];
                }
            }
            shifts = sums.iter().zip(&weights).map(ratio).collect();
        }
        shifts
    }

    /// Moves vertices along their normals, all by the same distance, so that the volume grows by
    /// `gain`.
    fn grow(&mut self, free: &[u32], gain: f64) {
        let mut directions = vec![DVec3::ZERO; self.freedoms.len()];
        for (&vertex, direction) in free.iter().zip(self.directions(free)) {
            directions[vertex as usize] = direction;
        }
        let origin = free.first().map_or(DVec3::ZERO, |&vertex| self.surface.position(vertex));
        let mut sums: [CompensatedSum; 3] = Default::default();
        for record in self.surface.topology.triangles().iter().filter(|record| record.is_alive()) {
            let [a, b, c] = record.vertices.map(|vertex| self.surface.position(vertex) - origin);
            let [d, e, f] = record.vertices.map(|vertex| directions[vertex as usize]);
            let volume = |a: DVec3, b: DVec3, c: DVec3| a.dot(b.cross(c)) / 6.0;
            sums[0].add(volume(d, b, c) + volume(a, e, c) + volume(a, b, f));
            sums[1].add(volume(a, e, f) + volume(d, b, f) + volume(d, e, c));
            sums[2].add(volume(d, e, f));
        }
        let [linear, square, cube] = sums.map(|sum| sum.value());
        let mut shift = 0.0;
        for _ in 0..NEWTON_STEPS {
            let rest = gain - shift * (linear + shift * (square + shift * cube));
            let step = rest / (linear + shift * (2.0 * square + shift * 3.0 * cube));
            if !step.is_finite() {
                return;
            }
            shift += step;
        }
        for &vertex in free {
            let position = self.surface.position(vertex);
            self.surface.positions.set(vertex, position + shift * directions[vertex as usize]);
        }
    }
}
