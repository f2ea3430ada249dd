//! Tests of remeshing: quality, distance, volume, crossings, and everything that must be kept.

mod attributes;
mod difficult;
mod lines;
mod measures;
mod quality;
mod shapes;

use isochore_mesh::{NoProgress, TriMesh};
use isochore_sculpt::{Remeshed, remesh, session::RemeshOptions};

use measures::{crossing_triangles, hausdorff};

/// Remeshes and checks what holds for every mesh: the distance, the volume, and no new crossings.
fn checked(mesh: &TriMesh, options: &RemeshOptions) -> Remeshed {
    let remeshed = remesh(mesh.clone(), options, &NoProgress).unwrap();
    let receipt = &remeshed.receipt;
    remeshed.mesh.check_valid().unwrap();
    assert_eq!(remeshed.mesh.triangles.len(), receipt.triangles_after);
    assert!(crossing_triangles(&remeshed.mesh) <= crossing_triangles(mesh));
    let distance = hausdorff(mesh, &remeshed.mesh);
    assert!(distance <= receipt.allowance, "{distance} > {}", receipt.allowance);
    if mesh.check().is_closed() {
        assert!(remeshed.mesh.check().is_closed());
        let change = remeshed.mesh.volume() / mesh.volume() - 1.0;
        assert!(change.abs() <= 1e-12, "{change}");
    }
    remeshed
}
