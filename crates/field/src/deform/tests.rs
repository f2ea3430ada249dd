mod masked;

use std::{f64::consts::FRAC_PI_2, sync::Arc};

use glam::DVec3;
use isochore_mesh::{Capsule, NoProgress, SelfIntersections, Sphere, primitives};

use super::*;
use crate::{
    fields::{Pose, Profile, Tool, rotation_from_vector},
    flow::{Move, Twist},
};

/// Refined, but not locked.
const REFINED: DeformOptions = DeformOptions {
    refine: Some(RefineOptions {
        volume: Some(1e-4),
        deviation: 1e-3,
        max_edge: None,
        max_triangles: 2_000_000,
        rebase: Rebase::Auto,
    }),
    lock: false,
};

/// Neither refined nor locked.
const BARE: DeformOptions = DeformOptions { refine: None, lock: false };

fn ball(radius: f64, support: f64) -> Arc<Tool> {
    Arc::new(Tool::new(Arc::new(Sphere::new(radius).unwrap()), support, Profile::Quintic).unwrap())
}

fn press(step: f64) -> Stroke {
    let start = DVec3::new(0.1, 0.05, 1.72);
    let keys = vec![Pose::at(start), Pose::at(start - DVec3::Z * 0.82)];
    Stroke::Move(Move::new(ball(0.4, 0.3), keys, step).unwrap())
}

fn run(mesh: &TriMesh, strokes: &[Stroke], options: &DeformOptions) -> Deformed {
    deform(mesh, strokes, options, &NoProgress).unwrap()
}

fn volume_change(deformed: &Deformed) -> f64 {
    deformed.receipt.volume_before_lock.unwrap() / deformed.receipt.volume_before.unwrap() - 1.0
}

#[test]
fn golden_facet_error_of_a_press() {
    let deformed = run(&primitives::icosphere(1.0, 4), &[press(1.0 / 64.0)], &BARE);
    // The golden value has seven digits; the error of the step is less than 1e-9.
    assert!((volume_change(&deformed) - 9.331199e-3).abs() < 1e-8, "{}", volume_change(&deformed));
}

#[test]
fn golden_facet_error_of_a_twist() {
    let cube = primitives::box_mesh(DVec3::ONE, [40, 60, 60]);
    for rate in [0.5 * FRAC_PI_2, -0.5 * FRAC_PI_2] {
        let twist = Stroke::Twist(Twist::new(DVec3::ZERO, DVec3::Z, rate).unwrap());
        let deformed = run(&cube, &[twist], &BARE);
        assert!((volume_change(&deformed) + 1.142250e-4).abs() < 1e-10, "{}", volume_change(&deformed));
    }
}

#[test]
fn estimated_facet_error_matches_the_volume_gained_by_refinement() {
    let deformed = run(&primitives::icosphere(1.0, 4), &[press(0.0625)], &BARE);
    let estimate = deformed.receipt.facet_error.unwrap() / deformed.receipt.volume_before.unwrap();
    // The facet error is the change of volume with the opposite sign. The estimate is asymptotic, and
    // holds within a fifth on this mesh.
    assert!((estimate + volume_change(&deformed)).abs() < 0.2 * estimate.abs(), "{estimate}");
}

#[test]
fn a_smaller_volume_tolerance_reduces_the_drift() {
    let sphere = primitives::icosphere(1.0, 4);
    let mut last = (f64::INFINITY, 0);
    for volume in [1e-3, 1e-4, 1e-5] {
        let refine =
            RefineOptions { volume: Some(volume), deviation: 1.0, max_edge: Some(10.0), ..RefineOptions::default() };
        let deformed = run(&sphere, &[press(0.125)], &DeformOptions { refine: Some(refine), lock: false });
        let (drift, triangles) = (volume_change(&deformed).abs(), deformed.mesh.triangles.len());
        // The estimate is asymptotic, and the error of the time step is 1e-5.
        assert!(drift < 2.0 * volume + 1e-5, "{volume}: {drift:.1e}");
        assert!(drift < last.0 && triangles > last.1, "{volume}: {drift:.1e} with {triangles}");
        last = (drift, triangles);
    }
}

#[test]
fn refinement_keeps_the_mesh_closed_and_the_rest_volume() {
    let sphere = primitives::icosphere(1.0, 3);
    let deformed = run(&sphere, &[press(0.125)], &DeformOptions::default());
    assert!(deformed.receipt.inserted_vertices > 100);
    assert!(ClosedMesh::new(&deformed.mesh).is_ok());
    assert!(ClosedMesh::new(&deformed.rest).is_ok());
    // Midpoints of straight edges change no volume beyond rounding.
    assert!((deformed.rest.volume() / sphere.volume() - 1.0).abs() < 1e-14);
    assert_eq!(deformed.rest.positions[..sphere.positions.len()], sphere.positions);
}

