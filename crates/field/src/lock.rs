//! The volume lock: a last small displacement that gives back exactly the volume at rest.
//!
//! Moving every vertex by λ times its own vector makes the volume an exact cubic in λ, whose root is found by Newton's method.
//! The vectors are the gradient of the volume weighted by how far each vertex has come, so that what did not move is not moved
//! and small triangles are moved least.

use glam::DVec3;
use isochore_mesh::sum_terms;

/// What the lock did.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Lock {
    /// Longest displacement of a vertex, model units.
    pub(crate) max_shift: f64,
    /// Largest ratio of a vertex' displacement to the shortest edge at it.
    pub(crate) max_shift_per_edge: f64,
}

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

/// Moves `image` so that its volume is `volume`. None, and nothing moved, when nothing had moved or the displacement has no
/// hold on the volume, so that no root brings it back.
pub(crate) fn lock_volume(rest: &[DVec3], image: &mut [DVec3], triangles: &[[u32; 3]], volume: f64) -> Option<Lock> {
    let directions = directions(rest, image, triangles)?;
    let mut total = 0.0;
    // The second pass takes back what rounding the moved coordinates has changed.
    let unlocked = image.to_vec();
    for _ in 0..2 {
        let [c0, c1, c2, c3] = volume_cubic(image, &directions, triangles);
        let has_hold = c1.abs() > LEAST_SLOPE * volume.abs();
        let Some(lambda) = has_hold.then(|| root(c0 - volume, c1, c2, c3, volume.abs())).flatten() else {
            image.copy_from_slice(&unlocked);
            return None;
        };
        total += lambda;
        for index in 0..image.len() {
            // Adding zero would turn a coordinate of −0 into +0.
            if directions[index] != DVec3::ZERO {
                image[index] = unlocked[index] + total * directions[index];
            }
        }
    }
    let shift = |vertex: u32| image[vertex as usize].distance(unlocked[vertex as usize]);
    let max_shift = (0..image.len() as u32).map(shift).fold(0.0, f64::max);
    let mut max_shift_per_edge: f64 = 0.0;
    for [a, b, c] in triangles {
        for (a, b) in [(*a, *b), (*b, *c), (*c, *a)] {
            let length = unlocked[a as usize].distance(unlocked[b as usize]);
            let longest = shift(a).max(shift(b));
            if longest > 0.0 {
                max_shift_per_edge = max_shift_per_edge.max(longest / length);
            }
        }
    }
    Some(Lock { max_shift, max_shift_per_edge })
}

/// For each vertex its area normal, scaled by its share of the largest displacement.
fn directions(rest: &[DVec3], image: &[DVec3], triangles: &[[u32; 3]]) -> Option<Vec<DVec3>> {
    let displacements: Vec<f64> = rest.iter().zip(image).map(|(rest, image)| rest.distance(*image)).collect();
    let largest = displacements.iter().copied().fold(0.0, f64::max);
    if largest == 0.0 {
        return None;
    }
    let mut directions = vec![DVec3::ZERO; image.len()];
    for triangle in triangles {
        let [a, b, c] = triangle.map(|vertex| image[vertex as usize]);
        // A sixth of the cross product is a third of the area, along the normal: the gradient of the volume at each corner.
        let gradient = (b - a).cross(c - a) / 6.0;
        for vertex in triangle {
            directions[*vertex as usize] += gradient;
        }
    }
    // Of the size of the mean area normal, so that λ is a length times a number near one.
    let scale = directions.iter().map(|direction| direction.length()).fold(0.0, f64::max);
    if scale == 0.0 {
        return None;
    }
    for (direction, displacement) in directions.iter_mut().zip(&displacements) {
        *direction *= displacement / largest / scale;
    }
    Some(directions)
}

/// Coefficients of the volume of `positions` + λ `directions`, in powers of λ.
fn volume_cubic(positions: &[DVec3], directions: &[DVec3], triangles: &[[u32; 3]]) -> [f64; 4] {
    let center = positions.iter().sum::<DVec3>() / positions.len() as f64;
    let det = |a: DVec3, b: DVec3, c: DVec3| a.dot(b.cross(c)) / 6.0;
    sum_terms(triangles.len(), |index| {
        let [a, b, c] = triangles[index].map(|vertex| positions[vertex as usize] - center);
        let [u, v, w] = triangles[index].map(|vertex| directions[vertex as usize]);
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
