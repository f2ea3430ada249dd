use isochore_sculpt::session::{History, SessionOptions};

use super::*;

/// Poses of a shallow stroke at one of many places all around the unit sphere.
fn shallow(index: i32) -> Vec<Pose> {
    // The golden angle spreads the places evenly.
    let (turn, height) = (2.399_963_229_728_653 * f64::from(index), (f64::from(index) * 0.618_033_988_75).fract());
    let axis = DVec3::new(libm::cos(turn), libm::sin(turn), 2.0 * height - 1.0).normalize();
    let rotation = glam::DQuat::from_rotation_arc(DVec3::X, axis);
    let place =
        |pose: Pose| Pose { rotation: rotation * pose.rotation, translation: rotation * (1.05 * pose.translation) };
    arc(0.0, 6).into_iter().map(place).collect()
}

#[test]
fn undo_and_redo_of_many_strokes_restore_the_bits() {
    let mut session = ball();
    let mut states = vec![snapshot(&session)];
    for index in 0..20 {
        let tool = if index % 3 == 0 { rod() } else { brush() };
        make(&mut session, &tool, &refined(0.12), &shallow(index));
        // A stroke that was ended at its beginning leaves no trace.
        if session.history().undoable == states.len() {
            states.push(snapshot(&session));
        }
    }
    assert!(states.len() > 18, "{}", states.len());
    assert_sound(&session);
    assert!(session.vertex_count() > session.opened().positions.len() + 500);
    for state in states.iter().rev().skip(1) {
        assert!(session.undo().unwrap());
        assert_eq!(snapshot(&session), *state);
    }
    assert!(!session.undo().unwrap());
    for state in &states[1..] {
        assert!(session.redo().unwrap());
        assert_eq!(snapshot(&session), *state);
    }
    assert!(!session.redo().unwrap());
    // Later strokes do not depend on undone, redone or canceled ones.
    let mut other = ball();
    for index in 0..20 {
        let tool = if index % 3 == 0 { rod() } else { brush() };
        make(&mut other, &tool, &refined(0.12), &shallow(index));
    }
    session.begin_stroke(&brush(), refined(0.05)).unwrap();
    arc(2.0, 5).iter().for_each(|pose| assert!(session.move_to(pose, 0.0).is_ok()));
    session.cancel_stroke().unwrap();
    for session in [&mut session, &mut other] {
        make(session, &brush(), &refined(0.07), &arc(1.0, 6));
    }
    assert_eq!(snapshot(&session), snapshot(&other));
}

#[test]
fn a_canceled_stroke_leaves_no_trace() {
    let mut session = ball();
    make(&mut session, &brush(), &refined(0.1), &arc(0.0, 5));
    let before = snapshot(&session);
    session.begin_stroke(&rod(), refined(0.06)).unwrap();
    for pose in arc(0.2, 9) {
        session.move_to(&pose, 0.0).unwrap();
    }
    assert_ne!(snapshot(&session), before);
    session.cancel_stroke().unwrap();
    assert_eq!(snapshot(&session), before);
    assert_eq!(session.log().strokes.len(), 1);
}

#[test]
fn undo_forgets_the_oldest_strokes_and_the_log_keeps_them() {
    let mut session = ball();
    make(&mut session, &brush(), &UNREFINED, &arc(0.0, 5));
    let one = session.history().bytes;
    let mut session =
        Session::open(icosphere(1.0, 3), SessionOptions { undo_bytes: 3 * one + one / 2, ..SessionOptions::default() })
            .unwrap();
    let mut forgotten = 0;
    for index in 0..8 {
        session.begin_stroke(&brush(), UNREFINED).unwrap();
        arc(0.01 * f64::from(index), 5).iter().for_each(|pose| assert!(session.move_to(pose, 0.0).is_ok()));
        forgotten += session.end_stroke().unwrap().forgotten_strokes;
    }
    let history = session.history();
    assert_eq!((history.forgotten, history.undoable + history.forgotten), (forgotten, 8));
    assert!(history.bytes <= 3 * one + one / 2 && history.undoable >= 2, "{history:?}");
    while session.undo().unwrap() {}
    assert_eq!(session.log().strokes.len(), forgotten);
    assert_eq!(session.history().redoable, history.undoable);
    // A new stroke replaces the undone ones.
    make(&mut session, &brush(), &UNREFINED, &arc(1.0, 3));
    assert_eq!(session.history().redoable, 0);
}

#[test]
fn memory_of_a_stroke_is_proportional_to_the_touched_vertices() {
    let bytes = |subdivisions| {
        let mut session = open(icosphere(1.0, subdivisions));
        session.begin_stroke(&brush(), UNREFINED).unwrap();
        arc(0.0, 5).iter().for_each(|pose| assert!(session.move_to(pose, 0.0).is_ok()));
        let receipt = session.end_stroke().unwrap();
        receipt.undo_bytes as f64 / receipt.touched_vertices as f64
    };
    // Position and offset, the f32 copy and the normal, each with a number, and a rim of normals
    // that is thinner on finer meshes.
    let [coarse, fine] = [3, 5].map(bytes);
    assert!(fine < 104.0 + 16.0 && fine < coarse, "{coarse} {fine}");
}

#[test]
fn memory_of_a_refined_stroke_is_proportional_also_after_undo() {
    for subdivisions in [3, 4] {
        let mut session = open(icosphere(1.0, subdivisions));
        session.begin_stroke(&brush(), refined(0.03)).unwrap();
        arc(0.0, 5).iter().for_each(|pose| assert!(session.move_to(pose, 0.0).is_ok()));
        let receipt = session.end_stroke().unwrap();
        assert!(receipt.inserted_vertices > 500, "{receipt:?}");
        assert!(session.undo().unwrap());
        let bytes = session.history().bytes;
        // For an inserted vertex, 128 bytes with its render vertex, and 88 for its two triangles.
        // For an existing vertex, 104 and 20 as above, and six cut triangles at 56. The rim adds at
        // most a twentieth.
        let expected = 216 * (receipt.inserted_vertices - receipt.removed_vertices) + 460 * receipt.touched_vertices;
        let most = 216 * receipt.inserted_vertices + 460 * receipt.touched_vertices;
        assert!(bytes as f64 <= 1.05 * most as f64, "{bytes} {expected}");
        assert!(bytes as f64 >= 0.5 * expected as f64, "{bytes} {expected}");
    }
}

#[test]
fn undo_stays_within_its_memory() {
    let stroke = |session: &mut Session, index: i32| {
        make(session, &brush(), &refined(0.05), &arc(0.4 * f64::from(index), 6));
        session.history().bytes
    };
    let most = 3 * stroke(&mut ball(), 0);
    let options = SessionOptions { undo_bytes: most, ..SessionOptions::default() };
    let mut session = Session::open(icosphere(1.0, 3), options).unwrap();
    (0..8).for_each(|index| assert!(stroke(&mut session, index) <= most));
    let History { undoable, forgotten, bytes, .. } = session.history();
    assert!(undoable >= 2 && forgotten >= 1, "{:?}", session.history());
    // The number includes from the start what undo will need to store for redo.
    let before = snapshot(&session);
    for step in [Session::undo, Session::redo, Session::undo] {
        while step(&mut session).unwrap() {
            assert_eq!(session.history().bytes, bytes);
        }
    }
    while session.redo().unwrap() {}
    assert_eq!(snapshot(&session), before);
}
