use glam::dvec3;

use super::*;
use crate::primitives::{box_mesh, icosphere};
use crate::{DistanceField, DistanceFieldOptions, NoProgress, Padding};

fn field(mesh: &TriMesh, resolution: usize) -> DistanceField {
    let options = DistanceFieldOptions { resolution, padding: Padding::Cells(2), ..Default::default() };
    DistanceField::new(mesh, &options, &NoProgress).unwrap()
}

/// Compares the signs of all nodes off the surface with winding numbers of single points. Returns
/// the number of nodes compared.
fn compare_signs(mesh: &TriMesh, field: &DistanceField) -> usize {
    let winding_number = WindingNumber::new(Arc::new(Bvh::new(&mesh.positions, &mesh.triangles).unwrap()));
    let mut compared = 0;
    for (index, &sample) in field.samples().iter().enumerate() {
        let node = field.grid().node_at(index);
        let number = winding_number.at(node, 0.0);
        // On the mesh, up to rounding, the winding number jumps. Near one half, the rounding of
        // thousands of angles decides.
        if sample.abs() > 1e-12 && (number - 0.5).abs() > 1e-12 {
            assert_eq!(sample < 0.0, number > 0.5, "node {index} at {node}: {number}");
            compared += 1;
        }
    }
    compared
}

#[test]
fn counts_rows_along_faces_edges_and_vertices() {
    // With 8 cells per side, rows run within faces, along edges and through vertices, also of
    // triangles parallel to the rows.
    for segments in [[1, 1, 1], [2, 4, 8], [3, 5, 7]] {
        let mesh = box_mesh(DVec3::ONE, segments);
        let field = field(&mesh, 8);
        assert!(compare_signs(&mesh, &field) > 13 * 13 * 13 - 9 * 9 * 9);
        let inside = field.samples().iter().filter(|&&sample| sample < -1e-12).count();
        assert_eq!(inside, 7 * 7 * 7, "nodes strictly inside");
    }
}

#[test]
fn counts_rows_across_rotated_and_curved_surfaces() {
    for degrees in [0.0_f64, 30.0, 45.0, 90.0] {
        let (sin, cos) = (libm::sin(degrees.to_radians()), libm::cos(degrees.to_radians()));
        let mut mesh = box_mesh(dvec3(1.0, 0.5, 0.75), [3, 2, 5]);
        for p in &mut mesh.positions {
            *p = dvec3(p.x, cos * p.y - sin * p.z, sin * p.y + cos * p.z);
        }
        let compared = compare_signs(&mesh, &field(&mesh, 16));
        assert!(compared > 16 * 8 * 12);
    }
    let sphere = icosphere(1.0, 3);
    assert!(compare_signs(&sphere, &field(&sphere, 20)) > 20 * 20 * 20);
}

#[test]
fn signs_of_open_surfaces_follow_the_winding_number() {
    // Nodes are in the plane of the hole, which contains its patch.
    let mut open_box = box_mesh(DVec3::ONE, [4, 4, 4]);
    open_box.triangles.retain(|t| !t.iter().all(|&v| open_box.positions[v as usize].z == 1.0));
    let mut bowl = icosphere(1.0, 3);
    bowl.triangles.retain(|t| t.iter().all(|&v| bowl.positions[v as usize].z < 0.3));
    let mut sieve = icosphere(1.0, 4);
    let mut number = 0;
    sieve.triangles.retain(|_| {
        number += 1;
        number % 17 != 0
    });
    // A fan of three sheets on one edge is not a manifold, but has a winding number.
    let sheets = TriMesh::new(
        vec![DVec3::ZERO, DVec3::Z, DVec3::X, dvec3(-0.5, 0.8, 0.3), dvec3(-0.5, -0.9, 0.2)],
        vec![[0, 1, 2], [0, 1, 3], [1, 0, 4]],
    );
    for mesh in [open_box, bowl, sieve, sheets] {
        let field = field(&mesh, 16);
        assert!(!field.is_closed());
        assert!(compare_signs(&mesh, &field) > field.samples().len() / 2);
    }
}
