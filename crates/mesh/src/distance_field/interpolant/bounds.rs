//! Box of the points where a spline is below a value.
//!
//! In a slab between two neighboring planes of nodes, the spline is a convex combination of the
//! splines along the lines of nodes across the slab. Each of those is above the lower convex hull of
//! its four Bézier control values, hence above that of the least control values of all lines.

use super::Interpolant;
use crate::Aabb;
use crate::distance_field::Grid;
use crate::extremes::min;

/// Margin for the rounding of a point to grid coordinates, in cells. Larger: boxes grow without
/// need. Smaller: a point on the surface of the box may be missed.
const ROUNDING_CELLS: f64 = 1e-6;

impl Interpolant {
    /// Box of the points where the spline is below `value`, in either precision; empty if there are
    /// none. The box is slightly too large.
    pub(in crate::distance_field) fn bounds_below(&self, grid: &Grid, value: f64) -> Aabb {
        if self.geometry.is_none() {
            return Aabb::EMPTY;
        }
        let value = value + self.single_error();
        let mut bounds = Aabb::EMPTY;
        for axis in 0..3 {
            let slabs = 1..=grid.dims[axis] - 3;
            let minima = |slab: usize| least_controls(&self.coefficients, grid.dims, axis, slab - 1);
            let first = slabs.clone().find_map(|slab| {
                let [a, b, c, d] = minima(slab);
                Some(slab as f64 + 1.0 - last_below([d, c, b, a], value)?)
            });
            let last = slabs.rev().find_map(|slab| Some(slab as f64 + last_below(minima(slab), value)?));
            let (Some(first), Some(last)) = (first, last) else { return Aabb::EMPTY };
            bounds.min[axis] = grid.origin[axis] + grid.cell * (first - ROUNDING_CELLS);
            bounds.max[axis] = grid.origin[axis] + grid.cell * (last + ROUNDING_CELLS);
        }
        bounds
    }
}

/// The four least Bézier control values of all lines along `axis`, in the slab whose first
/// coefficient on a line is number `first`.
fn least_controls(coefficients: &[f32], dims: [usize; 3], axis: usize, first: usize) -> [f64; 4] {
    let strides = [1, dims[0], dims[0] * dims[1]];
    let (one, other) = ((axis + 1) % 3, (axis + 2) % 3);
    let mut least = [f64::INFINITY; 4];
    for v in 0..dims[other] {
        for u in 0..dims[one] {
            let start = first * strides[axis] + u * strides[one] + v * strides[other];
            let [a, b, c, d] = [0, 1, 2, 3].map(|node| f64::from(coefficients[start + node * strides[axis]]));
            let control = [(a + 4.0 * b + c) / 6.0, (2.0 * b + c) / 3.0, (b + 2.0 * c) / 3.0, (b + 4.0 * c + d) / 6.0];
            for (least, control) in least.iter_mut().zip(control) {
                *least = min(*least, control);
            }
        }
    }
    least
}

/// The last place from 0 to 1 where the convex hull of a Bézier curve's control values reaches below
/// `value`; `None` if it does not.
fn last_below(control: [f64; 4], value: f64) -> Option<f64> {
    let place = |index: usize| index as f64 / 3.0;
    let below = (0..4).filter(|&index| control[index] < value);
    below.fold(None, |last: Option<f64>, low| {
        let above = (low + 1..4).filter(|&index| control[index] >= value);
        // The edges of the hull that leave at the value connect a control value below with one
        // above.
        let crossings = above.map(|high| {
            let part = (value - control[low]) / (control[high] - control[low]);
            place(low) + part * (place(high) - place(low))
        });
        let end = crossings.fold(place(low), f64::max);
        Some(last.map_or(end, |last| last.max(end)))
    })
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;
    use crate::NoProgress;

    #[test]
    fn the_box_contains_all_points_below_the_value() {
        let grid = Grid { origin: DVec3::new(-3.0, 2.0, 0.5), cell: 0.1, dims: [19, 17, 23] };
        let middle = grid.bounds().center();
        // Two balls of radius 0.3, the second 0.35 farther along x and 0.2 along z.
        let distance = |point: DVec3| {
            let second = middle + DVec3::new(0.35, 0.0, 0.2);
            (point - middle).length().min((point - second).length()) - 0.3
        };
        let samples: Vec<f32> = (0..grid.len()).map(|index| distance(grid.node_at(index)) as f32).collect();
        let interpolant = Interpolant::new(&grid, &samples, &NoProgress).unwrap();
        let bounds = interpolant.bounds_below(&grid, 0.1);
        let exact = Aabb { min: middle - 0.4, max: middle + DVec3::new(0.75, 0.4, 0.6) };
        // Not larger than needed by more than a third of a cell.
        assert!(bounds.min.distance(exact.min).max(bounds.max.distance(exact.max)) < 0.033, "{bounds:?}");
        let mut block = crate::DistanceBlock::FAR;
        for index in 1..40_000 {
            let part = (f64::from(index) * DVec3::new(0.819_172_513, 0.671_043_607, 0.549_700_478)).fract();
            let point = grid.origin + grid.bounds().size() * part;
            interpolant.sample_single_into(&crate::PointBlock::splat(point), &mut block);
            assert!(block.value[0] >= 0.1 || bounds.distance(point) == 0.0, "{point}");
        }
        assert_eq!(interpolant.bounds_below(&grid, -0.6), Aabb::EMPTY);
    }

    #[test]
    fn a_box_ends_where_the_hull_of_the_control_values_does() {
        assert_eq!(last_below([0.0, 1.0, 2.0, 3.0], 1.5), Some(0.5));
        assert_eq!(last_below([3.0, 2.0, 1.0, 0.0], 1.5), Some(1.0));
        assert_eq!(last_below([2.0, 2.0, 1.5, 3.0], 1.5), None);
    }
}
