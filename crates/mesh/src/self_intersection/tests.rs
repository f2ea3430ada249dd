use glam::{DVec3, dvec3};
use parry3d_f64::math::{Pose, Vector};
use parry3d_f64::query;
use parry3d_f64::shape::Triangle;
use proptest::prelude::*;

use super::*;
use crate::{NoProgress, primitives::icosphere};

fn pairs(positions: &[[f64; 3]], triangles: &[[u32; 3]]) -> Vec<[u32; 2]> {
    let mesh = TriMesh::new(positions.iter().map(|&p| DVec3::from_array(p)).collect(), triangles.to_vec());
    SelfIntersections::of(&mesh, &NoProgress).unwrap().pairs().to_vec()
}

/// Two triangles without common indices.
fn two(a: [[f64; 3]; 3], b: [[f64; 3]; 3]) -> bool {
    !pairs(&[a, b].concat(), &[[0, 1, 2], [3, 4, 5]]).is_empty()
}

const FLAT: [[f64; 3]; 3] = [[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [0.0, 2.0, 0.0]];

#[test]
fn contacts_of_separate_triangles_count() {
    assert!(two(FLAT, [[0.5, 0.5, -1.0], [0.5, 0.5, 1.0], [3.0, 3.0, 0.0]]), "piercing");
    assert!(two(FLAT, [[0.5, 0.5, 0.0], [0.5, 0.5, 1.0], [1.0, 0.5, 1.0]]), "touching with a corner");
    assert!(two(FLAT, [[1.0, -1.0, 0.0], [1.0, 1.0, 0.0], [3.0, 0.0, 0.0]]), "overlapping in one plane");
    assert!(two(FLAT, [[0.2, 0.2, 0.0], [0.4, 0.2, 0.0], [0.2, 0.4, 0.0]]), "one inside the other in one plane");
    assert!(two(FLAT, [[1.0, 0.0, 0.0], [3.0, 0.0, 0.0], [2.0, -1.0, 0.0]]), "along an edge in one plane");
    assert!(!two(FLAT, [[0.5, 0.5, 1e-300], [0.5, 0.5, 1.0], [1.0, 0.5, 1.0]]), "slightly above the plane");
    assert!(!two(FLAT, [[1.5, 1.5, 0.0], [3.0, 1.5, 0.0], [1.5, 3.0, 0.0]]), "side by side in one plane");
}

#[test]
fn triangles_with_a_common_edge_intersect_if_folded() {
    let fold = |apex: [f64; 3]| !pairs(&[FLAT[0], FLAT[1], FLAT[2], apex], &[[0, 1, 2], [1, 0, 3]]).is_empty();
    assert!(fold([0.3, 1.0, 0.0]));
    assert!(fold([5.0, 5.0, 0.0]));
    assert!(!fold([0.3, -1.0, 0.0]));
    // Folded back almost onto the other triangle, but not in its plane.
    assert!(!fold([0.3, 1.0, 1e-17]));
}

#[test]
fn triangles_with_a_common_vertex_intersect_if_they_meet_elsewhere() {
    let fan = |p: [f64; 3], q: [f64; 3]| !pairs(&[FLAT[0], FLAT[1], FLAT[2], p, q], &[[0, 1, 2], [0, 3, 4]]).is_empty();
    assert!(fan([1.0, 0.5, -1.0], [0.5, 1.0, 1.0]), "piercing");
    assert!(fan([0.5, 0.1, 0.0], [0.1, 0.5, 0.0]), "inside, in one plane");
    assert!(fan([9.0, 1.0, 0.0], [1.0, 9.0, 0.0]), "across, in one plane");
    assert!(!fan([-1.0, -0.5, 0.0], [-0.5, -1.0, 0.0]), "opposite, in one plane");
    assert!(!fan([1.0, 0.5, 1.0], [0.5, 1.0, 1.0]), "above");
}

#[test]
fn split_vertices_count_as_one() {
    assert!(!two(FLAT, [FLAT[1], FLAT[0], [1.0, -1.0, 0.5]]));
    assert!(!two(FLAT, [FLAT[1], [3.0, 0.0, 0.5], [3.0, 1.0, 0.5]]));
    assert!(two(FLAT, FLAT), "twice the same triangle");
}

#[test]
fn ignores_triangles_without_area() {
    assert!(!two(FLAT, [[0.5, 0.5, -1.0], [0.5, 0.5, 1.0], [0.5, 0.5, 3.0]]));
    assert!(!two(FLAT, [[0.5, 0.5, -1.0], [0.5, 0.5, 1.0], [0.5, 0.5, 1.0]]));
}

#[test]
fn interpenetrating_spheres_intersect_in_a_band() {
    let sphere = icosphere(1.0, 3);
    assert!(SelfIntersections::of(&sphere, &NoProgress).unwrap().is_empty());
    let shift = dvec3(0.7, 0.1, 0.05);
    let count = sphere.positions.len() as u32;
    let mesh = TriMesh::new(
        sphere.positions.iter().copied().chain(sphere.positions.iter().map(|&p| p + shift)).collect(),
        sphere.triangles.iter().copied().chain(sphere.triangles.iter().map(|t| t.map(|v| v + count))).collect(),
    );
    let found = SelfIntersections::of(&mesh, &NoProgress).unwrap();

    // Slow reference: all pairs, with distances by another library. A pair nearer than the rounding
    // of that library would be undecided, but does not occur.
    let triangle = |t: usize| {
        let [a, b, c] = mesh.corners(t).map(|p| Vector::new(p.x, p.y, p.z));
        Triangle::new(a, b, c)
    };
    let half = sphere.triangles.len();
    let mut expected = Vec::new();
    for a in 0..half {
        for b in half..2 * half {
            let apart =
                query::distance(&Pose::identity(), &triangle(a), &Pose::identity(), &triangle(b)).unwrap().distance;
            if apart == 0.0 {
                expected.push([a as u32, b as u32]);
            } else {
                assert!(apart > 1e-9);
            }
        }
    }
    assert!(expected.len() > 50);
    assert_eq!(found.pairs(), expected);

    // The band is about as wide as a triangle and as long as the intersection circle of the
    // spheres.
    let circle = 2.0 * std::f64::consts::PI * (1.0 - 0.25 * shift.length_squared()).sqrt();
    let area = found.area(&mesh);
    assert!(area > 0.05 * circle && area < 0.5 * circle, "{area}");
}

#[test]
fn same_pairs_for_any_number_of_threads() {
    let mut mesh = icosphere(1.0, 4);
    for (i, p) in mesh.positions.iter_mut().enumerate() {
        *p += 0.15 * dvec3(i as f64 * 0.618_034, i as f64 * 0.414_214, i as f64 * 0.732_051).fract();
    }
    let with = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| SelfIntersections::of(&mesh, &NoProgress).unwrap())
    };
    let one = with(1);
    assert!(!one.is_empty());
    assert_eq!(one, with(2));
    assert_eq!(one, with(8));
}

