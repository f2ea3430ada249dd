//! Meshes with the features of scans, made up.

use glam::{DVec3, dvec3};
use isochore_mesh::{TriMesh, primitives};

/// Waves of the surface: directions with their wave numbers, and heights. Together they keep the sphere star-shaped, so that its
/// triangles do not cross.
const WAVES: [(DVec3, f64); 5] = [
    (dvec3(2.0, 1.0, -1.0), 0.12),
    (dvec3(-3.0, 5.0, 2.0), 0.05),
    (dvec3(7.0, -4.0, 9.0), 0.02),
    (dvec3(-17.0, 15.0, 11.0), 0.007),
    (dvec3(41.0, 37.0, -29.0), 0.002),
];

/// Height of the roughness between neighboring vertices, as a share of their distance: that of a good scanner.
const ROUGHNESS: f64 = 0.05;

/// Share of the distance between neighbors by which vertices are shifted along the surface, so that no two triangles are alike.
const IRREGULARITY: f64 = 0.2;

/// A closed, rough, wavy ball of 20 · 4ⁿ triangles that do not cross; it encloses the origin.
pub fn scan(subdivisions: u32) -> TriMesh {
    roughened(primitives::icosphere(1.0, subdivisions), 1.2 * libm::exp2(-f64::from(subdivisions)))
}

/// The same of 12 `segments`² triangles, which are less alike in size.
pub fn scan_of_cube(segments: usize) -> TriMesh {
    let mut mesh = primitives::box_mesh(DVec3::ONE, [segments; 3]);
    mesh.positions.iter_mut().for_each(|position| *position = position.normalize());
    // The smallest edges, at the corners of the cube.
    roughened(mesh, 0.8 / segments as f64)
}

/// Makes a scan of a unit sphere, the vertices of which are about `spacing` apart.
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

/// Two such balls that run through each other, as one mesh.
pub fn crossing_scans(subdivisions: u32) -> TriMesh {
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
fn scans_are_closed_and_do_not_cross() {
    for mesh in [scan(5), scan_of_cube(29), scan_of_cube(51)] {
        assert!(isochore_mesh::ClosedMesh::new(&mesh).is_ok());
        let crossings = isochore_mesh::SelfIntersections::of(&mesh, &isochore_mesh::NoProgress).unwrap();
        assert!(crossings.is_empty(), "{:?}", crossings.triangles());
    }
}
