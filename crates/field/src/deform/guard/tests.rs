use std::{f64::consts::FRAC_PI_2, sync::Arc};

use glam::DVec3;
use isochore_mesh::{Capsule, NoProgress, Sphere, TriMesh, primitives};

use super::*;
use crate::{
    deform::{DeformOptions, Deformed, Note, RefineOptions, deform},
    fields::{Pose, Profile, Tool, rotation_from_vector},
    flow::Move,
};

fn press(step: f64) -> Stroke {
    let tool = Tool::new(Arc::new(Sphere::new(0.4).unwrap()), 0.3, Profile::Quintic).unwrap();
    let keys = vec![Pose::at(DVec3::new(0.1, 0.05, 1.72)), Pose::at(DVec3::new(0.1, 0.05, 0.9))];
    Stroke::Move(Move::new(Arc::new(tool), keys, step).unwrap())
}

fn step_of(stroke: &Stroke) -> f64 {
    match stroke {
        Stroke::Move(motion) => motion.step(),
        other => panic!("{other:?} is not a move"),
    }
}

fn run(mesh: &TriMesh, stroke: Stroke, options: &DeformOptions) -> Deformed {
    deform(mesh, &[stroke], options, &NoProgress).unwrap()
}

#[test]
fn a_step_that_is_too_long_is_halved_with_a_note() {
    let sphere = primitives::icosphere(1.0, 4);
    let options = DeformOptions { refine: None, lock: false };
    let coarse = run(&sphere, press(1.0), &options);
    let step = step_of(&coarse.strokes[0]);
    assert!(step < 1.0, "{step}");
    assert!(matches!(coarse.receipt.notes[0], Note::StepHalved { stroke: 0, .. }), "{:?}", coarse.receipt.notes);
    assert!(coarse.receipt.strokes[0].jacobian.unwrap().deviation() <= JACOBIAN_TOLERANCE);
    // The result equals that of the halved step.
    let fine = run(&sphere, press(step), &options);
    assert_eq!(fine.receipt.notes, coarse.receipt.notes[1..]);
    assert_eq!(fine.mesh, coarse.mesh);
    // A fine step is not halved.
    assert_eq!(step_of(&run(&sphere, press(0.125), &options).strokes[0]), 0.125);
}

#[test]
fn a_jump_of_the_velocity_does_not_halve_the_step() {
    // A profile that acts inside a thin rod has a jump of the velocity on its axis, for any step.
    let tool = Tool::new(Arc::new(Capsule::new(0.02, 0.8).unwrap()), 0.3, Profile::Contact).unwrap();
    let at = DVec3::new(0.0, 0.9, 0.0);
    let turned = Pose { rotation: rotation_from_vector(DVec3::Y * FRAC_PI_2), translation: at };
    let stroke = Stroke::Move(Move::new(Arc::new(tool), vec![Pose::at(at), turned], 0.125).unwrap());
    let deformed = run(&primitives::icosphere(1.0, 4), stroke, &DeformOptions { refine: None, lock: false });
    assert!(step_of(&deformed.strokes[0]) > 0.125 / f64::from(1 << MAX_HALVINGS));
}

#[test]
fn refinement_reaches_the_volume_tolerance() {
    let sphere = primitives::icosphere(1.0, 4);
    for volume in [1e-3, 1e-4] {
        let refine = RefineOptions { volume: Some(volume), ..RefineOptions::default() };
        let receipt = run(&sphere, press(0.0625), &DeformOptions { refine: Some(refine), lock: false }).receipt;
        let change = receipt.volume_before_lock.unwrap() / receipt.volume_before.unwrap() - 1.0;
        assert!(change.abs() <= volume, "{volume}: {change:e}");
    }
}

/// On a sheet so thin that the lock of a coarse mesh would cross it.
#[test]
fn the_lock_adds_no_crossings() {
    let sphere = primitives::icosphere(1.0, 4);
    let rod = Tool::new(Arc::new(Capsule::new(0.15, 0.8).unwrap()), 0.25, Profile::Quintic).unwrap();
    let at = DVec3::new(0.0, 0.6, 0.0);
    let turned = Pose { rotation: rotation_from_vector(DVec3::Y * FRAC_PI_2), translation: at };
    let stroke = Stroke::Move(Move::new(Arc::new(rod), vec![Pose::at(at), turned], 0.05).unwrap());
    let refine = RefineOptions { volume: Some(3e-3), deviation: 1e-2, ..RefineOptions::default() };
    let on = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| run(&sphere, stroke.clone(), &DeformOptions { refine: Some(refine), lock: true }))
    };
    let deformed = on(1);
    let is_lock_crossing = |note: &Note| matches!(note, Note::LockCrossings { .. });
    let found = isochore_mesh::SelfIntersections::of(&deformed.mesh, &NoProgress).unwrap();
    assert!(
        found.triangles().is_empty() || deformed.receipt.notes.iter().any(is_lock_crossing),
        "{:?}",
        deformed.receipt
    );
    assert_eq!(deformed.mesh, on(2).mesh);
    assert_eq!(deformed.mesh, on(8).mesh);
}
