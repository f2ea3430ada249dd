use glam::{DVec2, DVec4, Vec3};
use isochore_mesh::{
    TriMesh,
    primitives::{box_mesh, icosphere},
};
use isochore_sculpt::session::NormalWeights;

use super::*;

/// A ball with a texture seam along a meridian, two materials with a hard edge between them, colors
/// and skin weights.
pub(crate) fn painted_ball() -> TriMesh {
    let mut mesh = icosphere(1.0, 3);
    let around = |p: DVec3| libm::atan2(p.y, p.x) / std::f64::consts::TAU + 0.5;
    let uv = |triangle: &[u32; 3]| {
        let corners = triangle.map(|vertex| mesh.positions[vertex as usize]);
        let us = corners.map(around);
        let breaks = us.iter().cloned().fold(0.0, f64::max) - us.iter().cloned().fold(1.0, f64::min) > 0.5;
        [0, 1, 2].map(|i| DVec2::new(if breaks && us[i] < 0.5 { us[i] + 1.0 } else { us[i] }, corners[i].z).as_vec2())
    };
    mesh.corner.uvs = vec![mesh.triangles.iter().map(uv).collect()];
    mesh.materials = vec!["north".to_owned(), "south".to_owned()];
    let south =
        |triangle: &[u32; 3]| u32::from(triangle.iter().map(|&v| mesh.positions[v as usize].z).sum::<f64>() < 0.0);
    mesh.triangle_materials = mesh.triangles.iter().map(south).collect();
    let normals = |(triangle, &side): (&[u32; 3], &u32)| {
        let tilt = DVec3::Z * if side == 0 { 0.3 } else { -0.3 };
        triangle.map(|vertex| (mesh.positions[vertex as usize] + tilt).normalize().as_vec3())
    };
    mesh.corner.normals = mesh.triangles.iter().zip(&mesh.triangle_materials).map(normals).collect();
    mesh.vertex.colors =
        mesh.positions.iter().map(|p| DVec4::new(0.5 + 0.5 * p.x, 0.5 + 0.5 * p.y, 0.5, 1.0)).collect();
    let skin = |p: &DVec3| {
        let weight = 0.5 + 0.5 * p.z;
        vec![((p.x > 0.0) as u32, weight), (2, 1.0 - weight)]
    };
    mesh.vertex.skin = mesh.positions.iter().map(skin).collect();
    mesh
}

#[test]
fn render_vertices_follow_vertices_and_keep_seams_closed() {
    let mut session = open(painted_ball());
    let opened = session.opened().clone();
    let vertices = opened.positions.len();
    assert!(session.buffers().positions.len() > vertices, "a seam needs more render vertices");
    for round in 0..12 {
        make(&mut session, &brush(), &refined(0.1), &arc(0.5 * f64::from(round), 7));
    }
    assert_sound(&session);
    let buffers = session.buffers();
    let mut inserted = 0;
    for (triangle, corners) in buffers.indices.iter().enumerate() {
        let Some(expected) = session.triangle(triangle as u32) else {
            assert_eq!(*corners, [0; 3]);
            continue;
        };
        assert_eq!(corners.map(|corner| session.vertex_of(corner)), expected);
        for corner in *corners {
            let vertex = session.vertex_of(corner);
            let position = session.positions()[vertex as usize] + session.offsets()[vertex as usize];
            assert_eq!(buffers.positions[corner as usize], position.as_vec3().to_array());
            // Attributes are those of the origin, interpolated once.
            let origin = session.origin_of(corner).unwrap();
            assert_eq!(buffers.uvs[0][corner as usize], opened.uv_at(0, &origin).to_array());
            assert_eq!(buffers.colors[corner as usize], opened.color_at(&origin).unwrap().as_vec4().to_array());
            assert!((origin.weights.element_sum() - 1.0).abs() < 1e-15 && origin.weights.min_element() >= 0.0);
            inserted += usize::from(vertex as usize >= vertices);
        }
        // Within a triangle, texture coordinates never jump from one end of the map to the other.
        let us = corners.map(|corner| buffers.uvs[0][corner as usize][0]);
        let spread = us.iter().cloned().fold(0.0, f32::max) - us.iter().cloned().fold(2.0, f32::min);
        let is_polar =
            expected.iter().any(|&vertex| vertex < vertices as u32 && opened.positions[vertex as usize].z.abs() > 0.9);
        assert!(spread < 0.5 || is_polar, "triangle {triangle}: {us:?}");
    }
    assert!(inserted > 1000, "{inserted}");
}

#[test]
fn export_keeps_all_attributes() {
    let mut session = open(painted_ball());
    for round in 0..8 {
        make(&mut session, &brush(), &refined(0.1), &arc(0.7 * f64::from(round), 7));
    }
    let exported = session.export(true);
    let (mesh, opened) = (&exported.mesh, session.opened());
    assert_eq!(mesh.triangle_materials.len(), mesh.triangles.len());
    assert_eq!(mesh.materials, opened.materials);
    for (index, &vertex) in exported.vertices.iter().enumerate() {
        let skin = &mesh.vertex.skin[index];
        assert!(skin.len() <= 2);
        assert!((skin.iter().map(|(_, weight)| weight).sum::<f64>() - 1.0).abs() < 1e-12);
        if (vertex as usize) < opened.positions.len() {
            assert_eq!(skin, &opened.vertex.skin[vertex as usize]);
            assert_eq!(mesh.vertex.colors[index], opened.vertex.colors[vertex as usize]);
        }
    }
    // The lock restores the volume of the mesh as opened, up to rounding.
    assert!(exported.lock.is_some());
    assert!((mesh.volume() / opened.volume() - 1.0).abs() < 1e-14);
    let unlocked = session.export(false).mesh;
    assert!((unlocked.volume() / opened.volume() - 1.0).abs() > 1e-9);
    assert!((unlocked.volume() / session.volume().unwrap() - 1.0).abs() < 1e-12);
}

