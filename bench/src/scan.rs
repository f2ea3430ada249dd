//! Synthetic meshes with the features of 3D scans.

use glam::{DVec3, dvec3};
use isochore_mesh::{TriMesh, primitives};

/// Wave vectors and heights of the surface waves. The result is star-shaped, so its triangles do
/// not intersect.
const WAVES: [(DVec3, f64); 5] = [
    (dvec3(2.0, 1.0, -1.0), 0.12),
    (dvec3(-3.0, 5.0, 2.0), 0.05),
    (dvec3(7.0, -4.0, 9.0), 0.02),
    (dvec3(-17.0, 15.0, 11.0), 0.007),
    (dvec3(41.0, 37.0, -29.0), 0.002),
];

/// Height of the roughness between neighboring vertices, relative to their distance: the noise of a
/// good scanner.
const ROUGHNESS: f64 = 0.05;

/// Displacement of vertices along the surface, relative to the distance between neighbors. It makes
/// all triangles different.
const IRREGULARITY: f64 = 0.2;

/// A closed, rough, wavy ball around the origin with 20 · 4ⁿ triangles, where n is `subdivisions`.
/// The triangles do not intersect.
pub fn scan(subdivisions: u32) -> TriMesh {
    roughened(primitives::icosphere(1.0, subdivisions), 1.2 * libm::exp2(-f64::from(subdivisions)))
}

/// The same with 12 `segments`² triangles, whose sizes differ more.
pub fn scan_of_cube(segments: usize) -> TriMesh {
    let mut mesh = primitives::box_mesh(DVec3::ONE, [segments; 3]);
    mesh.positions.iter_mut().for_each(|position| *position = position.normalize());
    // Length of the smallest edges, at the corners of the cube.
    roughened(mesh, 0.8 / segments as f64)
}

/// Adds waves and roughness to a unit sphere with edges of length about `spacing`.
fn roughened(mut mesh: TriMesh, spacing: f64) -> TriMesh {
    for (index, position) in mesh.positions.iter_mut().enumerate() {
        let noise = |ratio: f64| 2.0 * (index as f64 * ratio).fract() - 1.0;
        let shift = IRREGULARITY * spacing * dvec3(noise(0.618_034), noise(0.414_214), noise(0.732_051));
        let direction = (*position + shift).normalize();
        let height: f64 = WAVES.iter().map(|&(wave, height)| height * libm::sin(wave.dot(direction))).sum();
        *position = direction * (1.0 + height + ROUGHNESS * spacing * noise(0.236_068));
    }
    mesh
}

/// Two balls as in [`scan`] that intersect each other, as one mesh.
pub fn intersecting_scans(subdivisions: u32) -> TriMesh {
    let mesh = scan(subdivisions);
    let (count, shift) = (mesh.positions.len() as u32, dvec3(0.9, 0.3, 0.2));
    let second = mesh.positions.iter().map(|&position| position + shift);
    let triangles = mesh.triangles.iter().map(|triangle| triangle.map(|vertex| vertex + count));
    TriMesh::new(
        mesh.positions.iter().copied().chain(second).collect(),
        mesh.triangles.iter().copied().chain(triangles).collect(),
    )
}

#[test]
fn scans_are_closed_and_do_not_intersect_themselves() {
    for mesh in [scan(5), scan_of_cube(29), scan_of_cube(51)] {
        assert!(isochore_mesh::ClosedMesh::new(&mesh).is_ok());
        let intersections = isochore_mesh::SelfIntersections::of(&mesh, &isochore_mesh::NoProgress).unwrap();
        assert!(intersections.is_empty(), "{:?}", intersections.triangles());
    }
}
