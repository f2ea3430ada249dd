//! The exact test of a small part of a surface against its surroundings.

use glam::DVec3;
use multiversion::multiversion;

use super::common_corners::CommonCorners;
use super::exact_triangle::{ExactTriangle, bounded_scale};
use super::separation::{LANES, PairBlock};
use crate::Aabb;
use crate::bvh::UnitFrame;

/// Largest extent of a triangle, relative to the patch, in the fast separation test. Larger: its
/// products, of degree four, could overflow in single precision. Smaller: coarse surroundings make
/// the patch so small that its products underflow and go to the exact test.
const LARGEST_EXTENT: f64 = (1_u64 << 24) as f64;

/// Whether two triangles of `patch`, or a triangle of `patch` and one of `surroundings`, intersect
/// beyond their common corners and edges. It is [`triangles_intersect`](super::triangles_intersect)
/// for many pairs, and several times faster.
///
/// ```
/// use glam::DVec3;
/// use isochore_mesh::{patch_intersects, primitives};
///
/// let ball = primitives::icosphere(1.0, 2);
/// let all: Vec<[DVec3; 3]> = (0..ball.triangles.len()).map(|triangle| ball.corners(triangle)).collect();
/// let (patch, surroundings) = all.split_at(6);
/// assert!(!patch_intersects(patch, surroundings));
/// assert!(patch_intersects(&[[-DVec3::X, 2.0 * DVec3::X, DVec3::Y]], surroundings));
/// ```
pub fn patch_intersects(patch: &[[DVec3; 3]], surroundings: &[[DVec3; 3]]) -> bool {
    let around = |triangles: &[[DVec3; 3]]| Aabb::of(triangles.iter().flatten().copied());
    let frame = UnitFrame::around(around(patch));
    let extents = surroundings.iter().map(|corners| Aabb::of(*corners).size().max_element());
    let largest = extents.fold(0.0, f64::max);
    let scale = if largest * frame.scale() > LARGEST_EXTENT {
        UnitFrame::around(around(patch).union(around(surroundings))).scale() * LARGEST_EXTENT
    } else {
        frame.scale()
    };
    let scale = bounded_scale(patch.iter().chain(surroundings).flatten().copied(), scale);
    any_crossing(patch, surroundings, scale)
}

/// Pairs that wait for the separation test, by number of common corners.
struct Pending<'a> {
    block: PairBlock,
    pairs: [[&'a [DVec3; 3]; 2]; LANES],
}

#[multiversion(targets("x86_64+avx512f+avx512vl", "x86_64+avx2", "x86_64+sse4.1", "aarch64+neon"))]
fn any_crossing(patch: &[[DVec3; 3]], surroundings: &[[DVec3; 3]], scale: f64) -> bool {
    const NOWHERE: [DVec3; 3] = [DVec3::ZERO; 3];
    let mut pending = [0, 1, 2].map(|_| Pending { block: PairBlock::EMPTY, pairs: [[&NOWHERE; 2]; LANES] });
    for (index, first) in patch.iter().enumerate() {
        let bounds = Aabb::of(*first);
        for second in patch[index + 1..].iter().chain(surroundings) {
            if !bounds.overlaps(Aabb::of(*second)) {
                continue;
            }
            let common = CommonCorners::of(first, second);
            if common.count == 3 {
                if intersect([first, second], scale) {
                    return true;
                }
                continue;
            }
            let Pending { block, pairs } = &mut pending[common.count as usize];
            pairs[block.len()] = [first, second];
            let [a, b, c] = common.first.map(|corner| first[corner as usize] * scale);
            let [d, e, f] = common.second.map(|corner| second[corner as usize] * scale);
            block.push(&a, [&b, &c, &d, &e, &f]);
            if block.len() == LANES {
                if any_crossing_of(block, common.count, pairs, scale) {
                    return true;
                }
                block.clear();
            }
        }
    }
    (0..3).any(|count: u8| {
        let Pending { block, pairs } = &pending[count as usize];
        any_crossing_of(block, count, &pairs[..block.len()], scale)
    })
}

/// Whether any of `pairs`, which fill `block` and have `common` corners in common, intersects.
#[inline(always)]
fn any_crossing_of(block: &PairBlock, common: u8, pairs: &[[&[DVec3; 3]; 2]], scale: f64) -> bool {
    if pairs.is_empty() {
        return false;
    }
    let are_separate = match common {
        0 => block.are_apart(),
        1 => block.meet_in_corner(),
        _ => block.meet_in_edge(),
    };
    pairs.iter().zip(are_separate).any(|(&pair, is_separate)| !is_separate && intersect(pair, scale))
}

#[inline(never)]
fn intersect(pair: [&[DVec3; 3]; 2], scale: f64) -> bool {
    let [first, second] = pair.map(|triangle| ExactTriangle::new(triangle.map(|corner| corner * scale)));
    first.intersects(&second)
}
