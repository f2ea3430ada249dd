use glam::DVec3;
use isochore_bench::cpu_seconds;
use isochore_mesh::TriMesh;
use parry3d::math::Vector as Vector32;
use parry3d::query::PointQuery as _;
use parry3d::shape::{TriMesh as Mesh32, TriMeshFlags as Flags32};
use parry3d_f64::math::Vector as Vector64;
use parry3d_f64::query::PointQuery as _;
use parry3d_f64::shape::{TriMesh as Mesh64, TriMeshFlags as Flags64};

use super::{Peer, Round, Task};

/// parry3d in single precision: exact, with signs from pseudonormals, its fastest method.
pub(super) struct Parry32;

/// parry3d in double precision.
pub(super) struct Parry64;

/// mesh_to_sdf: propagates the nearest triangle from cell to cell, which is not exact, and casts
/// rays for signs. It computes a whole grid.
pub(super) struct MeshToSdf;

impl Peer for Parry32 {
    fn name(&self) -> &'static str {
        "parry3d 0.31"
    }

    fn prepare(&mut self, _task: &Task<'_>) -> Result<(), String> {
        Ok(())
    }

    fn round(&mut self, task: &Task<'_>) -> Result<Round, String> {
        let vector = |p: DVec3| Vector32::new(p.x as f32, p.y as f32, p.z as f32);
        Ok(one_by_one(task, |mesh| {
            let points = mesh.positions.iter().map(|&p| vector(p)).collect();
            let peer = Mesh32::with_flags(points, mesh.triangles.clone(), Flags32::ORIENTED).expect("a valid mesh");
            move |point| {
                let point = vector(point);
                let projection = peer.project_local_point(point, false);
                let distance = f64::from((projection.point - point).length());
                if projection.is_inside { -distance } else { distance }
            }
        }))
    }
}

impl Peer for Parry64 {
    fn name(&self) -> &'static str {
        "parry3d-f64 0.31"
    }

    fn prepare(&mut self, _task: &Task<'_>) -> Result<(), String> {
        Ok(())
    }

    fn round(&mut self, task: &Task<'_>) -> Result<Round, String> {
        let vector = |p: DVec3| Vector64::new(p.x, p.y, p.z);
        Ok(one_by_one(task, |mesh| {
            let points = mesh.positions.iter().map(|&p| vector(p)).collect();
            let peer = Mesh64::with_flags(points, mesh.triangles.clone(), Flags64::ORIENTED).expect("a valid mesh");
            move |point| {
                let point = vector(point);
                let projection = peer.project_local_point(point, false);
                let distance = (projection.point - point).length();
                if projection.is_inside { -distance } else { distance }
            }
        }))
    }
}

/// Runs a round of a library that queries one point at a time.
fn one_by_one<Q: Fn(DVec3) -> f64>(task: &Task<'_>, build: impl FnOnce(&TriMesh) -> Q) -> Round {
    let begin = cpu_seconds();
    let query = build(task.mesh);
    let built = cpu_seconds();
    let distances: Vec<f64> = task.nodes().map(|node| query(task.grid.node_at(node))).collect();
    Round { build: built - begin, query: (cpu_seconds() - built) / distances.len() as f64, distances }
}

impl Peer for MeshToSdf {
    fn name(&self) -> &'static str {
        "mesh_to_sdf 0.4 (not exact)"
    }

    fn prepare(&mut self, _task: &Task<'_>) -> Result<(), String> {
        Ok(())
    }

    fn round(&mut self, task: &Task<'_>) -> Result<Round, String> {
        let single = |p: DVec3| p.to_array().map(|x| x as f32);
        let positions: Vec<[f32; 3]> = task.mesh.positions.iter().map(|&p| single(p)).collect();
        let triangles = task.mesh.triangles.as_flattened();
        let dims = task.grid.dims;
        let begin = cpu_seconds();
        let grid = mesh_to_sdf::Grid::new(single(task.grid.origin), [task.grid.cell as f32; 3], dims);
        let topology = mesh_to_sdf::Topology::TriangleList(Some(triangles));
        let all = mesh_to_sdf::generate_grid_sdf(&positions, topology, &grid, mesh_to_sdf::SignMethod::Raycast);
        let query = (cpu_seconds() - begin) / all.len() as f64;
        let at = |node: usize| {
            let cell = [node % dims[0], node / dims[0] % dims[1], node / (dims[0] * dims[1])];
            f64::from(all[grid.get_cell_idx(&cell)])
        };
        Ok(Round { build: 0.0, query, distances: task.nodes().map(at).collect() })
    }
}
