use isochore_field::{Move, MoveError, Stroke, StrokeError, advect_points};
use isochore_mesh::{NoProgress, TriMesh, primitives::icosphere};
use isochore_sculpt::{
    Meshes, Recipe,
    recipe::{Format, Mask, MirrorPlane, Pin},
    replay_points,
    session::{SessionError, SessionOptions, SessionReplayError, Supplies},
};

use super::*;

fn meshes(mesh: TriMesh) -> Meshes {
    Meshes::from([("target".to_owned(), mesh.into())])
}

#[test]
fn vertices_move_with_the_flow_of_the_logged_move() {
    for options in [UNREFINED, refined(0.08)] {
        let mut session = ball();
        let rest = session.positions().to_vec();
        make(&mut session, &brush(), &options, &arc(0.0, 20));
        // The poses of the log.
        let log = session.log();
        let isochore_sculpt::recipe::Stroke::Move(motion) = &log.strokes[0] else { panic!("a move") };
        let keys = motion.keys.iter().map(|key| {
            let [x, y, z, degrees] = key.rotate;
            let half = 0.5 * degrees.to_radians();
            let axis = DVec3::new(x, y, z).normalize_or_zero() * libm::sin(half);
            Pose { rotation: DQuat::from_xyzw(axis.x, axis.y, axis.z, libm::cos(half)), translation: key.at.into() }
        });
        let stroke = Stroke::Move(Move::new(Arc::clone(brush().tool()), keys.collect(), 0.125).unwrap());
        let advected = advect_points(&rest, &[stroke], &NoProgress).unwrap();
        assert_eq!(&session.positions()[..rest.len()], &advected[..]);
        assert!(advected.iter().zip(&rest).filter(|(a, b)| a != b).count() > 30);
    }
}

#[test]
fn replays_of_the_log_give_the_same_bits() {
    let pin = Pin { center: [0.8, 0.6, 0.0], radius: 0.1, support: 0.2 };
    let mirror = MirrorPlane { point: [0.0; 3], normal: [0.0, 0.0, 1.0] };
    for mask in [
        Mask::default(),
        Mask { pins: vec![pin.clone()], ..Mask::default() },
        Mask { pins: vec![pin], mirror: vec![mirror], ..Mask::default() },
    ] {
        let mesh = icosphere(1.0, 3);
        let mut session = Session::open(mesh.clone(), SessionOptions { mask, ..SessionOptions::default() }).unwrap();
        for (index, tool) in [brush(), rod(), brush()].iter().enumerate() {
            let options = if index == 1 { refined(0.1) } else { UNREFINED };
            make(&mut session, tool, &options, &arc(0.4 * index as f64, 8));
        }
        let log = session.log();
        assert_eq!((log.strokes.len(), log.tools.len()), (3, 2));
        let read = Recipe::parse(&log.to_toml(), Format::Toml, &[]).unwrap();
        assert_eq!(read, log);

        // On points, also on those of a finer mesh, whose first vertices are the same.
        let points = replay_points(&log, &meshes(mesh.clone()), &mesh.positions, &NoProgress).unwrap().points;
        assert_eq!(&session.positions()[..points.len()], &points[..]);
        let finer = icosphere(1.0, 4).positions;
        let points = replay_points(&log, &meshes(mesh.clone()), &finer, &NoProgress).unwrap().points;
        assert_eq!(finer[..mesh.positions.len()], mesh.positions[..]);
        assert_eq!(&session.positions()[..mesh.positions.len()], &points[..mesh.positions.len()]);

        // On the mesh itself, with and without the lock.
        let mut plain = log.clone();
        plain.refine.enabled = false;
        assert!(plain.volume.lock);
        let kept = isochore_sculpt::replay(&plain, &meshes(mesh.clone()), &NoProgress).unwrap().deformed;
        assert!(kept.receipt.lock_max_shift.is_some());
        // Rounding of a sum over some thousand triangles.
        assert!((kept.mesh.volume() / mesh.volume() - 1.0).abs() < 1e-13);
        plain.volume.lock = false;
        let replayed = isochore_sculpt::replay(&plain, &meshes(mesh.clone()), &NoProgress).unwrap();
        let count = mesh.positions.len();
        assert_eq!(replayed.deformed.receipt.lock_max_shift, None);
        assert_eq!(&session.positions()[..count], &replayed.deformed.mesh.positions[..count]);

        // In another session.
        let mut again = Session::open(mesh, session_options(&log)).unwrap();
        let receipts = again.replay(&log, &Supplies::default(), &UNREFINED, &NoProgress).unwrap();
        assert_eq!(receipts.len(), 3);
        assert_eq!(&again.positions()[..count], &session.positions()[..count]);
        assert_eq!(again.log(), log);
    }
}

