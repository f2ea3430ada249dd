use isochore_sculpt::session::SessionOptions;

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
        assert!((locked.mesh.volume() - opened).abs() < 1e-13 * opened, "{}", locked.mesh.volume() - opened);
        assert!((bare.mesh.volume() - opened).abs() > 1e-9 * opened);
        let shift = receipt.lock_max_shift.unwrap();
        // Edges of 0.1 at most, some times coarser than the field asks for.
        assert!(shift > 0.0 && shift < 0.1, "{shift}");
        assert!(locked.lock.unwrap().max_shift > 0.0 && bare.lock.is_none());
        for (vertex, (flow, shown)) in
            locked.vertices.iter().zip(bare.mesh.positions.iter().zip(&locked.mesh.positions))
        {
            assert_eq!(session.positions()[*vertex as usize], *flow);
            assert_eq!(*flow + session.offsets()[*vertex as usize], *shown);
        }
    }
    // Undo takes the lock back with the stroke.
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
    // What strokes work on is the same.
    assert_eq!(unlocked.positions(), locked.positions());
    assert_eq!(unlocked.export(true).mesh.positions, locked.export(false).mesh.positions);
}
