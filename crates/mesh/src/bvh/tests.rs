use glam::{DVec3, dvec3};
use parry3d_f64::math::Vector;
use parry3d_f64::query::PointQuery;
use parry3d_f64::shape::TriMesh as ParryMesh;
use proptest::prelude::*;

use super::*;
use crate::TriMesh;
use crate::primitives::{box_mesh, icosphere};

fn bvh(mesh: &TriMesh) -> Bvh {
    Bvh::new(&mesh.positions, &mesh.triangles).unwrap()
}

fn parry(mesh: &TriMesh) -> ParryMesh {
    let points = mesh.positions.iter().map(|p| Vector::new(p.x, p.y, p.z)).collect();
    ParryMesh::new(points, mesh.triangles.clone()).unwrap()
}

fn point(reach: f64) -> impl Strategy<Value = DVec3> {
    prop::array::uniform3(-reach..reach).prop_map(DVec3::from_array)
}

proptest! {
    #[test]
    fn closest_point_agrees_with_parry(p in point(2.0), offset in prop::sample::select(vec![0.0, 1e5])) {
        let mut mesh = icosphere(1.0, 2);
        for (i, position) in mesh.positions.iter_mut().enumerate() {
            *position = *position * (1.0 + 0.3 * (i as f64 * 0.618_034).fract()) + offset;
        }
        let p = p + offset;
        let found = bvh(&mesh).closest_point(p);
        let other = parry(&mesh).project_local_point(Vector::new(p.x, p.y, p.z), false).point;
        let expected = p.distance(dvec3(other.x, other.y, other.z));
        // Both implementations round coordinates of size `offset` a few times.
        let error = 1e-15 * (4.0 + 16.0 * offset);
        prop_assert!((found.distance - expected).abs() < error, "{} {expected}", found.distance);
        prop_assert!((p.distance(found.point) - found.distance).abs() < error);

        // The feature contains the point.
        let corners = mesh.corners(found.triangle as usize);
        match found.feature {
            Feature::Face => {
                let [a, b, c] = corners;
                let normal = (b - a).cross(c - a).normalize();
                prop_assert!((found.point - a).dot(normal).abs() < error);
                prop_assert!((p - found.point).cross(normal).length() < 10.0 * error);
            }
            Feature::Edge(k) => {
                let (from, to) = (corners[k as usize], corners[(k as usize + 1) % 3]);
                let along = from.distance(found.point) + found.point.distance(to);
                prop_assert!((along - from.distance(to)).abs() < error);
            }
            Feature::Vertex(k) => prop_assert!(found.point.distance(corners[k as usize]) < error),
        }
    }

    #[test]
    fn guess_does_not_change_the_distance(p in point(3.0), guess in 0..320_u32) {
        let bvh = bvh(&icosphere(1.0, 2));
        let p = bvh.frame().to_unit(p);
        prop_assert_eq!(bvh.nearest(p, None).squared, bvh.nearest(p, Some(guess)).squared);
    }
}

#[test]
fn features_of_a_box() {
    let bvh = bvh(&box_mesh(dvec3(1.0, 1.0, 1.0), [1, 1, 1]));
    let feature = |p: DVec3| bvh.closest_point(p).feature;
    assert_eq!(feature(dvec3(0.5, 0.2, 2.0)), Feature::Face);
    assert!(matches!(feature(dvec3(0.5, 2.0, 2.0)), Feature::Edge(_)));
    assert!(matches!(feature(dvec3(2.0, 2.0, 2.0)), Feature::Vertex(_)));
    assert!((bvh.closest_point(dvec3(2.0, 2.0, 1.0)).distance - 2f64.sqrt()).abs() < 1e-15);
}

#[test]
fn slivers_and_triangles_without_area_are_found() {
    let (a, b) = (dvec3(-1.0, 0.0, 0.0), dvec3(1.0, 0.0, 0.0));
    for height in [0.0, 1e-300, 1e-16, 1e-9, 1e-5, 1e-3] {
        for third in [dvec3(0.3, height, 0.0), dvec3(3.0, height, 0.0)] {
            let bvh = Bvh::new(&[a, b, third], &[[0, 1, 2]]).unwrap();
            for p in [dvec3(0.2, -1.0, 0.5), dvec3(0.2, 0.5 * height, 1.0), dvec3(0.31, 2.0, -0.1)] {
                let found = bvh.closest_point(p);
                // The triangle is within its height of a segment of the x axis.
                let on_axis = p.x.clamp(-1.0, third.x.max(1.0));
                let expected = p.distance(dvec3(on_axis, 0.0, 0.0));
                assert!((found.distance - expected).abs() <= 1e-14 + height, "height {height} at {p}: {found:?}");
            }
        }
    }
    let same = Bvh::new(&[a], &[[0, 0, 0]]).unwrap().closest_point(b);
    assert_eq!((same.distance, same.point), (2.0, a));
}

#[test]
fn extreme_sizes_are_searched() {
    for scale in [1e-300, 1e-100, 1e100, 1e300] {
        let mut mesh = icosphere(1.0, 1);
        mesh.positions.iter_mut().for_each(|p| *p *= scale);
        let found = bvh(&mesh).closest_point(mesh.positions[5] * 1.5);
        assert!((found.distance / scale - 0.5).abs() < 1e-14, "{scale}: {found:?}");
    }
}

#[test]
fn many_equal_triangles_are_searched() {
    let mesh = TriMesh::new(vec![DVec3::ZERO, DVec3::X, DVec3::Y], vec![[0, 1, 2]; 1000]);
    assert_eq!(bvh(&mesh).closest_point(dvec3(0.2, 0.2, 3.0)).distance, 3.0);
}
