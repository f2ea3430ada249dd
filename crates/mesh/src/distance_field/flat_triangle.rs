use super::lanes::{LANES, Lanes3, at, cross, direction, dot, minus, perpendicular, select, square};
use super::packet::Packet;
use crate::extremes::{max, min};

/// A triangle in its own plane, with corners at (0, 0), (`base`, 0) and `left_length` · `left`.
#[derive(Debug, Clone, Copy, bytemuck::Zeroable)]
pub(super) struct FlatTriangle {
    origin: [f32; 3],
    along: [f32; 3],
    across: [f32; 3],
    normal: [f32; 3],
    base: f32,
    /// Unit vector from the second corner to the third.
    right: [f32; 2],
    right_length: f32,
    /// Unit vector from the first corner to the third.
    left: [f32; 2],
    left_length: f32,
}

impl FlatTriangle {
    /// Sets up one triangle per lane, with the longest edge of each along the first axis. This
    /// keeps slivers well-conditioned. A triangle without area gets any plane through its longest
    /// edge.
    #[inline(always)]
    pub(super) fn set_each(triangles: &mut [Self], corners: &[Lanes3; 3]) {
        let [mut base, mut right_length, mut left_length] = [[0.0; LANES]; 3];
        let [mut origins, mut alongs, mut acrosses, mut normals] = [[[0.0; LANES]; 3]; 4];
        let [mut rights, mut lefts] = [[[0.0; LANES]; 2]; 2];
        for i in 0..LANES {
            let (p, q, r) = (at(&corners[0], i), at(&corners[1], i), at(&corners[2], i));
            let (pq, qr, rp) = (square(minus(q, p)), square(minus(r, q)), square(minus(p, r)));
            // Rotate the corners cyclically so that the edge from a to b is the longest.
            let is_first = (pq >= qr) & (pq >= rp);
            let is_second = qr >= rp;
            let a = select(is_first, p, select(is_second, q, r));
            let b = select(is_first, q, select(is_second, r, p));
            let c = select(is_first, r, select(is_second, p, q));
            // Axes of the plane: along the base, and across it toward the apex.
            let (along, length) = direction(minus(b, a), [1.0, 0.0, 0.0]);
            let to_apex = minus(c, a);
            let u = dot(along, to_apex);
            let across = perpendicular(along, to_apex);
            let apex = [u, dot(across, to_apex), 0.0];
            // An edge of length zero may have any direction.
            let (right, right_size) = direction([apex[0] - length, apex[1], 0.0], [1.0, 0.0, 0.0]);
            let (left, left_size) = direction(apex, [1.0, 0.0, 0.0]);
            let normal = cross(along, across);
            for axis in 0..3 {
                origins[axis][i] = a[axis] as f32;
                alongs[axis][i] = along[axis] as f32;
                acrosses[axis][i] = across[axis] as f32;
                normals[axis][i] = normal[axis] as f32;
            }
            for axis in 0..2 {
                rights[axis][i] = right[axis] as f32;
                lefts[axis][i] = left[axis] as f32;
            }
            base[i] = length as f32;
            right_length[i] = right_size as f32;
            left_length[i] = left_size as f32;
        }
        for (i, triangle) in triangles.iter_mut().enumerate().take(LANES) {
            *triangle = Self {
                origin: [origins[0][i], origins[1][i], origins[2][i]],
                along: [alongs[0][i], alongs[1][i], alongs[2][i]],
                across: [acrosses[0][i], acrosses[1][i], acrosses[2][i]],
                normal: [normals[0][i], normals[1][i], normals[2][i]],
                base: base[i],
                right: [rights[0][i], rights[1][i]],
                right_length: right_length[i],
                left: [lefts[0][i], lefts[1][i]],
                left_length: left_length[i],
            };
        }
    }

    /// Assigns the triangle, number `slot`, to the lanes for which it is nearer than their current
    /// one.
    ///
    /// The loops have no branches and are separate. With a comparison in the first loop, the
    /// compiler either does not vectorize it, or loads the operands of one branch lane by lane.
    #[inline(always)]
    pub(super) fn update(&self, packet: &mut Packet, slot: u32) {
        let [mut above, mut to_border, mut inside] = [[0.0; LANES]; 3];
        for i in 0..LANES {
            // Coordinates in the frame of the triangle: along the base, across it, and height above
            // the plane.
            let (x, y, z) = (packet.x[i] - self.origin[0], packet.y[i] - self.origin[1], packet.z[i] - self.origin[2]);
            let u = x * self.along[0] + y * self.along[1] + z * self.along[2];
            let v = x * self.across[0] + y * self.across[1] + z * self.across[2];
            let w = x * self.normal[0] + y * self.normal[1] + z * self.normal[2];

            // Squared distances within the plane to the three edges, each clamped to its length.
            let past_base = u - clamp(u, self.base);
            let to_base = past_base * past_base + v * v;

            let u_right = u - self.base;
            let along_right = u_right * self.right[0] + v * self.right[1];
            let from_right = self.right[0] * v - self.right[1] * u_right;
            let past_right = along_right - clamp(along_right, self.right_length);
            let to_right = past_right * past_right + from_right * from_right;

            let along_left = u * self.left[0] + v * self.left[1];
            let from_left = self.left[1] * u - self.left[0] * v;
            let past_left = along_left - clamp(along_left, self.left_length);
            let to_left = past_left * past_left + from_left * from_left;

            above[i] = w * w;
            to_border[i] = min(to_base, min(to_right, to_left));
            inside[i] = min(v, min(from_right, from_left));
        }
        let mut squared = [0.0; LANES];
        for i in 0..LANES {
            squared[i] = above[i] + if inside[i] > 0.0 { 0.0 } else { to_border[i] };
        }
        for i in 0..LANES {
            packet.slot[i] = if squared[i] < packet.squared[i] { slot } else { packet.slot[i] };
            packet.squared[i] = min(squared[i], packet.squared[i]);
        }
    }
}

/// Clamps `x` to the range from zero to `limit`.
#[inline(always)]
fn clamp(x: f32, limit: f32) -> f32 {
    min(max(x, 0.0), limit)
}