#[test]
fn stops_when_cancelled() {
    struct Stop;
    impl Monitor for Stop {
        fn is_cancelled(&self) -> bool {
            true
        }
    }
    let result = SelfIntersections::of(&icosphere(1.0, 2), &Stop);
    assert_eq!(result, Err(SelfIntersectionError::Cancelled(Cancelled)));
}

#[test]
fn one_pair_at_any_scale() {
    let piercing = [[0.5, 0.5, -1.0], [0.5, 0.5, 1.0], [3.0, 3.0, 0.0]];
    let above = [[0.5, 0.5, 1e-9], [0.5, 0.5, 1.0], [1.0, 0.5, 1.0]];
    // The products of three lengths overflow or underflow in the end cases.
    for scale in [1e-150, 1e-9, 1.0, 1e9, 1e150] {
        let at = |triangle: [[f64; 3]; 3]| triangle.map(|corner| scale * DVec3::from_array(corner));
        assert!(triangles_intersect(at(FLAT), at(piercing)), "{scale}");
        assert!(!triangles_intersect(at(FLAT), at(above)), "{scale}");
    }
    let nowhere = [DVec3::NAN, DVec3::INFINITY, DVec3::ZERO];
    assert!(!triangles_intersect(FLAT.map(DVec3::from_array), nowhere));
    assert!(!triangles_intersect(nowhere, nowhere));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]
    #[test]
    fn one_pair_agrees_with_the_search(
        coordinates in prop::array::uniform18(-2..=2_i64),
        shift in prop::array::uniform18(-1.0..1.0_f64),
        common in 0..=3_usize,
        spread in prop::sample::select(vec![0.0, 1e-300, 1e-16, 1e-3, 1.0]),
    ) {
        // Corners on a small lattice coincide, are collinear or coplanar; shifted ones nearly so.
        let corner = |i: usize| {
            DVec3::from_array(std::array::from_fn(|axis| {
                coordinates[3 * i + axis] as f64 + spread * shift[3 * i + axis]
            }))
        };
        let first = [corner(0), corner(1), corner(2)];
        let mut second = [corner(3), corner(4), corner(5)];
        second[..common].copy_from_slice(&first[3 - common..]);
        second.rotate_left(coordinates[0].rem_euclid(3) as usize);
        let mesh = TriMesh::new([first, second].concat(), vec![[0, 1, 2], [3, 4, 5]]);
        let found = SelfIntersections::of(&mesh, &NoProgress).unwrap();
        prop_assert_eq!(triangles_intersect(first, second), !found.is_empty());
        prop_assert_eq!(triangles_intersect(second, first), !found.is_empty());
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(500))]
    #[test]
    fn patch_agrees_with_single_pairs(
        coordinates in prop::collection::vec((-2..=2_i64, -2..=2_i64, -2..=2_i64), 9..60),
        patch in 1..4_usize,
        near in 0..20_usize,
        spread in prop::sample::select(vec![0.0, 1e-16, 1e-3, 1.0]),
        scale in prop::sample::select(vec![1e-200, 1.0, 1e12, 1e200]),
    ) {
        // Most lattice points are far from the patch, so that patches without crossings occur.
        let corner = |(i, &(x, y, z)): (usize, &(i64, i64, i64))| {
            let jitter = |k: f64| spread * ((i as f64 + 1.0) * k).fract();
            let point = dvec3(x as f64 + jitter(0.618), y as f64 + jitter(0.414), z as f64 + jitter(0.732));
            scale * (point + if i < near { 0.0 } else { 3.0 * i as f64 })
        };
        let points: Vec<DVec3> = coordinates.iter().enumerate().map(corner).collect();
        let triangles: Vec<[DVec3; 3]> = points.chunks_exact(3).map(|c| [c[0], c[1], c[2]]).collect();
        let (patch, surroundings) = triangles.split_at(patch.min(triangles.len()));
        let expected = (0..patch.len()).any(|i| {
            patch[i + 1..].iter().chain(surroundings).any(|&other| triangles_intersect(patch[i], other))
        });
        prop_assert_eq!(patch_intersects(patch, surroundings), expected);
    }
}

