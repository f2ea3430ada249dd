//! The exact balance of a volume: vertices move along given vectors, by the one factor that makes the volume what is wanted.
//!
//! Moving every vertex by λ times its own vector makes the volume an exact cubic in λ, whose root is found by Newton's method.

use glam::DVec3;
use isochore_mesh::sum_terms;

/// Newton's method ends when the volume is off by less than this share: a few roundings of its sum. Smaller never ends; larger
/// leaves volume behind.
const RESIDUAL: f64 = 1e-15;

/// Where rounding keeps Newton's method from [`RESIDUAL`], a root this good will do. Larger lets vertices be moved towards no
/// root at all; smaller refuses what rounding allows.
const ACCEPTED_RESIDUAL: f64 = 1e-13;

/// Newton's method on a cubic that is nearly linear doubles its digits each time: five to reach f64's, the rest for safety.
const MAX_ITERATIONS: usize = 60;

/// The coefficient of λ may be this small against the volume before dividing by it makes the shift explode. Larger gives up
/// where the lock is still harmless.
const LEAST_SLOPE: f64 = 1e-9;

/// Moves `positions` along `directions` by the common factor that makes the volume inside `triangles` equal to `volume`, and
/// returns the factor. None, and nothing moved, when the directions have no hold on the volume, so that no root brings it back.
pub(crate) fn balance(
    positions: &mut [DVec3],
    directions: &[DVec3],
    triangles: &[[u32; 3]],
    volume: f64,
) -> Option<f64> {
    solve(positions, directions, triangles, mean, volume, volume.abs())
}

/// The same for a part of a closed surface, at whose boundary the directions are zero: the volume inside the whole grows by `gain`.
/// `size` is that volume.
pub(crate) fn balance_part(
    positions: &mut [DVec3],
    directions: &[DVec3],
    triangles: &[[u32; 3]],
    gain: f64,
    size: f64,
) -> Option<f64> {
    // Cones to any one point differ by as much as the whole does.
    let center = mean(positions);
    let [volume, ..] = volume_cubic(positions, directions, triangles, center);
    solve(positions, directions, triangles, |_| center, volume + gain, size)
}

fn mean(positions: &[DVec3]) -> DVec3 {
    positions.iter().sum::<DVec3>() / positions.len() as f64
}

/// Makes the volume between the triangles and a center equal to `volume`, up to a share of `size`.
fn solve(
    positions: &mut [DVec3],
    directions: &[DVec3],
    triangles: &[[u32; 3]],
    center: impl Fn(&[DVec3]) -> DVec3,
    volume: f64,
    size: f64,
) -> Option<f64> {
    let mut total = 0.0;
    // The second pass takes back what rounding the moved coordinates has changed.
    let before = positions.to_vec();
    for _ in 0..2 {
        let [c0, c1, c2, c3] = volume_cubic(positions, directions, triangles, center(positions));
        let has_hold = c1.abs() > LEAST_SLOPE * size;
        let Some(lambda) = has_hold.then(|| root(c0 - volume, c1, c2, c3, size)).flatten() else {
            positions.copy_from_slice(&before);
            return None;
        };
        total += lambda;
        for index in 0..positions.len() {
            // Adding zero would turn a coordinate of −0 into +0.
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

/// The root of c0 + c1 λ + c2 λ² + c3 λ³ that Newton's method reaches from zero, to a residual that is a share of `size`; none
/// where it reaches none.
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
    fn a_root_is_found() {
        let (c0, c1, c2, c3) = (0.02, 1.0, 0.3, 0.1);
        let lambda = root(c0, c1, c2, c3, 1.0).unwrap();
        assert!((c0 + lambda * (c1 + lambda * (c2 + lambda * c3))).abs() <= RESIDUAL);
    }

    #[test]
    fn what_has_no_root_moves_nothing() {
        assert_eq!(root(1.0, 0.1, 1.0, 0.0, 1.0), None);
        assert_eq!(root(1.0, 0.0, 0.0, 0.0, 1.0), None);
    }
}