#[test]
fn shading_is_discontinuous_only_at_hard_edges() {
    for weights in [NormalWeights::Area, NormalWeights::Angle] {
        let options = SessionOptions { normals: weights, ..SessionOptions::default() };
        let mut session = Session::open(painted_ball(), options).unwrap();
        let (mut edits, squeezing) = ([0; 3], InteractiveRefinement { collapse: 0.4, ..Default::default() });
        for round in 0..10 {
            let options =
                StrokeOptions { refine: Some(InteractiveRefinement { longest: Some(0.08), ..squeezing.clone() }) };
            session.begin_stroke(&brush(), options).unwrap();
            arc(0.6 * f64::from(round), 9).iter().for_each(|pose| assert!(session.move_to(pose, 0.0).is_ok()));
            let receipt = session.end_stroke().unwrap();
            let counts = [receipt.inserted_vertices, receipt.removed_vertices, receipt.flipped_edges];
            (0..3).for_each(|kind| edits[kind] += counts[kind]);
        }
        assert!(edits.iter().all(|&count| count > 0), "{edits:?}");
        for _ in 0..3 {
            assert!(session.undo().unwrap());
        }
        assert_is_shaded_by_material(&session, weights);
        while session.redo().unwrap() {}
        assert_is_shaded_by_material(&session, weights);
    }
}

/// Each corner must have the mean normal of the triangles at its vertex that have its triangle's
/// material.
fn assert_is_shaded_by_material(session: &Session, weights: NormalWeights) {
    let mesh = session.export(true).mesh;
    let normals = |triangle: usize| {
        let corners = mesh.corners(triangle);
        [0, 1, 2].map(|side| {
            let [a, b, c] = [0, 1, 2].map(|step| corners[(side + step) % 3]);
            let normal = (b - a).cross(c - a);
            match weights {
                NormalWeights::Area => normal,
                NormalWeights::Angle => normal.normalize() * (b - a).angle_between(c - a),
            }
        })
    };
    let mut sums = vec![[DVec3::ZERO; 2]; mesh.positions.len()];
    for (triangle, (vertices, &side)) in mesh.triangles.iter().zip(&mesh.triangle_materials).enumerate() {
        for (&vertex, normal) in vertices.iter().zip(normals(triangle)) {
            sums[vertex as usize][side as usize] += normal;
        }
    }
    let alive = session.buffers().indices.iter().filter(|corners| **corners != [0; 3]);
    let mut broken = 0;
    for (corners, (vertices, &side)) in alive.zip(mesh.triangles.iter().zip(&mesh.triangle_materials)) {
        for (&corner, &vertex) in corners.iter().zip(vertices) {
            let normal = DVec3::from_array(session.buffers().normals[corner as usize].map(f64::from));
            let [own, other] = [side, 1 - side].map(|side| sums[vertex as usize][side as usize].normalize_or_zero());
            // Rounded to f32 once; sums in another order.
            assert!(normal.distance(own) < 1e-6, "vertex {vertex}: {normal} {own}");
            broken += usize::from(other != DVec3::ZERO && own.distance(other) > 1e-3);
        }
    }
    assert!(broken > 100, "{broken}");
}

#[test]
fn rounding_of_normals_does_not_make_hard_edges() {
    let flat = |error: f32| {
        let mut mesh = box_mesh(DVec3::ONE, [3, 3, 3]);
        let normals = |triangle: usize| {
            let [a, b, c] = mesh.corners(triangle);
            let normal = (b - a).cross(c - a).normalize().as_vec3();
            [0.0, 1.0, -1.0].map(|factor| normal + Vec3::splat(factor * error * (triangle % 7) as f32))
        };
        mesh.corner.normals = (0..mesh.triangles.len()).map(normals).collect();
        open(mesh)
    };
    let [exact, rounded, broken] = [0.0, 1e-7, 1e-2].map(|error| flat(error).buffers().positions.len());
    // Each of the six faces has its own grid of corners.
    assert_eq!([exact, rounded], [6 * 16; 2]);
    assert!(broken > exact);
}

#[test]
fn an_unchanged_session_exports_the_mesh_as_opened() {
    let mut mesh = painted_ball();
    mesh.positions.push(DVec3::splat(3.0));
    mesh.vertex.colors.push(DVec4::ONE);
    mesh.vertex.skin.push(vec![(1, 1.0)]);
    let mut session = open(mesh.clone());
    assert_eq!(session.export(true).mesh, mesh);
    assert_eq!(session.export(false).mesh, mesh);
    make(&mut session, &brush(), &refined(0.05), &arc(0.0, 7));
    assert!(session.undo().unwrap());
    assert_eq!(session.export(false).mesh, mesh);
}

#[test]
fn advects_a_vertex_without_triangles() {
    let mut mesh = icosphere(1.0, 3);
    mesh.positions.push(DVec3::new(1.05, 0.1, 0.0));
    let mut session = open(mesh.clone());
    make(&mut session, &brush(), &refined(0.1), &arc(0.0, 5));
    let loose = mesh.positions.len() - 1;
    assert!(session.positions()[loose].distance(mesh.positions[loose]) > 0.01);
    assert_eq!(session.buffers().positions[loose], session.positions()[loose].as_vec3().to_array());
    assert!(session.is_alive(loose as u32));
}
