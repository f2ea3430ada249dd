//! Polygons into triangles, without flipping any.

use glam::{DVec2, DVec3};
use robust::{Coord, orient2d};

/// Splits a polygon into triangles of its corner numbers, two fewer than it has corners, turned as it is.
///
/// A quadrilateral is split along the diagonal that turns no triangle over; where both do not, along the one whose worse
/// triangle has the better shape. Larger polygons lose one ear after another, seen along their normal.
///
/// # Panics
/// If there are fewer than three corners.
pub(super) fn triangulate(polygon: &[DVec3], mut emit: impl FnMut([usize; 3])) {
    match *polygon {
        [_, _, _] => emit([0, 1, 2]),
        [a, b, c, d] => split_quadrilateral([a, b, c, d]).into_iter().for_each(emit),
        _ => clip_ears(&flatten(polygon), emit),
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

/// Area over squared edge lengths: greatest for the equilateral triangle, negative for one turned against `normal`.
fn signed_shape([a, b, c]: [DVec3; 3], normal: DVec3) -> f64 {
    let lengths = a.distance_squared(b) + b.distance_squared(c) + c.distance_squared(a);
    if lengths > 0.0 { (b - a).cross(c - a).dot(normal) / lengths } else { 0.0 }
}

/// The polygon seen along its normal (Newell's sum), counter-clockwise as a whole.
fn flatten(polygon: &[DVec3]) -> Vec<DVec2> {
    let origin = polygon[0];
    let mut normal = DVec3::ZERO;
    for (corner, &a) in polygon.iter().enumerate() {
        let b = polygon[(corner + 1) % polygon.len()];
        normal += (a - origin).cross(b - origin);
    }
    let axis = normal.abs().max_position();
    let (u, v) = match normal[axis] < 0.0 {
        true => ((axis + 2) % 3, (axis + 1) % 3),
        false => ((axis + 1) % 3, (axis + 2) % 3),
    };
    polygon.iter().map(|corner| DVec2::new(corner[u], corner[v])).collect()
}

/// Ear clipping (Meisters, "Polygons have ears", 1975). Where rounding or a crossing leaves no ear, the next corner is
/// cut off all the same, so that every edge of the polygon gets its triangle and no neighbor is left with a gap.
fn clip_ears(corners: &[DVec2], mut emit: impl FnMut([usize; 3])) {
    let turn = |a: usize, b: usize, c: usize| {
        let [a, b, c] = [corners[a], corners[b], corners[c]].map(|p| Coord { x: p.x, y: p.y });
        orient2d(a, b, c)
    };
    let count = corners.len();
    let mut ring: Vec<usize> = (0..count).collect();
    // A corner inside an ear is never a convex one, and convex corners stay convex.
    let not_convex = |&corner: &usize| turn((corner + count - 1) % count, corner, (corner + 1) % count) <= 0.0;
    let mut obstacles: Vec<usize> = (0..count).filter(not_convex).collect();
    let mut at = 0;
    let mut tried = 0;
    while ring.len() > 3 {
        let count = ring.len();
        let [before, ear, after] = [ring[(at + count - 1) % count], ring[at % count], ring[(at + 1) % count]];
        let is_inside = |&other: &usize| {
            ![before, ear, after].contains(&other)
                && turn(before, ear, other) >= 0.0
                && turn(ear, after, other) >= 0.0
                && turn(after, before, other) >= 0.0
        };
        let is_ear = turn(before, ear, after) > 0.0 && !obstacles.iter().any(is_inside);
        if is_ear || tried == count {
            emit([before, ear, after]);
            ring.remove(at % count);
            obstacles.retain(|&corner| corner != ear);
            // The corner after the next makes rounder triangles than another ear at the same place.
            at = (at + 1) % ring.len();
            tried = 0;
        } else {
            at = (at + 1) % count;
            tried += 1;
        }
    }
    emit([ring[0], ring[1], ring[2]]);
}
