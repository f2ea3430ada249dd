use isochore_mesh::{TriMesh, primitives::box_mesh};
use isochore_sculpt::{
    recipe::{Mask, VertexWeights},
    session::{OpenError, SessionError, StrokeReceipt},
};

use super::*;

fn stroke(session: &mut Session, tool: &Arc<SessionTool>, options: StrokeOptions, poses: &[Pose]) -> StrokeReceipt {
    session.begin_stroke(tool, options).unwrap();
    for (index, pose) in poses.iter().enumerate() {
        session.move_to(pose, index as f64).unwrap();
    }
    session.end_stroke().unwrap()
}

/// Poses straight down onto the top of a box of half-extent one.
fn press(depth: f64) -> Vec<Pose> {
    (0..=20).map(|index| Pose::at(DVec3::new(0.2, 0.1, 1.3 - depth * f64::from(index) / 20.0))).collect()
}

#[test]
fn a_brush_shapes_a_coarse_box() {
    let mut session = open(box_mesh(DVec3::ONE, [1, 1, 1]));
    let receipt = stroke(&mut session, &brush(), StrokeOptions::default(), &press(0.3));
    assert_sound(&session);
    assert!(receipt.inserted_vertices > 100 && receipt.touched_vertices == 0, "{receipt:?}");
    // The lowest point follows the tool down, but not completely, because the field fades.
    let lowest = session.positions().iter().filter(|p| p.z > 0.0).map(|p| p.z).fold(f64::INFINITY, f64::min);
    assert!(lowest < 0.9, "{lowest}");
    // The other side is nearly as coarse as before: only triangles that extend up to the tool are
    // halved.
    let far = |p: &&DVec3| p.z < 0.0;
    let count = session.positions().iter().filter(far).count();
    assert!(count < 20, "{count}");
}

#[test]
fn receipts_report_the_change_of_the_volume() {
    let mut session = ball();
    let mut tools = [brush(), rod()].into_iter().cycle();
    for round in 0..10 {
        let tool = tools.next().unwrap();
        let before = session.export(false).mesh.volume();
        let receipt = stroke(&mut session, &tool, refined(0.1), &arc(0.9 * f64::from(round), 12));
        let volume = receipt.volume.unwrap();
        let after = session.export(false).mesh.volume();
        // Sums over the whole mesh round by some units of the last place of the volume.
        let tolerance = volume.rounding + 1e-14 * before;
        assert!((volume.total() - (after - before)).abs() < tolerance, "{volume:?} {}", after - before);
        assert!(volume.rounding < 1e-9 * before, "{volume:?}");
        assert!((session.volume().unwrap() - after).abs() < 1e-12 * before);
        assert!(volume.splits != 0.0 || receipt.is_limited);
    }
}

#[test]
fn finer_limits_change_less_volume() {
    let bare = |longest: f64| {
        let mut session = ball();
        let options =
            InteractiveRefinement { longest: Some(longest), deviation: Some(1.0), ..InteractiveRefinement::default() };
        let receipt = stroke(&mut session, &brush(), StrokeOptions { refine: Some(options) }, &press(0.35));
        receipt.volume.unwrap().bare().abs()
    };
    // The facet error is of second order in the edge length, so three halvings must remove most of
    // it.
    let [coarse, fine] = [0.16, 0.02].map(bare);
    assert!(fine < coarse / 10.0, "{coarse:e} {fine:e}");
}

#[test]
fn remeshing_is_zero_without_edits() {
    let mut session = ball();
    let volume = stroke(&mut session, &brush(), UNREFINED, &arc(0.0, 9)).volume.unwrap();
    assert_eq!((volume.splits, volume.remeshing), (0.0, 0.0));
    assert_ne!(volume.flow, 0.0);
}

#[test]
fn squeezed_edges_collapse_and_bad_triangles_flip() {
    let mut session = ball();
    let back_and_forth: Vec<Pose> =
        [press(0.5), press(0.5).into_iter().rev().collect()].concat().into_iter().cycle().take(160).collect();
    let options = InteractiveRefinement { longest: Some(0.06), collapse: 0.4, ..InteractiveRefinement::default() };
    let receipt = stroke(&mut session, &brush(), StrokeOptions { refine: Some(options) }, &back_and_forth);
    assert!(receipt.removed_vertices > 0 && receipt.flipped_edges > 0, "{receipt:?}");
    assert_ne!(receipt.volume.unwrap().remeshing, 0.0);
    assert_sound(&session);
    let alive = (0..session.vertex_count() as u32).filter(|&vertex| session.is_alive(vertex)).count();
    assert_eq!(alive, session.opened().positions.len() + receipt.inserted_vertices - receipt.removed_vertices);
}

