//! Attributes that are carried to the new triangles.

use glam::{DVec2, DVec3, DVec4};

use super::{
    shapes::{grid, torus},
    *,
};

/// A torus with a texture that has a seam along the circle y = 0, x > 0, with colors by position and
/// skin weights by height.
fn painted_torus() -> TriMesh {
    let mut mesh = torus(0.4, 96, 40);
    let corners: Vec<[DVec3; 3]> = (0..mesh.triangles.len()).map(|triangle| mesh.corners(triangle)).collect();
    mesh.corner.uvs = vec![corners.iter().map(|corners| texture(corners).map(|uv| uv.as_vec2())).collect()];
    mesh.vertex.colors = mesh.positions.iter().map(|&position| color(position)).collect();
    let weight = |p: &DVec3| 0.5 + p.z;
    mesh.vertex.skin = mesh.positions.iter().map(|p| vec![(0, weight(p)), (1, 1.0 - weight(p))]).collect();
    mesh
}

fn color(position: DVec3) -> DVec4 {
    (0.5 + 0.3 * position).extend(1.0)
}

/// Angle around the axis as a fraction, from the seam on, and height.
fn texture(corners: &[DVec3; 3]) -> [DVec2; 3] {
    let center = corners.iter().sum::<DVec3>() / 3.0;
    corners.map(|p| {
        let around = libm::atan2(p.y, p.x) / std::f64::consts::TAU;
        let is_before = center.y < 0.0;
        let around = if is_before && around > -1e-9 && around < 0.25 {
            1.0
        } else if around < -1e-9 {
            around + 1.0
        } else {
            around.max(0.0)
        };
        DVec2::new(around, p.z)
    })
}

#[test]
fn texture_colors_and_skin_are_carried() {
    let mesh = painted_torus();
    let remeshed = checked(&mesh, &RemeshOptions::default()).mesh;
    assert!(remeshed.triangles.len() < mesh.triangles.len());
    let mut seam = 0;
    for triangle in 0..remeshed.triangles.len() {
        let corners = remeshed.corners(triangle);
        let expected = texture(&corners);
        for (side, &position) in corners.iter().enumerate() {
            let found = remeshed.corner.uvs[0][triangle][side].as_dvec2();
            assert!(
                found.distance(expected[side]) < 3e-3,
                "triangle {triangle}: {found} instead of {}",
                expected[side]
            );
            seam += usize::from(position.y.abs() < 1e-12 && position.x > 0.0);
        }
    }
    assert!(seam > 20, "{seam}");
    for (vertex, &position) in remeshed.positions.iter().enumerate() {
        assert!(remeshed.vertex.colors[vertex].distance(color(position)) < 3e-3);
        let weight = |bone: u32| {
            let of_bone = remeshed.vertex.skin[vertex].iter().filter(|(found, _)| *found == bone);
            of_bone.map(|(_, weight)| weight).sum::<f64>()
        };
        assert!((weight(0) - 0.5 - position.z).abs() < 4e-3);
        assert!((weight(0) + weight(1) - 1.0).abs() < 1e-9);
    }
}

#[test]
fn smooth_shading_follows_the_surface() {
    let mut mesh = torus(0.4, 96, 40);
    let normals = mesh.vertex_normals();
    mesh.corner.normals =
        mesh.triangles.iter().map(|triangle| triangle.map(|vertex| normals[vertex as usize].as_vec3())).collect();
    let remeshed = checked(&mesh, &RemeshOptions::default()).mesh;
    for (triangle, vertices) in remeshed.triangles.iter().enumerate() {
        for (side, &vertex) in vertices.iter().enumerate() {
            let position = remeshed.positions[vertex as usize];
            let ring = position.with_z(0.0).normalize();
            let expected = (position - ring).normalize();
            let found = remeshed.corner.normals[triangle][side].as_dvec3();
            assert!(found.dot(expected) > 0.995, "{found} instead of {expected}");
        }
    }
}

#[test]
fn flat_shading_stays_flat() {
    let mut mesh = torus(0.4, 96, 40);
    let flat = |mesh: &TriMesh, triangle: usize| {
        let [a, b, c] = mesh.corners(triangle);
        [(b - a).cross(c - a).normalize().as_vec3(); 3]
    };
    mesh.corner.normals = (0..mesh.triangles.len()).map(|triangle| flat(&mesh, triangle)).collect();
    let remeshed = checked(&mesh, &RemeshOptions::default()).mesh;
    assert!(remeshed.triangles.len() < mesh.triangles.len());
    for triangle in 0..remeshed.triangles.len() {
        assert_eq!(remeshed.corner.normals[triangle], flat(&remeshed, triangle));
    }
}

#[test]
fn loose_vertices_stay() {
    let mut mesh = grid([12, 12], [true, true], |i, j| torus(0.4, 12, 12).positions[12 * j + i]);
    mesh.positions.push(DVec3::splat(3.0));
    let remeshed = remesh(mesh, &RemeshOptions::default(), &NoProgress).unwrap().mesh;
    assert!(remeshed.positions.contains(&DVec3::splat(3.0)));
}
