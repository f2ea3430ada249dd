//! Unsigned distances at all nodes of a grid.

use std::sync::atomic::{AtomicUsize, Ordering};

use multiversion::multiversion;
use rayon::prelude::*;

use super::Grid;
use super::exact_distance::{Points, exact_squared_distances};
use super::lanes::{LANES, PACKET};
use super::packet::{NOTHING, Packet};
use super::packet_search::PacketSearch;
use crate::huge_pages::in_huge_pages;
use crate::{Bvh, Cancelled, Monitor};

/// Returns unsigned distances and a bound on their error, both in model units.
///
/// Triangles are selected in `f32` and measured in `f64`. So errors come only from selecting among
/// nearly equidistant triangles, and from rounding the result. Nodes farther away than `band` are
/// set to `band`.
pub(super) fn unsigned(
    search: &PacketSearch,
    bvh: &Bvh,
    grid: &Grid,
    band: f64,
    monitor: &dyn Monitor,
) -> Result<(Vec<f32>, f64), Cancelled> {
    monitor.check("distance", 0.0)?;
    let [nx, ny, nz] = grid.dims;
    let mut samples = in_huge_pages(vec![0.0; nx * ny * nz]);
    let slab = nx * ny * PACKET[2];
    let slabs = nz.div_ceil(PACKET[2]);
    let done = AtomicUsize::new(0);
    // Slabs are independent, so the result does not depend on their assignment to threads.
    samples.par_chunks_mut(slab).enumerate().try_for_each(|(number, samples)| {
        let slab = Slab { search, bvh, grid, band, layer: number * PACKET[2] };
        let mut last_strip = vec![[NOTHING; LANES]; nx.div_ceil(PACKET[0])];
        for strip in 0..ny.div_ceil(PACKET[1]) {
            monitor.check_cancelled()?;
            sample_strip(&slab, strip, samples, &mut last_strip);
        }
        let done = done.fetch_add(1, Ordering::Relaxed) + 1;
        monitor.check("distance", done as f64 / slabs as f64)
    })?;
    let farthest = samples.par_iter().copied().reduce(|| 0.0, f32::max);
    Ok((samples, error_bound(bvh, search, f64::from(farthest))))
}

/// Layers of a grid, as many as a packet has.
struct Slab<'a> {
    search: &'a PacketSearch,
    bvh: &'a Bvh,
    grid: &'a Grid,
    band: f64,
    /// Index of the first layer.
    layer: usize,
}

/// Fills a strip of packets in the layers of `samples`. On entry, `found` holds the triangles found
/// by the packets of the previous strip, on return those of this strip. They are good guesses,
/// because neighboring packets have nearby results.
#[multiversion(targets("x86_64+avx512f+avx512vl", "x86_64+avx2", "x86_64+sse4.1", "aarch64+neon"))]
fn sample_strip(slab: &Slab<'_>, strip: usize, samples: &mut [f32], found: &mut [[u32; LANES]]) {
    let Slab { search, bvh, grid, band, layer } = *slab;
    let scale = bvh.frame().scale();
    // Slightly more, so that rounding includes too much rather than too little.
    let reach = band * scale * (1.0 + 4.0 * EPSILON);
    let [nx, ny, _] = grid.dims;
    let layers = samples.len() / (nx * ny);
    let columns = nx.div_ceil(PACKET[0]);
    let mut stack = Vec::with_capacity(bvh.stack_capacity());
    let mut guesses = Vec::with_capacity(2 * LANES);
    for column in 0..columns {
        let mut index = [0; LANES];
        let mut points = Points::ZERO;
        for lane in 0..LANES {
            // Lanes outside the grid repeat the last node inside.
            let i = (column * PACKET[0] + lane % PACKET[0]).min(nx - 1);
            let j = (strip * PACKET[1] + lane / PACKET[0] % PACKET[1]).min(ny - 1);
            let k = (lane / (PACKET[0] * PACKET[1])).min(layers - 1);
            index[lane] = (k * ny + j) * nx + i;
            points.set(lane, bvh.frame().to_unit(grid.node(i, j, layer + k)));
        }
        let mut packet = Packet {
            x: points.x.map(|x| x as f32),
            y: points.y.map(|y| y as f32),
            z: points.z.map(|z| z as f32),
            squared: [(reach * reach) as f32; LANES],
            slot: [NOTHING; LANES],
        };
        // Guesses: the distinct triangles of the packet before in this strip and of the one in the
        // last strip.
        guesses.clear();
        for &slot in found[column.saturating_sub(1)..=column].as_flattened() {
            if slot != NOTHING && !guesses.contains(&slot) {
                guesses.push(slot);
            }
        }
        search.search(&mut packet, &guesses, &mut stack);
        found[column] = packet.slot;
        if packet.slot == [NOTHING; LANES] {
            index.iter().for_each(|&index| samples[index] = band as f32);
            continue;
        }
        let squared = exact_squared_distances(&points, bvh, &packet.slot);
        for lane in 0..LANES {
            samples[index[lane]] = (squared[lane].sqrt() / scale).min(band) as f32;
        }
    }
}

/// Half a unit in the last place of `f32`, relative.
const EPSILON: f64 = f32::EPSILON as f64 / 2.0;

/// Bound on the error of the samples, model units.
///
/// In the unit frame, let ε = 2⁻²⁴, E the largest coordinate of a node, d the distance and L the
/// longest edge.
///
/// - Rounding the node and the triangle's first corner to `f32` displaces one against the other by
///   at most √3 ε (E + 1).
/// - Their difference, at most d + L long, is rounded (ε), rotated into the triangle's plane by
///   rounded unit vectors (4ε with the sum), compared with rounded lengths and directions in the
///   plane (3ε), and squared and summed (2ε as a distance). The total is 10 ε (d + L).
/// - A box has a margin for the rounding of coordinates along its axes. It is pruned by its squared
///   distance, whose sum and squares are off by no more than 2ε as a distance.
///
/// So the distance that selects a triangle is off by at most δ = ε (√3 (E + 1) + 12 (d + L)). The
/// selected triangle is at most 2δ farther away than the nearest. Its distance is then rounded
/// to `f32`, which adds ε d.
fn error_bound(bvh: &Bvh, search: &PacketSearch, farthest: f64) -> f64 {
    let scale = bvh.frame().scale();
    let distance = farthest * scale;
    let choice = EPSILON
        * (3f64.sqrt() * (search.largest_coordinate() + 1.0) + 12.0 * (distance + search.longest_edge2().sqrt()));
    (2.0 * choice + EPSILON * distance) / scale
}
