//! The closest sheets of a surface.

use glam::DVec3;

use crate::deform::tessellation::Tessellation;

/// Two sheets of a surface that come close to each other.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sheets {
    /// Distance between them, model units.
    pub gap: f64,
    /// The point midway between them, model units.
    pub at: DVec3,
}

/// Triangles around a crossing among which the sheets are searched. A larger value takes longer; a
/// smaller value may miss the other sheet where triangles are small.
const SEARCHED: usize = 256;

/// Cosine between the normals of two sheets that face each other, at most. A larger value takes parts of
/// one curved sheet for two; a smaller value misses sheets that meet at an angle.
const FACING: f64 = -0.2;

impl Sheets {
    /// The gap between two triangles that do not cross: the shortest of the distances between their
    /// edges, and from the corners of each to the other.
    pub fn between(a: [DVec3; 3], b: [DVec3; 3]) -> Self {
        let edge = |corners: [DVec3; 3], side: usize| [corners[side], corners[(side + 1) % 3]];
        let edges = (0..9).map(|index| closest_on_segments(edge(a, index / 3), edge(b, index % 3)));
        let corners = (0..3).flat_map(|index| [[a[index], foot(a[index], b)], [b[index], foot(b[index], a)]]);
        let sheets = |[p, q]: [DVec3; 2]| Self { gap: p.distance(q), at: 0.5 * (p + q) };
        let none = Self { gap: f64::INFINITY, at: a[0] };
        edges.chain(corners).map(sheets).fold(none, |one, other| if other.gap < one.gap { other } else { one })
    }

    /// The closest two sheets among some triangles, given by the numbers of their vertices and their
    /// corners: triangles without a common vertex that face in opposite directions. `None` if there are
    /// none. Takes time proportional to the square of the number of triangles.
    ///
    /// ```
    /// use glam::DVec3;
    /// use isochore_field::Sheets;
    ///
    /// let lower = [DVec3::ZERO, DVec3::X, DVec3::Y];
    /// let upper = [DVec3::Z, DVec3::Z + DVec3::Y, DVec3::Z + DVec3::X];
    /// let sheets = Sheets::closest(&[([0, 1, 2], lower), ([3, 4, 5], upper)]).unwrap();
    /// assert_eq!(sheets.gap, 1.0);
    /// ```
    pub fn closest(triangles: &[([u32; 3], [DVec3; 3])]) -> Option<Self> {
        let directions: Vec<DVec3> =
            triangles.iter().map(|(_, [a, b, c])| (*b - *a).cross(*c - *a).normalize_or_zero()).collect();
        let mut closest: Option<Self> = None;
        for (index, (vertices, one)) in triangles.iter().enumerate() {
            for (other_index, (others, other)) in triangles[..index].iter().enumerate() {
                let are_neighbors = others.iter().any(|vertex| vertices.contains(vertex));
                if are_neighbors || directions[index].dot(directions[other_index]) > FACING {
                    continue;
                }
                let sheets = Self::between(*one, *other);
                if closest.is_none_or(|closest| sheets.gap < closest.gap) {
                    closest = Some(sheets);
                }
            }
        }
        closest
    }
}

/// The place where a pair of triangles crosses.
pub(in crate::deform) fn crossing_place(mesh: &Tessellation, image: &[DVec3], pair: [u32; 2]) -> DVec3 {
    let [a, b] = pair.map(|index| mesh.triangles[index as usize].map(|vertex| image[vertex as usize]));
    Sheets::between(a, b).at
}

/// The closest two sheets at the positions `image` around a place.
pub(in crate::deform) fn closest_sheets(mesh: &Tessellation, image: &[DVec3], place: DVec3) -> Option<Sheets> {
    let corners = |index: u32| mesh.triangles[index as usize].map(|vertex| image[vertex as usize]);
    let middle = |[a, b, c]: [DVec3; 3]| (a + b + c) / 3.0;
    let mut near: Vec<(f64, u32)> =
        (0..mesh.triangles.len() as u32).map(|index| (middle(corners(index)).distance_squared(place), index)).collect();
    let searched = near.len().min(SEARCHED);
    if searched < near.len() {
        near.select_nth_unstable_by(searched, |one, other| one.0.total_cmp(&other.0).then(one.1.cmp(&other.1)));
    }
    let triangle = |&(_, index): &(f64, u32)| (mesh.triangles[index as usize], corners(index));
    Sheets::closest(&near[..searched].iter().map(triangle).collect::<Vec<_>>())
}

/// The closest points of two segments.
///
/// Source: C. Ericson, *Real-Time Collision Detection*, 2005, section 5.1.9.
fn closest_on_segments([p, p_end]: [DVec3; 2], [q, q_end]: [DVec3; 2]) -> [DVec3; 2] {
    let (u, v, w) = (p_end - p, q_end - q, p - q);
    let (uu, uv, vv) = (u.dot(u), u.dot(v), v.dot(v));
    let (uw, vw) = (u.dot(w), v.dot(w));
    let ratio = |above: f64, below: f64| if below > 0.0 { (above / below).clamp(0.0, 1.0) } else { 0.0 };
    let s = ratio(uv * vw - vv * uw, uu * vv - uv * uv);
    let t = ratio(uv * s + vw, vv);
    // The end of the second segment that was reached may have another closest point on the first.
    let s = ratio(uv * t - uw, uu);
    [p + s * u, q + t * v]
}

/// The orthogonal projection of a point onto the plane of a triangle if it is inside the triangle, else a
/// corner.
fn foot(point: DVec3, [a, b, c]: [DVec3; 3]) -> DVec3 {
    let normal = (b - a).cross(c - a);
    let area2 = normal.length_squared();
    if area2 == 0.0 {
        return a;
    }
    let foot = point - (point - a).dot(normal) / area2 * normal;
    let is_inside = [(a, b), (b, c), (c, a)].iter().all(|(a, b)| (*b - *a).cross(foot - *a).dot(normal) >= 0.0);
    if is_inside { foot } else { a }
}

#[cfg(test)]
mod tests {
    use glam::dvec3;

    use super::*;

    const FLAT: [DVec3; 3] = [DVec3::ZERO, DVec3::X, DVec3::Y];

    #[test]
    fn a_corner_above_a_triangle() {
        let above = [dvec3(0.25, 0.25, 0.1), dvec3(0.25, 0.25, 1.0), dvec3(0.5, 0.25, 1.0)];
        let sheets = Sheets::between(FLAT, above);
        assert!((sheets.gap - 0.1).abs() < 1e-15);
        assert!(sheets.at.distance(dvec3(0.25, 0.25, 0.05)) < 1e-15);
    }

    #[test]
    fn crossing_directions_of_edges() {
        let beside = [dvec3(0.5, -0.2, -1.0), dvec3(0.5, -0.2, 1.0), dvec3(0.5, -2.0, 0.0)];
        let sheets = Sheets::between(FLAT, beside);
        assert!((sheets.gap - 0.2).abs() < 1e-15, "{sheets:?}");
        assert!(sheets.at.distance(dvec3(0.5, -0.1, 0.0)) < 1e-15);
    }

    #[test]
    fn triangles_without_area() {
        let point = [dvec3(0.0, 0.0, 2.0); 3];
        assert_eq!(Sheets::between(FLAT, point).gap, 2.0);
        assert_eq!(Sheets::between(point, point).gap, 0.0);
    }
}
