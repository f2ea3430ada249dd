mod errors;

use glam::{DVec3, dvec3};
use proptest::prelude::*;

use super::*;
use crate::primitives::{box_mesh, icosphere};
use crate::{Bvh, LANES, MeshDistance, NoProgress};

fn field(mesh: &TriMesh, resolution: usize, padding: Padding) -> DistanceField {
    let options = DistanceFieldOptions { resolution, padding, ..Default::default() };
    DistanceField::new(mesh, &options, &NoProgress).unwrap()
}

/// A closed shape with edges, hollows and triangles of many sizes, about 2 across.
fn bumpy() -> TriMesh {
    let mut mesh = icosphere(1.0, 3);
    for p in &mut mesh.positions {
        let bump = 1.0 + 0.25 * libm::sin(5.0 * p.x) * libm::cos(4.0 * p.y + p.z);
        *p = dvec3(p.x, 0.6 * p.y, p.z.max(-0.5)) * bump;
    }
    mesh
}

fn transformed(mesh: &TriMesh, map: impl Fn(DVec3) -> DVec3) -> TriMesh {
    TriMesh::new(mesh.positions.iter().map(|&p| map(p)).collect(), mesh.triangles.clone())
}

/// Pseudo-random points in a box: a lattice of irrational steps.
fn scattered(bounds: Aabb, count: usize) -> impl Iterator<Item = DVec3> {
    (1..=count).map(move |i| {
        let i = i as f64;
        bounds.min + bounds.size() * dvec3(i * 0.819_172_513, i * 0.671_043_607, i * 0.549_700_478).fract()
    })
}

/// Signed distance by brute force over all triangles. The sign is from the sum of all solid angles.
fn by_brute_force(mesh: &TriMesh, point: DVec3) -> f64 {
    let mut distance = f64::INFINITY;
    let mut angle = 0.0;
    for triangle in 0..mesh.triangles.len() {
        let corners = mesh.corners(triangle);
        distance = distance.min(closest_by_ternary_search(point, corners));
        let [a, b, c] = corners.map(|corner| (corner - point).normalize());
        angle += 2.0 * a.dot(b.cross(c)).atan2(1.0 + a.dot(b) + b.dot(c) + c.dot(a));
    }
    if angle > 2.0 * std::f64::consts::PI { -distance } else { distance }
}

/// Distance to a triangle: the minimum over its border and, if the point projects inside, its
/// plane.
fn closest_by_ternary_search(point: DVec3, [a, b, c]: [DVec3; 3]) -> f64 {
    let to_segment = |p: DVec3, q: DVec3| {
        let t = ((point - p).dot(q - p) / (q - p).length_squared()).clamp(0.0, 1.0);
        point.distance(p + (q - p) * t)
    };
    let border = to_segment(a, b).min(to_segment(b, c)).min(to_segment(c, a));
    let normal = (b - a).cross(c - a).normalize();
    let foot = point - normal * normal.dot(point - a);
    let is_left = |p: DVec3, q: DVec3| normal.dot((q - p).cross(foot - p)) >= 0.0;
    if is_left(a, b) && is_left(b, c) && is_left(c, a) { normal.dot(point - a).abs().min(border) } else { border }
}

#[test]
fn samples_agree_with_brute_force() {
    let bumpy = bumpy();
    let meshes = [
        transformed(&bumpy, |p| p),
        transformed(&bumpy, |p| p * 1e-12),
        transformed(&bumpy, |p| p * 1e12),
        // At this offset, f32 alone could not distinguish the vertices.
        transformed(&bumpy, |p| p + dvec3(1e6, -2e6, 3e6)),
        box_mesh(dvec3(1.0, 0.4, 0.1), [3, 2, 1]),
    ];
    for mesh in &meshes {
        let field = field(mesh, 20, Padding::Cells(3));
        // Far from the origin the positions themselves are rounded: 3e6 · 2⁻⁵³ on both sides.
        let error = field.sample_error() + 1e-15 * mesh.positions[0].abs().max_element();
        for (index, &sample) in field.samples().iter().enumerate() {
            let expected = by_brute_force(mesh, field.grid().node_at(index));
            assert!((f64::from(sample) - expected).abs() <= error, "{sample}, not {expected}, at node {index}");
        }
        // The bound is not far from the truth: less than a millionth of the size.
        assert!(field.sample_error() < 2e-6 * mesh.bounds().size().max_element());
    }
}

#[test]
fn signs_are_right_far_from_holes() {
    let mut mesh = bumpy();
    let whole = field(&mesh, 24, Padding::Cells(2));
    assert!(whole.is_closed());
    let before = mesh.triangles.len();
    let mut holes = Vec::new();
    let mut number = 0;
    mesh.triangles.retain(|&t| {
        number += 1;
        let stays = number % 13 != 0;
        if !stays {
            holes.push(t.map(|v| mesh.positions[v as usize]));
        }
        stays
    });
    assert!(before - mesh.triangles.len() > 90);
    let open = field(&mesh, 24, Padding::Cells(2));
    assert!(!open.is_closed());
    assert_eq!(open.grid(), whole.grid());
    let mut compared = 0;
    for (index, (&with, &without)) in whole.samples().iter().zip(open.samples()).enumerate() {
        let node = open.grid().node_at(index);
        let is_near_hole = holes.iter().any(|hole| {
            let size = hole[0].distance(hole[1]).max(hole[1].distance(hole[2]));
            hole.iter().any(|&corner| corner.distance(node) < size)
        });
        if !is_near_hole {
            compared += 1;
            assert_eq!(with < 0.0, without < 0.0, "at node {index}");
        }
    }
    assert!(compared > open.samples().len() / 2);
}

