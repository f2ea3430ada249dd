use glam::dvec3;
use parry3d_f64::math::Vector;
use parry3d_f64::query::PointQuery;
use parry3d_f64::shape::{TriMesh as ParryMesh, TriMeshFlags};
use proptest::prelude::*;

use super::*;
use crate::NoProgress;
use crate::primitives::{box_mesh, icosphere};

fn distance(mesh: &TriMesh) -> MeshDistance {
    MeshDistance::new(mesh, &NoProgress).unwrap()
}

/// A shape with spikes and dents: convex and concave sharp edges.
fn spiky() -> TriMesh {
    let mut mesh = icosphere(1.0, 2);
    for (i, p) in mesh.positions.iter_mut().enumerate() {
        *p *= 0.3 + (i as f64 * 0.618_034).fract();
    }
    mesh
}

fn point() -> impl Strategy<Value = DVec3> {
    prop::array::uniform3(-1.5..1.5_f64).prop_map(DVec3::from_array)
}

proptest! {
    #[test]
    fn pseudo_normals_agree_with_winding_numbers_and_parry(p in point()) {
        let mesh = spiky();
        let fast = distance(&mesh);
        prop_assert!(fast.uses_pseudo_normals());
        let (value, gradient) = fast.sample(p);
        let winding_number = WindingNumber::new(fast.bvh.clone());
        prop_assert_eq!(value < 0.0, winding_number.is_inside(p));

        let points = mesh.positions.iter().map(|p| Vector::new(p.x, p.y, p.z)).collect();
        let other = ParryMesh::with_flags(points, mesh.triangles.clone(), TriMeshFlags::ORIENTED).unwrap();
        let projection = other.project_local_point(Vector::new(p.x, p.y, p.z), false);
        prop_assert_eq!(value < 0.0, projection.is_inside);
        // Rounding of coordinates of size 1.5.
        prop_assert!((value.abs() - p.distance(dvec3(projection.point.x, projection.point.y, projection.point.z))).abs() < 1e-14);
        // The nearest point is the step down the gradient.
        prop_assert!(fast.sample(p - value * gradient).0.abs() < 1e-14);
    }

    #[test]
    fn triangles_without_area_do_not_flip_signs(p in point(), edge in 0..30_usize) {
        // A vertex in the middle of an edge. One side uses its two halves, the other a triangle
        // without area. So nearest points on that edge belong to several features with different
        // normals.
        let mut mesh = box_mesh(dvec3(1.0, 0.05, 0.6), [1, 1, 1]);
        let [a, b, c] = mesh.triangles[edge % mesh.triangles.len()];
        let middle = mesh.positions.len() as u32;
        mesh.positions.push(mesh.positions[a as usize].midpoint(mesh.positions[b as usize]));
        mesh.triangles[edge % 12] = [a, middle, c];
        mesh.triangles.extend([[middle, b, c], [a, b, middle]]);
        let distance = distance(&mesh);
        prop_assert!(!distance.uses_pseudo_normals());
        let is_inside = p.abs().cmplt(dvec3(1.0, 0.05, 0.6)).all();
        prop_assert_eq!(distance.sample(p).0 < 0.0, is_inside);
        prop_assert_eq!(distance.is_inside(p), is_inside);
    }

    #[test]
    fn thin_walls_keep_their_signs(x in -1.2..1.2_f64, y in -1.0..1.0_f64, z in -0.8..0.8_f64) {
        // A plate so thin that both faces are almost equally near from everywhere.
        let half = dvec3(1.0, 1e-9, 0.6);
        let distance = distance(&box_mesh(half, [3, 1, 2]));
        for p in [dvec3(x, y, z), dvec3(x, 1e-9 * y, z), dvec3(x, 3e-9 * y, z)] {
            prop_assert_eq!(distance.is_inside(p), p.abs().cmplt(half).all(), "{}", p);
        }
    }
}

#[test]
fn distance_is_zero_on_vertices_edges_and_faces() {
    let mesh = spiky();
    let distance = distance(&mesh);
    for t in 0..mesh.triangles.len() {
        let [a, b, c] = mesh.corners(t);
        for p in [a, a.midpoint(b), (a + b + c) / 3.0] {
            let (value, gradient) = distance.sample(p);
            assert!(value.abs() < 1e-15 && !gradient.is_nan());
        }
    }
}

#[test]
fn crossing_nested_and_open_meshes_use_the_winding_number() {
    let sphere = icosphere(1.0, 2);
    let count = sphere.positions.len() as u32;
    let twice = |map: &dyn Fn(DVec3) -> DVec3| {
        let positions = sphere.positions.iter().copied().chain(sphere.positions.iter().map(|&p| map(p))).collect();
        let again = sphere.triangles.iter().map(|t| t.map(|v| v + count));
        TriMesh::new(positions, sphere.triangles.iter().copied().chain(again).collect())
    };
    let mut open = sphere.clone();
    open.triangles.pop();
    for mesh in [twice(&|p| p + DVec3::X), twice(&|p| 0.5 * p), open] {
        let distance = distance(&mesh);
        assert!(!distance.uses_pseudo_normals());
        // Next to the inner surface of the nested pair, the nearest feature alone would say
        // outside.
        assert!(distance.sample(dvec3(0.55, 0.0, 0.0)).0 < 0.0);
        assert!(distance.sample(dvec3(-1.1, 0.0, 0.0)).0 > 0.0);
    }
}

#[test]
fn centroid_is_that_of_the_volume_or_the_area() {
    let half = dvec3(1.0, 0.5, 0.25);
    let shift = dvec3(1e6, 2e6, 3e6);
    let mut mesh = box_mesh(half, [2, 2, 2]);
    mesh.positions.iter_mut().for_each(|p| *p += shift);
    // Rounding of coordinates of 3e6.
    assert!(distance(&mesh).centroid().distance(shift) < 1e-9);
    // Without the face at z = 0.25: areas and their centroids computed by hand.
    mesh.triangles.retain(|t| !t.iter().all(|&v| mesh.positions[v as usize].z == shift.z + 0.25));
    let (bottom, sides) = (2.0 * 1.0, 2.0 * (2.0 + 1.0) * 0.5);
    let height = -0.25 * bottom / (bottom + sides);
    assert!(distance(&mesh).centroid().distance(shift + dvec3(0.0, 0.0, height)) < 1e-9);
}
