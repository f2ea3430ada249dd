use glam::dvec3;
use proptest::prelude::*;

use super::*;
use crate::primitives::{box_mesh, icosphere};
use crate::{Bvh, EditMesh, TriMesh};

fn topology(mesh: &TriMesh) -> EditMesh {
    EditMesh::new(&mesh.triangles, mesh.positions.len()).unwrap()
}

proptest! {
    #[test]
    fn finds_the_nearest_point_of_a_ball_from_anywhere(
        start in 0..1280_u32,
        point in prop::array::uniform3(-1.0..1.0_f64),
    ) {
        let mesh = icosphere(1.0, 3);
        let point = 1.5 * DVec3::from_array(point).normalize_or(DVec3::X);
        let foot = SurfaceWalk::new(topology(&mesh).triangles(), &mesh.positions).nearest(start, point, |_| false);
        let nearest = Bvh::new(&mesh.positions, &mesh.triangles).unwrap().closest_point(point);
        // The two are computed in different frames.
        prop_assert!((foot.squared.sqrt() - nearest.distance).abs() < 1e-13);
        prop_assert!(foot.point.distance(nearest.point) < 1e-6);
    }
}

#[test]
fn stays_on_its_side_of_a_barrier_and_of_the_boundary() {
    // A strip of four squares along x, cut between the second and the third.
    let mut mesh = box_mesh(dvec3(2.0, 0.5, 0.5), [4, 1, 1]);
    mesh.triangles.retain(|triangle| triangle.iter().all(|&vertex| mesh.positions[vertex as usize].z > 0.0));
    let topology = topology(&mesh);
    let at = |half_edge: u32| mesh.positions[topology.start(half_edge) as usize].x;
    let is_cut = |half_edge: u32| at(half_edge) == 0.0 && at(next_half_edge(half_edge)) == 0.0;
    let walk = SurfaceWalk::new(topology.triangles(), &mesh.positions);
    let left = (0..8).find(|&triangle| mesh.corners(triangle as usize).iter().all(|corner| corner.x < -0.9)).unwrap();
    // The computed point of a face is off by the rounding of its weights.
    let ends = |goal: DVec3, foot: Foot| assert!(foot.point.distance(goal) < 1e-14, "{} {goal}", foot.point);
    let goal = dvec3(1.3, 0.1, 0.5);
    ends(goal, walk.nearest(left, goal, |_| false));
    ends(dvec3(0.0, 0.1, 0.5), walk.nearest(left, goal, is_cut));
    // Past the boundary.
    ends(dvec3(2.0, 0.5, 0.5), walk.nearest(left, dvec3(5.0, 5.0, 0.5), |_| false));
    // Around a vertex of the cut.
    ends(dvec3(0.0, 0.5, 0.5), walk.nearest(left, dvec3(0.5, 5.0, 0.5), is_cut));
}

#[test]
fn ends_on_triangles_without_area() {
    let positions = vec![DVec3::ZERO, DVec3::X, 2.0 * DVec3::X, DVec3::Y];
    let mesh = TriMesh::new(positions, vec![[0, 1, 2], [1, 0, 3]]);
    let topology = topology(&mesh);
    let walk = SurfaceWalk::new(topology.triangles(), &mesh.positions);
    let foot = walk.nearest(0, dvec3(0.3, 0.3, 1.0), |_| false);
    assert_eq!(foot.triangle, 1);
    assert!((foot.squared - 1.0).abs() < 1e-15);
    assert_eq!(walk.nearest(0, DVec3::NAN, |_| false).triangle, 0);
}
