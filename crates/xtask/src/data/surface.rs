//! Meshing of solids: surface nets first, then flips and relaxation on the surface until triangles are well shaped.

use fast_surface_nets::{
    SurfaceNetsBuffer,
    ndshape::{RuntimeShape, Shape},
    surface_nets,
};
use glam::DVec3;
use isochore_mesh::{Aabb, TriMesh};

use rayon::prelude::*;

use super::flips::Flips;

/// Rounds of flipping and relaxing. Twice as many raise the smallest angle by less than a degree.
const ROUNDS: usize = 40;

/// Fraction of the distance to the mean of its neighbors that a vertex moves in a round. Above one half, thin parts oscillate.
const RELAXATION: f64 = 0.5;

/// Newton steps onto the surface after each round and at the end.
const STEPS_BETWEEN: usize = 1;
const STEPS_AT_END: usize = 8;

/// Half the distance between the points of central differences, in cells. Smaller values see rounding, larger ones blur
/// fillets.
const DIFFERENCE: f64 = 1e-3;

/// The surface of the solid whose signed distance is `distance`, inside `bounds`, with triangles whose edges are about
/// as long as `cell`.
///
/// Details smaller than a cell are lost; the caller checks that the result is closed and manifold.
pub(crate) fn surface(distance: &(dyn Fn(DVec3) -> f64 + Sync), bounds: Aabb, cell: f64) -> TriMesh {
    let mut mesh = nets(distance, bounds, cell);
    for _ in 0..ROUNDS {
        Flips::of(&mut mesh).improve_valences();
        relax(&mut mesh, distance, cell);
    }
    Flips::of(&mut mesh).make_delaunay();
    mesh.positions.par_iter_mut().for_each(|position| project(position, distance, cell, STEPS_AT_END));
    mesh
}

/// Naive surface nets of the samples on a grid.
fn nets(distance: &(dyn Fn(DVec3) -> f64 + Sync), bounds: Aabb, cell: f64) -> TriMesh {
    let bounds = bounds.expanded(2.0 * cell);
    let size = (bounds.size() / cell).ceil().as_uvec3() + 1;
    let shape = RuntimeShape::<u32, 3>::new(size.to_array());
    let samples: Vec<f32> = (0..shape.size())
        .into_par_iter()
        .map(|index| {
            let place = DVec3::from_array(shape.delinearize(index).map(f64::from));
            (distance(bounds.min + cell * place) / cell) as f32
        })
        .collect();
    let mut buffer = SurfaceNetsBuffer::default();
    surface_nets(&samples, &shape, [0; 3], (size - 1).to_array(), &mut buffer);
    let positions = buffer.positions.iter().map(|&place| bounds.min + cell * DVec3::from_array(place.map(f64::from)));
    TriMesh { positions: positions.collect(), triangles: buffer.indices.as_chunks().0.to_vec(), ..TriMesh::default() }
}

/// Moves every vertex along the surface toward the mean of its neighbors.
fn relax(mesh: &mut TriMesh, distance: &(dyn Fn(DVec3) -> f64 + Sync), cell: f64) {
    let mut sums = vec![(DVec3::ZERO, 0.0); mesh.positions.len()];
    for triangle in &mesh.triangles {
        for side in 0..3 {
            let [from, to] = [triangle[side], triangle[(side + 1) % 3]].map(|vertex| vertex as usize);
            sums[from].0 += mesh.positions[to];
            sums[from].1 += 1.0;
        }
    }
    mesh.positions.par_iter_mut().zip(sums).for_each(|(position, (sum, count))| {
        let normal = gradient(distance, *position, cell).normalize_or_zero();
        let shift = sum / count - *position;
        *position += RELAXATION * (shift - shift.dot(normal) * normal);
        project(position, distance, cell, STEPS_BETWEEN);
    });
}

/// Newton steps along the gradient to the zero of the distance, each at most one cell long.
fn project(position: &mut DVec3, distance: &(dyn Fn(DVec3) -> f64 + Sync), cell: f64, steps: usize) {
    for _ in 0..steps {
        let slope = gradient(distance, *position, cell);
        let step = distance(*position) / slope.length_squared().max(1e-6) * slope;
        *position -= step.clamp_length_max(cell);
    }
}

/// Gradient by central differences.
fn gradient(distance: &(dyn Fn(DVec3) -> f64 + Sync), point: DVec3, cell: f64) -> DVec3 {
    let half = DIFFERENCE * cell;
    let slope = |axis: DVec3| (distance(point + half * axis) - distance(point - half * axis)) / (2.0 * half);
    DVec3::new(slope(DVec3::X), slope(DVec3::Y), slope(DVec3::Z))
}
