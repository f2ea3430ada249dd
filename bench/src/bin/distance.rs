//! Building a distance grid, against asking a general library for one node after the other; one core.

#![expect(clippy::print_stdout, reason = "benchmarks print their results")]

use glam::dvec3;
use isochore_bench::{interleaved_medians, on_one_thread, print_row};
use isochore_mesh::primitives::latitude_longitude_sphere;
use isochore_mesh::{Bvh, DistanceField, DistanceFieldOptions, SelfIntersections, Silent, TriMesh};
use parry3d_f64::math::Vector;
use parry3d_f64::query::PointQuery;
use parry3d_f64::shape::{TriMesh as ParryMesh, TriMeshFlags};

/// Every so many nodes are asked of the other library, or a round would take minutes. Coprime to the sides of the grids, so that
/// they lie everywhere.
const STRIDE: usize = 17;

/// About 70,000 triangles with hollows and ridges, which fill little of their bounding box.
fn rugged() -> TriMesh {
    let mut mesh = latitude_longitude_sphere(1.0, 220, 160);
    for p in &mut mesh.positions {
        let bump = 1.0 + 0.3 * (7.0 * p.x).sin() * (5.0 * p.y + 2.0 * p.z).cos() + 0.02 * (40.0 * p.z).sin();
        *p *= dvec3(0.8, 0.6, 1.0) * bump;
    }
    mesh
}

fn main() {
    on_one_thread(|| {
        let mesh = rugged();
        let points = mesh.positions.iter().map(|p| Vector::new(p.x, p.y, p.z)).collect();
        let peer = ParryMesh::with_flags(points, mesh.triangles.clone(), TriMeshFlags::ORIENTED).expect("a sound mesh");
        println!(
            "{} triangles; distance to each node of a grid, hierarchy, signs and spline included",
            mesh.triangles.len()
        );
        print_row(["resolution", "nodes", "µs/node", "parry3d µs/node", "ratio", "max error/size"]);
        for resolution in [32, 64] {
            compare(&mesh, &peer, resolution);
        }

        println!("\nother work on the same mesh");
        print_row(["hierarchy ms", "crossings ms"]);
        let seconds = interleaved_medians(&mut [
            &mut || drop(Bvh::new(&mesh.positions, &mesh.triangles).expect("a sound mesh")),
            &mut || drop(SelfIntersections::of(&mesh, &Silent).expect("a sound mesh")),
        ]);
        print_row([&format!("{:.1}", 1e3 * seconds[0]), &format!("{:.1}", 1e3 * seconds[1])]);
    });
}

fn compare(mesh: &TriMesh, peer: &ParryMesh, resolution: usize) {
    let options = DistanceFieldOptions { resolution, ..Default::default() };
    let build = || DistanceField::new(mesh, &options, &Silent).expect("a sound mesh");
    let field = build();
    let nodes: Vec<usize> = (0..field.samples().len()).step_by(STRIDE).collect();
    let ask = |node: usize| {
        let p = field.grid().node_at(node);
        let point = Vector::new(p.x, p.y, p.z);
        let projection = peer.project_local_point(point, false);
        let distance = (projection.point - point).length();
        if projection.is_inside { -distance } else { distance }
    };
    let mut answers = Vec::new();
    let seconds = interleaved_medians(&mut [&mut || drop(build()), &mut || {
        answers = nodes.iter().map(|&node| ask(node)).collect::<Vec<f64>>();
    }]);

    let error = (nodes.iter().zip(&answers))
        .map(|(&node, answer)| (f64::from(field.samples()[node]) - answer).abs())
        .fold(0.0, f64::max);
    let ours = seconds[0] / field.samples().len() as f64;
    let theirs = seconds[1] / nodes.len() as f64;
    print_row([
        &resolution.to_string(),
        &field.samples().len().to_string(),
        &format!("{:.3}", 1e6 * ours),
        &format!("{:.2}", 1e6 * theirs),
        &format!("{:.1}", theirs / ours),
        &format!("{:.1e}", error / mesh.bounds().size().max_element()),
    ]);
}
