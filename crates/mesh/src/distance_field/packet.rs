//! The nearest triangle for packets of neighboring grid nodes, in `f32` lanes.
//!
//! Neighbors share their way through the hierarchy and start from what the packet beside them found, and the arithmetic has no
//! branches, so that lanes become vector registers.

use glam::{DVec2, DVec3};

use crate::bvh::{Bvh, Node};

/// Nodes in a packet along x, y and z.
pub(super) const PACKET: [usize; 3] = [4, 2, 2];

/// Nodes in a packet.
pub(super) const LANES: usize = PACKET[0] * PACKET[1] * PACKET[2];

type Lanes = [f32; LANES];

/// Triangles prepared for the kernel, with the hierarchy to find them in.
pub(super) struct PacketSearch<'a> {
    bvh: &'a Bvh,
    triangles: Vec<FlatTriangle>,
}

/// A triangle in its own plane: corners at (0, 0), (`base`, 0) and `left_length` · `left`.
#[derive(Debug, Clone, Copy)]
struct FlatTriangle {
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

/// Points in the unit frame with the nearest triangles found so far.
#[derive(Debug, Clone)]
pub(super) struct Packet {
    pub(super) x: Lanes,
    pub(super) y: Lanes,
    pub(super) z: Lanes,
    /// Squared distances.
    squared: Lanes,
    /// Nearest triangles, in leaf order.
    pub(super) slot: [u32; LANES],
}

impl Packet {
    /// A packet that has found nothing yet.
    pub(super) fn new(points: [DVec3; LANES]) -> Self {
        Self {
            x: points.map(|p| p.x as f32),
            y: points.map(|p| p.y as f32),
            z: points.map(|p| p.z as f32),
            squared: [f32::INFINITY; LANES],
            slot: [0; LANES],
        }
    }

    /// Smallest and largest coordinates: those of the first and the last lane.
    fn bounds(&self) -> [[f32; 3]; 2] {
        [0, LANES - 1].map(|lane| [self.x[lane], self.y[lane], self.z[lane]])
    }

    /// The largest squared distance of all lanes.
    fn farthest(&self) -> f32 {
        self.squared.iter().copied().fold(0.0, greater)
    }
}

impl<'a> PacketSearch<'a> {
    pub(super) fn new(bvh: &'a Bvh) -> Self {
        Self { bvh, triangles: bvh.corners().iter().map(FlatTriangle::new).collect() }
    }

    /// Finds the nearest triangle for each lane. `guesses` are triangles likely to be near; they save time. `stack` is scratch.
    pub(super) fn search(&self, packet: &mut Packet, guesses: &[u32], stack: &mut Vec<(u32, f32)>) {
        for &slot in guesses {
            self.triangles[slot as usize].update(packet, slot);
        }
        let nodes = self.bvh.nodes();
        let bounds = packet.bounds();
        let mut farthest = packet.farthest();
        stack.clear();
        stack.push((0, 0.0));
        while let Some((index, squared)) = stack.pop() {
            let node = &nodes[index as usize];
            // The first test, for the box of all lanes, is coarse and cheap.
            if squared >= farthest || !may_improve(node, packet) {
                continue;
            }
            if node.count > 0 {
                for slot in node.first..node.first + node.count {
                    self.triangles[slot as usize].update(packet, slot);
                }
                farthest = packet.farthest();
            } else {
                let [left, right] =
                    [node.first, node.first + 1].map(|child| (child, apart(&nodes[child as usize], &bounds)));
                let (near, far) = if left.1 <= right.1 { (left, right) } else { (right, left) };
                if far.1 < farthest {
                    stack.push(far);
                }
                if near.1 < farthest {
                    stack.push(near);
                }
            }
        }
    }
}

impl FlatTriangle {
    /// Puts the longest edge along the first axis, which keeps slivers well-conditioned. A triangle without area lies in any
    /// plane through its longest edge.
    fn new(corners: &[DVec3; 3]) -> Self {
        let longest = (0..3)
            .max_by(|&i, &j| {
                let length2 = |k: usize| (corners[(k + 1) % 3] - corners[k]).length_squared();
                length2(i).total_cmp(&length2(j))
            })
            .unwrap_or(0);
        let [a, b, c] = [0, 1, 2].map(|k| corners[(longest + k) % 3]);
        let base = (b - a).length();
        let along = (b - a).try_normalize().unwrap_or(DVec3::X);
        let height = (c - a) - along * along.dot(c - a);
        let across = height.try_normalize().unwrap_or_else(|| along.any_orthonormal_vector());
        let apex = DVec2::new(along.dot(c - a), across.dot(c - a));
        let right = apex - DVec2::new(base, 0.0);
        let f = |v: DVec3| v.to_array().map(|x| x as f32);
        let f2 = |v: DVec2| v.normalize_or_zero().to_array().map(|x| x as f32);
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

    /// Takes the triangle for the lanes where it is nearer than what they have. Two loops without branches: with the comparison in the
    /// first, the compiler makes neither into vector code.
    fn update(&self, packet: &mut Packet, slot: u32) {
        let mut squared = [0.0; LANES];
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

            let inside = lesser(v, lesser(from_right, from_left));
            let in_plane = if inside > 0.0 { 0.0 } else { lesser(to_base, lesser(to_right, to_left)) };
            squared[i] = w * w + in_plane;
        }
        for i in 0..LANES {
            packet.slot[i] = if squared[i] < packet.squared[i] { slot } else { packet.slot[i] };
            packet.squared[i] = lesser(squared[i], packet.squared[i]);
        }
    }
}

/// Whether the box of a node is nearer than the best triangle in any lane.
#[inline]
fn may_improve(node: &Node, packet: &Packet) -> bool {
    let mut nearer = 0;
    for i in 0..LANES {
        let x = greater(greater(node.min[0] - packet.x[i], packet.x[i] - node.max[0]), 0.0);
        let y = greater(greater(node.min[1] - packet.y[i], packet.y[i] - node.max[1]), 0.0);
        let z = greater(greater(node.min[2] - packet.z[i], packet.z[i] - node.max[2]), 0.0);
        nearer |= u32::from(x * x + y * y + z * z < packet.squared[i]);
    }
    nearer != 0
}

/// Squared distance between the box of a node and that of a packet.
#[inline]
fn apart(node: &Node, [min, max]: &[[f32; 3]; 2]) -> f32 {
    let along = |axis: usize| greater(greater(node.min[axis] - max[axis], min[axis] - node.max[axis]), 0.0);
    let [x, y, z] = [along(0), along(1), along(2)];
    x * x + y * y + z * z
}

// `f32::min` and `max` also say what becomes of NaN, which costs three instructions more; there is none here.

#[inline]
fn lesser(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}

#[inline]
fn greater(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}

/// `x` clamped to the range from zero to `limit`.
#[inline]
fn clamp(x: f32, limit: f32) -> f32 {
    lesser(greater(x, 0.0), limit)
}
