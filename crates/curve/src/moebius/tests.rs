//! Test of the published center of inversion.

use super::*;
use crate::TrigonometricCurve;

/// Figure 2 of the paper: by the symmetry of a helix segment about its midpoint, the planar
/// tangents are parallel, and the cubic does not have an inflection.
#[test]
fn published_centers_fail_on_every_part_of_a_helix() {
    let helix = TrigonometricCurve::helix(1.0, 0.5, (0.0, std::f64::consts::PI));
    for (start, half_turns) in [(0.0, 0.5), (0.5, 0.5), (0.0, 0.1), (0.2, 0.7)] {
        let [start, end] = [start, start + half_turns].map(|at| helix.jet(std::f64::consts::PI * at));
        let ends = Ends::new(start.position, end.position, start.first, end.first).unwrap();
        let center = ends.opposite_center();
        let angles = ends
            .image_tangents(&center)
            .map(|tangent| libm::atan2(center.normal.dot(ends.chord.cross(tangent)), ends.chord.dot(tangent)));
        assert!((angles[0] - angles[1]).abs() < 1e-13, "parallel: {angles:?}");
        if half_turns == 0.5 {
            // The reference value has nine digits.
            assert!((angles[0] + 0.084_001_077_4).abs() < 5.1e-11, "{angles:?}");
        }
        assert!(ends.segment(&center).is_err());
    }
}
