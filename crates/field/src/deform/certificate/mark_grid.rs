//! A coarse grid of marked cells, to find boxes that are near some others.

use glam::DVec3;
use isochore_mesh::Aabb;

/// Cells along the longest side. A larger value marks more cells per box; a smaller value finds more
/// boxes that are not near.
const CELLS: f64 = 96.0;

/// The cells of a box that some given boxes overlap.
#[derive(Debug)]
pub(super) struct MarkGrid {
    bounds: Aabb,
    cell: f64,
    dims: [usize; 3],
    is_marked: Vec<bool>,
}

impl MarkGrid {
    /// Marks all cells that `boxes` overlap.
    pub(super) fn of(boxes: impl Iterator<Item = Aabb> + Clone) -> Self {
        let bounds = boxes.clone().fold(Aabb::EMPTY, Aabb::union);
        let size = bounds.size();
        let cell = size.max_element() / CELLS;
        // Without extent, or beyond the range of numbers, a single cell stands for the whole.
        let count = |length: f64| if cell.is_normal() { (length / cell).ceil().clamp(1.0, CELLS) as usize } else { 1 };
        let dims = size.to_array().map(count);
        let mut grid = Self { bounds, cell, dims, is_marked: vec![false; dims.iter().product()] };
        for corners in boxes {
            let (from, to) = (grid.cell_of(corners.min), grid.cell_of(corners.max));
            for z in from[2]..=to[2] {
                for y in from[1]..=to[1] {
                    let row = grid.index([0, y, z]);
                    grid.is_marked[row + from[0]..=row + to[0]].fill(true);
                }
            }
        }
        grid
    }

    /// Whether a box overlaps a marked cell.
    pub(super) fn is_near(&self, corners: Aabb) -> bool {
        if !corners.overlaps(self.bounds) {
            return false;
        }
        let (from, to) = (self.cell_of(corners.min), self.cell_of(corners.max));
        (from[2]..=to[2]).any(|z| {
            (from[1]..=to[1]).any(|y| {
                let row = self.index([0, y, z]);
                self.is_marked[row + from[0]..=row + to[0]].contains(&true)
            })
        })
    }

    /// The cell that contains a point, or the nearest cell. Monotonic in each coordinate, so that
    /// overlapping boxes have a common cell.
    fn cell_of(&self, point: DVec3) -> [usize; 3] {
        let place = (point - self.bounds.min) / self.cell;
        // The cast saturates, and NaN becomes zero.
        std::array::from_fn(|axis| (place[axis] as usize).min(self.dims[axis] - 1))
    }

    fn index(&self, [x, y, z]: [usize; 3]) -> usize {
        (z * self.dims[1] + y) * self.dims[0] + x
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cube(center: DVec3, half: f64) -> Aabb {
        Aabb { min: center - half, max: center + half }
    }

    #[test]
    fn overlapping_boxes_are_near() {
        // Numbers without structure: fractional parts of multiples of irrational numbers.
        let point = |index: usize| (DVec3::new(0.618_034, 0.732_051, 0.414_214) * index as f64).fract();
        let boxes: Vec<Aabb> = (0..40).map(|index| cube(point(index), 0.03)).collect();
        let grid = MarkGrid::of(boxes.iter().copied());
        let mut near = 0;
        for index in 100..900 {
            let other = cube(point(index), 0.02);
            let does_overlap = boxes.iter().any(|marked| marked.overlaps(other));
            assert!(grid.is_near(other) || !does_overlap, "{other:?}");
            near += usize::from(grid.is_near(other));
        }
        assert!(near < 400, "{near} boxes count as near");
    }

    #[test]
    fn a_point_has_one_cell() {
        let grid = MarkGrid::of(std::iter::once(cube(DVec3::ONE, 0.0)));
        assert!(grid.is_near(cube(DVec3::ONE, 0.5)));
        assert!(!grid.is_near(cube(DVec3::ZERO, 0.5)));
    }
}
