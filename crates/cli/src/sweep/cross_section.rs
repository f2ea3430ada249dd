//! The cross-section that a sweep moves along a curve.

use glam::{DVec2, DVec3};
use isochore_curve::RationalCrossSection;
use isochore_sculpt::files::CsvTable;

use crate::{arguments::SweepArguments, command_error::CommandError};

/// Number of points of a Bézier cross-section on a mesh.
const BEZIER_POINTS: usize = 33;

/// A cross-section read from a file: a polyline, a polygon or a rational Bézier curve.
#[derive(Debug)]
pub(super) struct CrossSection {
    /// Homogeneous control points; those of a polyline have unit weights.
    rows: Vec<DVec3>,
    is_bezier: bool,
    pub(super) is_closed: bool,
}

impl CrossSection {
    /// Reads the file of `--profile`.
    ///
    /// # Errors
    /// The file is not a table of two columns (or three with `--bezier`), has too few rows, a
    /// weight is not positive, or a closed cross-section repeats its first point.
    pub(super) fn read(arguments: &SweepArguments) -> Result<Self, CommandError> {
        let columns: &[usize] = if arguments.bezier { &[2, 3] } else { &[2] };
        let table = CsvTable::read(&arguments.profile, columns)?;
        let mut rows = Vec::with_capacity(table.rows().len());
        for (index, row) in table.rows().iter().enumerate() {
            let weight = row.get(2).copied().unwrap_or(1.0);
            if weight <= 0.0 {
                return Err(table.error(index, "the weight must be above 0").into());
            }
            rows.push((DVec2::new(row[0], row[1]) * weight).extend(weight));
        }
        let is_closed = arguments.profile_closed;
        let least = if is_closed { 3 } else { 2 };
        if rows.len() < least {
            let problem = format!("the cross-section needs at least {least} rows, not {}", rows.len());
            return Err(table.error_in_file(problem).into());
        }
        if is_closed && rows[0] == rows[rows.len() - 1] {
            let problem = "the row repeats the first point; remove it, because --profile-closed connects the ends";
            return Err(table.error(rows.len() - 1, problem).into());
        }
        Ok(Self { rows, is_bezier: arguments.bezier, is_closed })
    }

    /// Points to sweep, counter-clockwise if the cross-section is closed.
    pub(super) fn points(&self) -> Vec<DVec2> {
        if self.is_bezier {
            return (0..BEZIER_POINTS).map(|i| self.bezier_point(i as f64 / (BEZIER_POINTS - 1) as f64)).collect();
        }
        let mut points: Vec<DVec2> = self.rows.iter().map(|row| row.truncate()).collect();
        let doubled_area: f64 = (0..points.len()).map(|i| points[i].perp_dot(points[(i + 1) % points.len()])).sum();
        if self.is_closed && doubled_area < 0.0 {
            // A counter-clockwise cross-section makes the normals of the surface point outward.
            points.reverse();
        }
        points
    }

    /// Evaluates the Bézier curve by de Casteljau's algorithm.
    fn bezier_point(&self, parameter: f64) -> DVec2 {
        let mut points = self.rows.clone();
        while points.len() > 1 {
            points = points.windows(2).map(|pair| pair[0].lerp(pair[1], parameter)).collect();
        }
        points[0].truncate() / points[0].z
    }

    /// The rational curves that form the cross-section.
    pub(super) fn curves(&self) -> Vec<RationalCrossSection> {
        if self.is_bezier {
            return vec![RationalCrossSection { control_points: self.rows.clone() }];
        }
        let count = self.rows.len();
        let sides = if self.is_closed { count } else { count - 1 };
        (0..sides)
            .map(|i| RationalCrossSection { control_points: vec![self.rows[i], self.rows[(i + 1) % count]] })
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reverses_clockwise_cross_sections() {
        let rows = [(0.0, 0.0), (0.0, 1.0), (1.0, 0.0)].map(|(x, y)| DVec3::new(x, y, 1.0)).to_vec();
        let cross_section = CrossSection { rows, is_bezier: false, is_closed: true };
        assert_eq!(cross_section.points()[0], DVec2::X);
        assert_eq!(cross_section.curves().len(), 3);
    }

    #[test]
    fn weights_of_a_quarter_circle_give_unit_radius() {
        let weight = std::f64::consts::FRAC_1_SQRT_2;
        let rows = vec![DVec3::new(1.0, 0.0, 1.0), DVec3::new(weight, weight, weight), DVec3::new(0.0, 1.0, 1.0)];
        let cross_section = CrossSection { rows, is_bezier: true, is_closed: false };
        assert!(cross_section.points().iter().all(|point| (point.length() - 1.0).abs() < 1e-15));
    }
}