#[test]
fn coarse_surroundings_of_a_patch_do_not_overflow() {
    let patch = [FLAT.map(|corner| 1e-3 * DVec3::from_array(corner))];
    for size in [1e3, 1e6, 1e9, 1e30, 1e90] {
        let floor = |z: f64| [dvec3(-size, -size, z), dvec3(size, -size, z), dvec3(0.0, size, z)];
        assert!(!patch_intersects(&patch, &[floor(-1e-4)]), "{size}");
        assert!(patch_intersects(&patch, &[floor(0.0)]), "{size}");
    }
    assert!(!patch_intersects(&[], &patch));
    assert!(!patch_intersects(&patch, &[]));
}

proptest! {
    #[test]
    fn agrees_with_exact_integers(coordinates in prop::array::uniform18(-2..=2_i64)) {
        // On a small lattice all kinds of contact are common, and integer determinants are exact.
        let corner = |i: usize| [coordinates[3 * i], coordinates[3 * i + 1], coordinates[3 * i + 2]];
        let triangles = [[corner(0), corner(1), corner(2)], [corner(3), corner(4), corner(5)]];
        let shares = triangles[0].iter().any(|p| triangles[1].contains(p));
        let flat = triangles.iter().any(|t| integers::normal(t) == [0; 3]);
        prop_assume!(!shares && !flat);
        let real = triangles.map(|t| t.map(|p| p.map(|x| x as f64)));
        prop_assert_eq!(two(real[0], real[1]), integers::have_common_point(&triangles));
    }
}

/// Reference for triangles with integer corners, by separation instead of intersection. Convex
/// bodies are disjoint exactly if a plane is strictly between them, and for triangles a few normals
/// suffice.
mod integers {
    type Point = [i64; 3];

    fn minus(a: Point, b: Point) -> Point {
        [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
    }

    fn cross(a: Point, b: Point) -> Point {
        [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
    }

    fn dot(a: Point, b: Point) -> i64 {
        a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
    }

    pub(super) fn normal(t: &[Point; 3]) -> Point {
        cross(minus(t[1], t[0]), minus(t[2], t[0]))
    }

    pub(super) fn have_common_point(triangles: &[[Point; 3]; 2]) -> bool {
        let normals = triangles.map(|t| normal(&t));
        let edges = |t: &[Point; 3]| [minus(t[1], t[0]), minus(t[2], t[1]), minus(t[0], t[2])];
        let mut axes = normals.to_vec();
        for edge in edges(&triangles[0]) {
            axes.extend(edges(&triangles[1]).map(|other| cross(edge, other)));
        }
        for (t, normal) in triangles.iter().zip(normals) {
            axes.extend(edges(t).map(|edge| cross(edge, normal)));
        }
        !axes.into_iter().any(|axis| {
            let [first, second] = triangles.map(|t| t.map(|p| dot(p, axis)));
            let (low, high) = (|v: [i64; 3]| *v.iter().min().unwrap(), |v: [i64; 3]| *v.iter().max().unwrap());
            high(first) < low(second) || high(second) < low(first)
        })
    }
}