/// A rod that turns by 90° just below the surface and draws a thin lip out of it.
fn turning_rod(profile: Profile, step: f64) -> Stroke {
    let rod = Arc::new(Tool::new(Arc::new(Capsule::new(0.15, 0.8).unwrap()), 0.25, profile).unwrap());
    let at = DVec3::new(0.0, 0.6, 0.0);
    let turned = Pose { rotation: rotation_from_vector(DVec3::Y * FRAC_PI_2), translation: at };
    Stroke::Move(Move::new(rod, vec![Pose::at(at), turned], step).unwrap())
}

/// Some triangles are compressed until only their longest edge meets the criteria.
#[test]
fn refinement_ends_and_leaves_no_slivers() {
    let sphere = primitives::icosphere(1.0, 4);
    let deformed = run(&sphere, &[turning_rod(Profile::Quintic, 0.125)], &REFINED);
    let shortest = |mesh: &TriMesh| mesh.edge_lengths().unwrap().min;
    // The tip of the rod stretches material more than a hundredfold, which takes seven halvings; an
    // endless split would reach 2⁻⁴⁰.
    assert!(shortest(&deformed.rest) > shortest(&sphere) / 1024.0);
    assert!(volume_change(&deformed).abs() < 1e-3);
}

#[test]
fn refinement_removes_the_crossings_of_a_smooth_stroke() {
    let sphere = primitives::icosphere(1.0, 4);
    let crossings = |options: &DeformOptions| {
        let Deformed { mesh, receipt, .. } = run(&sphere, &[turning_rod(Profile::Quintic, 0.05)], options);
        assert_eq!(receipt.strokes[0].stopped_at, None);
        let found = SelfIntersections::of(&mesh, &NoProgress).unwrap().triangles().len();
        assert_eq!(receipt.new_crossings, found);
        found
    };
    assert!(crossings(&BARE) > 0);
    assert_eq!(crossings(&REFINED), 0);
}

#[test]
fn the_lock_restores_the_volume() {
    let sphere = primitives::icosphere(1.0, 4);
    for refine in [None, Some(RefineOptions::default())] {
        let deformed = run(&sphere, &[press(0.125)], &DeformOptions { refine, lock: true });
        assert!((deformed.mesh.volume() / sphere.volume() - 1.0).abs() < 1e-14);
        let touched = deformed.rest.positions.iter().zip(&deformed.mesh.positions).filter(|(a, b)| a != b).count();
        assert_eq!(touched, deformed.receipt.moved_vertices);
    }
}

#[test]
fn the_lock_of_an_untouched_mesh_is_skipped_with_a_note() {
    let far = Stroke::Move(
        Move::new(ball(0.1, 0.1), vec![Pose::at(DVec3::X * 5.0), Pose::at(DVec3::X * 6.0)], 0.125).unwrap(),
    );
    let sphere = primitives::icosphere(1.0, 2);
    let deformed = run(&sphere, &[far], &DeformOptions::default());
    assert_eq!(deformed.mesh, sphere);
    assert_eq!(deformed.receipt.notes, [Note::LockSkipped]);
    assert_eq!(deformed.receipt.moved_vertices, 0);
}

#[test]
fn refinement_finds_a_tool_smaller_than_the_triangles() {
    let cube = primitives::box_mesh(DVec3::ONE, [1, 1, 1]);
    let tip = DVec3::new(0.3, -0.1, 1.4);
    let press =
        Stroke::Move(Move::new(ball(0.1, 0.1), vec![Pose::at(tip), Pose::at(tip - DVec3::Z * 0.5)], 0.125).unwrap());
    let deformed = run(&cube, &[press], &REFINED);
    assert!(deformed.receipt.max_displacement > 0.1, "{}", deformed.receipt.max_displacement);
    assert!(ClosedMesh::new(&deformed.mesh).is_ok());
    assert!(volume_change(&deformed).abs() < 1e-3);
}

#[test]
fn the_limit_on_triangles_holds_and_is_noted() {
    let refine = RefineOptions { max_triangles: 6000, max_edge: Some(1e-3), ..RefineOptions::default() };
    let deformed =
        run(&primitives::icosphere(1.0, 4), &[press(0.125)], &DeformOptions { refine: Some(refine), lock: false });
    assert!(deformed.mesh.triangles.len() <= 6000);
    assert_eq!(deformed.receipt.notes[0], Note::TriangleLimit { stroke: 0, max_triangles: 6000 });
}

