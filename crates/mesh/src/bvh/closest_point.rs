use glam::DVec3;

/// Ratio of height to longest edge below which the edges of a triangle are tried in addition to its
/// plane. Larger: needless work. Smaller: rounding tilts the plane by 1e-16 over this number, and
/// the resulting point may be farther away than the nearest one by as much.
const SLIVER: f64 = 1e-4;

/// The part of a triangle that contains a point. Edges and vertices are numbered like the corners:
/// edge 0 runs from corner 0 to corner 1.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Feature {
    /// Inside the triangle.
    Face,
    /// Inside the edge from this corner to the next.
    Edge(u8),
    /// At this corner.
    Vertex(u8),
}

/// The point of a mesh that is nearest to a query point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ClosestPoint {
    /// Position on the mesh, model units.
    pub point: DVec3,
    /// Distance to the query point, not negative, model units.
    pub distance: f64,
    /// Index of the triangle that contains the point.
    pub triangle: u32,
    /// The part of the triangle that contains the point.
    pub feature: Feature,
}

/// A triangle, given by its slot in leaf order, and the squared distance to it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct SquaredDistance {
    pub(crate) slot: u32,
    pub(crate) squared: f64,
}

/// A point on a triangle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct OnTriangle {
    pub(crate) point: DVec3,
    pub(crate) feature: Feature,
}

/// The point of a triangle that is nearest to `point`, and the square of its distance.
///
/// ```
/// use glam::{DVec3, dvec3};
/// use isochore_mesh::nearest_on_triangle;
///
/// let triangle = [DVec3::ZERO, DVec3::X, DVec3::Y];
/// assert_eq!(nearest_on_triangle(dvec3(-1.0, 0.5, 2.0), &triangle), (dvec3(0.0, 0.5, 0.0), 5.0));
/// ```
pub fn nearest_on_triangle(point: DVec3, corners: &[DVec3; 3]) -> (DVec3, f64) {
    let (nearest, squared) = closest_on_triangle(point, corners);
    (nearest.point, squared)
}

/// Returns the nearest point of a triangle and its squared distance.
///
/// Every candidate is a convex combination of corners, so the result is on the triangle even if the
/// triangle is a sliver.
pub(crate) fn closest_on_triangle(point: DVec3, corners: &[DVec3; 3]) -> (OnTriangle, f64) {
    let [a, b, c] = *corners;
    let edges = [b - a, c - b, a - c];
    let offsets = [point - a, point - b, point - c];
    let normal = edges[0].cross(-edges[2]);
    let area = normal.length_squared();

    let mut best = (OnTriangle { point: a, feature: Feature::Vertex(0) }, f64::INFINITY);
    // The barycentric coordinates of the projection, up to a common factor: twice the signed area
    // that the projection spans with each edge, times twice the area of the triangle.
    let spans = [0, 1, 2].map(|k| edges[k].cross(offsets[k]).dot(normal));
    if spans[0] > 0.0 && spans[1] > 0.0 && spans[2] > 0.0 {
        let projection = (a * spans[1] + b * spans[2] + c * spans[0]) / (spans[0] + spans[1] + spans[2]);
        best = (OnTriangle { point: projection, feature: Feature::Face }, (point - projection).length_squared());
        let longest = edges.map(DVec3::length_squared).into_iter().fold(0.0, f64::max);
        if area > (SLIVER * SLIVER) * longest * longest {
            // The projection is inside, and the plane is well-conditioned.
            return best;
        }
    }
    for k in 0..3 {
        let length2 = edges[k].length_squared();
        // Otherwise the nearest point is on an edge or at a corner, unless the projection is nearer
        // still.
        let along = offsets[k].dot(edges[k]);
        let (candidate, feature) = if along <= 0.0 {
            (corners[k], Feature::Vertex(k as u8))
        } else if along >= length2 {
            (corners[(k + 1) % 3], Feature::Vertex((k as u8 + 1) % 3))
        } else {
            (corners[k] + edges[k] * (along / length2), Feature::Edge(k as u8))
        };
        let squared = (point - candidate).length_squared();
        if squared < best.1 {
            best = (OnTriangle { point: candidate, feature }, squared);
        }
    }
    best
}
