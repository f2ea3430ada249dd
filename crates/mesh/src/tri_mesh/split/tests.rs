use super::*;
use crate::{ClosedMesh, NoProgress, primitives};

/// Bound of the relative rounding error of the sums below, with a large margin.
const ROUNDING: f64 = 1e-12;

fn uneven() -> TriMesh {
    let mut mesh = primitives::icosphere(1.0, 2);
    for (index, position) in mesh.positions.iter_mut().enumerate() {
        *position *= 1.0 + 0.5 * (index as f64 * 0.618_034).fract();
    }
    mesh
}

#[test]
fn respects_the_longest_edge_and_keeps_the_surface() {
    let mesh = uneven();
    for longest in [2.0, 0.3, 0.1, 0.02] {
        let split = mesh.split_to_length(longest, 10_000_000, &NoProgress).unwrap();
        let fine = mesh.subdivided(&split);
        assert!(ClosedMesh::new(&fine).is_ok(), "{longest}");
        let edges = (0..fine.triangles.len()).flat_map(|triangle| {
            let [a, b, c] = fine.corners(triangle);
            [a.distance(b), b.distance(c), c.distance(a)]
        });
        assert!(edges.fold(0.0, f64::max) <= longest * (1.0 + ROUNDING), "{longest}");
        assert!((fine.volume() - mesh.volume()).abs() < ROUNDING * mesh.volume(), "{longest}");
        assert!((fine.area() - mesh.area()).abs() < ROUNDING * mesh.area(), "{longest}");
        for part in &split.triangles {
            let corners = mesh.corners(part.parent as usize);
            for (vertex, weights) in part.vertices.into_iter().zip(part.corners) {
                let expected = corners[0] * weights.x + corners[1] * weights.y + corners[2] * weights.z;
                assert!(split.positions[vertex as usize].distance(expected) < ROUNDING);
            }
        }
    }
}

#[test]
fn short_edges_keep_their_triangles() {
    let mesh = uneven();
    let split = mesh.split_to_length(10.0, 1000, &NoProgress).unwrap();
    assert_eq!(split.positions, mesh.positions);
    assert_eq!(split.triangles.iter().map(|part| part.vertices).collect::<Vec<_>>(), mesh.triangles);
}

#[test]
fn one_long_edge_splits_both_triangles_at_it() {
    let positions = vec![DVec3::ZERO, 4.0 * DVec3::X, 2.0 * DVec3::X + DVec3::Y, 2.0 * DVec3::X - DVec3::Y];
    let mesh = TriMesh::new(positions, vec![[0, 1, 2], [1, 0, 3]]);
    let split = mesh.split_to_length(3.0, 10, &NoProgress).unwrap();
    assert_eq!(split.positions[4..], [2.0 * DVec3::X]);
    let vertices: Vec<_> = split.triangles.iter().map(|part| part.vertices).collect();
    assert_eq!(vertices, [[0, 4, 2], [4, 1, 2], [1, 4, 3], [4, 0, 3]]);
}

#[test]
fn same_bits_for_any_number_of_threads() {
    let mesh = primitives::icosphere(1.0, 5);
    let with = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| mesh.split_to_length(0.02, 1_000_000, &NoProgress).unwrap())
    };
    let one = with(1);
    assert!(one.triangles.len() > mesh.triangles.len());
    assert_eq!(one, with(2));
    assert_eq!(one, with(8));
}

#[test]
fn rejects_invalid_lengths_limits_and_meshes() {
    let mesh = uneven();
    for length in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(matches!(mesh.split_to_length(length, 1000, &NoProgress), Err(SplitError::Length(_))));
    }
    for length in [0.1, 1e-6, 1e-300] {
        let error = mesh.split_to_length(length, 1000, &NoProgress).unwrap_err();
        assert_eq!(error, SplitError::TooManyTriangles { length, limit: 1000 });
    }
    let broken = TriMesh::new(mesh.positions.clone(), vec![[0, 1, 9999]]);
    assert!(matches!(broken.split_to_length(1.0, 1000, &NoProgress), Err(SplitError::Mesh(_))));
}
