//! Meshes of the shapes that a recipe can name as its target.

use std::collections::HashMap;

use glam::DVec3;
use isochore_mesh::TriMesh;

use crate::recipe::{BoxMesh, Icosphere, SphereMesh, TargetShape};

/// The closed mesh of a shape, centered on the origin, its triangles counter-clockwise seen from outside.
///
/// The shape must be [valid](crate::Recipe::validate).
pub(crate) fn target_mesh(shape: &TargetShape) -> TriMesh {
    match shape {
        TargetShape::Icosphere(shape) => icosphere(shape),
        TargetShape::Box(shape) => box_mesh(shape),
        TargetShape::Sphere(shape) => sphere(shape),
    }
}

fn icosphere(shape: &Icosphere) -> TriMesh {
    let golden = 0.5 * (1.0 + 5.0_f64.sqrt());
    let mut directions: Vec<DVec3> = [
        [-1.0, golden, 0.0],
        [1.0, golden, 0.0],
        [-1.0, -golden, 0.0],
        [1.0, -golden, 0.0],
        [0.0, -1.0, golden],
        [0.0, 1.0, golden],
        [0.0, -1.0, -golden],
        [0.0, 1.0, -golden],
        [golden, 0.0, -1.0],
        [golden, 0.0, 1.0],
        [-golden, 0.0, -1.0],
        [-golden, 0.0, 1.0],
    ]
    .map(|corner| DVec3::from_array(corner).normalize())
    .to_vec();
    // Five triangles round the vertex 0, five next to those, five round the opposite vertex 3, five next to those.
    #[rustfmt::skip]
    let mut triangles: Vec<[u32; 3]> = vec![
        [0, 11, 5], [0, 5, 1], [0, 1, 7], [0, 7, 10], [0, 10, 11],
        [1, 5, 9], [5, 11, 4], [11, 10, 2], [10, 7, 6], [7, 1, 8],
        [3, 9, 4], [3, 4, 2], [3, 2, 6], [3, 6, 8], [3, 8, 9],
        [4, 9, 5], [2, 4, 11], [6, 2, 10], [8, 6, 7], [9, 8, 1],
    ];
    for _ in 0..shape.subdivisions {
        let mut midpoints: HashMap<[u32; 2], u32> = HashMap::with_capacity(triangles.len() * 3 / 2);
        let mut finer = Vec::with_capacity(triangles.len() * 4);
        for [a, b, c] in triangles {
            let [ab, bc, ca] = [[a, b], [b, c], [c, a]].map(|[p, q]| {
                *midpoints.entry([p.min(q), p.max(q)]).or_insert_with(|| {
                    directions.push((directions[p as usize] + directions[q as usize]).normalize());
                    (directions.len() - 1) as u32
                })
            });
            finer.extend([[a, ab, ca], [b, bc, ab], [c, ca, bc], [ab, bc, ca]]);
        }
        triangles = finer;
    }
    let positions = directions.into_iter().map(|direction| shape.radius * direction).collect();
    TriMesh { positions, triangles, ..TriMesh::default() }
}

fn sphere(shape: &SphereMesh) -> TriMesh {
    use std::f64::consts::{PI, TAU};
    let [around, across] = shape.segments;
    let mut positions = vec![DVec3::Z * shape.radius];
    for row in 1..across {
        let polar = PI * f64::from(row) / f64::from(across);
        let (height, ring) = (libm::cos(polar), libm::sin(polar));
        positions.extend((0..around).map(|column| {
            let longitude = TAU * f64::from(column) / f64::from(around);
            shape.radius * DVec3::new(ring * libm::cos(longitude), ring * libm::sin(longitude), height)
        }));
    }
    positions.push(DVec3::NEG_Z * shape.radius);
    let south = (positions.len() - 1) as u32;
    let at = |row: u32, column: u32| 1 + (row - 1) * around + column % around;
    let mut triangles = Vec::with_capacity(2 * (around * (across - 1)) as usize);
    for column in 0..around {
        triangles.push([0, at(1, column), at(1, column + 1)]);
    }
    for row in 1..across - 1 {
        for column in 0..around {
            let quad = [at(row, column), at(row + 1, column), at(row + 1, column + 1), at(row, column + 1)];
            triangles.extend([[quad[0], quad[1], quad[2]], [quad[0], quad[2], quad[3]]]);
        }
    }
    for column in 0..around {
        triangles.push([at(across - 1, column), south, at(across - 1, column + 1)]);
    }
    TriMesh { positions, triangles, ..TriMesh::default() }
}