#[test]
fn the_limit_on_triangles_holds() {
    let mut session = ball();
    let most = session.triangle_count() + 50;
    let options =
        InteractiveRefinement { longest: Some(0.02), max_triangles: most, ..InteractiveRefinement::default() };
    let receipt = stroke(&mut session, &brush(), StrokeOptions { refine: Some(options) }, &press(0.3));
    assert!(receipt.is_limited && session.triangle_count() <= most);
    assert_sound(&session);
}

#[test]
fn does_not_edit_kept_or_frozen_edges() {
    let keep = (DVec3::Z, 10.0);
    let mut session = ball();
    let options = InteractiveRefinement { longest: Some(0.05), keep: vec![keep], ..InteractiveRefinement::default() };
    let receipt = stroke(&mut session, &brush(), StrokeOptions { refine: Some(options) }, &press(0.3));
    assert_eq!((receipt.inserted_vertices, receipt.removed_vertices, receipt.flipped_edges), (0, 0, 0));

    let mut session = ball();
    let north: Vec<u32> =
        (0..session.vertex_count() as u32).filter(|&v| session.positions()[v as usize].z > 0.0).collect();
    session.freeze_edges(&north).unwrap();
    let at = |session: &Session, triangle: u32| session.triangle(triangle);
    let before: Vec<_> = (0..session.triangle_count() as u32).map(|triangle| at(&session, triangle)).collect();
    make(&mut session, &brush(), &refined(0.05), &press(0.3));
    make(&mut session, &brush(), &refined(0.05), &arc(0.0, 9));
    let mut stayed = 0;
    for (triangle, before) in before.iter().enumerate() {
        if before.unwrap().iter().all(|vertex| north.contains(vertex)) {
            assert_eq!(at(&session, triangle as u32), *before);
            stayed += 1;
        }
    }
    assert!(stayed > 100 && session.vertex_count() > session.opened().positions.len());
    assert_sound(&session);
}

#[test]
fn freezes_inserted_vertices_until_they_are_removed() {
    let count = ball().vertex_count() as u32;
    let edits = |session: &mut Session, longest: f64| {
        let receipt = stroke(session, &rod(), refined(longest), &press(0.3));
        [receipt.inserted_vertices, receipt.removed_vertices, receipt.flipped_edges]
    };
    let mut session = ball();
    assert!(edits(&mut session, 0.1)[0] > 100);
    let reached: Vec<u32> = session.vertices().collect();
    let beyond = session.vertex_count() as u32;
    let refused = session.freeze_edges(&[0, beyond]).unwrap_err();
    assert_eq!(refused, SessionError::NoVertex { vertex: beyond, count: beyond as usize });
    // A rejected call freezes nothing. Frozen edges are not edited.
    assert_ne!(edits(&mut session, 0.07), [0; 3]);
    assert!(session.undo().unwrap());
    session.freeze_edges(&reached).unwrap();
    assert_eq!(edits(&mut session, 0.07), [0; 3]);

    // Restored vertices are frozen again, but not new vertices with the same numbers.
    assert!(session.undo().unwrap() && session.undo().unwrap());
    assert!(session.redo().unwrap());
    assert_eq!(edits(&mut session, 0.07), [0; 3]);
    assert!(session.undo().unwrap() && session.undo().unwrap());
    let (mut fresh, inserted) = (ball(), |session: &Session| session.vertices().filter(|&v| v >= count).count());
    for session in [&mut session, &mut fresh] {
        session.freeze_edges(&(0..10).collect::<Vec<u32>>()).unwrap();
        assert!(edits(session, 0.1)[0] > 100);
        assert_ne!(edits(session, 0.05), [0; 3]);
    }
    assert_eq!(snapshot(&session), snapshot(&fresh));
    assert!(inserted(&session) > 300, "{}", inserted(&session));
}