#[test]
fn overlapping_volumes_count_as_inside() {
    let (one, other) = (icosphere(1.0, 2), icosphere(1.0, 2));
    let count = one.positions.len() as u32;
    let positions = one.positions.iter().copied().chain(other.positions.iter().map(|&p| p + DVec3::X)).collect();
    let triangles = one.triangles.iter().copied().chain(other.triangles.iter().map(|t| t.map(|v| v + count))).collect();
    let field = field(&TriMesh::new(positions, triangles), 24, Padding::Cells(2));
    for (x, is_inside) in [(-0.5, true), (0.5, true), (1.5, true), (2.05, false), (-1.05, false)] {
        assert_eq!(field.sample(dvec3(x, 0.01, 0.02)).0 < 0.0, is_inside, "at x = {x}");
    }
}

#[test]
fn neighbors_differ_by_no_more_than_their_distance() {
    let field = field(&bumpy(), 24, Padding::Reach(0.3));
    let [nx, ny, nz] = field.grid().dims;
    let steepest = field.grid().cell + 2.0 * field.sample_error();
    let at = |i: usize, j: usize, k: usize| f64::from(field.samples()[(k * ny + j) * nx + i]);
    for k in 1..nz {
        for j in 1..ny {
            for i in 1..nx {
                for before in [at(i - 1, j, k), at(i, j - 1, k), at(i, j, k - 1)] {
                    assert!((at(i, j, k) - before).abs() <= steepest);
                }
            }
        }
    }
}

#[test]
fn spline_interpolates_the_samples_up_to_the_requested_reach() {
    let mesh = bumpy();
    let reach = 0.37;
    let field = field(&mesh, 24, Padding::Reach(reach));
    assert_eq!(field.reach(), reach);
    let [nx, ny, nz] = field.grid().dims;
    for index in 0..field.samples().len() {
        let (i, j, k) = (index % nx, index / nx % ny, index / (nx * ny));
        let is_inner = |i: usize, n: usize| (1..n - 1).contains(&i);
        let (value, _) = field.sample(field.grid().node_at(index));
        if is_inner(i, nx) && is_inner(j, ny) && is_inner(k, nz) {
            // Sums of coefficients rounded to f32. Near kinks the coefficients are a few times the
            // samples, which are below 2. A node on the border of the inner cells may be rounded
            // out of them.
            assert!(value.is_infinite() || (value - f64::from(field.samples()[index])).abs() < 1e-6);
        } else {
            assert_eq!(value, f64::INFINITY);
        }
    }
    let exact = MeshDistance::new(&mesh, &NoProgress).unwrap();
    let around = field.bounds().expanded(1.2 * reach);
    for point in scattered(around, 20_000) {
        assert!(exact.sample(point).0 > reach || field.sample(point).0.is_finite());
    }
}

#[test]
fn distance_is_infinite_outside_the_grid() {
    let field = field(&icosphere(1.0, 2), 8, Padding::Cells(2));
    for point in [dvec3(9.0, 0.0, 0.0), dvec3(0.0, -1e300, 0.0), DVec3::INFINITY, DVec3::NAN] {
        assert_eq!(field.sample(point), (f64::INFINITY, DVec3::ZERO));
    }
}

#[test]
fn spline_of_a_sphere_approximates_its_distance() {
    let mesh = icosphere(1.0, 5);
    let field = field(&mesh, 48, Padding::Reach(0.3));
    for point in scattered(field.bounds().expanded(0.17), 2_000).filter(|p| p.length() > 0.8) {
        let (value, gradient) = field.sample(point);
        // The facets of this sphere are up to 5e-4 inside it and tilted by up to 0.03.
        assert!((value - (point.length() - 1.0)).abs() < 1e-3);
        assert!((gradient - point.normalize()).length() < 0.05);
    }
}

#[test]
fn lipschitz_bounds_the_gradient() {
    for mesh in [bumpy(), box_mesh(dvec3(1.0, 0.4, 0.1), [1, 1, 1])] {
        let field = field(&mesh, 24, Padding::Reach(0.3));
        let steepest = (scattered(field.grid().bounds(), 100_000).map(|point| field.sample(point)))
            .filter(|(value, _)| *value > 0.0)
            .map(|(_, gradient)| gradient.length())
            .fold(0.0, f64::max);
        assert!(steepest <= field.lipschitz());
        // Halving leaves little slack, and the spline of a distance is not much steeper than one.
        assert!(field.lipschitz() < 1.2 * steepest && field.lipschitz() < 2.0);
    }
}

