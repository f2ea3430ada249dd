#![expect(unsafe_code, reason = "calls of the kernels for narrower targets")]

use glam::DVec3;

use super::*;
use crate::{
    LANES, NoProgress,
    distance_field::{Grid, interpolant::columns::Plain, spline},
};

/// Bound on the rounding of slopes in `f32` lanes, times cell size over the spread of the
/// coefficients. Derived like [`VALUE_ROUNDING`], except that the weights along one axis are those
/// of the derivative. Their sizes sum to 1.5, and roundings move them by 21u.
const SLOPE_ROUNDING: f64 = 93.0 / (1 << 24) as f64;

const GRID: Grid = Grid { origin: DVec3::new(-3.0, 2.0, 0.5), cell: 0.1, dims: [19, 17, 23] };

/// Coefficients like those of a distance with kinks, far from zero: rough, with slopes of up to
/// one.
fn interpolant() -> Interpolant {
    let grid = GRID;
    let samples: Vec<f32> = (0..grid.len())
        .map(|index| {
            let from = grid.node_at(index) - DVec3::new(-2.1, 2.7, 1.5);
            (40.0 + from.abs().max_element() + 0.001 * libm::sin(7.0 * index as f64)) as f32
        })
        .collect();
    Interpolant::new(&grid, &samples, &NoProgress).unwrap()
}

/// Points inside and outside, on nodes, on the border of the sampled cells, and not finite.
fn blocks() -> Vec<PointBlock> {
    let Grid { origin, cell, dims } = GRID;
    let size = cell * DVec3::from_array(dims.map(|nodes| nodes as f64 - 1.0));
    let scattered = (1..4000).map(|index| {
        let part = (f64::from(index) * DVec3::new(0.819_172_513, 0.671_043_607, 0.549_700_478)).fract();
        origin + size * (1.1 * part - 0.05)
    });
    let nodes = (0..GRID.len()).map(|index| GRID.node_at(index));
    let wild = [DVec3::NAN, DVec3::INFINITY, DVec3::NEG_INFINITY, DVec3::splat(1e300), origin + DVec3::splat(f64::NAN)];
    let points: Vec<DVec3> = scattered.chain(nodes).chain(wild).collect();
    points.chunks(LANES).map(PointBlock::gather).collect()
}

/// All numbers of a block, as bits.
fn bits(block: &DistanceBlock) -> [[u64; LANES]; 4] {
    let DistanceBlock { value, gradient: PointBlock { x, y, z } } = block;
    [value, x, y, z].map(|numbers| numbers.map(f64::to_bits))
}