#[test]
fn the_log_enables_the_lock_only_if_the_session_had_one() {
    let mut opened = icosphere(1.0, 3);
    opened.triangles.pop();
    let unlocked = SessionOptions { lock: false, ..SessionOptions::default() };
    for (mesh, options, expected) in [
        (icosphere(1.0, 3), SessionOptions::default(), true),
        (icosphere(1.0, 3), unlocked, false),
        (opened, SessionOptions::default(), false),
    ] {
        let mut session = Session::open(mesh, options).unwrap();
        make(&mut session, &brush(), &UNREFINED, &arc(0.0, 5));
        assert_eq!(session.log().volume.lock, expected);
    }
}

fn session_options(log: &Recipe) -> SessionOptions {
    SessionOptions { mask: log.mask.clone(), ..SessionOptions::default() }
}

#[test]
fn different_tools_of_the_same_name_get_different_entries() {
    let mut session = ball();
    let other = SessionTool::new("brush", rod().description().clone(), &Meshes::new(), &NoProgress).unwrap();
    make(&mut session, &brush(), &UNREFINED, &arc(0.0, 3));
    make(&mut session, &Arc::new(other), &UNREFINED, &arc(0.0, 3));
    make(&mut session, &brush(), &UNREFINED, &arc(0.0, 3));
    let log = session.log();
    assert_eq!(log.tools.keys().collect::<Vec<_>>(), ["brush", "brush 2"]);
    log.validate().unwrap();
}

#[test]
fn a_session_replays_only_moves() {
    let text = "recipe = 1\n[target]\nmesh = 'm'\n[[stroke]]\nkind = 'twist'\norigin = [0,0,0]\naxis = [0,0,1]\ndegrees_per_unit = 3\n";
    let recipe = Recipe::parse(text, Format::Toml, &[]).unwrap();
    let error = ball().replay(&recipe, &Supplies::default(), &UNREFINED, &NoProgress).unwrap_err();
    assert!(matches!(error, SessionReplayError::Kind { index: 0, kind: "twist" }), "{error}");
}

#[test]
fn rejected_calls_change_nothing() {
    let mut session = ball();
    let pose = Pose::at(DVec3::X);
    assert_eq!(session.move_to(&pose, 0.0).unwrap_err(), SessionError::NoStroke);
    assert_eq!(session.end_stroke().unwrap_err(), SessionError::NoStroke);
    assert_eq!(session.cancel_stroke().unwrap_err(), SessionError::NoStroke);
    session.begin_stroke(&brush(), UNREFINED).unwrap();
    assert_eq!(session.begin_stroke(&brush(), UNREFINED).unwrap_err(), SessionError::StrokeUnderWay);
    assert_eq!(session.undo().unwrap_err(), SessionError::StrokeUnderWay);
    assert_eq!(session.redo().unwrap_err(), SessionError::StrokeUnderWay);
    session.move_to(&pose, 1.0).unwrap();
    let before = snapshot(&session);
    assert_eq!(session.move_to(&pose, 0.5).unwrap_err(), SessionError::Time { time: 0.5, last: 1.0 });
    assert!(matches!(session.move_to(&pose, f64::NAN), Err(SessionError::Time { .. })));
    let nowhere = Pose::at(DVec3::NAN);
    assert!(matches!(
        session.move_to(&nowhere, 2.0),
        Err(SessionError::Stroke(StrokeError::Move(MoveError::NotFinite)))
    ));
    let turned = Pose { rotation: DQuat::from_xyzw(1.0, 0.0, 0.0, 0.0), ..pose };
    assert!(matches!(
        session.move_to(&turned, 2.0),
        Err(SessionError::Stroke(StrokeError::Move(MoveError::HalfTurn { .. })))
    ));
    let far = Pose::at(DVec3::X * 1e9);
    assert!(matches!(
        session.move_to(&far, 2.0),
        Err(SessionError::Stroke(StrokeError::Move(MoveError::TooManySteps { .. })))
    ));
    assert_eq!(snapshot(&session), before);
    // A stroke needs two poses.
    assert_eq!(session.end_stroke().unwrap().moves, 0);
    assert_eq!((session.history().undoable, session.log().strokes.len()), (0, 0));
}
