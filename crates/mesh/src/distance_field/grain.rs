//! Triangles that are prepared for the search together, in vector registers: a small part of the hierarchy, with boxes along it.

use glam::DVec3;
use multiversion::multiversion;

use super::flat_triangle::{FlatTriangle, Lanes3, at};
use super::oriented_box::{OrientedBox, Shell};
use super::packet::LANES;
use super::vector::{cross, dot, minus, square};
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

/// Extents along three axes, of each lane.
struct Extents {
    min: Lanes3,
    max: Lanes3,
}

#[multiversion(targets("x86_64+avx512f+avx512vl", "x86_64+avx2", "x86_64+sse4.1", "aarch64+neon"))]
pub(super) fn prepare(bvh: &Bvh, node: usize, slot: u32, place: &mut Place<'_>) -> Grain {
    let count = bvh.nodes()[node].count as usize;
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

    let mut areas = [[0.0; LANES]; 3];
    let mut centers = [[0.0; LANES]; 3];
    let mut longest2 = [0.0; LANES];
    for i in 0..LANES {
        let (a, b, c) = (at(&corners[0], i), at(&corners[1], i), at(&corners[2], i));
        let area = cross(minus(b, a), minus(c, a));
        for axis in 0..3 {
            areas[axis][i] = area[axis];
            centers[axis][i] = a[axis] + b[axis] + c[axis];
        }
        longest2[i] = greater(square(minus(b, a)), greater(square(minus(c, b)), square(minus(a, c))));
    }
    let (mut normal, mut center) = (DVec3::ZERO, DVec3::ZERO);
    for lane in 0..count {
        let area = DVec3::from_array(at(&areas, lane));
        normal += turned_along(normal, area);
        center += DVec3::from_array(at(&centers, lane));
    }
    center /= 3.0 * count as f64;
    // A corner far from the center tells the direction in which the grain is long.
    let mut far = (0.0, DVec3::ZERO);
    for lane in 0..count {
        let offset = DVec3::from_array(at(&corners[0], lane)) - center;
        if offset.length_squared() > far.0 {
            far = (offset.length_squared(), offset);
        }
    }
    let shell = Shell::across_and_along(normal, far.1);

    let mut extents = Extents { min: [[0.0; LANES]; 3], max: [[0.0; LANES]; 3] };
    for axis in 0..3 {
        let direction = shell.axes.col(axis).to_array();
        for i in 0..LANES {
            let a = dot(at(&corners[0], i), direction);
            let b = dot(at(&corners[1], i), direction);
            let c = dot(at(&corners[2], i), direction);
            extents.min[axis][i] = lesser(a, lesser(b, c));
            extents.max[axis][i] = greater(a, greater(b, c));
        }
    }
    let shell = boxes_below(bvh, node, &mut 0, shell, &extents, place);
    let longest2 = longest2.into_iter().fold(0.0, greater);
    Grain { count: count as u32, center, normal, shell, longest2 }
}

/// The shell of a node, after the boxes of the nodes below it; `empty` has the axes.
fn boxes_below(
    bvh: &Bvh,
    node: usize,
    lane: &mut usize,
    empty: Shell,
    extents: &Extents,
    place: &mut Place<'_>,
) -> Shell {
    let mut shell = empty;
    let Node { first, count, .. } = bvh.nodes()[node];
    if bvh.nodes()[node].is_leaf() {
        for lane in *lane..*lane + count as usize {
            shell.min = shell.min.min(DVec3::from_array(at(&extents.min, lane)));
            shell.max = shell.max.max(DVec3::from_array(at(&extents.max, lane)));
        }
        *lane += count as usize;
        return shell;
    }
    for child in [first as usize, first as usize + 1] {
        let below = boxes_below(bvh, child, lane, empty, extents, place);
        place.boxes[child - place.first_box] = below.rounded(place.rounding, &bvh.nodes()[child]);
        shell.min = shell.min.min(below.min);
        shell.max = shell.max.max(below.max);
    }
    shell
}

/// `vector`, or its opposite if that is the one to the same side as `side`.
fn turned_along(side: DVec3, vector: DVec3) -> DVec3 {
    if side.dot(vector) < 0.0 { -vector } else { vector }
}
