//! Unsigned distances at all nodes of a grid.

use std::sync::atomic::{AtomicUsize, Ordering};

use multiversion::multiversion;
use rayon::prelude::*;

use super::Grid;
use super::exact_distance::{Points, exact_squared_distances};
use super::packet::{LANES, NOTHING, PACKET, Packet, PacketSearch};
use crate::huge_pages::in_huge_pages;
use crate::{Bvh, Cancelled, Monitor};

/// Distances without sign, and a bound on their error, both in model units.
///
/// Triangles are chosen in `f32` and measured in `f64`, so that an error can only come from a choice between triangles that are
/// nearly equally near, and from rounding the result. Nodes farther than `band` get that distance.
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
    // A slab knows nothing of other slabs, so that the result does not depend on how threads share them.
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

/// Layers of a grid as thick as a packet.
struct Slab<'a> {
    search: &'a PacketSearch,
    bvh: &'a Bvh,
    grid: &'a Grid,
    band: f64,
    /// The first of the layers.
    layer: usize,
}

/// Fills a strip of packets through the layers that `samples` has room for. `found` are the triangles that the packets of the strip
/// before found, and of this one in the end: what a packet finds is near to what those beside it found.
#[multiversion(targets("x86_64+avx512f+avx512vl", "x86_64+avx2", "x86_64+sse4.1", "aarch64+neon"))]
fn sample_strip(slab: &Slab<'_>, strip: usize, samples: &mut [f32], found: &mut [[u32; LANES]]) {
    let Slab { search, bvh, grid, band, layer } = *slab;
    let scale = bvh.frame().scale();
    // A little more, so that rounding finds too much rather than too little.
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
            // Lanes that stick out repeat the last node inside.
            let i = (column * PACKET[0] + lane % PACKET[0]).min(nx - 1);
            let j = (strip * PACKET[1] + lane / PACKET[0] % PACKET[1]).min(ny - 1);
            let k = (lane / (PACKET[0] * PACKET[1])).min(layers - 1);
            index[lane] = (k * ny + j) * nx + i;
            points.set(lane, bvh.frame().inward(grid.node(i, j, layer + k)));
        }
        let mut packet = Packet {
            x: points.x.map(|x| x as f32),
            y: points.y.map(|y| y as f32),
            z: points.z.map(|z| z as f32),
            squared: [(reach * reach) as f32; LANES],
            slot: [NOTHING; LANES],
        };
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

/// In the unit frame, with ε = 2⁻²⁴, E the largest coordinate of a node, d the distance and L the longest edge:
///
/// - Rounding the node and the triangle's first corner to `f32` displaces one against the other by at most √3 ε (E + 1).
/// - Their difference, at most d + L long, is rounded (ε), turned into the triangle's plane by rounded unit vectors (4ε with the
///   sum), compared with rounded lengths and directions in the plane (3ε), and squared and summed (2ε as a distance): 10 ε (d + L).
/// - A box, which is grown by the rounding of coordinates along its axes, may be left out by comparison with its squared distance,
///   whose sum and squares are wrong by no more than 2ε as a distance.
///
/// So the distance by which a triangle is chosen is off by δ = ε (√3 (E + 1) + 12 (d + L)), and the chosen triangle is no more than
/// 2δ farther than the nearest. Its distance is then rounded to `f32`: ε d.
fn error_bound(bvh: &Bvh, search: &PacketSearch, farthest: f64) -> f64 {
    let scale = bvh.frame().scale();
    let distance = farthest * scale;
    let choice = EPSILON
        * (3f64.sqrt() * (search.largest_coordinate() + 1.0) + 12.0 * (distance + search.longest_edge2().sqrt()));
    (2.0 * choice + EPSILON * distance) / scale
}
