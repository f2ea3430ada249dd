use super::*;

/// Only splits, to edges of a third of the brush's support.
fn refining() -> StrokeOptions {
    let refine = InteractiveRefinement { longest: Some(0.08), collapse: 0.0, ..InteractiveRefinement::default() };
    StrokeOptions { refine: Some(refine) }
}

/// Only collapses, all edges that the stroke squeezes to half.
fn coarsening() -> StrokeOptions {
    let refine = InteractiveRefinement {
        longest: Some(1.0),
        deviation: Some(1.0),
        collapse: 0.3,
        ..InteractiveRefinement::default()
    };
    StrokeOptions { refine: Some(refine) }
}

/// Numbers of elements in use and of slots, for render vertices and triangles.
fn lengths(session: &Session) -> [[usize; 2]; 2] {
    let (render, triangles) = (session.buffers().positions.len(), session.buffers().indices.len());
    let shown = (0..render as u32).filter(|&render| session.vertex_of(render) != u32::MAX).count();
    [[shown, render], [session.triangle_count(), triangles]]
}

/// Poses that pull the brush out of the ball along a direction, or push it back.
fn pull(direction: DVec3, is_back: bool) -> Vec<Pose> {
    let pose = |index: usize| {
        let step = if is_back { 8 - index } else { index };
        Pose::at(direction * (1.0 + 0.05 * step as f64))
    };
    (0..=8).map(pose).collect()
}

#[test]
fn buffers_do_not_grow_with_the_history() {
    for mesh in [icosphere(1.0, 3), super::attributes::painted_ball()] {
        let mut session = open(mesh);
        let opened = session.opened().positions.len();
        let [mut most_shown, mut most_triangles] = [0; 2];
        let mut inserted = 0;
        let mut snapshots = vec![snapshot(&session)];
        for round in 0..30 {
            let (is_back, direction) = (round % 2 == 1, [DVec3::X, DVec3::Y, DVec3::NEG_Z][round / 2 % 3]);
            let before = session.vertices().count();
            let options = if is_back { coarsening() } else { refining() };
            make(&mut session, &brush(), &options, &pull(direction, is_back));
            let now = session.vertices().count();
            assert_eq!(now > before, !is_back);
            inserted += now.saturating_sub(before);

            // A stroke reuses all free slots before it adds new ones, except those of vertices of
            // the mesh as opened.
            let [[shown, render], [triangles, slots]] = lengths(&session);
            let gone = opened - session.vertices().filter(|&vertex| (vertex as usize) < opened).count();
            (most_shown, most_triangles) = (most_shown.max(shown + gone), most_triangles.max(triangles));
            assert!(render <= most_shown && slots <= most_triangles);
            snapshots.push(snapshot(&session));
        }
        assert_sound(&session);
        // Far more insertions than slots.
        let slots = session.vertex_count() - opened;
        assert!(inserted > 3 * slots && slots > 300, "{inserted} {slots}");
        for expected in snapshots.iter().rev().skip(1) {
            assert!(session.undo().unwrap());
            assert_eq!(snapshot(&session), *expected);
        }
        for expected in &snapshots[1..] {
            assert!(session.redo().unwrap());
            assert_eq!(snapshot(&session), *expected);
        }
    }
}

#[test]
fn reuse_of_slots_does_not_depend_on_undone_strokes() {
    let strokes = |session: &mut Session, is_hesitant: bool| {
        for round in 0..8 {
            let (is_back, direction) = (round % 2 == 1, [DVec3::X, DVec3::Z][round / 2 % 2]);
            let options = if is_back { coarsening() } else { refining() };
            if is_hesitant {
                make(session, &rod(), &refining(), &pull(DVec3::Y, is_back));
                make(session, &brush(), &coarsening(), &pull(direction, !is_back));
                assert!(session.undo().unwrap() && session.undo().unwrap());
                session.begin_stroke(&brush(), refining()).unwrap();
                pull(direction, false).iter().for_each(|pose| assert!(session.move_to(pose, 0.0).is_ok()));
                session.cancel_stroke().unwrap();
            }
            make(session, &brush(), &options, &pull(direction, is_back));
        }
    };
    let (mut straight, mut hesitant) = (ball(), ball());
    strokes(&mut straight, false);
    strokes(&mut hesitant, true);
    assert!(straight.vertex_count() > straight.vertices().count());
    assert_eq!(snapshot(&straight), snapshot(&hesitant));
}

#[test]
fn vertex_map_returns_the_replacement_of_removed_vertices() {
    let (mut session, mut unrefined) = (ball(), ball());
    let opened: Vec<u32> = (0..session.vertex_count() as u32).collect();
    assert_eq!(session.vertex_map(), opened);
    let mut maps = vec![opened.clone()];
    for round in 0..24 {
        let (is_back, direction) = (round % 2 == 1, [DVec3::X, DVec3::Y, DVec3::NEG_Z][round / 2 % 3]);
        let options = if is_back { coarsening() } else { refining() };
        make(&mut session, &brush(), &options, &pull(direction, is_back));
        make(&mut unrefined, &brush(), &UNREFINED, &pull(direction, is_back));
        let map = session.vertex_map();
        for (&vertex, &kept) in opened.iter().zip(&map) {
            assert!(session.is_alive(kept));
            assert_eq!(session.is_alive(vertex), kept == vertex);
        }
        // Edits do not influence the motion of the vertices of the mesh as opened.
        let distance = |vertex: u32| {
            unrefined.positions()[vertex as usize].distance(session.positions()[map[vertex as usize] as usize])
        };
        let farthest = opened.iter().map(|&vertex| distance(vertex)).fold(0.0, f64::max);
        // No collapse spans more than 0.3, and the brush leaves nothing stretched after its return.
        assert!(!is_back || farthest < 0.3, "{farthest}");
        maps.push(map);
    }
    let replaced = session.vertex_map().iter().zip(&opened).filter(|(kept, vertex)| kept != vertex).count();
    assert!(replaced > 5, "{replaced}");
    for expected in maps.iter().rev().skip(1) {
        assert!(session.undo().unwrap());
        assert_eq!(session.vertex_map(), *expected);
    }
    for expected in &maps[1..] {
        assert!(session.redo().unwrap());
        assert_eq!(session.vertex_map(), *expected);
    }
}
