//! Origins of inserted vertices on the mesh as opened.

use glam::DVec3;
use isochore_mesh::{Origin, TriMesh};

use super::opening::is_same_corner;

/// The point of the mesh halfway between two of its points.
///
/// Within one triangle, it is the mean of their barycentric coordinates. After flips and collapses,
/// the ends may be in different triangles, and their midpoint is off the mesh. Then the result is
/// the nearest point in the triangle `parent` and in those of the ends.
pub(super) fn midpoint_origin(mesh: &TriMesh, ends: [Origin; 2], parent: u32) -> Origin {
    let candidates = [parent, ends[0].triangle, ends[1].triangle];
    for triangle in candidates {
        let within = ends.map(|end| weights_in(mesh, &end, triangle));
        if let [Some(one), Some(other)] = within {
            return Origin { triangle, weights: 0.5 * (one + other) };
        }
    }
    let middle = 0.5 * (mesh.point_at(&ends[0]) + mesh.point_at(&ends[1]));
    nearest_origin(mesh, candidates, middle)
}

/// The point of the mesh with these barycentric coordinates between three of its points.
///
/// If the three are in different triangles that have no edge in common, the result is the nearest
/// point in the triangle `parent` and in those of the three.
pub(super) fn blended_origin(mesh: &TriMesh, corners: [Origin; 3], weights: DVec3, parent: u32) -> Origin {
    let candidates = [parent, corners[0].triangle, corners[1].triangle, corners[2].triangle];
    for triangle in candidates {
        let within = corners.map(|corner| weights_in(mesh, &corner, triangle));
        if let [Some(a), Some(b), Some(c)] = within {
            return Origin { triangle, weights: weights.x * a + weights.y * b + weights.z * c };
        }
    }
    let [a, b, c] = corners.map(|corner| mesh.point_at(&corner));
    nearest_origin(mesh, candidates, weights.x * a + weights.y * b + weights.z * c)
}

/// The point nearest to `point` in some triangles. Ties go to the first.
fn nearest_origin<const COUNT: usize>(mesh: &TriMesh, triangles: [u32; COUNT], point: DVec3) -> Origin {
    let mut best = (f64::INFINITY, Origin { triangle: triangles[0], weights: DVec3::X });
    for triangle in triangles {
        let weights = nearest_weights(point, &mesh.corners(triangle as usize));
        let origin = Origin { triangle, weights };
        let squared = mesh.point_at(&origin).distance_squared(point);
        if squared < best.0 {
            best = (squared, origin);
        }
    }
    best.1
}

/// Barycentric coordinates of `origin` in another triangle that contains it on an edge or at a
/// corner. `None` if that triangle does not contain it or is across a seam.
fn weights_in(mesh: &TriMesh, origin: &Origin, triangle: u32) -> Option<DVec3> {
    if origin.triangle == triangle {
        return Some(origin.weights);
    }
    let vertices = mesh.triangles[triangle as usize];
    let mut weights = [0.0; 3];
    for (side, weight) in origin.weights.to_array().into_iter().enumerate().filter(|&(_, weight)| weight != 0.0) {
        let vertex = mesh.triangles[origin.triangle as usize][side];
        let other = vertices.iter().position(|&other| other == vertex)?;
        if !is_same_corner(mesh, [(origin.triangle, side), (triangle, other)]) {
            return None;
        }
        weights[other] = weight;
    }
    Some(DVec3::from_array(weights))
}

/// Barycentric coordinates of the point of the triangle nearest to `point`, up to rounding.
pub(super) fn nearest_weights(point: DVec3, corners: &[DVec3; 3]) -> DVec3 {
    let [a, b, c] = *corners;
    let normal = (b - a).cross(c - a);
    let area = normal.length_squared();
    let spans = [(b, c), (c, a), (a, b)].map(|(from, to)| (to - from).cross(point - from).dot(normal));
    if area > 0.0 && spans.iter().all(|&span| span >= 0.0) {
        let sum: f64 = spans.iter().sum();
        return DVec3::from_array(spans) / sum;
    }
    // Outside: the nearest point is on an edge.
    let edges = [0, 1, 2].map(|side| {
        let (from, to) = (corners[side], corners[(side + 1) % 3]);
        let along = (point - from).dot(to - from) / (to - from).length_squared();
        let along = if along.is_finite() { along.clamp(0.0, 1.0) } else { 0.0 };
        let mut weights = [0.0; 3];
        (weights[side], weights[(side + 1) % 3]) = (1.0 - along, along);
        (from.lerp(to, along).distance_squared(point), DVec3::from_array(weights))
    });
    let nearest = edges.into_iter().reduce(|best, other| if other.0 < best.0 { other } else { best });
    nearest.map_or(DVec3::X, |(_, weights)| weights)
}

#[cfg(test)]
mod tests {
    use glam::{Vec2, dvec3, vec2};

    use super::*;

    /// Two triangles with the common edge from vertex 1 to vertex 2.
    fn pair() -> TriMesh {
        let positions = vec![dvec3(0.0, 0.0, 0.0), dvec3(1.0, 0.0, 0.0), dvec3(0.0, 1.0, 0.0), dvec3(1.0, 1.0, 0.0)];
        TriMesh::new(positions, vec![[0, 1, 2], [2, 1, 3]])
    }

    #[test]
    fn finds_midpoints_in_the_triangle_of_both_ends() {
        let mesh = pair();
        let at = |triangle, weights: [f64; 3]| Origin { triangle, weights: weights.into() };
        // From the middle of the common edge, in coordinates of the first triangle, to a corner of
        // the second.
        let found = midpoint_origin(&mesh, [at(0, [0.0, 0.5, 0.5]), at(1, [0.0, 0.0, 1.0])], 1);
        assert_eq!(found, at(1, [0.25, 0.25, 0.5]));
        // Between the far corners: the middle of the common edge.
        let found = midpoint_origin(&mesh, [at(0, [1.0, 0.0, 0.0]), at(1, [0.0, 0.0, 1.0])], 0);
        assert!(mesh.point_at(&found).distance(dvec3(0.5, 0.5, 0.0)) < 1e-15);
    }

    #[test]
    fn does_not_cross_a_seam() {
        let mut mesh = pair();
        let uv = |side: f32| [vec2(side, 0.0), vec2(side, 1.0), Vec2::ONE];
        mesh.corner.uvs = vec![vec![uv(0.0), uv(5.0)]];
        let end = Origin { triangle: 0, weights: dvec3(0.0, 1.0, 0.0) };
        assert_eq!(weights_in(&mesh, &end, 1), None);
        assert_eq!(weights_in(&pair(), &end, 1), Some(dvec3(0.0, 1.0, 0.0)));
    }
}