fn box_mesh(shape: &BoxMesh) -> TriMesh {
    let half_extents = DVec3::from_array(shape.half_extents);
    let segments = shape.segments;
    let mut positions = Vec::new();
    let mut vertices: HashMap<[u32; 3], u32> = HashMap::new();
    let mut vertex = |cell: [u32; 3]| {
        *vertices.entry(cell).or_insert_with(|| {
            let share = |axis: usize| 2.0 * f64::from(cell[axis]) / f64::from(segments[axis]) - 1.0;
            positions.push(half_extents * DVec3::new(share(0), share(1), share(2)));
            (positions.len() - 1) as u32
        })
    };
    let mut triangles = Vec::new();
    for axis in 0..3 {
        let [right, up] = [(axis + 1) % 3, (axis + 2) % 3];
        for side in [0, segments[axis]] {
            for row in 0..segments[up] {
                for column in 0..segments[right] {
                    let mut corner = |across: u32, along: u32| {
                        let mut cell = [0; 3];
                        cell[axis] = side;
                        cell[right] = column + across;
                        cell[up] = row + along;
                        vertex(cell)
                    };
                    let quad = [corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1)];
                    // Right, up and the axis are right-handed, so the quad faces along the axis: outside on the far side only.
                    let [a, b, c, d] = if side == 0 { [quad[0], quad[3], quad[2], quad[1]] } else { quad };
                    // The diagonals of neighboring quads cross, so that no direction on the face is favored.
                    if (row + column) % 2 == 0 {
                        triangles.extend([[a, b, c], [a, c, d]]);
                    } else {
                        triangles.extend([[b, c, d], [b, d, a]]);
                    }
                }
            }
        }
    }
    TriMesh { positions, triangles, ..TriMesh::default() }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn volume(mesh: &TriMesh) -> f64 {
        let corner = |index: u32| mesh.positions[index as usize];
        mesh.triangles.iter().map(|&[a, b, c]| corner(a).dot(corner(b).cross(corner(c))) / 6.0).sum()
    }

    /// Every directed edge has its opposite exactly once.
    fn is_closed(mesh: &TriMesh) -> bool {
        let mut edges = HashMap::new();
        for &[a, b, c] in &mesh.triangles {
            for edge in [[a, b], [b, c], [c, a]] {
                *edges.entry(edge).or_insert(0) += 1;
            }
        }
        edges.iter().all(|(&[a, b], &count)| count == 1 && edges.contains_key(&[b, a]))
    }

    // Reference volumes were computed independently; the sums round at the 1e-14 level.
    const TOLERANCE: f64 = 1e-12;

    #[test]
    fn icosphere_has_the_reference_volume() {
        let volumes = [(1, 3.658712208512160), (4, 4.179738947994641), (5, 4.186524949278792)];
        for (subdivisions, expected) in volumes {
            let mesh = icosphere(&Icosphere { radius: 1.0, subdivisions });
            assert_eq!(mesh.triangles.len(), 20 << (2 * subdivisions));
            assert!(is_closed(&mesh));
            assert!((volume(&mesh) - expected).abs() < TOLERANCE, "{subdivisions}: {}", volume(&mesh));
        }
    }

    #[test]
    fn sphere_has_the_reference_volume() {
        let mesh = sphere(&SphereMesh { radius: 1.0, segments: [80, 71] });
        assert_eq!(mesh.triangles.len(), 11_200);
        assert!(is_closed(&mesh));
        assert!((volume(&mesh) - 4.182437273960657).abs() < TOLERANCE, "{}", volume(&mesh));
    }

    #[test]
    fn coarsest_sphere_is_closed() {
        let mesh = sphere(&SphereMesh { radius: 1.0, segments: [3, 2] });
        assert_eq!(mesh.triangles.len(), 6);
        assert!(is_closed(&mesh) && volume(&mesh) > 0.0);
    }

    #[test]
    fn box_is_closed_and_exact() {
        let mesh = box_mesh(&BoxMesh { half_extents: [1.0, 0.5, 2.0], segments: [4, 3, 5] });
        assert_eq!(mesh.triangles.len(), 4 * (4 * 3 + 3 * 5 + 5 * 4));
        assert!(is_closed(&mesh));
        assert!((volume(&mesh) - 8.0).abs() < TOLERANCE);
    }
}
