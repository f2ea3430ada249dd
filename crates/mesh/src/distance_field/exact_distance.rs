use glam::DVec3;

use super::lanes::{LANES, cross, dot, minus};
use super::packet::NOTHING;
use crate::Bvh;
use crate::extremes::min;

type Lanes = [f64; LANES];

/// Points in the unit frame, in double precision.
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

/// Returns the squared distance of each point to the triangle in its slot; infinity for
/// [`NOTHING`].
///
/// A version of [`closest_on_triangle`](crate::bvh::closest_on_triangle) without branches. It takes
/// the minimum of the distances to the three edges and, if the point projects into the triangle, to
/// its plane. Every candidate is a convex combination of corners, so the result is accurate even
/// for slivers.
#[inline(always)]
pub(super) fn exact_squared_distances(points: &Points, bvh: &Bvh, slots: &[u32; LANES]) -> Lanes {
    // Gather the corners into lanes. Lanes without a triangle keep zeros.
    let mut corners = [const { Points::ZERO }; 3];
    for lane in 0..LANES {
        if slots[lane] != NOTHING {
            let triangle = bvh.corners(slots[lane]);
            for k in 0..3 {
                corners[k].set(lane, triangle[k]);
            }
        }
    }
    let mut squared = [0.0; LANES];
    for i in 0..LANES {
        let p = [points.x[i], points.y[i], points.z[i]];
        let [a, b, c] = [0, 1, 2].map(|k: usize| [corners[k].x[i], corners[k].y[i], corners[k].z[i]]);
        let edges = [minus(b, a), minus(c, b), minus(a, c)];
        let offsets = [minus(p, a), minus(p, b), minus(p, c)];
        let normal = cross(edges[0], minus(c, a));

        let to_edge = |k: usize| {
            let along = dot(offsets[k], edges[k]);
            let length2 = dot(edges[k], edges[k]);
            // Zero, not NaN, for an edge of length zero.
            let fraction = if along > 0.0 { along / length2 } else { 0.0 };
            let fraction = if fraction < 1.0 { fraction } else { 1.0 };
            let offset = [0, 1, 2].map(|axis: usize| offsets[k][axis] - fraction * edges[k][axis]);
            dot(offset, offset)
        };
        let to_border = min(to_edge(0), min(to_edge(1), to_edge(2)));

        // Barycentric coordinates of the projection, up to a common factor.
        let spans = [0, 1, 2].map(|k: usize| dot(cross(edges[k], offsets[k]), normal));
        let sum = spans[0] + spans[1] + spans[2];
        let offset = [0, 1, 2].map(|axis: usize| {
            (spans[1] * offsets[0][axis] + spans[2] * offsets[1][axis] + spans[0] * offsets[2][axis]) / sum
        });
        let to_plane = dot(offset, offset);
        let is_above = min(spans[0], min(spans[1], spans[2])) > 0.0;
        squared[i] = if is_above & (to_plane < to_border) { to_plane } else { to_border };
        squared[i] = if slots[i] == NOTHING { f64::INFINITY } else { squared[i] };
    }
    squared
}
