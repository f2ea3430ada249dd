//! Surfaces swept by a rigid planar cross-section along a spine, and their regularity and
//! curvature.
//!
//! With rotation-minimizing frames, the parameter lines of a swept surface are lines of curvature, a
//! straight cross-section gives a developable surface, and the offsets are swept surfaces of the
//! same kind. The paper calls them *profile surfaces*.
//!
//! Source: Mäurer and Jüttler 1999, section 2. Correction: the normal (10) and the curvature (11)
//! of the paper have opposite signs. With the normal (10), K = −κ_u κ_v cos θ.

use glam::{DVec2, DVec3};

use crate::{CurveJet, Frame};

mod patch;

pub use patch::{RationalCrossSection, RationalPatch, SurfaceJet};

/// A grid of points, with one row per station and one column per point of the cross-section.
#[derive(Debug, Clone, PartialEq)]
pub struct PointGrid {
    /// Points row by row, model units.
    pub points: Vec<DVec3>,
    /// Number of rows.
    pub rows: usize,
    /// Number of columns.
    pub columns: usize,
}

impl PointGrid {
    /// Point in `row` and `column`.
    ///
    /// # Panics
    /// If the row or column is out of range.
    pub fn point(&self, row: usize, column: usize) -> DVec3 {
        assert!(column < self.columns, "column {column} is out of range: the grid has {} columns", self.columns);
        self.points[row * self.columns + column]
    }

    /// Points of one row.
    ///
    /// # Panics
    /// If the row is out of range.
    pub fn row(&self, row: usize) -> &[DVec3] {
        &self.points[row * self.columns..(row + 1) * self.columns]
    }
}

/// Sweeps `cross_section`, given by coordinates along r and s, along `stations` of a spine.
///
/// # Examples
/// ```
/// use glam::{DVec2, DVec3};
/// use isochore_curve::{Frame, sweep};
///
/// let frame = Frame::new(DVec3::X, DVec3::Z);
/// let grid = sweep(&[(DVec3::ZERO, frame), (DVec3::Z, frame)], &[DVec2::X, DVec2::Y]);
/// assert_eq!(grid.row(1), [DVec3::new(1.0, 0.0, 1.0), DVec3::new(0.0, 1.0, 1.0)]);
/// ```
pub fn sweep(stations: &[(DVec3, Frame)], cross_section: &[DVec2]) -> PointGrid {
    sweep_varying(stations, cross_section.len(), |_, column| cross_section[column])
}

/// Sweeps a cross-section of `columns` points that varies along the spine. `cross_section(station,
/// column)` returns coordinates along r and s.
pub fn sweep_varying(
    stations: &[(DVec3, Frame)],
    columns: usize,
    cross_section: impl Fn(usize, usize) -> DVec2,
) -> PointGrid {
    let points = stations
        .iter()
        .enumerate()
        .flat_map(|(row, (point, frame))| {
            let cross_section = &cross_section;
            (0..columns).map(move |column| *point + frame.offset(cross_section(row, column)))
        })
        .collect();
    PointGrid { points, rows: stations.len(), columns }
}

/// Margin of condition (9): 1 − κ n · p for the point p of the cross-section. The swept surface is
/// regular if the margin is positive. It is also the ratio of the speed of the swept point to the
/// speed of the spine.
pub fn regularity(spine: &CurveJet, frame: &Frame, point: DVec2) -> f64 {
    1.0 - spine.curvature_vector().dot(frame.offset(point))
}

/// Radius of the largest disk in which every cross-section gives a regular surface: 1/κ_max over
/// `jets`, infinite for a straight spine.
pub fn safe_cross_section_radius(jets: &[CurveJet]) -> f64 {
    1.0 / jets.iter().map(CurveJet::curvature).fold(0.0, f64::max)
}

/// A point of a cross-section with its first two derivatives, with coordinates along r and s.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CrossSectionJet {
    /// Position.
    pub position: DVec2,
    /// First derivative.
    pub first: DVec2,
    /// Second derivative.
    pub second: DVec2,
}

impl CrossSectionJet {
    /// Signed curvature κ_u, positive for a left turn (equation 11). Zero if the speed is zero.
    pub fn curvature(&self) -> f64 {
        let speed = self.first.length();
        if speed == 0.0 { 0.0 } else { self.first.perp_dot(self.second) / (speed * speed * speed) }
    }

    /// Right-hand normal (c₃′, −c₂′)/|c′|, which is also the normal of the swept surface
    /// (equation 10).
    pub fn normal(&self) -> DVec2 {
        DVec2::new(self.first.y, -self.first.x).normalize_or_zero()
    }
}

/// Gaussian curvature of the surface swept with a rotation-minimizing frame, K = −κ_u κ_v cos θ
/// (equation 13 with the sign of the normal (10)). Returns `None` if the surface is singular.
pub fn swept_surface_curvature(spine: &CurveJet, frame: &Frame, cross_section: &CrossSectionJet) -> Option<f64> {
    let margin = regularity(spine, frame, cross_section.position);
    if margin == 0.0 {
        return None;
    }
    // κ_v cos θ is the component of the curvature vector of the line u = const along the surface
    // normal. The tangent of that line is parallel to the tangent of the spine, and its speed is
    // scaled by the margin.
    let across = spine.curvature_vector().dot(frame.offset(cross_section.normal())) / margin;
    Some(-cross_section.curvature() * across)
}
