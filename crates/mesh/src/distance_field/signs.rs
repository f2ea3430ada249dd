//! Signs of the nodes of a grid: inside or outside.

#[cfg(test)]
mod tests;

use std::sync::Arc;

use glam::DVec3;
use rayon::prelude::*;

use super::patches::Patches;
use super::row_crossings::RowCrossings;
use super::{DistanceFieldError, Grid};
use crate::{Bvh, Monitor, TriMesh, WindingNumber};

/// Nodes of the hierarchy between two checks of the monitor.
const NODES_AT_ONCE: usize = 1 << 13;

/// Nodes along each side of a brick. A brick far from all patches is decided as a whole.
const BRICK: usize = 4;

/// Distance from a patch, relative to the longest side of the mesh, below which the winding number
/// of the mesh is used instead of that of the patches. Larger: slower. Smaller than the rounding of
/// 1e-15: a node on a patch could be assigned inconsistently.
const TOO_CLOSE: f64 = 1e-9;

/// Negates the distances of the nodes inside, those whose winding number exceeds one half.
///
/// `open_edges` are the open edges of the mesh. Without open edges, counting crossings of rows is
/// enough. With open edges, patches close the mesh for the count. Then the winding number of the
/// patches, which decreases with the distance from the holes, is subtracted.
pub(super) fn negate_inside(
    samples: &mut [f32],
    mesh: &TriMesh,
    open_edges: &[[u32; 2]],
    bvh: &Arc<Bvh>,
    grid: &Grid,
    monitor: &dyn Monitor,
) -> Result<(), DistanceFieldError> {
    let rows = RowCrossings::new(grid, bvh.frame());
    bvh.nodes().par_chunks(NODES_AT_ONCE).try_for_each(|nodes| {
        // Most triangles of a fine mesh are between rows, and so are most leaves.
        for leaf in nodes.iter().filter(|node| node.is_leaf() && rows.may_meet(node)) {
            for slot in leaf.first..leaf.first + leaf.count {
                rows.add(&bvh.corners(slot), &bvh.triangles()[slot as usize]);
            }
        }
        monitor.check_cancelled()
    })?;
    if open_edges.is_empty() {
        let numbers = rows.into_winding_numbers();
        samples.par_iter_mut().zip(numbers).for_each(|(sample, number)| negate_if(sample, number >= 1));
        return Ok(());
    }

    let patches = Patches::over(open_edges, &mesh.positions);
    for (corners, vertices) in patches.positions.iter().zip(&patches.triangles) {
        rows.add(&corners.map(|corner| bvh.frame().to_unit(corner)), vertices);
    }
    let numbers = rows.into_winding_numbers();
    let of_patches = patches.winding_number()?;
    let of_mesh = std::sync::OnceLock::new();
    let size = 1.0 / bvh.frame().scale();
    let is_inside = |node: DVec3, number: i32| {
        if of_patches.is_below_half(node, 0.0) {
            number >= 1
        } else if of_patches.bvh().closest_point(node).distance > TOO_CLOSE * size {
            !of_patches.exceeds(node, f64::from(number) - 0.5)
        } else {
            of_mesh.get_or_init(|| WindingNumber::new(bvh.clone())).is_inside(node)
        }
    };
    let [nx, ny, _] = grid.dims;
    let slabs = samples.par_chunks_mut(nx * ny * BRICK).zip(numbers.par_chunks(nx * ny * BRICK)).enumerate();
    slabs.try_for_each(|(slab, (samples, numbers))| {
        let layers = samples.len() / (nx * ny);
        for (row, column) in
            (0..ny.div_ceil(BRICK)).flat_map(|row| (0..nx.div_ceil(BRICK)).map(move |column| (row, column)))
        {
            let start = DVec3::new((column * BRICK) as f64, (row * BRICK) as f64, (slab * BRICK) as f64);
            let half = 0.5 * (BRICK - 1) as f64 * grid.cell;
            let is_far = of_patches.is_below_half(grid.origin + start * grid.cell + half, 3f64.sqrt() * half);
            for k in 0..layers {
                for j in row * BRICK..((row + 1) * BRICK).min(ny) {
                    for i in column * BRICK..((column + 1) * BRICK).min(nx) {
                        let index = (k * ny + j) * nx + i;
                        let number = numbers[index];
                        let is_inside =
                            if is_far { number >= 1 } else { is_inside(grid.node(i, j, slab * BRICK + k), number) };
                        negate_if(&mut samples[index], is_inside);
                    }
                }
            }
            monitor.check_cancelled()?;
        }
        Ok(())
    })
}

fn negate_if(sample: &mut f32, is_inside: bool) {
    if is_inside {
        *sample = -*sample;
    }
}