proptest! {
    #[test]
    fn gradient_is_that_of_the_spline(x in -1.0..1.0_f64, y in -1.0..1.0_f64, z in -1.0..1.0_f64) {
        use std::sync::OnceLock;
        static FIELD: OnceLock<DistanceField> = OnceLock::new();
        let field = FIELD.get_or_init(|| field(&bumpy(), 24, Padding::Cells(3)));
        let point = dvec3(x, y, z);
        let (value, gradient) = field.sample(point);
        prop_assume!(value.is_finite());
        // Central differences of a C² function: the error is STEP² times the third derivative, which is
        // 10/cell² at kinks, plus rounding.
        const STEP: f64 = 1e-5;
        for axis in 0..3 {
            let step = DVec3::AXES[axis] * STEP;
            let quotient = (field.sample(point + step).0 - field.sample(point - step).0) / (2.0 * STEP);
            prop_assert!(!quotient.is_finite() || (gradient[axis] - quotient).abs() < 1e-6, "{} {}", gradient, quotient);
        }
    }
}

#[test]
fn lanes_are_independent() {
    let field = field(&icosphere(1.0, 1), 8, Padding::Cells(2));
    let points: Vec<_> = scattered(field.grid().bounds().expanded(0.2), 64 * LANES).collect();
    for points in points.chunks(LANES) {
        let mut block = DistanceBlock::FAR;
        field.sample_into(&PointBlock::gather(points), &mut block);
        for (lane, &point) in points.iter().enumerate() {
            assert_eq!(field.sample(point), (block.value[lane], block.gradient.get(lane)));
        }
    }
}

#[test]
fn same_bits_for_any_number_of_threads() {
    let with = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let field = pool.install(|| field(&bumpy(), 20, Padding::Cells(2)));
        let bits: Vec<_> = field.samples().iter().map(|sample| sample.to_bits()).collect();
        (bits, field.lipschitz(), field.sample(DVec3::splat(0.1)))
    };
    let one = with(1);
    assert_eq!(one, with(2));
    assert_eq!(one, with(8));
}

#[test]
fn distances_are_clamped_to_the_band() {
    let mesh = bumpy();
    let all = field(&mesh, 24, Padding::Reach(0.4));
    let options =
        DistanceFieldOptions { resolution: 24, padding: Padding::Reach(0.4), band: 0.3, ..Default::default() };
    let band = DistanceField::new(&mesh, &options, &NoProgress).unwrap();
    assert_eq!(all.grid(), band.grid());
    for (&all, &within) in all.samples().iter().zip(band.samples()) {
        assert!((f64::from(within) - f64::from(all).clamp(-0.3, 0.3)).abs() <= band.sample_error());
    }
    assert_eq!(band.reach(), 0.3 - 2.0 * band.grid().cell);
    // A kink decays by a factor of 2 − √3 per node, over at least two nodes: 0.07 of half the kink
    // of one cell.
    for point in scattered(band.grid().bounds(), 20_000) {
        let (expected, found) = (all.sample(point).0, band.sample(point).0);
        if expected.abs() < band.reach() && found.is_finite() {
            assert!((found - expected).abs() < 0.07 * 0.5 * band.grid().cell, "{point}: {found}, not {expected}");
        }
    }
}

#[test]
fn samples_an_open_mesh() {
    let mut mesh = icosphere(1.0, 3);
    mesh.triangles.retain(|t| t.iter().all(|&v| mesh.positions[v as usize].z < 0.3));
    let field = field(&mesh, 24, Padding::Reach(0.3));
    assert!(!field.is_closed());
    assert!(field.sample(dvec3(0.0, 0.0, -0.5)).0 < 0.0);
    assert!(field.sample(dvec3(0.0, 0.0, 0.95)).0 > 0.0);
}

#[test]
fn degenerate_meshes_have_finite_distances() {
    let flat = TriMesh::new(vec![DVec3::ZERO, DVec3::X, DVec3::Y], vec![[0, 1, 2], [0, 2, 1]]);
    let needle = TriMesh::new(vec![DVec3::ZERO, DVec3::X, DVec3::X * 0.5], vec![[0, 1, 2], [0, 0, 1], [1, 1, 1]]);
    for mesh in [flat, needle] {
        let field = field(&mesh, 8, Padding::Cells(3));
        let bvh = Bvh::new(&mesh.positions, &mesh.triangles).unwrap();
        for (index, &sample) in field.samples().iter().enumerate() {
            let expected = bvh.closest_point(field.grid().node_at(index)).distance;
            assert!((f64::from(sample) - expected).abs() <= field.sample_error(), "{sample}, not {expected}");
        }
        let (value, gradient) = field.sample(dvec3(0.4, 0.1, 0.2));
        // Around a sheet the spline smooths the kink over two cells of 1/8.
        let expected = bvh.closest_point(dvec3(0.4, 0.1, 0.2)).distance;
        assert!((value - expected).abs() < 0.125, "{value} {expected}");
        assert!(gradient.is_finite() && field.centroid().is_finite());
    }
}
