use isochore_sculpt::recipe::{Key, Stroke};

use super::*;

fn logged_keys(session: &Session) -> Vec<Key> {
    match &session.log().strokes[..] {
        [Stroke::Move(motion)] => motion.keys.clone(),
        strokes => panic!("{strokes:?}"),
    }
}

/// Keys over the north pole, with angles and axes that do not survive a conversion to a quaternion.
fn keys() -> Vec<Key> {
    let turns = [[0.0, 0.0, 1.0, 30.0], [0.0, 0.0, 2.0, 60.0], [1.0, 1.0, 1.0, 89.9], [0.0, 1.0, 0.0, -45.0]];
    let key = |(index, &rotate): (usize, &[f64; 4])| Key { at: [0.0, 0.1 * index as f64, 1.1], rotate };
    turns.iter().enumerate().map(key).collect()
}

fn move_along(session: &mut Session, keys: &[Key]) {
    session.begin_stroke(&rod(), refined(0.1)).unwrap();
    for (index, key) in keys.iter().enumerate() {
        session.move_to_key(key, index as f64).unwrap();
    }
    session.end_stroke().unwrap();
}

#[test]
fn the_log_records_keys_as_given() {
    let mut session = ball();
    move_along(&mut session, &keys());
    assert_eq!(logged_keys(&session), keys());
    assert!(session.log().to_toml().contains("30.0"));
}

#[test]
fn a_replay_of_poses_gives_the_same_bits() {
    let mut session = ball();
    // The negated quaternion is the same rotation, and one of any length has a direction.
    let mut poses = arc(0.0, 9);
    poses[3].rotation = -poses[3].rotation;
    poses[5].rotation *= 3.0;
    make(&mut session, &rod(), &refined(0.1), &poses);
    let mut again = ball();
    move_along(&mut again, &logged_keys(&session));
    assert_eq!(snapshot(&again), snapshot(&session));
    assert_eq!(logged_keys(&again), logged_keys(&session));
}

#[test]
fn rejects_a_key_without_an_axis() {
    let mut session = ball();
    session.begin_stroke(&rod(), UNREFINED).unwrap();
    let error = session.move_to_key(&Key { at: [0.0; 3], rotate: [0.0, 0.0, 0.0, 30.0] }, 0.0).unwrap_err();
    assert!(error.to_string().starts_with("rotate: "), "{error}");
    assert_eq!(session.end_stroke().unwrap().moves, 0);
}
