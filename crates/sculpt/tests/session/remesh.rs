use isochore_mesh::{SelfIntersections, next_half_edge};
use isochore_sculpt::{
    recipe::{Mask, Pin},
    session::{RemeshOptions, SessionError},
};

use super::*;

fn remeshed(session: &mut Session) -> isochore_sculpt::session::RemeshReceipt {
    session.remesh(&RemeshOptions::default(), &NoProgress).unwrap()
}

fn crossings(session: &Session) -> usize {
    SelfIntersections::of(&session.export(true).mesh, &NoProgress).unwrap().triangles().len()
}

#[test]
fn undo_and_redo_of_a_remesh_restore_all_bits() {
    let mut session = open(super::attributes::painted_ball());
    make(&mut session, &brush(), &refined(0.05), &arc(0.0, 7));
    let before = snapshot(&session);
    let receipt = remeshed(&mut session);
    assert!(receipt.triangles_after != receipt.triangles_before && receipt.undo_bytes > 0);
    assert_eq!(receipt.triangles_after, session.triangle_count());
    let after = snapshot(&session);
    assert_sound(&session);
    assert!(session.undo().unwrap());
    assert_eq!(snapshot(&session), before);
    assert!(session.redo().unwrap());
    assert_eq!(snapshot(&session), after);
}

#[test]
fn a_remesh_coarsens_what_strokes_have_refined() {
    let mut session = open(icosphere(1.0, 4));
    for round in 0..6 {
        make(&mut session, &brush(), &refined(0.03), &arc(0.3 * f64::from(round), 6));
    }
    let crossing = crossings(&session);
    let shown = session.export(true).mesh.volume();
    let receipt = remeshed(&mut session);
    assert!(2 * receipt.triangles_after < receipt.triangles_before, "{receipt:?}");
    assert!(crossings(&session) <= crossing);
    // The locks of the strokes are part of the surface now.
    assert!(session.offsets().iter().all(|&offset| offset == DVec3::ZERO));
    let now = session.export(true).mesh.volume();
    assert!((now - shown).abs() < 1e-12 && (now - session.opened().volume()).abs() < 1e-12, "{now} {shown}");
    assert!((session.volume().unwrap() - now).abs() < 1e-12);
}

#[test]
fn strokes_continue_after_a_remesh() {
    let mut session = open(super::attributes::painted_ball());
    for round in 0..4 {
        make(&mut session, &brush(), &refined(0.08), &arc(0.5 * f64::from(round), 6));
        remeshed(&mut session);
        assert_sound(&session);
        let exported = session.export(true).mesh;
        assert!((exported.volume() - session.opened().volume()).abs() < 1e-12);
        exported.check_valid().unwrap();
        // Seams stay closed: render vertices at both ends of an edge belong to the same vertices.
        let buffers = session.buffers();
        for half_edge in 0..3 * buffers.indices.len() as u32 {
            if let Some(vertices) = session.triangle(half_edge / 3) {
                let corner = |edge: u32| buffers.indices[edge as usize / 3][edge as usize % 3];
                assert_eq!(session.vertex_of(corner(half_edge)), vertices[half_edge as usize % 3]);
                assert!(session.origin_of(corner(next_half_edge(half_edge))).is_some());
            }
        }
    }
    // A remesh is not a stroke.
    assert_eq!(session.log().strokes.len(), 4);
}

#[test]
fn the_mask_and_frozen_vertices_stay() {
    let pin = Pin { center: [0.0, 0.0, 1.0], radius: 0.3, support: 0.1 };
    let options = SessionOptions { mask: Mask { pins: vec![pin], ..Mask::default() }, ..SessionOptions::default() };
    let mut session = Session::open(icosphere(1.0, 4), options).unwrap();
    let opened = session.positions().to_vec();
    session.freeze_edges(&[7, 100]).unwrap();
    let neighbors = |session: &Session, vertex: u32| {
        let mut found: Vec<u32> = (0..session.buffers().indices.len() as u32)
            .filter_map(|triangle| session.triangle(triangle))
            .filter(|vertices| vertices.contains(&vertex))
            .flatten()
            .collect();
        found.sort_unstable();
        found
    };
    let frozen = [7, 100].map(|vertex| neighbors(&session, vertex));
    let coarse = RemeshOptions { edge_length: Some(0.3), deviation: Some(0.02), ..RemeshOptions::default() };
    session.remesh(&coarse, &NoProgress).unwrap();
    for (vertex, &position) in (0..).zip(&opened) {
        if position.distance(DVec3::Z) < 0.3 {
            assert!(session.is_alive(vertex) && session.positions()[vertex as usize] == position, "{vertex}");
        }
    }
    assert_eq!(frozen, [7, 100].map(|vertex| neighbors(&session, vertex)));
}

#[test]
fn no_remesh_during_a_stroke() {
    let mut session = ball();
    session.begin_stroke(&brush(), StrokeOptions::default()).unwrap();
    let error = session.remesh(&RemeshOptions::default(), &NoProgress).unwrap_err();
    assert!(matches!(error, SessionError::StrokeUnderWay));
}

#[test]
fn a_cancelled_remesh_changes_nothing() {
    struct Stop(std::sync::atomic::AtomicUsize);
    impl isochore_mesh::Monitor for Stop {
        fn is_cancelled(&self) -> bool {
            let order = std::sync::atomic::Ordering::SeqCst;
            self.0.fetch_update(order, order, |calls| calls.checked_sub(1)).is_err()
        }
    }
    let mut session = open(super::attributes::painted_ball());
    make(&mut session, &brush(), &refined(0.05), &arc(0.0, 7));
    let before = snapshot(&session);
    for calls in [0, 2, 10] {
        let error = session.remesh(&RemeshOptions::default(), &Stop(calls.into())).unwrap_err();
        assert!(matches!(error, SessionError::Cancelled(_)));
        assert_eq!(snapshot(&session), before);
    }
    assert_eq!(session.history().undoable, 1);
    assert!(session.undo().unwrap());
}