#[test]
fn deforms_an_open_mesh_without_a_volume() {
    let mut bowl = primitives::icosphere(1.0, 3);
    bowl.triangles.truncate(900);
    let deformed = run(&bowl, &[press(0.125)], &DeformOptions::default());
    assert_eq!(deformed.receipt.volume_before, None);
    assert_eq!(deformed.receipt.notes, [Note::LockNeedsClosed]);
}

#[test]
fn rejects_an_index_out_of_range() {
    let mut sphere = primitives::icosphere(1.0, 1);
    sphere.triangles[7][2] = 99;
    let error = deform(&sphere, &[press(0.125)], &BARE, &NoProgress).unwrap_err();
    assert!(matches!(error, DeformError::Mesh(_)) && error.to_string().contains("99"), "{error}");
}

#[test]
fn shading_normals_turn_with_the_surface() {
    let mut sphere = primitives::icosphere(1.0, 3);
    let normals = sphere.vertex_normals();
    sphere.corner.normals =
        sphere.triangles.iter().map(|corners| corners.map(|vertex| normals[vertex as usize].as_vec3())).collect();
    let quarter = Stroke::Twist(Twist::new(DVec3::ZERO, DVec3::Z, FRAC_PI_2).unwrap());
    let twisted = run(&sphere, &[quarter], &BARE).mesh;
    let expected = twisted.vertex_normals();
    for (corners, normals) in twisted.triangles.iter().zip(&twisted.corner.normals) {
        for (&vertex, normal) in corners.iter().zip(normals) {
            // Single precision turns a direction by at most 1e-7, and changes its cosine by the square.
            assert!(normal.as_dvec3().normalize().dot(expected[vertex as usize]) > 1.0 - 1e-9);
        }
    }
}

#[test]
fn threads_do_not_change_the_bits() {
    let strokes = [press(0.125), Stroke::Twist(Twist::new(DVec3::ZERO, DVec3::Y, 0.4).unwrap())];
    let on = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| run(&primitives::icosphere(1.0, 4), &strokes, &DeformOptions::default()).mesh)
    };
    let one = on(1);
    assert_eq!(one, on(2));
    assert_eq!(one, on(8));
}

#[test]
fn advects_points_like_vertices() {
    let sphere = primitives::icosphere(1.0, 3);
    let strokes = [press(0.125)];
    let deformed = run(&sphere, &strokes, &REFINED);
    let points = crate::flow::advect_points(&sphere.positions, &strokes, &NoProgress).unwrap();
    assert_eq!(points, deformed.mesh.positions[..points.len()]);
}

#[test]
fn a_stroke_counts_only_the_vertices_that_moved() {
    let receipt = run(&primitives::icosphere(1.0, 3), &[press(0.125)], &REFINED).receipt;
    assert!(receipt.inserted_vertices > 100);
    assert_eq!(receipt.strokes[0].moved, receipt.moved_vertices);
}

#[test]
fn volume_changes_of_an_inverted_mesh_have_the_opposite_sign() {
    let sphere = primitives::icosphere(1.0, 3);
    let mut turned = sphere.clone();
    turned.triangles.iter_mut().for_each(|corners| corners.swap(1, 2));
    let [change, turned] =
        [sphere, turned].map(|mesh| run(&mesh, &[press(0.125)], &BARE).receipt.strokes[0].volume_change.unwrap());
    // Rounding of two sums over a thousand triangles.
    assert!(change > 1e-3 && (change + turned).abs() < 1e-13, "{change} {turned}");
}

#[test]
fn deforms_a_closed_mesh_of_zero_volume() {
    let positions = vec![DVec3::new(-1.0, -1.0, 0.9), DVec3::new(1.0, -1.0, 0.9), DVec3::new(0.0, 1.5, 0.9)];
    let sheet = TriMesh::new(positions, vec![[0, 1, 2], [0, 2, 1]]);
    let deformed = run(&sheet, &[press(0.125)], &DeformOptions::default());
    assert_eq!(deformed.receipt.strokes[0].volume_change, None);
    assert!(deformed.receipt.max_displacement > 0.1);
    assert!(deformed.mesh.positions.iter().all(|position| position.is_finite()));
}

#[test]
fn rejects_a_volume_that_overflows() {
    let sphere = primitives::icosphere(1e150, 2);
    assert_eq!(deform(&sphere, &[], &BARE, &NoProgress).unwrap_err(), DeformError::VolumeOverflow);
}
