use glam::DVec3;

use super::packet::{LANES, NOTHING};
use super::vector::{cross, dot, minus};
use crate::Bvh;
use crate::extremes::lesser;

type Lanes = [f64; LANES];

/// Points in the unit frame, in full precision.
#[derive(Debug, Clone)]
#[repr(align(64))]
pub(super) struct Points {
    pub(super) x: Lanes,
    pub(super) y: Lanes,
    pub(super) z: Lanes,
}

impl Points {
    pub(super) const ZERO: Self = Self { x: [0.0; LANES], y: [0.0; LANES], z: [0.0; LANES] };

    #[inline(always)]
    pub(super) fn set(&mut self, lane: usize, point: DVec3) {
        [self.x[lane], self.y[lane], self.z[lane]] = point.to_array();
    }
}

/// Squared distance of each point to the triangle in its slot; infinite for no triangle.
///
/// As [`closest_on_triangle`](crate::bvh::closest_on_triangle), but without branches: the least of the distances to the three
/// edges and, if the point is above the triangle, to its plane. Every candidate is a convex combination of corners, so that the
/// result is right however thin the triangle is.
#[inline(always)]
pub(super) fn exact_squared_distances(points: &Points, bvh: &Bvh, slots: &[u32; LANES]) -> Lanes {
    let mut held = [const { Points::ZERO }; 3];
    for lane in 0..LANES {
        if slots[lane] != NOTHING {
            let triangle = bvh.corners(slots[lane]);
            for k in 0..3 {
                held[k].set(lane, triangle[k]);
            }
        }
    }
    let mut squared = [0.0; LANES];
    for i in 0..LANES {
        let p = [points.x[i], points.y[i], points.z[i]];
        let [a, b, c] = [0, 1, 2].map(|k: usize| [held[k].x[i], held[k].y[i], held[k].z[i]]);
        let edges = [minus(b, a), minus(c, b), minus(a, c)];
        let offsets = [minus(p, a), minus(p, b), minus(p, c)];
        let normal = cross(edges[0], minus(c, a));

        let to_edge = |k: usize| {
            let along = dot(offsets[k], edges[k]);
            let length2 = dot(edges[k], edges[k]);
            // Zero, not NaN, on an edge without length.
            let share = if along > 0.0 { along / length2 } else { 0.0 };
            let share = if share < 1.0 { share } else { 1.0 };
            let apart = [0, 1, 2].map(|axis: usize| offsets[k][axis] - share * edges[k][axis]);
            dot(apart, apart)
        };
        let to_border = lesser(to_edge(0), lesser(to_edge(1), to_edge(2)));

        // Proportional to the areas that the projection of the point spans with the edges.
        let spans = [0, 1, 2].map(|k: usize| dot(cross(edges[k], offsets[k]), normal));
        let sum = spans[0] + spans[1] + spans[2];
        let apart = [0, 1, 2].map(|axis: usize| {
            (spans[1] * offsets[0][axis] + spans[2] * offsets[1][axis] + spans[0] * offsets[2][axis]) / sum
        });
        let to_plane = dot(apart, apart);
        let is_above = lesser(spans[0], lesser(spans[1], spans[2])) > 0.0;
        squared[i] = if is_above & (to_plane < to_border) { to_plane } else { to_border };
        squared[i] = if slots[i] == NOTHING { f64::INFINITY } else { squared[i] };
    }
    squared
}
