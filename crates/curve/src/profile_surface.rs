//! Surfaces swept by a rigid planar profile along a spine, and the quantities by which they are judged.
//!
//! With rotation-minimizing frames these are profile surfaces: their parameter lines are lines of curvature, a straight
//! profile gives a developable, and offsets are again of this kind.
//!
//! Source: Mäurer and Jüttler 1999, section 2. The paper's normal (10) and curvature (11) have opposite signs; with the
//! normal K = −κ_u κ_v cos θ.

use glam::{DVec2, DVec3};

use crate::{CurveJet, Frame};

mod patch;

pub use patch::{RationalPatch, RationalCrossSection, SurfaceJet};

/// Rows of points, one row a station and one column a profile point.
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
    /// The point in `row` and `column`.
    ///
    /// # Panics
    /// If there is no such row or column.
    pub fn point(&self, row: usize, column: usize) -> DVec3 {
        assert!(column < self.columns, "column {column} of {}", self.columns);
        self.points[row * self.columns + column]
    }

    /// The points of one row.
    ///
    /// # Panics
    /// If there is no such row.
    pub fn row(&self, row: usize) -> &[DVec3] {
        &self.points[row * self.columns..(row + 1) * self.columns]
    }
}

/// Moves `profile`, given by coordinates along r and s, along `stations` of a spine.
pub fn sweep(stations: &[(DVec3, Frame)], profile: &[DVec2]) -> PointGrid {
    sweep_varying(stations, profile.len(), |_, column| profile[column])
}

/// Sweeps a profile of `columns` points that changes from station to station: `profile(station, column)` gives
/// coordinates along r and s.
pub fn sweep_varying(
    stations: &[(DVec3, Frame)],
    columns: usize,
    profile: impl Fn(usize, usize) -> DVec2,
) -> PointGrid {
    let points = stations
        .iter()
        .enumerate()
        .flat_map(|(row, (point, frame))| {
            let profile = &profile;
            (0..columns).map(move |column| *point + frame.offset(profile(row, column)))
        })
        .collect();
    PointGrid { points, rows: stations.len(), columns }
}

/// Condition (9) as a margin: 1 − κ n · p for the point p of the profile. The profile surface is regular where it is
/// positive, and the sweep there advances by this share of the spine's own step.
pub fn regularity(spine: &CurveJet, frame: &Frame, profile: DVec2) -> f64 {
    1.0 - spine.curvature_vector().dot(frame.offset(profile))
}

/// Radius within which every profile is safe on a spine: 1/κ_max over `jets`, infinite for straight spines.
pub fn safe_cross_section_radius(jets: &[CurveJet]) -> f64 {
    1.0 / jets.iter().map(CurveJet::curvature).fold(0.0, f64::max)
}

/// A point of a planar profile with its first two derivatives, coordinates along r and s.
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
    /// Signed curvature κ_u, positive where the profile turns left (equation 11). Zero where the speed vanishes.
    pub fn curvature(&self) -> f64 {
        let speed = self.first.length();
        if speed == 0.0 { 0.0 } else { self.first.perp_dot(self.second) / (speed * speed * speed) }
    }

    /// The profile's normal to its right, (c₃′, −c₂′)/|c′|, which is that of the profile surface (equation 10).
    pub fn normal(&self) -> DVec2 {
        DVec2::new(self.first.y, -self.first.x).normalize_or_zero()
    }
}

/// Gaussian curvature of the profile surface, K = −κ_u κ_v cos θ (equation 13 with the sign of the normal (10)). None
/// where the surface is singular.
pub fn profile_surface_curvature(spine: &CurveJet, frame: &Frame, profile: &CrossSectionJet) -> Option<f64> {
    let margin = regularity(spine, frame, profile.position);
    if margin == 0.0 {
        return None;
    }
    // κ_v cos θ is the curvature vector of the line u = const along the surface normal; that line runs parallel to the
    // spine, its speed scaled by the margin.
    let across = spine.curvature_vector().dot(frame.offset(profile.normal())) / margin;
    Some(-profile.curvature() * across)
}