#[test]
fn undone_and_canceled_strokes_keep_edges_frozen() {
    // A canceled stroke temporarily uses the numbers of undone vertices.
    let edits = |is_hesitant: bool| {
        let mut session = ball();
        make(&mut session, &brush(), &refined(0.1), &press(0.3));
        let all: Vec<u32> = session.vertices().collect();
        session.freeze_edges(&all).unwrap();
        assert!(session.undo().unwrap());
        if is_hesitant {
            session.begin_stroke(&rod(), refined(0.08)).unwrap();
            press(0.2).iter().for_each(|pose| assert!(session.move_to(pose, 0.0).is_ok()));
            session.cancel_stroke().unwrap();
        }
        assert!(session.redo().unwrap());
        stroke(&mut session, &brush(), refined(0.05), &press(0.3)).inserted_vertices
    };
    assert_eq!([false, true].map(edits), [0, 0]);

    // A later call releases all other edges, including those of vertices that are undone at the
    // time.
    let mut session = ball();
    make(&mut session, &brush(), &refined(0.1), &press(0.3));
    let all: Vec<u32> = session.vertices().collect();
    session.freeze_edges(&all).unwrap();
    assert!(session.undo().unwrap());
    session.freeze_edges(&[]).unwrap();
    assert!(session.redo().unwrap());
    assert!(stroke(&mut session, &brush(), refined(0.05), &press(0.3)).inserted_vertices > 0);
}

#[test]
fn a_mask_holds_edges_and_vertices() {
    let session = |weights: Vec<f64>| {
        let mask = Mask { vertices: Some(VertexWeights::Values(weights)), fade: Some(0.2), ..Mask::default() };
        Session::open(icosphere(1.0, 3), SessionOptions { mask, ..SessionOptions::default() }).unwrap()
    };
    let fine = InteractiveRefinement { longest: Some(0.03), collapse: 0.4, ..InteractiveRefinement::default() };
    let fine = StrokeOptions { refine: Some(fine) };
    let count = ball().vertex_count();
    let mut held = session(vec![1.0; count]);
    let before = snapshot(&held);
    let receipt = stroke(&mut held, &brush(), fine.clone(), &press(0.3));
    assert_eq!((receipt.touched_vertices, receipt.inserted_vertices, receipt.flipped_edges), (0, 0, 0));
    assert_eq!(snapshot(&held), before);

    // Hold half of the brush's reach: triangles whose corners are all held do not change, and
    // others are refined.
    let is_held = |p: &DVec3| p.x > 0.2;
    let mut half = session(ball().positions().iter().map(|p| f64::from(is_held(p))).collect());
    let receipt = stroke(&mut half, &brush(), fine, &press(0.3));
    assert!(receipt.inserted_vertices > 100 && receipt.touched_vertices > 0, "{receipt:?}");
    let opened = half.opened().clone();
    let mut stayed = 0;
    for (triangle, corners) in (0_u32..).zip(&opened.triangles) {
        if corners.iter().all(|&vertex| is_held(&opened.positions[vertex as usize])) {
            assert_eq!(half.triangle(triangle), Some(*corners));
            stayed += 1;
        }
    }
    assert!(stayed > 100, "{stayed}");
    assert_sound(&half);
}

#[test]
fn only_triangles_near_the_path_of_the_tool_are_edited() {
    let mesh = icosphere(1.0, 4);
    let mut session = open(mesh.clone());
    let poses = arc(0.0, 6);
    let fine = InteractiveRefinement { longest: Some(0.03), collapse: 0.4, ..InteractiveRefinement::default() };
    let receipt = stroke(&mut session, &brush(), StrokeOptions { refine: Some(fine) }, &poses);
    assert!(receipt.inserted_vertices > 1000 && receipt.flipped_edges > 0, "{receipt:?}");
    let edge = mesh.triangles.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]);
    let longest = edge.map(|ends| ends.map(|end| mesh.positions[end as usize])).map(|[a, b]| a.distance(b));
    let longest = longest.fold(0.0, f64::max);
    let step = poses.windows(2).map(|pair| pair[0].translation.distance(pair[1].translation)).fold(0.0, f64::max);
    // The ball around a triangle that may be touched extends an edge beyond the support, and its
    // corners another edge. The longest edge nearby, which is split for an edge that is too long, can
    // be a few triangles farther.
    let reach = 0.2 + 0.25 + 0.5 * step + 5.0 * longest;
    let (mut far, mut near) = (0, 0);
    for (triangle, corners) in (0_u32..).zip(&mesh.triangles) {
        let is_far = |&vertex: &u32| {
            let position = mesh.positions[vertex as usize];
            poses.iter().all(|pose| pose.translation.distance(position) > reach)
        };
        if corners.iter().all(is_far) {
            assert_eq!(session.triangle(triangle), Some(*corners));
            far += 1;
        } else {
            near += usize::from(session.triangle(triangle) != Some(*corners));
        }
    }
    assert!(far > mesh.triangles.len() / 2 && near > 100, "{far} {near}");
}

