//! Gauss–Legendre quadrature, composite and adaptive.

/// Positive abscissae and weights of the ten-point Gauss–Legendre rule on [−1, 1].
const NODES: [(f64, f64); 5] = [
    (0.148_874_338_981_631_22, 0.295_524_224_714_752_87),
    (0.433_395_394_129_247_2, 0.269_266_719_309_996_35),
    (0.679_409_568_299_024_4, 0.219_086_362_515_982_05),
    (0.865_063_366_688_984_5, 0.149_451_349_150_580_6),
    (0.973_906_528_517_171_7, 0.066_671_344_308_688_14),
];

/// Largest relative difference between a panel and the sum of its halves. Larger: reference values
/// lose digits. Smaller: rounding errors force the recursion to its full depth.
const TOLERANCE: f64 = 1e-14;

/// Largest number of halvings of a panel. Larger: only more time at discontinuities. Smaller:
/// narrow peaks are not resolved.
const DEPTH: u32 = 18;

/// Integral of `function` over [a, b] by the ten-point rule: exact for polynomials of degree 19.
pub(crate) fn gauss(function: &mut impl FnMut(f64) -> f64, a: f64, b: f64) -> f64 {
    let center = 0.5 * (a + b);
    let half = 0.5 * (b - a);
    let sum: f64 = NODES
        .iter()
        .map(|&(node, weight)| weight * (function(center - half * node) + function(center + half * node)))
        .sum();
    half * sum
}

/// Abscissae and weights of the composite ten-point rule with `panels` equal panels on [a, b],
/// ascending.
pub(crate) fn gauss_points(a: f64, b: f64, panels: usize) -> Vec<(f64, f64)> {
    let width = (b - a) / panels as f64;
    let half = 0.5 * width;
    let mut points = Vec::with_capacity(10 * panels);
    for panel in 0..panels {
        let center = a + (panel as f64 + 0.5) * width;
        points.extend(NODES.iter().rev().map(|&(node, weight)| (center - half * node, half * weight)));
        points.extend(NODES.iter().map(|&(node, weight)| (center + half * node, half * weight)));
    }
    points
}

/// Integral of `function` over [a, b]. Panels are halved until they agree with the sum of their
/// halves.
///
/// `scale` is the size of the whole integral, to which the error is relative. Panels that
/// contribute less than its rounding error are not refined.
pub(crate) fn integrate(function: &mut impl FnMut(f64) -> f64, a: f64, b: f64, scale: f64) -> f64 {
    let whole = gauss(function, a, b);
    refine(function, a, b, whole, scale, DEPTH)
}

fn refine(function: &mut impl FnMut(f64) -> f64, a: f64, b: f64, whole: f64, scale: f64, depth: u32) -> f64 {
    let middle = 0.5 * (a + b);
    let left = gauss(function, a, middle);
    let right = gauss(function, middle, b);
    let halves = left + right;
    if depth == 0 || (halves - whole).abs() <= TOLERANCE * scale.max(halves.abs()) {
        return halves;
    }
    refine(function, a, middle, left, scale, depth - 1) + refine(function, middle, b, right, scale, depth - 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ten_points_are_exact_to_degree_nineteen() {
        let exact = 1.0 / 20.0;
        assert!((gauss(&mut |x| x.powi(19), 0.0, 1.0) - exact).abs() < 2e-16, "degree 19 is exact");
        let error = (gauss(&mut |x| x.powi(20), 0.0, 1.0) - 1.0 / 21.0).abs();
        assert!(error > 1e-13, "degree 20 is not exact; its error, 1e-12, is above rounding: {error}");
    }

    #[test]
    fn adaptive_panels_reach_rounding_on_a_peak() {
        // ∫ ε/(ε² + x²) over [−1, 1] = 2 atan(1/ε): a peak of width 1e-4.
        let epsilon = 1e-4;
        let value = integrate(&mut |x| epsilon / (epsilon * epsilon + x * x), -1.0, 1.0, 1.0);
        let exact = 2.0 * libm::atan(1.0 / epsilon);
        assert!((value - exact).abs() < 1e-12, "{value}, expected {exact}");
    }

    #[test]
    fn composite_points_integrate_cubics_exactly() {
        let sum: f64 = gauss_points(0.0, 2.0, 3).iter().map(|&(x, w)| w * x * x * x).sum();
        assert!((sum - 4.0).abs() < 4e-15);
    }
}
