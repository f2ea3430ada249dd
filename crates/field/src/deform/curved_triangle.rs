//! A flat triangle and the curved image that it approximates.

use glam::DVec3;

/// Fraction of the facet error that one level of splitting removes. The error is proportional to the
/// square of the edge length, so the whole error is 4/3 of the volume that one level gains.
pub(crate) const GAIN_FRACTION: f64 = 0.75;

/// The image of a triangle with the images of the midpoints of its edges.
#[derive(Debug, Clone, Copy)]
pub(crate) struct CurvedTriangle {
    /// Images of the corners.
    pub(crate) corners: [DVec3; 3],
    /// Images of the midpoints of the edges 01, 12 and 20.
    pub(crate) midpoints: [DVec3; 3],
}

impl CurvedTriangle {
    /// Signed volume gained by splitting the flat triangle once at the images of its midpoints.
    ///
    /// Along each edge, the triangle of its ends and its midpoint closes the region. The neighbor is
    /// closed by the same triangle from the other side, so the sum over a closed surface is exactly
    /// the change of volume by the split.
    pub(crate) fn volume_gain(&self) -> f64 {
        let [a, b, c] = self.corners;
        let [ab, bc, ca] = self.midpoints.map(|midpoint| midpoint - a);
        let (b, c) = (b - a, c - a);
        // With the apex at a, only faces without a contribute: three parts, and the triangle that
        // closes the region along edge bc.
        let six_volumes = ab.cross(b).dot(bc) + ca.cross(bc).dot(c) + ab.cross(bc).dot(ca) + bc.cross(b).dot(c);
        six_volumes / 6.0
    }

    /// Offset of the midpoint of each edge from the mean of the images of its ends.
    pub(crate) fn deviations(&self) -> [DVec3; 3] {
        std::array::from_fn(|edge| self.midpoints[edge] - 0.5 * (self.corners[edge] + self.corners[(edge + 1) % 3]))
    }

    /// Lengths of the edges 01, 12 and 20 of the flat triangle.
    pub(crate) fn lengths(&self) -> [f64; 3] {
        edge_lengths(&self.corners)
    }

    /// Unit normal of the flat triangle, or zero if it has no area.
    pub(crate) fn normal(&self) -> DVec3 {
        let [a, b, c] = self.corners;
        (b - a).cross(c - a).normalize_or_zero()
    }
}

/// Lengths of the edges 01, 12 and 20.
pub(crate) fn edge_lengths(corners: &[DVec3; 3]) -> [f64; 3] {
    std::array::from_fn(|edge| corners[edge].distance(corners[(edge + 1) % 3]))
}