#[test]
fn an_open_surface_keeps_its_boundary() {
    let mut mesh = icosphere(1.0, 3);
    let whole = mesh.triangles.clone();
    mesh.triangles.retain(|triangle| triangle.iter().any(|&vertex| mesh.positions[vertex as usize].x < 0.9));
    assert!(mesh.triangles.len() < whole.len());
    let mut session = open(mesh);
    let receipt = stroke(&mut session, &brush(), refined(0.08), &arc(-0.2, 12));
    assert_eq!((receipt.volume, session.volume()), (None, None));
    let check = session.export(true).mesh.check();
    assert!(check.is_oriented() && check.is_manifold() && !check.is_closed());
    let again = open(session.export(false).mesh);
    assert_eq!(again.triangle_count(), session.triangle_count());
}

#[test]
fn rejects_invalid_meshes_and_options_by_name() {
    let refuse = |triangles: Vec<[u32; 3]>| {
        let positions = (0..6).map(|i| DVec3::new(f64::from(i), f64::from(i * i), 1.0)).collect();
        Session::open(TriMesh::new(positions, triangles), SessionOptions::default()).unwrap_err()
    };
    assert!(matches!(refuse(vec![[0, 1, 9]]), OpenError::Mesh(_)));
    let error = refuse(vec![[0, 1, 2], [1, 0, 3], [0, 1, 4]]);
    assert!(error.to_string().contains("the edge between vertices 0 and 1"), "{error}");
    let mut mesh = icosphere(1.0, 1);
    mesh.vertex.colors = vec![glam::DVec4::ONE; 3];
    let error = Session::open(mesh, SessionOptions::default()).unwrap_err();
    assert_eq!(error, OpenError::AttributeCount { attribute: "vertex colors", found: 3, expected: 42 });
    let options = SessionOptions { step: 2.0, ..SessionOptions::default() };
    assert!(matches!(Session::open(icosphere(1.0, 1), options), Err(OpenError::Options(_))));
    for refine in [
        InteractiveRefinement { longest: Some(0.0), ..Default::default() },
        InteractiveRefinement { collapse: 0.9, ..Default::default() },
        InteractiveRefinement { keep: vec![(DVec3::NAN, 1.0)], ..Default::default() },
    ] {
        let begun = ball().begin_stroke(&brush(), StrokeOptions { refine: Some(refine) });
        assert!(matches!(begun, Err(SessionError::Refinement(_))));
    }
}

#[test]
fn stirring_does_not_add_triangles_without_end() {
    let spin = |phase: f64| Pose { rotation: rotation_from_vector(DVec3::Z * phase), translation: DVec3::Z };
    let circle = |phase: f64| Pose::at(DVec3::new(0.15 * libm::sin(phase), 0.15 * libm::cos(phase), 0.95));
    for path in [&spin as &dyn Fn(f64) -> Pose, &circle] {
        let mut session = ball();
        let poses: Vec<Pose> = (0..60).map(|index| path(0.4 * f64::from(index))).collect();
        let options = InteractiveRefinement { longest: Some(0.06), ..InteractiveRefinement::default() };
        let receipt = stroke(&mut session, &brush(), StrokeOptions { refine: Some(options) }, &poses);
        assert_sound(&session);
        // About 700 triangles of that size are in reach, a cap of radius 0.6. Without bounds, each move
        // would double them.
        assert!(session.triangle_count() < 256 * 700, "{}", session.triangle_count());
        assert!(!receipt.is_limited && (receipt.refused_splits > 0 || receipt.stopped_at.is_some()), "{receipt:?}");
    }
}
