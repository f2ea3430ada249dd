use glam::DVec3;

use super::{NONE, SurfaceTree};
use crate::{Aabb, bvh::closest_on_triangle};

/// Relative slack of pruning, as in [`crate::Bvh`]: a few rounding errors of squared distances. A
/// larger value visits boxes in vain; a smaller one could miss the nearest triangle by a rounding
/// error.
const PRUNING_SLACK: f64 = 1.0 + 1e-14;

/// A point of the surface found by a query.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SurfaceHit {
    /// The triangle.
    pub triangle: u32,
    /// The point, model units.
    pub point: DVec3,
    /// Distance: for a ray in multiples of its direction, for a closest point in model units.
    pub distance: f64,
}

impl SurfaceTree {
    /// Calls `visit` with every triangle whose leaf touches `bounds`, in unspecified order. Some of
    /// these triangles may be outside `bounds`.
    pub fn visit_box(&self, bounds: Aabb, visit: impl FnMut(u32)) {
        self.visit(|other| bounds.overlaps(other), visit);
    }

    /// Calls `visit` with every triangle of the leaves whose box, and every enclosing box,
    /// satisfies `may_touch`, in unspecified order.
    pub fn visit(&self, may_touch: impl Fn(Aabb) -> bool, mut visit: impl FnMut(u32)) {
        let mut stack = vec![0];
        while let Some(index) = stack.pop() {
            let node = &self.nodes[index as usize];
            if may_touch(node.bounds) {
                if node.child == NONE {
                    self.of_leaf(index).for_each(&mut visit);
                } else {
                    stack.extend([node.child + 1, node.child]);
                }
            }
        }
    }

    /// The first point of the surface along the ray from `origin`, from either side. Ties go to the
    /// triangle with the smallest index. `None` if the ray misses or is invalid.
    pub fn cast_ray(
        &self,
        origin: DVec3,
        direction: DVec3,
        corners: &impl Fn(u32) -> Option<[DVec3; 3]>,
    ) -> Option<SurfaceHit> {
        if !(origin.is_finite() && direction.is_finite() && direction != DVec3::ZERO) {
            return None;
        }
        let inverse = direction.recip();
        let enter = |bounds: Aabb, before: f64| -> Option<f64> {
            let (to_min, to_max) = ((bounds.min - origin) * inverse, (bounds.max - origin) * inverse);
            let (mut first, mut last) = (0.0_f64, before);
            for axis in 0..3 {
                // Along a side of the box the product is NaN, which `min` and `max` ignore.
                let (near, far) = if inverse[axis] < 0.0 { (to_max, to_min) } else { (to_min, to_max) };
                first = first.max(near[axis]);
                last = last.min(far[axis]);
            }
            (bounds.min.x <= bounds.max.x && first <= last * PRUNING_SLACK).then_some(first)
        };
        let mut best: Option<SurfaceHit> = None;
        let mut stack = vec![(0, 0.0)];
        while let Some((index, first)) = stack.pop() {
            let limit = best.map_or(f64::INFINITY, |hit| hit.distance);
            if first > limit {
                continue;
            }
            let node = &self.nodes[index as usize];
            if node.child == NONE {
                for triangle in self.of_leaf(index) {
                    let Some(distance) = corners(triangle).and_then(|corners| meet(origin, direction, &corners)) else {
                        continue;
                    };
                    let is_better = best.is_none_or(|best| (distance, triangle) < (best.distance, best.triangle));
                    if is_better {
                        best = Some(SurfaceHit { triangle, point: origin + distance * direction, distance });
                    }
                }
            } else {
                let children = [node.child, node.child + 1]
                    .map(|child| enter(self.nodes[child as usize].bounds, limit).map(|first| (child, first)));
                match children {
                    [Some(left), Some(right)] if left.1 <= right.1 => stack.extend([right, left]),
                    [left, right] => stack.extend([left, right].into_iter().flatten()),
                }
            }
        }
        best
    }

    /// The point of the surface nearest to `point`. Ties go to the triangle with the smallest
    /// index. `None` if the tree is empty or the point is not finite.
    pub fn closest_point(&self, point: DVec3, corners: &impl Fn(u32) -> Option<[DVec3; 3]>) -> Option<SurfaceHit> {
        if !point.is_finite() {
            return None;
        }
        let mut best: Option<(f64, SurfaceHit)> = None;
        let squared_to = |index: u32| {
            let distance = self.nodes[index as usize].bounds.distance(point);
            distance * distance
        };
        let mut stack = vec![(0, squared_to(0))];
        while let Some((index, squared)) = stack.pop() {
            if squared > best.map_or(f64::INFINITY, |(best, _)| best) * PRUNING_SLACK {
                continue;
            }
            let node = &self.nodes[index as usize];
            if node.child == NONE {
                for triangle in self.of_leaf(index) {
                    let Some(corners) = corners(triangle) else { continue };
                    let (found, squared) = closest_on_triangle(point, &corners);
                    if best.is_none_or(|(best, hit)| (squared, triangle) < (best, hit.triangle)) {
                        let hit = SurfaceHit { triangle, point: found.point, distance: squared.sqrt() };
                        best = Some((squared, hit));
                    }
                }
            } else {
                let (left, right) =
                    ((node.child, squared_to(node.child)), (node.child + 1, squared_to(node.child + 1)));
                stack.extend(if left.1 <= right.1 { [right, left] } else { [left, right] });
            }
        }
        best.map(|(_, hit)| hit)
    }
}

/// The intersection of a ray and a triangle, in multiples of its direction (T. Möller, B. Trumbore,
/// *Fast, Minimum Storage Ray/Triangle Intersection*, 1997). Edges belong to both of their
/// triangles.
fn meet(origin: DVec3, direction: DVec3, [a, b, c]: &[DVec3; 3]) -> Option<f64> {
    let (ab, ac) = (b - a, c - a);
    let across = direction.cross(ac);
    let determinant = ab.dot(across);
    if determinant == 0.0 {
        return None;
    }
    let from_a = origin - a;
    let u = from_a.dot(across) / determinant;
    let cross = from_a.cross(ab);
    let v = direction.dot(cross) / determinant;
    let distance = ac.dot(cross) / determinant;
    let is_inside = u >= -EDGE_SLACK && v >= -EDGE_SLACK && u + v <= 1.0 + EDGE_SLACK;
    (is_inside && distance >= 0.0 && distance.is_finite()).then_some(distance)
}

/// Distance beyond an edge, in barycentric coordinates, at which a ray still hits a triangle. A
/// larger value is visible at silhouettes; with a smaller one rays slip between two triangles by
/// rounding.
const EDGE_SLACK: f64 = 1e-12;
