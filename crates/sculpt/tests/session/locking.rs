use isochore_sculpt::session::{LockSkipped, SessionOptions, StrokeReceipt};

use super::*;

#[test]
fn the_host_sees_the_volume_of_the_mesh_as_opened() {
    let mut session = ball();
    let opened = session.opened().volume();
    let mut volumes = Vec::new();
    for index in 0..8 {
        session.begin_stroke(&brush(), refined(0.1)).unwrap();
        arc(0.5 * f64::from(index), 9).iter().for_each(|pose| assert!(session.move_to(pose, 0.0).is_ok()));
        let receipt = session.end_stroke().unwrap();
        let (bare, locked) = (session.export(false), session.export(true));
        volumes.push(bare.mesh.volume());
        // Rounding of a sum over some thousand triangles.
        assert!((locked.mesh.volume() - opened).abs() < 1e-13 * opened, "{receipt:?}");
        assert!((bare.mesh.volume() - opened).abs() > 1e-9 * opened);
        let shift = receipt.lock_max_shift.unwrap_or_else(|| panic!("{receipt:?}"));
        assert_eq!(receipt.lock_skipped, None);
        // Edges of at most 0.1, several times coarser than the field needs.
        assert!(shift > 0.0 && shift < 0.1, "{shift}");
        assert!(locked.lock.unwrap().max_shift > 0.0 && bare.lock.is_none());
        for (vertex, (flow, shown)) in
            locked.vertices.iter().zip(bare.mesh.positions.iter().zip(&locked.mesh.positions))
        {
            assert_eq!(session.positions()[*vertex as usize], *flow);
            assert_eq!(*flow + session.offsets()[*vertex as usize], *shown);
        }
    }
    // Undo also undoes the lock.
    while session.undo().unwrap() {
        volumes.pop();
        let before = volumes.last().copied().unwrap_or(opened);
        assert_eq!(session.export(false).mesh.volume(), before);
        assert!((session.export(true).mesh.volume() - opened).abs() < 1e-13 * opened);
    }
    assert!(session.offsets()[..session.opened().positions.len()].iter().all(|&offset| offset == DVec3::ZERO));
}

#[test]
fn a_session_without_a_lock_shows_the_flow() {
    let options = SessionOptions { lock: false, ..SessionOptions::default() };
    let mut unlocked = Session::open(icosphere(1.0, 3), options).unwrap();
    let mut locked = ball();
    for session in [&mut unlocked, &mut locked] {
        for index in 0..3 {
            make(session, &brush(), &refined(0.1), &arc(0.3 * f64::from(index), 6));
        }
    }
    assert!(unlocked.offsets().iter().all(|&offset| offset == DVec3::ZERO));
    assert!(locked.offsets().iter().any(|&offset| offset != DVec3::ZERO));
    // Strokes start from the same positions.
    assert_eq!(unlocked.positions(), locked.positions());
    assert_eq!(unlocked.export(true).mesh.positions, locked.export(false).mesh.positions);
}

#[test]
fn a_skipped_lock_reports_its_reason() {
    let end = |session: &mut Session, poses: &[Pose]| -> StrokeReceipt {
        session.begin_stroke(&brush(), UNREFINED).unwrap();
        poses.iter().for_each(|pose| assert!(session.move_to(pose, 0.0).is_ok()));
        let receipt = session.end_stroke().unwrap();
        assert_eq!(receipt.lock_skipped.is_some(), receipt.lock_max_shift.is_none());
        receipt
    };
    let poses = arc(0.0, 6);
    let skipped = |session: &mut Session, poses: &[Pose]| end(session, poses).lock_skipped;
    let unlocked = SessionOptions { lock: false, ..SessionOptions::default() };
    assert_eq!(skipped(&mut Session::open(icosphere(1.0, 3), unlocked).unwrap(), &poses), Some(LockSkipped::Off));
    assert_eq!(skipped(&mut ball(), &poses), None);
    assert_eq!(skipped(&mut ball(), &poses[..1]), Some(LockSkipped::NoHold));
    let far = [0.0, 1.0].map(|x| Pose::at(DVec3::new(x, 9.0, 0.0)));
    assert_eq!(skipped(&mut ball(), &far), Some(LockSkipped::NoHold));
    let mut opened = icosphere(1.0, 3);
    opened.triangles.pop();
    assert_eq!(skipped(&mut open(opened), &poses), Some(LockSkipped::NeedsClosed));

    // Only one vertex moves, and it has no triangles.
    let mut loose = icosphere(1.0, 3);
    loose.positions.push(DVec3::new(5.0, 0.0, 0.0));
    let mut session = open(loose);
    let around = [0.0, 0.1].map(|z| Pose::at(DVec3::new(5.0, 0.0, z)));
    assert_eq!(skipped(&mut session, &around), Some(LockSkipped::NoHold));
    assert_ne!(session.positions()[642], DVec3::new(5.0, 0.0, 0.0));
    for reason in [LockSkipped::Off, LockSkipped::NeedsClosed, LockSkipped::NoHold] {
        assert!(reason.to_string().starts_with("the lock was skipped: "));
    }
}
