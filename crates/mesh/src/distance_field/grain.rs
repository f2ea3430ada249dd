//! Triangles that are prepared for the search together, in vector registers: a small part of the hierarchy, with boxes along it.

use std::ops::Range;

use glam::{DMat3, DVec3};
use multiversion::multiversion;

use super::flat_triangle::FlatTriangle;
use super::oriented_box::{OrientedBox, Shell};
use super::packet::LANES;
use super::vector::{Lanes3, at, cross, direction, dot, minus, perpendicular, select, square};
use crate::Bvh;
use crate::bvh::Node;
use crate::extremes::{greater, lesser};

/// Triangles in a grain at most.
pub(super) const GRAIN: u32 = LANES as u32;

/// How a grain, or a larger part of the hierarchy, lies.
#[derive(Debug, Clone, Copy)]
pub(super) struct Grain {
    /// Triangles.
    count: u32,
    /// Mean of the corners.
    center: DVec3,
    /// Sum of the area vectors of all triangles, turned to the same side: across the grain.
    normal: DVec3,
    pub(super) shell: Shell,
    /// Square of the length of the longest edge.
    pub(super) longest2: f64,
}

/// Where what is prepared goes.
#[derive(Debug)]
pub(super) struct Place<'a> {
    /// From this number on.
    pub(super) first_slot: u32,
    pub(super) triangles: &'a mut [FlatTriangle],
    /// From this node on.
    pub(super) first_box: usize,
    pub(super) boxes: &'a mut [OrientedBox],
    /// What boxes are grown by.
    pub(super) rounding: f64,
}

impl Grain {
    /// Both together, in a box around these shells.
    pub(super) fn join(one: &Self, other: &Self, shells: &[Shell]) -> Self {
        let count = one.count + other.count;
        let share = f64::from(one.count) / f64::from(count);
        let normal = one.normal + turned_along(one.normal, other.normal);
        Self {
            count,
            center: one.center * share + other.center * (1.0 - share),
            normal,
            shell: Shell::across_and_along(normal, other.center - one.center).holding(shells),
            longest2: greater(one.longest2, other.longest2),
        }
    }
}

/// Triangles in lanes, and how they lie along the axes of their leaf and along those of the grain.
struct Lanes {
    /// Axes of the leaf that a lane belongs to.
    axes: [Lanes3; 3],
    along_leaf: Extents,
    along_grain: Extents,
}

/// Least and greatest coordinates along three axes.
struct Extents {
    min: Lanes3,
    max: Lanes3,
}

/// Makes the triangles below a node, of which there are at most [`GRAIN`], and the boxes of all nodes below it; `slot` is that of the
/// first triangle.
///
/// Leaves get boxes along their own triangles, the nodes above them along the whole grain.
#[multiversion(targets("x86_64+avx512f+avx512vl", "x86_64+avx2", "x86_64+sse4.1", "aarch64+neon"))]
pub(super) fn prepare(bvh: &Bvh, node: usize, slot: u32, place: &mut Place<'_>) -> Grain {
    let nodes = bvh.nodes();
    let count = nodes[node].count as usize;
    let mut corners = [[[0.0; LANES]; 3]; 3];
    for lane in 0..LANES {
        // Lanes without a triangle repeat the last one.
        let held = bvh.corners(slot + lane.min(count - 1) as u32);
        for k in 0..3 {
            for axis in 0..3 {
                corners[k][axis][lane] = held[k][axis];
            }
        }
    }
    let first = (slot - place.first_slot) as usize;
    FlatTriangle::set_each(&mut place.triangles[first..first + count], &corners);

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
    let half = if nodes[node].is_leaf() { 0 } else { nodes[nodes[node].first as usize].count as usize };
    let mut sum_of_half = DVec3::ZERO;
    let [mut normals, mut tangents] = [[[0.0; LANES]; 3]; 2];
    let mut longest = 0;
    let mut first = 0;
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
    // A node is long from one child to the other; a leaf has axes of its own.
    let tangent = if half > 0 { center - sum_of_half / (3.0 * half as f64) } else { DVec3::ZERO };
    let shell = Shell::across_and_along(normal, tangent);

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
    // Spelled out, since calls that take a closure stay calls in code for other registers than the rest.
    let all = |vector: DVec3| [[vector.x; LANES], [vector.y; LANES], [vector.z; LANES]];
    let of_grain = [all(shell.axes.x_axis), all(shell.axes.y_axis), all(shell.axes.z_axis)];
    let lanes = Lanes { axes, along_leaf, along_grain: Extents::of(&corners, &of_grain) };
    let mut grain = Grain { count: count as u32, center, normal, shell, longest2: longest2[longest] };
    if nodes[node].is_leaf() {
        grain.shell = lanes.leaf(0, count);
    } else {
        (grain.shell.min, grain.shell.max) = lanes.boxes_below(bvh, node, &mut 0, &shell, place);
    }
    grain
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
                extents.min[axis][i] = lesser(a, lesser(b, c));
                extents.max[axis][i] = greater(a, greater(b, c));
            }
        }
        extents
    }

    /// Of some lanes together.
    fn joined(&self, lanes: Range<usize>) -> (DVec3, DVec3) {
        let (mut min, mut max) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        for lane in lanes {
            min = min.min(DVec3::from_array(at(&self.min, lane)));
            max = max.max(DVec3::from_array(at(&self.max, lane)));
        }
        (min, max)
    }
}

impl Lanes {
    /// Extents of a node along the axes of the grain, after the boxes of the nodes below it.
    fn boxes_below(
        &self,
        bvh: &Bvh,
        node: usize,
        lane: &mut usize,
        grain: &Shell,
        place: &mut Place<'_>,
    ) -> (DVec3, DVec3) {
        let (mut min, mut max) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        let children = bvh.nodes()[node].first as usize;
        for child in [children, children + 1] {
            let node = &bvh.nodes()[child];
            let (own, (child_min, child_max)) = if node.is_leaf() {
                let (first, count) = (*lane, node.count as usize);
                *lane += count;
                (self.leaf(first, count), self.along_grain.joined(first..first + count))
            } else {
                let (min, max) = self.boxes_below(bvh, child, lane, grain, place);
                (Shell { axes: grain.axes, min, max }, (min, max))
            };
            place.boxes[child - place.first_box] = own.rounded(place.rounding, node);
            (min, max) = (min.min(child_min), max.max(child_max));
        }
        (min, max)
    }

    /// The shell of the leaf in these lanes.
    fn leaf(&self, first: usize, count: usize) -> Shell {
        let axes = [0, 1, 2].map(|axis| DVec3::from_array(at(&self.axes[axis], first)));
        let (min, max) = self.along_leaf.joined(first..first + count);
        Shell { axes: DMat3::from_cols(axes[0], axes[1], axes[2]), min, max }
    }
}

/// `vector`, or its opposite if that is the one to the same side as `side`.
fn turned_along(side: DVec3, vector: DVec3) -> DVec3 {
    if side.dot(vector) < 0.0 { -vector } else { vector }
}
