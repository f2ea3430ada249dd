//! The quality of smooth surfaces.

use isochore_mesh::primitives::{icosphere, latitude_longitude_sphere};

use super::{
    measures::fraction_below,
    shapes::{bumpy_ball, torus},
    *,
};

/// Angles, and the volume before the lock.
fn assert_smooth(name: &str, mesh: &TriMesh, options: &RemeshOptions) -> Remeshed {
    let remeshed = checked(mesh, options);
    let below = fraction_below(&remeshed.mesh, 20.0);
    assert!(below <= 0.001, "{name}: {below} of {} triangles", remeshed.mesh.triangles.len());
    let bare = remeshed.receipt.unlocked_volume_change.unwrap() / mesh.volume();
    assert!(bare.abs() <= 1e-5, "{name}: {bare}");
    remeshed
}

#[test]
fn smooth_surfaces_get_well_shaped_triangles_and_keep_their_volume() {
    let options = RemeshOptions::default();
    for (name, mesh) in [
        ("ball", icosphere(1.0, 5)),
        ("globe", latitude_longitude_sphere(1.0, 160, 80)),
        ("torus", torus(0.4, 200, 40)),
        ("thin torus", torus(0.1, 300, 24)),
    ] {
        let remeshed = assert_smooth(name, &mesh, &options);
        assert!(remeshed.mesh.triangles.len() < mesh.triangles.len(), "{name}");
    }
}

#[test]
fn random_bumpy_surfaces_keep_every_bound() {
    for seed in 0..6 {
        let mesh = bumpy_ball(seed, 5);
        let deviation = [1e-3, 3e-4, 3e-3][seed as usize % 3];
        let options = RemeshOptions { deviation: Some(deviation), ..RemeshOptions::default() };
        assert_smooth(&format!("ball {seed}"), &mesh, &options);
    }
}

#[test]
fn edges_get_the_length_asked_for() {
    let mesh = bumpy_ball(7, 4);
    for length in [0.05, 0.1, 0.2] {
        let options = RemeshOptions { edge_length: Some(length), ..RemeshOptions::default() };
        let remeshed = assert_smooth(&format!("length {length}"), &mesh, &options).mesh;
        let mean = remeshed.edge_lengths().unwrap().mean;
        assert!((mean / length - 1.0).abs() < 0.15, "{mean} instead of {length}");
    }
}

#[test]
fn a_second_remesh_changes_little() {
    let options = RemeshOptions::default();
    let once = assert_smooth("once", &bumpy_ball(3, 5), &options);
    let twice = assert_smooth("twice", &once.mesh, &options);
    let ratio = twice.mesh.triangles.len() as f64 / once.mesh.triangles.len() as f64;
    assert!((0.7..1.1).contains(&ratio), "{ratio}");
}

#[test]
fn same_bits_for_every_number_of_threads() {
    let mesh = bumpy_ball(11, 4);
    let with = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| remesh(mesh.clone(), &RemeshOptions::default(), &NoProgress).unwrap().mesh)
    };
    let one = with(1);
    for threads in [2, 5] {
        assert_eq!(one, with(threads), "{threads} threads");
    }
}
