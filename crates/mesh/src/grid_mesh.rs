//! Meshes of point grids, such as swept surfaces.

use earcut::Earcut;
use glam::{DVec2, DVec3};

use crate::TriMesh;

/// A grid of points, row by row, that is meshed with two triangles per cell.
///
/// Seen from outside, a step along a row followed by a step to the next row turns
/// counter-clockwise. A tube is therefore oriented outward if its rows run counter-clockwise about
/// the direction from the first row to the last.
///
/// ```
/// use glam::dvec3;
/// use isochore_mesh::GridMesh;
///
/// let points: Vec<_> = (0..6).map(|i| dvec3(f64::from(i % 3), f64::from(i / 3), 0.0)).collect();
/// let grid = GridMesh { points: &points, columns: 3, rows_close: false, columns_close: false };
/// assert_eq!(grid.mesh().triangles, [[0, 1, 4], [0, 4, 3], [1, 2, 5], [1, 5, 4]]);
/// ```
#[derive(Debug, Clone, Copy)]
pub struct GridMesh<'a> {
    /// Points, row by row, in model units.
    pub points: &'a [DVec3],
    /// Points in a row, at least two.
    pub columns: usize,
    /// Whether the last row connects to the first.
    pub rows_close: bool,
    /// Whether the last point of a row connects to its first.
    pub columns_close: bool,
}

impl GridMesh<'_> {
    /// The mesh of the grid, whose vertices are the points in their order. It is closed if both
    /// directions close.
    ///
    /// # Panics
    /// If the points do not fill whole rows, or there are more than 2³² of them.
    pub fn mesh(&self) -> TriMesh {
        assert!(self.columns > 0 && self.points.len().is_multiple_of(self.columns), "whole rows");
        let rows = self.points.len() / self.columns;
        let index = |row: usize, column: usize| {
            u32::try_from((row % rows) * self.columns + column % self.columns).expect("at most 2³² points")
        };
        let row_steps = if self.rows_close { rows } else { rows.saturating_sub(1) };
        let column_steps = if self.columns_close { self.columns } else { self.columns - 1 };
        let mut triangles = Vec::with_capacity(2 * row_steps * column_steps);
        for row in 0..row_steps {
            for column in 0..column_steps {
                let (a, b) = (index(row, column), index(row, column + 1));
                let (c, d) = (index(row + 1, column + 1), index(row + 1, column));
                triangles.extend([[a, b, c], [a, c, d]]);
            }
        }
        TriMesh { positions: self.points.to_vec(), triangles, ..TriMesh::default() }
    }

    /// The mesh with caps on its first and last rows. Both are triangulated as the interior of
    /// `outline`, a simple polygon with one corner per column, counter-clockwise seen from the side
    /// of the last row.
    ///
    /// # Panics
    /// As [`mesh`](Self::mesh), and if the outline does not have one corner per column.
    pub fn capped_mesh(&self, outline: &[DVec2]) -> TriMesh {
        assert_eq!(outline.len(), self.columns, "one corner per column");
        let mut mesh = self.mesh();
        let mut cap: Vec<u32> = Vec::new();
        Earcut::new().earcut(outline.iter().map(|corner| corner.to_array()), &[], &mut cap);
        let last_row = (self.points.len() - self.columns) as u32;
        for triangle in cap.chunks_exact(3) {
            // The library does not guarantee an orientation.
            let [a, b, c] = [triangle[0], triangle[1], triangle[2]].map(|corner| outline[corner as usize]);
            let [i, j, k] = if (b - a).perp_dot(c - a) >= 0.0 {
                [triangle[0], triangle[1], triangle[2]]
            } else {
                [triangle[0], triangle[2], triangle[1]]
            };
            mesh.triangles.push([i, k, j]);
            mesh.triangles.push([last_row + i, last_row + j, last_row + k]);
        }
        mesh
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ClosedMesh;

    /// A concave hexagon, counter-clockwise, of area 2.
    const OUTLINE: [DVec2; 6] = [
        DVec2::new(0.0, 0.0),
        DVec2::new(1.0, 0.5),
        DVec2::new(2.0, 0.0),
        DVec2::new(2.0, 1.5),
        DVec2::new(1.0, 1.0),
        DVec2::new(0.0, 1.5),
    ];

    fn prism() -> Vec<DVec3> {
        (0..4).flat_map(|row| OUTLINE.map(|corner| corner.extend(f64::from(row)))).collect()
    }

    #[test]
    fn capped_prism_is_closed_with_exact_volume() {
        let points = prism();
        let grid = GridMesh { points: &points, columns: 6, rows_close: false, columns_close: true };
        let mesh = grid.capped_mesh(&OUTLINE);
        assert_eq!(mesh.triangles.len(), 2 * 3 * 6 + 2 * 4);
        let closed = ClosedMesh::new(&mesh).unwrap();
        // Area 2 times height 3, positive for outward orientation.
        assert!((closed.volume() - 6.0).abs() < 1e-14);
    }

    #[test]
    fn torus_is_closed_in_both_directions() {
        let points: Vec<DVec3> = (0..40)
            .flat_map(|i| {
                let (sin, cos) = libm::sincos(std::f64::consts::TAU * f64::from(i) / 40.0);
                // Rows along +φ and columns counter-clockwise about it.
                (0..20).map(move |j| {
                    let (s, c) = libm::sincos(std::f64::consts::TAU * f64::from(j) / 20.0);
                    let radius = 2.0 - 0.5 * c;
                    DVec3::new(radius * cos, radius * sin, 0.5 * s)
                })
            })
            .collect();
        let grid = GridMesh { points: &points, columns: 20, rows_close: true, columns_close: true };
        let mesh = grid.mesh();
        let volume = ClosedMesh::new(&mesh).unwrap().volume();
        let exact = 2.0 * std::f64::consts::PI * std::f64::consts::PI * 2.0 * 0.25;
        // Inscribed n-gons lose 2π²/(3n²) of each area.
        assert!(volume > 0.0 && (volume / exact - 1.0).abs() < 0.03, "{volume} against {exact}");
    }

    #[test]
    fn open_grid_is_a_sheet() {
        let points = prism();
        let mesh = GridMesh { points: &points, columns: 6, rows_close: false, columns_close: false }.mesh();
        assert_eq!(mesh.triangles.len(), 2 * 3 * 5);
        assert!(ClosedMesh::new(&mesh).is_err());
    }
}
