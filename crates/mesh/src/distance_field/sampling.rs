//! Unsigned distances at all nodes of a grid.

use std::sync::atomic::{AtomicUsize, Ordering};

use glam::DVec3;
use rayon::prelude::*;

use super::Grid;
use super::packet::{LANES, PACKET, Packet, PacketSearch};
use crate::bvh::closest_on_triangle;
use crate::{Aabb, Bvh, Cancelled, Monitor};

/// Distances without sign, and a bound on their error, both in model units.
///
/// Triangles are chosen in `f32` and measured in `f64`, so that an error can only come from a choice between triangles that are
/// nearly equally near, and from rounding the result.
pub(super) fn unsigned(bvh: &Bvh, grid: &Grid, monitor: &dyn Monitor) -> Result<(Vec<f32>, f64), Cancelled> {
    let search = PacketSearch::new(bvh);
    let [nx, ny, nz] = grid.dims;
    let mut samples = vec![0.0; nx * ny * nz];
    let slab = nx * ny * PACKET[2];
    let slabs = nz.div_ceil(PACKET[2]);
    let done = AtomicUsize::new(0);
    // A slab knows nothing of other slabs, so that the result does not depend on how threads share them.
    samples.par_chunks_mut(slab).enumerate().try_for_each(|(number, samples)| {
        sample_slab(&search, bvh, grid, number * PACKET[2], samples, monitor)?;
        let done = done.fetch_add(1, Ordering::Relaxed) + 1;
        monitor.check("distance", done as f64 / slabs as f64)
    })?;
    let farthest = samples.par_iter().copied().reduce(|| 0.0, f32::max);
    Ok((samples, error_bound(bvh, grid, f64::from(farthest))))
}

/// Fills the layers from `layer` on that `samples` has room for, in strips of packets, back and forth.
fn sample_slab(
    search: &PacketSearch<'_>,
    bvh: &Bvh,
    grid: &Grid,
    layer: usize,
    samples: &mut [f32],
    monitor: &dyn Monitor,
) -> Result<(), Cancelled> {
    let [nx, ny, _] = grid.dims;
    let layers = samples.len() / (nx * ny);
    let columns = nx.div_ceil(PACKET[0]);
    let frame = bvh.frame();
    let mut stack = Vec::with_capacity(bvh.stack_capacity());
    let mut guesses: Vec<u32> = Vec::new();
    for strip in 0..ny.div_ceil(PACKET[1]) {
        if monitor.is_cancelled() {
            return Err(Cancelled);
        }
        for column in 0..columns {
            let column = if strip % 2 == 0 { column } else { columns - 1 - column };
            // Lanes that stick out repeat the last node inside.
            let node = |lane: usize| {
                [
                    (column * PACKET[0] + lane % PACKET[0]).min(nx - 1),
                    (strip * PACKET[1] + lane / PACKET[0] % PACKET[1]).min(ny - 1),
                    (lane / (PACKET[0] * PACKET[1])).min(layers - 1),
                ]
            };
            let points: [DVec3; LANES] = std::array::from_fn(|lane| {
                let [i, j, k] = node(lane);
                frame.inward(grid.node(i, j, layer + k))
            });
            let mut packet = Packet::new(points);
            search.search(&mut packet, &guesses, &mut stack);
            for (lane, &point) in points.iter().enumerate() {
                let [i, j, k] = node(lane);
                let (_, squared) = closest_on_triangle(point, &bvh.corners()[packet.slot[lane] as usize]);
                samples[(k * ny + j) * nx + i] = (squared.sqrt() / frame.scale()) as f32;
            }
            guesses.clear();
            guesses.extend_from_slice(&packet.slot);
            guesses.sort_unstable();
            guesses.dedup();
        }
    }
    Ok(())
}

/// Half a unit in the last place of `f32`, relative.
const EPSILON: f64 = f32::EPSILON as f64 / 2.0;

/// In the unit frame, with ε = 2⁻²⁴, E the largest coordinate of a node, d the distance and L the longest edge:
///
/// - Rounding the node and the triangle's first corner to `f32` displaces one against the other by at most √3 ε (E + 1).
/// - Their difference, at most d + L long, is rounded (ε), turned into the triangle's plane by rounded unit vectors (4ε with the
///   sum), compared with rounded lengths and directions in the plane (3ε), and squared and summed (2ε as a distance): 10 ε (d + L).
/// - A box may be left out by comparison with its squared distance, which is wrong by no more than 2ε as a distance.
///
/// So the distance by which a triangle is chosen is off by δ = ε (√3 (E + 1) + 12 (d + L)), and the chosen triangle is no more than
/// 2δ farther than the nearest. Its distance is then rounded to `f32`: ε d.
fn error_bound(bvh: &Bvh, grid: &Grid, farthest: f64) -> f64 {
    let frame = bvh.frame();
    let bounds = grid.bounds();
    let extent = Aabb { min: frame.inward(bounds.min), max: frame.inward(bounds.max) };
    let largest = extent.min.abs().max(extent.max.abs()).max_element();
    let longest_edge2 = (bvh.corners().iter())
        .map(|&[a, b, c]| a.distance_squared(b).max(b.distance_squared(c)).max(c.distance_squared(a)))
        .fold(0.0, f64::max);
    let distance = farthest * frame.scale();
    let choice = EPSILON * (3f64.sqrt() * (largest + 1.0) + 12.0 * (distance + longest_edge2.sqrt()));
    (2.0 * choice + EPSILON * distance) / frame.scale()
}
