//! Meshes with faults, near sheets, and options out of range.

use glam::{DQuat, DVec3};
use isochore_mesh::{Cancelled, Monitor, primitives::icosphere};
use isochore_sculpt::RemeshError;

use super::{
    shapes::{Numbers, bumpy_ball, grid},
    *,
};

#[test]
fn triangles_without_area_are_removed_or_kept_without_harm() {
    let mut mesh = icosphere(1.0, 3);
    // Edges of a random choice get a vertex on them, and random neighbors move together.
    let mut numbers = Numbers(5);
    for _ in 0..40 {
        let triangle = (numbers.next() * mesh.triangles.len() as f64) as usize;
        let [a, b, c] = mesh.triangles[triangle];
        let inserted = mesh.positions.len() as u32;
        mesh.positions.push(0.5 * (mesh.positions[a as usize] + mesh.positions[b as usize]));
        // The third triangle has no area.
        mesh.triangles[triangle] = [inserted, b, c];
        mesh.triangles.extend([[a, inserted, c], [a, b, inserted]]);
    }
    for _ in 0..20 {
        let [a, b, _] = mesh.triangles[(numbers.next() * mesh.triangles.len() as f64) as usize];
        mesh.positions[a as usize] = mesh.positions[b as usize];
    }
    let before = crossing_triangles(&mesh);
    let remeshed = remesh(mesh.clone(), &RemeshOptions::default(), &NoProgress).unwrap();
    assert!(crossing_triangles(&remeshed.mesh) <= before);
    assert!(remeshed.mesh.positions.iter().all(|position| position.is_finite()));
}

/// Two balls that nearly touch: a remesh that looked at single sheets only would make them cross.
#[test]
fn near_sheets_do_not_cross() {
    for seed in 0..3 {
        let one = bumpy_ball(seed, 4);
        // A thin shell: the same surface inside out, a little smaller.
        let mut mesh = one.clone();
        let count = one.positions.len() as u32;
        mesh.positions.extend(one.positions.iter().map(|p| p * (1.0 - 2e-4)));
        mesh.triangles.extend(one.triangles.iter().map(|&[a, b, c]| [a + count, c + count, b + count]));
        assert_eq!(crossing_triangles(&mesh), 0);
        let options = RemeshOptions { deviation: Some(2e-3), ..RemeshOptions::default() };
        let remeshed = remesh(mesh, &options, &NoProgress).unwrap();
        assert_eq!(crossing_triangles(&remeshed.mesh), 0);
    }
}

#[test]
fn existing_crossings_stay_and_none_is_added() {
    let mut mesh = icosphere(1.0, 4);
    let other = mesh.transformed(1.0, DQuat::from_rotation_x(0.3), DVec3::new(1.2, 0.1, 0.0));
    let count = mesh.positions.len() as u32;
    mesh.positions.extend(other.positions);
    mesh.triangles.extend(other.triangles.iter().map(|triangle| triangle.map(|vertex| vertex + count)));
    let before = crossing_triangles(&mesh);
    let remeshed = remesh(mesh.clone(), &RemeshOptions::default(), &NoProgress).unwrap().mesh;
    assert_eq!(crossing_triangles(&remeshed), before);
    assert!(remeshed.triangles.len() < mesh.triangles.len());
}

#[test]
fn scale_and_place_do_not_matter() {
    let mesh = bumpy_ball(2, 3);
    let reference = remesh(mesh.clone(), &RemeshOptions::default(), &NoProgress).unwrap().mesh;
    // Powers of two: no rounding.
    for exponent in [-160, -20, 20, 160] {
        let scale = libm::exp2(f64::from(exponent));
        let scaled =
            remesh(mesh.transformed(scale, DQuat::IDENTITY, DVec3::ZERO), &RemeshOptions::default(), &NoProgress);
        assert_eq!(scaled.unwrap().mesh.triangles, reference.triangles, "2^{exponent}");
    }
    let far = mesh.transformed(1.0, DQuat::IDENTITY, DVec3::splat(1e6));
    let far = remesh(far, &RemeshOptions::default(), &NoProgress).unwrap();
    assert!(far.receipt.volume_change.unwrap().abs() < 1e-9);
}

#[test]
fn small_meshes() {
    let tetrahedron =
        TriMesh::new(vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z], vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]);
    assert_eq!(checked(&tetrahedron, &RemeshOptions::default()).mesh.triangles.len(), 4);
    let triangle = TriMesh::new(vec![DVec3::ZERO, DVec3::X, DVec3::Y], vec![[0, 1, 2]]);
    assert_eq!(checked(&triangle, &RemeshOptions::default()).mesh.triangles.len(), 1);
    let finer = RemeshOptions { edge_length: Some(0.1), ..RemeshOptions::default() };
    assert!(checked(&triangle, &finer).mesh.triangles.len() > 60);
    let needle = grid([2, 40], [false; 2], |i, j| DVec3::new(1e-7 * i as f64, j as f64, 0.0));
    checked(&needle, &RemeshOptions::default());
    let empty = remesh(TriMesh::default(), &RemeshOptions::default(), &NoProgress);
    assert!(empty.is_err() || empty.is_ok_and(|remeshed| remeshed.mesh.triangles.is_empty()));
}

#[test]
fn triangles_stay_within_their_limit() {
    let options = RemeshOptions { edge_length: Some(0.01), max_triangles: 2000, ..RemeshOptions::default() };
    let remeshed = remesh(icosphere(1.0, 3), &options, &NoProgress).unwrap();
    assert!(remeshed.receipt.is_limited && remeshed.mesh.triangles.len() <= 2000);
}

#[test]
fn rejects_options_and_meshes() {
    let message = |mesh: TriMesh, options: &RemeshOptions| remesh(mesh, options, &NoProgress).unwrap_err().to_string();
    for length in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let options = RemeshOptions { edge_length: Some(length), ..RemeshOptions::default() };
        assert_eq!(message(icosphere(1.0, 1), &options), "remesh: the edge length must be a positive, finite number");
        let options = RemeshOptions { deviation: Some(length), ..RemeshOptions::default() };
        assert_eq!(message(icosphere(1.0, 1), &options), "remesh: the deviation must be a positive, finite number");
    }
    for scale in [1e-70, 1e100] {
        let mesh = icosphere(1.0, 1).transformed(scale, DQuat::IDENTITY, DVec3::ZERO);
        assert!(message(mesh, &RemeshOptions::default()).contains("scale the mesh"));
    }
    let fins =
        TriMesh::new(vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z, -DVec3::Y], vec![[0, 1, 2], [0, 1, 3], [1, 0, 4]]);
    assert!(matches!(remesh(fins, &RemeshOptions::default(), &NoProgress), Err(RemeshError::Mesh(_))));
}

/// A monitor that stops after some calls.
struct Stopping(std::sync::atomic::AtomicUsize);

impl Monitor for Stopping {
    fn is_cancelled(&self) -> bool {
        let order = std::sync::atomic::Ordering::SeqCst;
        self.0.fetch_update(order, order, |calls| calls.checked_sub(1)).is_err()
    }
}

#[test]
fn can_be_cancelled() {
    for calls in [0, 3, 20] {
        let stopped = remesh(bumpy_ball(1, 4), &RemeshOptions::default(), &Stopping(calls.into()));
        assert!(matches!(stopped, Err(RemeshError::Cancelled(Cancelled))), "{calls}");
    }
}
