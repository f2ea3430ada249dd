//! Sharp edges, hard edges, materials, boundaries and seams.

use glam::DVec3;
use isochore_mesh::primitives::box_mesh;

use super::{measures::one_sided, shapes::sheet, *};

/// The face of the unit cube that contains a triangle: twice the axis, plus one on the positive side.
fn face(corners: &[DVec3; 3]) -> usize {
    let normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
    let axis = normal.abs().max_position();
    2 * axis + usize::from(normal[axis] > 0.0)
}

fn faces(mesh: &TriMesh) -> Vec<usize> {
    (0..mesh.triangles.len()).map(|triangle| face(&mesh.corners(triangle))).collect()
}

fn area(corners: &[DVec3; 3]) -> f64 {
    0.5 * (corners[1] - corners[0]).cross(corners[2] - corners[0]).length()
}

fn areas_by(mesh: &TriMesh, key: impl Fn(usize) -> usize, count: usize) -> Vec<f64> {
    let mut areas = vec![0.0; count];
    for triangle in 0..mesh.triangles.len() {
        areas[key(triangle)] += area(&mesh.corners(triangle));
    }
    areas
}

#[test]
fn a_cube_keeps_its_edges_and_faces() {
    let mesh = box_mesh(DVec3::ONE, [20; 3]);
    for options in [RemeshOptions::default(), RemeshOptions { edge_length: Some(0.3), ..RemeshOptions::default() }] {
        let remeshed = checked(&mesh, &options).mesh;
        assert!(remeshed.triangles.len() < mesh.triangles.len() / 2, "{}", remeshed.triangles.len());
        assert!(one_sided(&mesh, &remeshed) < 1e-12);
        assert!(
            areas_by(&remeshed, |triangle| faces(&remeshed)[triangle], 6).iter().all(|area| (area - 4.0).abs() < 1e-9)
        );
    }
}

#[test]
fn hard_edges_and_materials_stay_on_their_side() {
    let mut mesh = box_mesh(DVec3::ONE, [16; 3]);
    let of_faces = faces(&mesh);
    mesh.corner.normals = of_faces
        .iter()
        .map(|&face| {
            let mut normal = DVec3::ZERO;
            normal[face / 2] = if face % 2 == 1 { 1.0 } else { -1.0 };
            [normal.as_vec3(); 3]
        })
        .collect();
    // A border across the top face, and another around the bottom one.
    let material = |triangle: usize| {
        let center = mesh.corners(triangle).iter().sum::<DVec3>() / 3.0;
        match of_faces[triangle] {
            4 => 1,
            5 if center.x > 0.0 => 2,
            _ => 0,
        }
    };
    mesh.triangle_materials = (0..mesh.triangles.len()).map(material).collect();
    mesh.materials = ["side", "bottom", "half"].map(str::to_owned).to_vec();
    // Smooth corners inside the faces would count as flat shading.
    for (triangle, normals) in mesh.corner.normals.iter_mut().enumerate() {
        if of_faces[triangle] == 5 {
            let corners = mesh.triangles[triangle].map(|vertex| mesh.positions[vertex as usize]);
            *normals = corners.map(|p| DVec3::new(0.1 * p.x, 0.1 * p.y, 1.0).normalize().as_vec3());
        }
    }
    let remeshed = checked(&mesh, &RemeshOptions::default()).mesh;
    assert!(remeshed.triangles.len() < mesh.triangles.len(), "{}", remeshed.triangles.len());
    assert_eq!(remeshed.materials, mesh.materials);
    let areas = areas_by(&remeshed, |triangle| remeshed.triangle_materials[triangle] as usize, 3);
    for (area, expected) in areas.iter().zip([18.0, 4.0, 2.0]) {
        assert!((area - expected).abs() < 1e-9, "{areas:?}");
    }
    for (triangle, face) in faces(&remeshed).into_iter().enumerate() {
        let mut normal = DVec3::ZERO;
        normal[face / 2] = if face % 2 == 1 { 1.0 } else { -1.0 };
        let least = remeshed.corner.normals[triangle].iter().map(|n| n.as_dvec3().dot(normal)).fold(1.0, f64::min);
        assert!(least > 0.98, "triangle {triangle} of face {face}: {least}");
    }
}

#[test]
fn a_sheet_keeps_its_boundary() {
    let mesh = sheet(60);
    let remeshed = checked(&mesh, &RemeshOptions::default()).mesh;
    assert!(remeshed.triangles.len() < mesh.triangles.len() / 2);
    for corner in [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0]] {
        let is_kept = |p: &DVec3| p.truncate().to_array() == corner;
        assert!(remeshed.positions.iter().any(is_kept), "{corner:?}");
    }
    // Seen from above, it still covers the unit square.
    let covered: f64 = (0..remeshed.triangles.len())
        .map(|triangle| {
            let [a, b, c] = remeshed.corners(triangle);
            0.5 * (b - a).cross(c - a).z
        })
        .sum();
    assert!((covered - 1.0).abs() < 1e-12, "{covered}");
}
