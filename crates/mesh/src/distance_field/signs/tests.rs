use glam::dvec3;

use super::*;
use crate::primitives::{box_mesh, icosphere};
use crate::{DistanceField, DistanceFieldOptions, NoProgress, Padding};

fn field(mesh: &TriMesh, resolution: usize) -> DistanceField {
    let options = DistanceFieldOptions { resolution, padding: Padding::Cells(2), ..Default::default() };
    DistanceField::new(mesh, &options, &NoProgress).unwrap()
}

/// Compares all signs, but those of nodes on the surface, with winding numbers of single points; says how many were compared.
fn judge(mesh: &TriMesh, field: &DistanceField) -> usize {
    let winding_number = WindingNumber::new(Arc::new(Bvh::new(&mesh.positions, &mesh.triangles).unwrap()));
    let mut judged = 0;
    for (index, &sample) in field.samples().iter().enumerate() {
        let node = field.grid().node_at(index);
        let number = winding_number.at(node, 0.0);
        // On the mesh, to rounding, the number jumps, and where it is one half the rounding of thousands of angles decides.
        if sample.abs() > 1e-12 && (number - 0.5).abs() > 1e-12 {
            assert_eq!(sample < 0.0, number > 0.5, "node {index} at {node}: {number}");
            judged += 1;
        }
    }
    judged
}

#[test]
fn rows_along_faces_edges_and_vertices_are_counted_right() {
    // 8 cells a side: rows run in the faces, along the edges and through vertices, of triangles that look along the rows too.
    for segments in [[1, 1, 1], [2, 4, 8], [3, 5, 7]] {
        let mesh = box_mesh(DVec3::ONE, segments);
        let field = field(&mesh, 8);
        assert!(judge(&mesh, &field) > 13 * 13 * 13 - 9 * 9 * 9);
        let inside = field.samples().iter().filter(|&&sample| sample < -1e-12).count();
        assert_eq!(inside, 7 * 7 * 7, "nodes strictly inside");
    }
}

#[test]
fn turned_and_bent_surfaces_are_counted_right() {
    for degrees in [0.0_f64, 30.0, 45.0, 90.0] {
        let (sin, cos) = (libm::sin(degrees.to_radians()), libm::cos(degrees.to_radians()));
        let mut mesh = box_mesh(dvec3(1.0, 0.5, 0.75), [3, 2, 5]);
        for p in &mut mesh.positions {
            *p = dvec3(p.x, cos * p.y - sin * p.z, sin * p.y + cos * p.z);
        }
        let judged = judge(&mesh, &field(&mesh, 16));
        assert!(judged > 16 * 8 * 12);
    }
    let sphere = icosphere(1.0, 3);
    assert!(judge(&sphere, &field(&sphere, 20)) > 20 * 20 * 20);
}

#[test]
fn open_surfaces_are_judged_by_their_winding_number() {
    // Nodes lie in the plane of the hole, where its patch is.
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
    // A fan of three sheets on one edge: no surface at all, and yet a number.
    let sheets = TriMesh::new(
        vec![DVec3::ZERO, DVec3::Z, DVec3::X, dvec3(-0.5, 0.8, 0.3), dvec3(-0.5, -0.9, 0.2)],
        vec![[0, 1, 2], [0, 1, 3], [1, 0, 4]],
    );
    for mesh in [open_box, bowl, sieve, sheets] {
        let field = field(&mesh, 16);
        assert!(!field.is_closed());
        assert!(judge(&mesh, &field) > field.samples().len() / 2);
    }
}
