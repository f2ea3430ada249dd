//! The volume between a flat triangle and the curved image it stands for.

use glam::DVec3;

/// Splitting all triangles once removes this share of the facet error, which falls with the square of the edge length; so the
/// whole error is 4/3 of what one level of splitting shows.
pub(crate) const SHARE_SEEN: f64 = 0.75;

/// A triangle's image together with the images of its edges' midpoints.
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
    /// The region is closed along each edge by the triangle of the edge's ends and its midpoint. The neighbor is closed by the
    /// same triangle from the other side, so over a closed surface the sum is exactly the change of volume by the split.
    pub(crate) fn volume_gain(&self) -> f64 {
        let [a, b, c] = self.corners;
        let [ab, bc, ca] = self.midpoints.map(|midpoint| midpoint - a);
        let (b, c) = (b - a, c - a);
        // Seen from a, only the faces that do not contain a have volume: three parts, and the closing triangle of edge bc.
        let six_volumes = ab.cross(b).dot(bc) + ca.cross(bc).dot(c) + ab.cross(bc).dot(ca) + bc.cross(b).dot(c);
        six_volumes / 6.0
    }

    /// How far the midpoint of each edge lies from the middle of the images of its ends.
    pub(crate) fn deviations(&self) -> [DVec3; 3] {
        std::array::from_fn(|edge| self.midpoints[edge] - 0.5 * (self.corners[edge] + self.corners[(edge + 1) % 3]))
    }

    /// Lengths of the edges 01, 12 and 20 of the flat triangle.
    pub(crate) fn lengths(&self) -> [f64; 3] {
        edge_lengths(&self.corners)
    }

    /// Unit normal of the flat triangle; zero when it has no area.
    pub(crate) fn normal(&self) -> DVec3 {
        let [a, b, c] = self.corners;
        (b - a).cross(c - a).normalize_or_zero()
    }
}

/// Lengths of the edges 01, 12 and 20.
pub(crate) fn edge_lengths(corners: &[DVec3; 3]) -> [f64; 3] {
    std::array::from_fn(|edge| corners[edge].distance(corners[(edge + 1) % 3]))
}
