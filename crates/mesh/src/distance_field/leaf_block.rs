//! Preparation of leaf blocks.
//!
//! A leaf block is a small part of the hierarchy: adjacent leaves with up to [`LEAF_BLOCK`]
//! triangles. All of its triangles are prepared together, one per lane, with boxes aligned to the
//! surface.

use std::ops::Range;

use glam::{DMat3, DVec3};
use multiversion::multiversion;

use super::flat_triangle::FlatTriangle;
use super::lanes::{LANES, Lanes3, at, cross, direction, dot, minus, perpendicular, select, square};
use super::oriented_box::{OrientedBox, PackedBox};
use crate::Bvh;
use crate::bvh::Node;
use crate::extremes::{max, min};

/// Maximum number of triangles in a leaf block.
pub(super) const LEAF_BLOCK: u32 = LANES as u32;

/// Position, orientation and size of a leaf block or of a larger part of the hierarchy.
#[derive(Debug, Clone, Copy)]
pub(super) struct SubtreeSummary {
    /// Number of triangles.
    count: u32,
    /// Mean of the corners.
    center: DVec3,
    /// Sum of the area vectors of all triangles, flipped to the same side: the direction across the
    /// part.
    normal: DVec3,
    pub(super) obb: OrientedBox,
    /// Square of the length of the longest edge.
    pub(super) longest2: f64,
}

/// Output slices for one part of the hierarchy.
#[derive(Debug)]
pub(super) struct OutputSlice<'a> {
    /// Slot of the first triangle in `triangles`.
    pub(super) first_slot: u32,
    pub(super) triangles: &'a mut [FlatTriangle],
    /// Node of the first box in `boxes`.
    pub(super) first_box: usize,
    pub(super) boxes: &'a mut [PackedBox],
    /// Margin of the boxes, which covers their rounding.
    pub(super) rounding: f64,
}

impl SubtreeSummary {
    /// Merges two parts. The box of the result encloses `obbs`.
    pub(super) fn join(one: &Self, other: &Self, obbs: &[OrientedBox]) -> Self {
        let count = one.count + other.count;
        let weight = f64::from(one.count) / f64::from(count);
        let normal = one.normal + turned_along(one.normal, other.normal);
        Self {
            count,
            center: one.center * weight + other.center * (1.0 - weight),
            normal,
            obb: OrientedBox::across_and_along(normal, other.center - one.center).enclosing(obbs),
            longest2: max(one.longest2, other.longest2),
        }
    }
}

/// Triangles in lanes, with their extents along the axes of their leaf and of the block.
struct BlockLanes {
    /// Axes of the leaf of each lane.
    axes: [Lanes3; 3],
    along_leaf: Extents,
    along_block: Extents,
}

/// Smallest and largest coordinates along three axes.
struct Extents {
    min: Lanes3,
    max: Lanes3,
}

/// Prepares the triangles below a node, at most [`LEAF_BLOCK`], and the boxes of all nodes below
/// it. The first triangle is in `slot`.
///
/// The boxes of leaves are aligned to their own triangles, the boxes of inner nodes to the whole
/// block.
#[multiversion(targets("x86_64+avx512f+avx512vl", "x86_64+avx2", "x86_64+sse4.1", "aarch64+neon"))]
pub(super) fn prepare(bvh: &Bvh, node: usize, slot: u32, out: &mut OutputSlice<'_>) -> SubtreeSummary {
    let nodes = bvh.nodes();
    let count = nodes[node].count as usize;
    let mut corners = [[[0.0; LANES]; 3]; 3];
    for lane in 0..LANES {
        // Lanes without a triangle repeat the last one.
        let triangle = bvh.corners(slot + lane.min(count - 1) as u32);
        for k in 0..3 {
            for axis in 0..3 {
                corners[k][axis][lane] = triangle[k][axis];
            }
        }
    }
    let first = (slot - out.first_slot) as usize;
    FlatTriangle::set_each(&mut out.triangles[first..first + count], &corners);

    // Area vector, sum of corners, and longest edge of each triangle.
    let [mut areas, mut sums, mut edges] = [[[0.0; LANES]; 3]; 3];
    let mut longest2 = [0.0; LANES];
    for i in 0..LANES {
        let (a, b, c) = (at(&corners[0], i), at(&corners[1], i), at(&corners[2], i));
        let (ab, bc, ca) = (minus(b, a), minus(c, b), minus(a, c));
        let area = cross(ab, bc);
        let edge = select(square(ab) > square(bc), ab, bc);
        let edge = select(square(edge) > square(ca), edge, ca);
        for axis in 0..3 {
            areas[axis][i] = area[axis];
            sums[axis][i] = a[axis] + b[axis] + c[axis];
            edges[axis][i] = edge[axis];
        }
        longest2[i] = square(edge);
    }
    let vector = |lanes: &Lanes3, lane: usize| DVec3::from_array(at(lanes, lane));
    let (mut normal, mut sum) = (DVec3::ZERO, DVec3::ZERO);
    // Number of triangles below the first child; zero for a leaf.
    let half = if nodes[node].is_leaf() { 0 } else { nodes[nodes[node].first as usize].count as usize };
    let mut sum_of_half = DVec3::ZERO;
    let [mut normals, mut tangents] = [[[0.0; LANES]; 3]; 2];
    let mut longest = 0;
    let mut first = 0;
    // Sum up the whole block. Copy the normal and the longest edge of each leaf to all of its
    // lanes.
    for_leaves(bvh, node, &mut |leaf: &Node| {
        let lanes = first..first + leaf.count as usize;
        first = lanes.end;
        if lanes.start == half {
            sum_of_half = sum;
        }
        let (mut across, mut long) = (DVec3::ZERO, lanes.start);
        for lane in lanes.clone() {
            across += turned_along(across, vector(&areas, lane));
            sum += vector(&sums, lane);
            long = if longest2[lane] > longest2[long] { lane } else { long };
        }
        normal += turned_along(normal, across);
        longest = if longest2[long] > longest2[longest] { long } else { longest };
        for axis in 0..3 {
            normals[axis][lanes.clone()].fill(across[axis]);
            tangents[axis][lanes.clone()].fill(edges[axis][long]);
        }
    });
    let center = sum / (3.0 * count as f64);
    // An inner node extends from one child to the other. A leaf uses the axes of its longest edge.
    let tangent = if half > 0 { center - sum_of_half / (3.0 * half as f64) } else { DVec3::ZERO };
    let obb = OrientedBox::across_and_along(normal, tangent);

    // Axes of the leaf of each lane: across the surface, along its longest edge, and across both.
    let mut axes = [[[0.0; LANES]; 3]; 3];
    for i in 0..LANES {
        let (across, _) = direction(at(&normals, i), [1.0, 0.0, 0.0]);
        let along = perpendicular(across, at(&tangents, i));
        let third = cross(across, along);
        for axis in 0..3 {
            axes[0][axis][i] = across[axis];
            axes[1][axis][i] = along[axis];
            axes[2][axis][i] = third[axis];
        }
    }
    let along_leaf = Extents::of(&corners, &axes);
    // Not a closure passed to `array::map`: such a call is not inlined into code for other targets.
    let all = |vector: DVec3| [[vector.x; LANES], [vector.y; LANES], [vector.z; LANES]];
    let block_axes = [all(obb.axes.x_axis), all(obb.axes.y_axis), all(obb.axes.z_axis)];
    let lanes = BlockLanes { axes, along_leaf, along_block: Extents::of(&corners, &block_axes) };
    let mut summary = SubtreeSummary { count: count as u32, center, normal, obb, longest2: longest2[longest] };
    if nodes[node].is_leaf() {
        summary.obb = lanes.leaf(0, count);
    } else {
        (summary.obb.min, summary.obb.max) = lanes.boxes_below(bvh, node, &mut 0, &obb, out);
    }
    summary
}

