//! Triangulation of polygons that keeps their orientation.

use earcut::Earcut;
use glam::DVec3;

/// Splits a polygon of n corners into n − 2 triangles of its corner indices, with its orientation.
///
/// A quadrilateral is split along the diagonal that flips neither triangle. If both diagonals
/// qualify, the one whose worse triangle has the better shape is taken. Larger polygons are
/// triangulated by ear clipping, projected along their normal. Every side of the polygon becomes
/// the side of a triangle, so no gap opens to a neighbor.
///
/// # Panics
/// If there are fewer than three corners.
pub(super) fn triangulate(polygon: &[DVec3], mut emit: impl FnMut([usize; 3])) {
    match *polygon {
        [_, _, _] => emit([0, 1, 2]),
        [a, b, c, d] => split_quadrilateral([a, b, c, d]).into_iter().for_each(emit),
        _ => clip_ears(polygon, emit),
    }
}

fn split_quadrilateral(corners: [DVec3; 4]) -> [[usize; 3]; 2] {
    let [a, b, c, d] = corners;
    let normal = (c - a).cross(d - b).normalize_or_zero();
    let splits = [[[0, 1, 2], [0, 2, 3]], [[0, 1, 3], [1, 2, 3]]];
    let worse_shape = |split: [[usize; 3]; 2]| {
        let shape = |triangle: [usize; 3]| signed_shape(triangle.map(|corner| corners[corner]), normal);
        shape(split[0]).min(shape(split[1]))
    };
    if worse_shape(splits[1]) > worse_shape(splits[0]) { splits[1] } else { splits[0] }
}

/// Area over the sum of squared edge lengths: largest for the equilateral triangle, negative for a
/// triangle oriented against `normal`.
fn signed_shape([a, b, c]: [DVec3; 3], normal: DVec3) -> f64 {
    let lengths = a.distance_squared(b) + b.distance_squared(c) + c.distance_squared(a);
    if lengths > 0.0 { (b - a).cross(c - a).dot(normal) / lengths } else { 0.0 }
}

fn clip_ears(polygon: &[DVec3], emit: impl FnMut([usize; 3])) {
    let mut ears: Vec<usize> = Vec::new();
    Earcut::new().earcut(flatten(polygon), &[], &mut ears);
    if ears.len() == 3 * (polygon.len() - 2) {
        // Corners in the order of the polygon have its orientation.
        ears.as_chunks().0.iter().map(|ear| sorted(*ear)).for_each(emit);
    } else {
        // The library skips corners if it finds no ear, as in a polygon without area.
        (2..polygon.len()).map(|corner| [0, corner - 1, corner]).for_each(emit);
    }
}

fn sorted(mut corners: [usize; 3]) -> [usize; 3] {
    corners.sort_unstable();
    corners
}

/// The polygon projected along the axis nearest to its normal (Newell's method).
fn flatten(polygon: &[DVec3]) -> impl Iterator<Item = [f64; 2]> {
    let origin = polygon[0];
    let mut normal = DVec3::ZERO;
    for (corner, &a) in polygon.iter().enumerate() {
        let b = polygon[(corner + 1) % polygon.len()];
        normal += (a - origin).cross(b - origin);
    }
    let axis = normal.abs().max_position();
    polygon.iter().map(move |&corner| {
        let corner = corner - origin;
        [corner[(axis + 1) % 3], corner[(axis + 2) % 3]]
    })
}