type Kernel = fn(&Lattice<'_>, &PointBlock, &mut DistanceBlock);

/// Checks the dispatched kernel against those for narrower targets that this machine can run.
fn assert_same_bits(dispatched: Kernel, narrow: &[(&str, Kernel)]) {
    let interpolant = interpolant();
    let lattice = interpolant.lattice().unwrap();
    let (mut expected, mut found) = (DistanceBlock::FAR, DistanceBlock::FAR);
    for points in blocks() {
        dispatched(&lattice, &points, &mut expected);
        for (name, kernel) in narrow {
            kernel(&lattice, &points, &mut found);
            assert_eq!(bits(&found), bits(&expected), "{name} at {points:?}");
        }
    }
}

macro_rules! narrow_kernels {
    ($real:ty) => {{
        // SAFETY: this implementation needs no CPU feature.
        let plain: Kernel = |lattice, points, out| unsafe { lattice.sample::<$real, Plain>(points, out) };
        #[cfg(not(target_arch = "x86_64"))]
        let narrow = vec![("plain", plain)];
        #[cfg(target_arch = "x86_64")]
        let narrow = {
            // SAFETY: every x86-64 has SSE.
            let sse: Kernel = |lattice, points, out| unsafe { lattice.sample::<$real, columns::Sse>(points, out) };
            #[target_feature(enable = "avx2")]
            fn on_avx2(lattice: &Lattice<'_>, points: &PointBlock, out: &mut DistanceBlock) {
                // SAFETY: called only on machines with AVX2.
                unsafe { lattice.sample::<$real, columns::Avx>(points, out) };
            }
            let mut narrow = vec![("plain", plain), ("sse", sse)];
            if std::arch::is_x86_feature_detected!("avx2") {
                // SAFETY: AVX2 was detected.
                narrow.push(("avx2", |lattice, points, out| unsafe { on_avx2(lattice, points, out) }));
            }
            narrow
        };
        narrow
    }};
}

#[test]
fn bits_do_not_depend_on_the_target() {
    assert_same_bits(sample_single, &narrow_kernels!(f32));
    assert_same_bits(sample_double, &narrow_kernels!(f64));
}

#[test]
fn single_precision_keeps_its_bounds() {
    let interpolant = interpolant();
    let (mut double, mut single) = (DistanceBlock::FAR, DistanceBlock::FAR);
    let (mut worst_value, mut worst_slope) = (0.0_f64, 0.0_f64);
    for points in blocks() {
        interpolant.sample_into(&points, &mut double);
        interpolant.sample_single_into(&points, &mut single);
        for lane in 0..LANES {
            if double.value[lane].is_infinite() {
                assert_eq!(single.value[lane], f64::INFINITY);
                assert_eq!(single.gradient.get(lane), DVec3::ZERO);
            } else {
                worst_value = worst_value.max((double.value[lane] - single.value[lane]).abs());
                let off = (double.gradient.get(lane) - single.gradient.get(lane)).abs();
                worst_slope = worst_slope.max(off.max_element());
            }
        }
    }
    let slope_bound = SLOPE_ROUNDING * interpolant.spread / GRID.cell;
    assert!(worst_value <= interpolant.single_error(), "{worst_value:e} of {:e}", interpolant.single_error());
    assert!(worst_slope <= slope_bound, "{worst_slope:e} of {slope_bound:e}");
    // The bounds are not far from the truth. Roundings are random, and few stencils are as steep as
    // the steepest, hence the small factor.
    assert!(worst_value > 5e-4 * interpolant.single_error(), "{worst_value:e} of {:e}", interpolant.single_error());
    assert!(worst_slope > 5e-4 * slope_bound, "{worst_slope:e} of {slope_bound:e}");
}

/// Compares the kernel with the plain sum over all 64 coefficients.
#[test]
fn double_precision_is_the_sum_of_products() {
    let interpolant = interpolant();
    let Grid { origin, cell, dims: [nx, ny, _] } = GRID;
    let mut block = DistanceBlock::FAR;
    for points in blocks().iter().take(100) {
        interpolant.sample_into(points, &mut block);
        for lane in (0..LANES).filter(|&lane| block.value[lane].is_finite()) {
            let local = (points.get(lane) - origin) / cell;
            let (first, passed) = (local.floor().to_array().map(|x| x as usize - 1), local.fract().to_array());
            let (weight, slope) = (passed.map(spline::weights), passed.map(spline::weight_derivatives));
            let (mut value, mut gradient) = (0.0, DVec3::ZERO);
            for (i, j, k) in (0..64).map(|index| (index % 4, index / 4 % 4, index / 16)) {
                let index = ((first[2] + k) * ny + first[1] + j) * nx + first[0] + i;
                let coefficient = f64::from(interpolant.coefficients[index]);
                let [x, y, z] = [weight[0][i], weight[1][j], weight[2][k]];
                value += coefficient * x * y * z;
                gradient +=
                    coefficient * DVec3::new(slope[0][i] * y * z, x * slope[1][j] * z, x * y * slope[2][k]) / cell;
            }
            // Both sides sum 64 products of coefficients near 41; the gradient divides by the cell
            // size. The fraction of the cell is rounded too, which matters because the slope
            // changes by up to 100 per unit length.
            assert!((block.value[lane] - value).abs() < 64.0 * 41.0 * f64::EPSILON, "{} {value}", block.value[lane]);
            let off = (block.gradient.get(lane) - gradient).length();
            assert!(off < 64.0 * 41.0 * f64::EPSILON / cell, "{off:e}");
        }
    }
}
