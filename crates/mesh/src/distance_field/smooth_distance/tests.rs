use glam::{DVec3, dvec3};

use super::gaussian::gaussian;
use super::pyramid::{doubled, halved};
use super::*;
use crate::primitives::{box_mesh, icosphere};
use crate::{DistanceField, NoProgress};

/// Two balls of radius 0.5, one unit and a tenth apart: a groove between two parts of a shape.
fn balls() -> TriMesh {
    let ball = icosphere(0.5, 3);
    let count = ball.positions.len() as u32;
    let positions = ball.positions.iter().copied().chain(ball.positions.iter().map(|&p| p + 1.1 * DVec3::X)).collect();
    let second = ball.triangles.iter().map(|t| t.map(|vertex| vertex + count));
    TriMesh::new(positions, ball.triangles.iter().copied().chain(second).collect())
}

const SUPPORT: f64 = 0.4;

fn options(resolution: usize) -> DistanceFieldOptions {
    DistanceFieldOptions { resolution, padding: Padding::Reach(SUPPORT), ..Default::default() }
}

fn smooth(resolution: usize) -> SmoothDistance {
    SmoothDistance::new(&balls(), SUPPORT, &options(resolution), &NoProgress).unwrap()
}

/// Exact and smoothed samples, and their grid.
fn samples(resolution: usize) -> (Grid, Vec<f32>, Vec<f32>) {
    let exact = DistanceField::new(&balls(), &options(resolution), &NoProgress).unwrap();
    let ladder = Ladder::new(SUPPORT, exact.grid().cell);
    let smooth = ladder.smoothed(exact.samples().to_vec(), exact.grid().dims, &NoProgress).unwrap();
    (*exact.grid(), exact.samples().to_vec(), smooth)
}

#[test]
fn a_gaussian_keeps_linear_functions() {
    let dims = [9, 7, 12];
    let at = |index: usize| {
        let (i, j, k) = (index % 9, index / 9 % 7, index / 63);
        0.5 * i as f32 - 0.25 * j as f32 + 0.125 * k as f32 - 1.0
    };
    let values: Vec<f32> = (0..9 * 7 * 12).map(at).collect();
    for sigma in [0.5, 1.3, 4.0] {
        for (smooth, value) in gaussian(&values, dims, sigma, &NoProgress).unwrap().iter().zip(&values) {
            // Continued lines reach ±14 cells, and 29 products are rounded.
            assert!((smooth - value).abs() < 30.0 * 8.0 * f32::EPSILON, "{sigma}: {smooth}, not {value}");
        }
    }
    let (half, coarse) = halved(&values, dims);
    assert_eq!(coarse, [5, 4, 6]);
    for (double, value) in doubled(&half, coarse, dims, &NoProgress).unwrap().iter().zip(&values) {
        assert!((double - value).abs() < 16.0 * f32::EPSILON, "{double}, not {value}");
    }
}

#[test]
fn a_gaussian_is_the_product_of_its_weights_along_the_axes() {
    let dims = [11, 13, 12];
    let mut values = vec![0.0; 11 * 13 * 12];
    values[(6 * 13 + 6) * 11 + 5] = 1.0;
    let smooth = gaussian(&values, dims, 0.9, &NoProgress).unwrap();
    let weight = |steps: usize| if steps > 3 { 0.0 } else { libm::exp(-0.5 * (steps as f64 / 0.9).powi(2)) };
    let sum = weight(0) + 2.0 * (1..=3).map(weight).sum::<f64>();
    for (index, smooth) in smooth.iter().enumerate() {
        let steps = [(index % 11).abs_diff(5), (index / 11 % 13).abs_diff(6), (index / 143).abs_diff(6)];
        let expected = steps.map(|steps| weight(steps) / sum).iter().product::<f64>();
        assert!((f64::from(*smooth) - expected).abs() < 1e-7, "{index}: {smooth}, not {expected}");
    }
}

#[test]
fn samples_inside_and_at_the_surface_stay_exact() {
    let (grid, exact, smooth) = samples(40);
    let mut changed = 0;
    for (exact, smooth) in exact.iter().zip(smooth) {
        // Near a convex surface a copy is slightly larger than the distance, so that it begins to
        // count a little closer than the cell.
        if f64::from(*exact) < 0.9 * grid.cell {
            assert_eq!(smooth, *exact);
        }
        changed += usize::from(smooth != *exact);
    }
    assert!(changed > exact.len() / 2);
}

#[test]
fn the_pyramid_changes_little() {
    // Level by level: two copies on the grid itself, and one or two at every second node.
    for resolution in [160, 200] {
        let (grid, exact, smooth) = samples(resolution);
        let direct = Ladder::new(SUPPORT, grid.cell).smoothed_at_all_nodes(&exact, grid.dims);
        let support = smooth.iter().zip(direct).filter(|(smooth, _)| f64::from(**smooth) < SUPPORT);
        let worst = support.map(|(smooth, direct)| (smooth - direct).abs()).fold(0.0, f32::max);
        assert!(f64::from(worst) < 1e-4 * SUPPORT, "{resolution}: {:e}", f64::from(worst) / SUPPORT);
    }
}

#[test]
fn the_distance_is_smooth_across_a_groove() {
    let exact = DistanceField::new(&balls(), &options(80), &NoProgress).unwrap();
    let smooth = smooth(80);
    // Over the groove, half a support from both balls.
    let point = dvec3(0.55, 0.0, libm::sqrt(0.7 * 0.7 - 0.55 * 0.55));
    let turn = |distance: &dyn Distance| {
        let [left, right] = [-0.008, 0.008].map(|shift| distance.sample(point + shift * DVec3::X).1);
        left.distance(right)
    };
    assert!(turn(&exact) > 0.7, "{}", turn(&exact));
    // A kink of 2 · 0.79, spread over the Gaussian of σ = 0.4 R/6 or more.
    assert!(turn(&smooth) < 1.58 * 0.016 / (2.5 * 0.4 * SUPPORT / 6.0), "{}", turn(&smooth));
    let (value, gradient) = smooth.sample(point);
    assert!(value > 0.8 * 0.2 && value < 0.2 && gradient.x.abs() < 0.01, "{value} {gradient}");
}

