use glam::dvec3;
use proptest::prelude::*;

use super::*;
use crate::TriMesh;
use crate::primitives::icosphere;

fn moved(mesh: &TriMesh, seed: f64) -> TriMesh {
    let mut mesh = mesh.clone();
    for (i, position) in mesh.positions.iter_mut().enumerate() {
        *position = *position * (1.0 + 0.4 * (seed * i as f64 * 0.618_034).fract()) + dvec3(seed, 0.0, 0.3 * seed);
    }
    mesh
}

/// Brute-force queries over all triangles.
struct Slow<'a>(&'a TriMesh, &'a [bool]);

impl Slow<'_> {
    fn corners(&self, triangle: u32) -> Option<[DVec3; 3]> {
        self.1[triangle as usize].then(|| self.0.corners(triangle as usize))
    }

    fn bounds(&self, triangle: u32) -> Aabb {
        Aabb::of(self.corners(triangle).into_iter().flatten())
    }

    fn closest(&self, point: DVec3) -> f64 {
        let all = (0..self.1.len() as u32).filter_map(|triangle| self.corners(triangle));
        all.map(|corners| crate::bvh::closest_on_triangle(point, &corners).1.sqrt()).fold(f64::INFINITY, f64::min)
    }

    fn assert_agrees(&self, tree: &SurfaceTree, point: DVec3, direction: DVec3) {
        let corners = |triangle| self.corners(triangle);
        let found = tree.closest_point(point, &corners).map_or(f64::INFINITY, |hit| hit.distance);
        // The same arithmetic on the same triangle.
        assert_eq!(found, self.closest(point));

        let mut all: Vec<(f64, u32)> = (0..self.1.len() as u32)
            .filter_map(|triangle| {
                let mut single = SurfaceTree::new(&[], &[]).unwrap();
                single.update(self.1.len(), &[], &|triangle| self.bounds(triangle), &|other| {
                    (other == triangle && self.1[triangle as usize]).then_some([NONE; 3])
                });
                single.cast_ray(point, direction, &corners).map(|hit| (hit.distance, triangle))
            })
            .collect();
        all.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        let hit = tree.cast_ray(point, direction, &corners).map(|hit| (hit.distance, hit.triangle));
        assert_eq!(hit, all.first().copied());

        let all = || 0..self.1.len() as u32;
        let some: Vec<u32> = all().filter(|triangle| triangle % 7 == 3).collect();
        let near = tree.triangles_near(&some);
        assert!(near.is_sorted());
        for triangle in all().filter(|&triangle| self.1[triangle as usize]) {
            let overlaps = |&other: &u32| self.bounds(other).overlaps(self.bounds(triangle));
            assert!(near.binary_search(&triangle).is_ok() || !some.iter().any(overlaps), "triangle {triangle}");
        }

        let bounds = Aabb { min: point - 0.3, max: point + 0.3 };
        let mut near = vec![false; self.1.len()];
        tree.visit_box(bounds, |triangle| near[triangle as usize] = true);
        for triangle in 0..self.1.len() as u32 {
            let is_inside = corners(triangle).is_some_and(|corners| corners.iter().any(|&c| bounds.distance(c) == 0.0));
            assert!(near[triangle as usize] || !is_inside, "triangle {triangle}");
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]
    #[test]
    fn updated_tree_agrees_with_brute_force(
        seed in 0.01..2.0_f64,
        known in 0..320_usize,
        gone in prop::collection::vec(0..320_usize, 0..40),
        point in prop::array::uniform3(-2.0..2.0_f64),
        direction in prop::array::uniform3(-1.0..1.0_f64),
    ) {
        let rest = icosphere(1.0, 2);
        let mut tree = SurfaceTree::new(&rest.positions, &rest.triangles[..known]).unwrap();
        let mut alive = vec![true; rest.triangles.len()];
        {
            let bounds = |triangle: u32| Aabb::of(rest.corners(triangle as usize));
            // Half of them are inserted next to a neighbor, the rest by a search.
            let near = |triangle: u32| if triangle.is_multiple_of(2) { [NONE, triangle.wrapping_sub(1), triangle] } else { [NONE; 3] };
            tree.update(rest.triangles.len(), &[], &bounds, &|triangle| Some(near(triangle)));
        }
        let mesh = moved(&rest, seed);
        gone.into_iter().for_each(|triangle| alive[triangle] = false);
        let slow = Slow(&mesh, &alive);
        let changed: Vec<u32> = (0..rest.triangles.len() as u32).collect();
        let beside = |triangle: u32| alive[triangle as usize].then_some([NONE, triangle + 1, NONE]);
        tree.update(rest.triangles.len(), &changed, &|triangle| slow.bounds(triangle), &beside);
        slow.assert_agrees(&tree, point.into(), direction.into());
        // Removed triangles return at other positions, and all others are removed.
        let gone: Vec<bool> = alive.iter().map(|alive| !alive).collect();
        let elsewhere = moved(&rest, seed + 1.0);
        let back = Slow(&elsewhere, &gone);
        let mut other = tree.clone();
        let beside = |triangle: u32| gone[triangle as usize].then_some([NONE; 3]);
        other.update(rest.triangles.len(), &changed, &|triangle| back.bounds(triangle), &beside);
        back.assert_agrees(&other, point.into(), direction.into());
        // Removed triangles do not enlarge the boxes.
        prop_assert_eq!(other.nodes[0].bounds, Aabb::of((0..320).filter_map(|triangle| back.corners(triangle)).flatten()));
        // Fewer triangles.
        let beside = |triangle: u32| alive[triangle as usize].then_some([NONE; 3]);
        tree.update(200, &[], &|triangle| slow.bounds(triangle), &beside);
        let fewer = TriMesh::new(mesh.positions.clone(), mesh.triangles[..200].to_vec());
        Slow(&fewer, &alive[..200]).assert_agrees(&tree, point.into(), direction.into());
    }
}

#[test]
fn ray_hits_the_near_side_first() {
    let mesh = icosphere(1.0, 3);
    let tree = SurfaceTree::new(&mesh.positions, &mesh.triangles).unwrap();
    let corners = |triangle: u32| Some(mesh.corners(triangle as usize));
    let hit = tree.cast_ray(dvec3(0.1, 0.2, 5.0), dvec3(0.0, 0.0, -2.0), &corners).unwrap();
    // Flat triangles of this size are at most 1.3 % below the sphere.
    assert!((hit.point.length() - 1.0).abs() < 0.013 && hit.point.z > 0.9);
    assert_eq!(tree.cast_ray(dvec3(0.1, 0.2, 5.0), dvec3(0.0, 0.0, 1.0), &corners), None);
    assert_eq!(tree.cast_ray(dvec3(0.1, 0.2, 5.0), DVec3::ZERO, &corners), None);
}
