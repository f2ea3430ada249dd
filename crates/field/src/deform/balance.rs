//! The exact balance of a volume: vertices move along given directions, by one common factor.
//!
//! If each vertex moves by λ times its direction, the volume is a cubic polynomial in λ. Newton's
//! method finds the root at which the volume has its target value.

use glam::DVec3;
use isochore_mesh::sum_terms;

/// Newton's method ends at this relative error of the volume: a few roundings of its sum. A larger
/// value leaves an error of the volume; a smaller value is never reached.
const RESIDUAL: f64 = 1e-15;

/// Relative error that is accepted if rounding keeps Newton's method from [`RESIDUAL`]. A larger value
/// accepts a point that is not a root; a smaller value rejects roots because of rounding.
const ACCEPTED_RESIDUAL: f64 = 1e-13;

/// Most iterations. On a nearly linear cubic each iteration doubles the correct digits, so five reach
/// the precision of `f64`; the rest are for safety.
const MAX_ITERATIONS: usize = 60;

/// Smallest coefficient of λ relative to the volume. A larger value gives up on harmless shifts; a
/// smaller value divides by noise and lets the shift explode.
const LEAST_SLOPE: f64 = 1e-9;

/// Moves `positions` along `directions` by the common factor that makes the volume inside `triangles`
/// equal to `volume`, and returns the factor. Returns `None` and leaves `positions` unchanged if the
/// directions cannot bring the volume to its target.
pub(crate) fn balance(
    positions: &mut [DVec3],
    directions: &[DVec3],
    triangles: &[[u32; 3]],
    volume: f64,
) -> Option<f64> {
    solve(positions, directions, triangles, mean, volume, volume.abs())
}

/// Like [`balance`] for a part of a closed surface: the volume inside the whole grows by `gain`. The
/// directions are zero at the boundary of the part, and `size` is the volume of the whole.
pub(crate) fn balance_part(
    positions: &mut [DVec3],
    directions: &[DVec3],
    triangles: &[[u32; 3]],
    gain: f64,
    size: f64,
) -> Option<f64> {
    // With the boundary fixed, the volume of the cones from any center changes as the whole does.
    let center = mean(positions);
    let [volume, ..] = volume_cubic(positions, directions, triangles, center);
    solve(positions, directions, triangles, |_| center, volume + gain, size)
}

fn mean(positions: &[DVec3]) -> DVec3 {
    positions.iter().sum::<DVec3>() / positions.len() as f64
}

/// Makes the volume between the triangles and a center equal to `volume`, up to a fraction of `size`.
fn solve(
    positions: &mut [DVec3],
    directions: &[DVec3],
    triangles: &[[u32; 3]],
    center: impl Fn(&[DVec3]) -> DVec3,
    volume: f64,
    size: f64,
) -> Option<f64> {
    let mut total = 0.0;
    // The second pass corrects the rounding of the moved coordinates.
    let before = positions.to_vec();
    for _ in 0..2 {
        let [c0, c1, c2, c3] = volume_cubic(positions, directions, triangles, center(positions));
        let is_effective = c1.abs() > LEAST_SLOPE * size;
        let Some(lambda) = is_effective.then(|| root(c0 - volume, c1, c2, c3, size)).flatten() else {
            positions.copy_from_slice(&before);
            return None;
        };
        total += lambda;
        for index in 0..positions.len() {
            // Skipped because adding zero would turn a coordinate of −0 into +0.
            if directions[index] != DVec3::ZERO {
                positions[index] = before[index] + total * directions[index];
            }
        }
    }
    Some(total)
}

/// Coefficients of the volume between `center` and `positions` + λ `directions`, in powers of λ.
fn volume_cubic(positions: &[DVec3], directions: &[DVec3], triangles: &[[u32; 3]], center: DVec3) -> [f64; 4] {
    let det = |a: DVec3, b: DVec3, c: DVec3| a.dot(b.cross(c)) / 6.0;
    sum_terms(triangles.len(), |index| {
        let [a, b, c] = triangles[index].map(|vertex| positions[vertex as usize] - center);
        let [u, v, w] = triangles[index].map(|vertex| directions[vertex as usize]);
        if u == DVec3::ZERO && v == DVec3::ZERO && w == DVec3::ZERO {
            return [det(a, b, c), 0.0, 0.0, 0.0];
        }
        [
            det(a, b, c),
            det(u, b, c) + det(a, v, c) + det(a, b, w),
            det(a, v, w) + det(u, b, w) + det(u, v, c),
            det(u, v, w),
        ]
    })
}

/// The root of c0 + c1 λ + c2 λ² + c3 λ³ that Newton's method reaches from zero, to a residual that is
/// a fraction of `size`. `None` if it does not converge.
fn root(c0: f64, c1: f64, c2: f64, c3: f64, size: f64) -> Option<f64> {
    let residual = |lambda: f64| c0 + lambda * (c1 + lambda * (c2 + lambda * c3));
    let mut lambda = 0.0;
    for _ in 0..MAX_ITERATIONS {
        if residual(lambda).abs() <= RESIDUAL * size {
            break;
        }
        lambda -= residual(lambda) / (c1 + lambda * (2.0 * c2 + lambda * 3.0 * c3));
    }
    (residual(lambda).abs() <= ACCEPTED_RESIDUAL * size).then_some(lambda)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn finds_a_root() {
        let (c0, c1, c2, c3) = (0.02, 1.0, 0.3, 0.1);
        let lambda = root(c0, c1, c2, c3, 1.0).unwrap();
        assert!((c0 + lambda * (c1 + lambda * (c2 + lambda * c3))).abs() <= RESIDUAL);
    }

    #[test]
    fn reports_a_cubic_without_a_root() {
        assert_eq!(root(1.0, 0.1, 1.0, 0.0, 1.0), None);
        assert_eq!(root(1.0, 0.0, 0.0, 0.0, 1.0), None);
    }
}