#[test]
fn the_support_is_within_its_box_and_the_grid() {
    let smooth = smooth(40);
    let bounds = smooth.bounds_within(SUPPORT);
    let exact = smooth.bounds().expanded(SUPPORT);
    let grid = smooth.grid().bounds();
    // The box of the support is that of a convex shape: grooves are inside.
    assert!(bounds.min.distance(exact.min).max(bounds.max.distance(exact.max)) < 0.3 * smooth.grid().cell);
    for index in 1..60_000 {
        let part = (f64::from(index) * dvec3(0.819_172_513, 0.671_043_607, 0.549_700_478)).fract();
        let point = grid.min + grid.size() * part;
        assert!(smooth.sample(point).0 >= SUPPORT || bounds.distance(point) == 0.0, "{point}");
    }
    assert!(bounds.min.cmpgt(grid.min + smooth.grid().cell).all());
    assert!(bounds.max.cmplt(grid.max - smooth.grid().cell).all());
}

#[test]
fn a_short_padding_and_a_narrow_band_are_widened() {
    let reference = smooth(40);
    let short = DistanceFieldOptions { padding: Padding::Cells(2), band: 0.1, ..options(40) };
    let smooth = SmoothDistance::new(&balls(), SUPPORT, &short, &NoProgress).unwrap();
    assert!(smooth.grid() == reference.grid() && smooth.reach() == SUPPORT);
    for index in 0..reference.grid().len() {
        let point = reference.grid().node_at(index);
        let (value, expected) = (smooth.sample(point).0, reference.sample(point).0);
        // Deep inside, samples end at the band.
        if expected < SUPPORT && expected > -0.1 {
            assert!((value - expected).abs() < 1e-4 * SUPPORT, "{point}: {value}, not {expected}");
        }
    }
    let farther = DistanceFieldOptions { padding: Padding::Reach(0.6), ..options(40) };
    assert_eq!(SmoothDistance::new(&balls(), SUPPORT, &farther, &NoProgress).unwrap().reach(), 0.6);
}

#[test]
fn the_grid_of_an_open_mesh_grows() {
    // A deep box without its lid: the inside bulges out of the opening.
    let mut mesh = box_mesh(dvec3(1.0, 1.0, 3.0), [1, 1, 1]);
    mesh.triangles.retain(|triangle| !triangle.iter().all(|&vertex| mesh.positions[vertex as usize].z > 1.0));
    let options = DistanceFieldOptions { resolution: 48, padding: Padding::Reach(0.4), ..Default::default() };
    let exact = DistanceField::new(&mesh, &options, &NoProgress).unwrap();
    let smooth = SmoothDistance::new(&mesh, 0.4, &options, &NoProgress).unwrap();
    assert!(!smooth.is_closed() && smooth.reach() >= exact.reach());
}

#[test]
fn same_bits_for_any_number_of_threads() {
    let with = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let (_, _, smooth) = pool.install(|| samples(100));
        smooth.iter().map(|sample| sample.to_bits()).collect::<Vec<_>>()
    };
    let one = with(1);
    assert!(one == with(8));
}

#[test]
fn distances_in_a_plane_are_smoothed_alike() {
    // The distance to two half-planes does not depend on z, nor do its copies.
    let plane: Vec<f32> = (0..40 * 30).map(|index: usize| (index % 40).abs_diff(20) as f32 * -0.05 + 0.6).collect();
    let solid: Vec<f32> = (0..9).flat_map(|_| plane.iter().copied()).collect();
    let smooth = |samples: Vec<f32>, layers: usize| {
        SmoothDistance::smooth_samples(samples, [40, 30, layers], 0.05, 0.6, &NoProgress).unwrap()
    };
    let (flat, deep) = (smooth(plane, 1), smooth(solid, 9));
    for (flat, deep) in flat.iter().zip(&deep[4 * 40 * 30..]) {
        assert!((flat - deep).abs() < 1e-6, "{flat} {deep}");
    }
}

#[test]
fn refuses_a_support_without_length() {
    for support in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let error = SmoothDistance::new(&balls(), support, &options(20), &NoProgress).unwrap_err();
        assert!(matches!(error, DistanceFieldError::Support { .. }), "{error}");
    }
    let empty = SmoothDistance::new(&TriMesh::default(), SUPPORT, &options(20), &NoProgress).unwrap_err();
    assert!(matches!(empty, DistanceFieldError::Mesh(_)), "{empty}");
}

#[test]
fn the_smoothing_can_be_cancelled() {
    struct Stop;
    impl Monitor for Stop {
        fn is_cancelled(&self) -> bool {
            true
        }
    }
    let ladder = Ladder::new(SUPPORT, 0.02);
    assert_eq!(ladder.smoothed(vec![0.0; 64], [4; 3], &Stop), Err(Cancelled));
}

#[test]
fn a_tiny_shape_has_finite_distances() {
    let mut mesh = balls();
    mesh.positions.iter_mut().for_each(|position| *position *= 1e-42);
    let options = DistanceFieldOptions { resolution: 24, padding: Padding::Cells(2), ..Default::default() };
    let smooth = SmoothDistance::new(&mesh, SUPPORT * 1e-42, &options, &NoProgress).unwrap();
    assert!(smooth.sample(DVec3::ZERO).0.is_finite() && smooth.lipschitz().is_finite());
}
