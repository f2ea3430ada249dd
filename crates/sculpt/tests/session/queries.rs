use super::*;

#[test]
fn picks_and_closest_points_are_on_the_surface() {
    let mut session = ball();
    for round in 0..5 {
        make(&mut session, &brush(), &refined(0.08), &arc(0.3 * f64::from(round), 9));
        let mesh = session.export(true).mesh;
        let bvh = isochore_mesh::Bvh::new(&mesh.positions, &mesh.triangles).unwrap();
        for index in 0..200 {
            let angle = f64::from(index) * 0.1;
            let point = DVec3::new(libm::cos(angle), libm::sin(angle), 0.3 * libm::sin(7.0 * angle)) * 1.4;
            let hit = session.closest_point(point).unwrap();
            // Both results round coordinates near one a few times.
            assert!((hit.distance - bvh.closest_point(point).distance).abs() < 1e-14);
            let picked = session.pick(point, -point).unwrap();
            assert!((picked.point - point * (1.0 - picked.distance)).length() < 1e-14);
            assert!(bvh.closest_point(picked.point).distance < 1e-14);
            assert!((picked.normal.length() - 1.0).abs() < 1e-14);
            assert_eq!(session.triangle(picked.triangle), Some(picked.vertices));
            for hit in [&hit, &picked] {
                let shown = hit.vertices.map(|v| session.positions()[v as usize] + session.offsets()[v as usize]);
                let weighted: DVec3 = (0..3).map(|corner| shown[corner] * hit.weights[corner]).sum();
                assert!(weighted.distance(hit.point) < 1e-14 && hit.weights.min_element() >= 0.0);
                assert!((hit.weights.element_sum() - 1.0).abs() < 1e-15);
            }
        }
    }
    assert_eq!(session.pick(DVec3::splat(5.0), DVec3::ONE), None);
    assert_eq!(session.pick(DVec3::ZERO, DVec3::NAN), None);
    assert_eq!(session.closest_point(DVec3::NAN), None);
}

#[test]
fn vertices_in_reach_are_those_that_move() {
    let mut session = ball();
    let (tool, poses) = (brush(), arc(0.0, 2));
    let mut within = Vec::new();
    session.vertices_in_reach(&tool, &poses[0], &mut within);
    let slow: Vec<u32> = (0..session.vertex_count() as u32)
        .filter(|&vertex| session.positions()[vertex as usize].distance(poses[0].translation) < 0.2 + 0.25)
        .collect();
    assert_eq!(within, slow);
    // A move so short that no further vertex enters the support.
    let rest = session.positions().to_vec();
    let next = Pose { translation: poses[0].translation + DVec3::new(0.0, 0.0, 1e-9), ..poses[0] };
    session.begin_stroke(&tool, UNREFINED).unwrap();
    session.move_to(&poses[0], 0.0).unwrap();
    session.move_to(&next, 0.1).unwrap();
    let moved: Vec<u32> =
        (0..rest.len() as u32).filter(|&v| rest[v as usize] != session.positions()[v as usize]).collect();
    // At the very rim the field is below rounding.
    assert!(moved.iter().all(|vertex| within.contains(vertex)) && moved.len() + 20 > within.len());
}

#[test]
fn previews_show_the_flow() {
    let session = ball();
    let [from, to] = [0.0, 0.05].map(|z| Pose::at(DVec3::new(1.0, 0.0, z)));
    let arrows = session.preview(&brush(), &from, &to, 9).unwrap();
    assert!(arrows.len() > 100, "{}", arrows.len());
    for arrow in &arrows {
        let distance = arrow.point.distance(from.translation);
        assert!(distance < 0.45 + 0.05 && arrow.shift.length() <= 2.0 * 0.05);
        // The core moves with the tool.
        if distance < 0.14 {
            assert!(arrow.shift.distance(to.translation - from.translation) < 1e-15);
        }
    }
}

#[test]
fn moved_volume_is_the_swept_volume() {
    let mut session = ball();
    session.begin_stroke(&brush(), refined(0.05)).unwrap();
    for index in 0..=10 {
        session.move_to(&Pose::at(DVec3::new(0.0, 0.0, 1.0 - 0.01 * f64::from(index))), 0.0).unwrap();
    }
    let moved = session.moved_volume();
    // The core alone, a disk of radius 0.2, moves down by a tenth. The return flow moves up around
    // it.
    let least = 0.8 * std::f64::consts::PI * 0.04 * 0.1;
    assert!(moved.inward > least && moved.inward < 8.0 * least, "{moved:?}");
    let volume = session.end_stroke().unwrap().volume.unwrap();
    // Swept volumes balance up to the change of the volume, with an error of second order in the
    // step over the tool.
    assert!((moved.outward - moved.inward - volume.total()).abs() < 0.02 * moved.inward, "{moved:?} {volume:?}");
    assert_eq!(session.moved_volume(), Default::default());
}
