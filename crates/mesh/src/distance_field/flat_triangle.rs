use glam::{DVec2, DVec3};

use super::packet::{LANES, Packet};
use crate::extremes::{greater, lesser};

/// A triangle in its own plane: corners at (0, 0), (`base`, 0) and `left_length` · `left`.
#[derive(Debug, Clone, Copy)]
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
    /// Puts the longest edge along the first axis, which keeps slivers well-conditioned. A triangle without area lies in any
    /// plane through its longest edge.
    pub(super) fn new(corners: &[DVec3; 3]) -> Self {
        let [ab, bc, ca] = [0, 1, 2].map(|k: usize| (corners[(k + 1) % 3] - corners[k]).length_squared());
        let longest = if ab >= bc && ab >= ca {
            0
        } else if bc >= ca {
            1
        } else {
            2
        };
        let [a, b, c] = [0, 1, 2].map(|k| corners[(longest + k) % 3]);
        let base = (b - a).length();
        let along = (b - a).try_normalize().unwrap_or(DVec3::X);
        let height = (c - a) - along * along.dot(c - a);
        let across = height.try_normalize().unwrap_or_else(|| along.any_orthonormal_vector());
        let apex = DVec2::new(along.dot(c - a), across.dot(c - a));
        let right = apex - DVec2::new(base, 0.0);
        let f = |v: DVec3| v.to_array().map(|x| x as f32);
        // An edge without length may have any direction, but must have one.
        let f2 = |v: DVec2| v.try_normalize().unwrap_or(DVec2::X).to_array().map(|x| x as f32);
        Self {
            origin: f(a),
            along: f(along),
            across: f(across),
            normal: f(along.cross(across)),
            base: base as f32,
            right: f2(right),
            right_length: right.length() as f32,
            left: f2(apex),
            left_length: apex.length() as f32,
        }
    }

    /// Takes the triangle, number `slot`, for the lanes where it is nearer than what they have.
    ///
    /// Several loops without branches: with a comparison in the first, the compiler either makes no vector code of it, or
    /// loads what only one side of the comparison needs lane by lane.
    #[inline(always)]
    pub(super) fn update(&self, packet: &mut Packet, slot: u32) {
        let [mut above, mut to_border, mut inside] = [[0.0; LANES]; 3];
        for i in 0..LANES {
            let (x, y, z) = (packet.x[i] - self.origin[0], packet.y[i] - self.origin[1], packet.z[i] - self.origin[2]);
            let u = x * self.along[0] + y * self.along[1] + z * self.along[2];
            let v = x * self.across[0] + y * self.across[1] + z * self.across[2];
            let w = x * self.normal[0] + y * self.normal[1] + z * self.normal[2];

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
            to_border[i] = lesser(to_base, lesser(to_right, to_left));
            inside[i] = lesser(v, lesser(from_right, from_left));
        }
        let mut squared = [0.0; LANES];
        for i in 0..LANES {
            squared[i] = above[i] + if inside[i] > 0.0 { 0.0 } else { to_border[i] };
        }
        for i in 0..LANES {
            packet.slot[i] = if squared[i] < packet.squared[i] { slot } else { packet.slot[i] };
            packet.squared[i] = lesser(squared[i], packet.squared[i]);
        }
    }
}

/// `x` clamped to the range from zero to `limit`.
#[inline(always)]
fn clamp(x: f32, limit: f32) -> f32 {
    lesser(greater(x, 0.0), limit)
}