/// Visits the leaves below a node in order.
fn for_leaves(bvh: &Bvh, node: usize, visit: &mut impl FnMut(&Node)) {
    let node = &bvh.nodes()[node];
    if node.is_leaf() {
        visit(node);
    } else {
        for_leaves(bvh, node.first as usize, visit);
        for_leaves(bvh, node.first as usize + 1, visit);
    }
}

impl Extents {
    #[inline(always)]
    fn of(corners: &[Lanes3; 3], axes: &[Lanes3; 3]) -> Self {
        let mut extents = Self { min: [[0.0; LANES]; 3], max: [[0.0; LANES]; 3] };
        for axis in 0..3 {
            for i in 0..LANES {
                let direction = at(&axes[axis], i);
                let a = dot(at(&corners[0], i), direction);
                let b = dot(at(&corners[1], i), direction);
                let c = dot(at(&corners[2], i), direction);
                extents.min[axis][i] = min(a, min(b, c));
                extents.max[axis][i] = max(a, max(b, c));
            }
        }
        extents
    }

    /// Returns the extents of several lanes together.
    fn joined(&self, lanes: Range<usize>) -> (DVec3, DVec3) {
        let (mut min, mut max) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        for lane in lanes {
            min = min.min(DVec3::from_array(at(&self.min, lane)));
            max = max.max(DVec3::from_array(at(&self.max, lane)));
        }
        (min, max)
    }
}

impl BlockLanes {
    /// Sets the boxes of the nodes below a node, then returns the extents of the node along the
    /// axes of the block.
    fn boxes_below(
        &self,
        bvh: &Bvh,
        node: usize,
        lane: &mut usize,
        block: &OrientedBox,
        out: &mut OutputSlice<'_>,
    ) -> (DVec3, DVec3) {
        let (mut min, mut max) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        let children = bvh.nodes()[node].first as usize;
        for child in [children, children + 1] {
            let node = &bvh.nodes()[child];
            let (own, (child_min, child_max)) = if node.is_leaf() {
                let (first, count) = (*lane, node.count as usize);
                *lane += count;
                (self.leaf(first, count), self.along_block.joined(first..first + count))
            } else {
                let (min, max) = self.boxes_below(bvh, child, lane, block, out);
                (OrientedBox { axes: block.axes, min, max }, (min, max))
            };
            out.boxes[child - out.first_box] = own.packed(out.rounding, node);
            (min, max) = (min.min(child_min), max.max(child_max));
        }
        (min, max)
    }

    /// Returns the box of the leaf in these lanes.
    fn leaf(&self, first: usize, count: usize) -> OrientedBox {
        let axes = [0, 1, 2].map(|axis| DVec3::from_array(at(&self.axes[axis], first)));
        let (min, max) = self.along_leaf.joined(first..first + count);
        OrientedBox { axes: DMat3::from_cols(axes[0], axes[1], axes[2]), min, max }
    }
}

/// Returns `vector` or its opposite, whichever is on the same side as `side`.
fn turned_along(side: DVec3, vector: DVec3) -> DVec3 {
    if side.dot(vector) < 0.0 { -vector } else { vector }
}
