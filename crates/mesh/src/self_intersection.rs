//! Exact detection of self-intersections.
//!
//! The search runs in three stages. A hierarchy of boxes finds pairs of triangles that are close to
//! each other. A separating plane, found in vector registers, proves most of these pairs disjoint.
//! Exact predicates decide the remaining pairs.

mod box_tree;
mod common_corners;
mod exact_triangle;
mod pair;
mod patch;
mod separation;
#[cfg(test)]
mod tests;

use std::sync::atomic::{AtomicUsize, Ordering};

use glam::DVec3;
use multiversion::multiversion;
use rayon::prelude::*;

use crate::bvh::{UnitFrame, checked_bounds};
use crate::{Aabb, BvhError, Cancelled, Monitor, TriMesh};
use box_tree::{BoxTree, NodePair};
use common_corners::CommonCorners;
use exact_triangle::{ExactTriangle, scaled};
pub use pair::triangles_intersect;
pub use patch::patch_intersects;
use separation::{LANES, PairBlock};

/// Target number of node pairs into which the work is divided. More: listing them takes longer.
/// Fewer: worse load balance and a slower reaction to cancellation.
const TASKS: usize = 4096;

/// Tasks between two checks of the monitor.
const TASKS_PER_CHUNK: usize = 64;

/// Errors when searching for self-intersections.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum SelfIntersectionError {
    /// The mesh has no triangles, an index out of range or a coordinate that is not finite.
    #[error(transparent)]
    Mesh(#[from] BvhError),
    /// The monitor stopped the work.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

/// Pairs of triangles of a mesh that intersect beyond their common vertices and edges.
///
/// ```
/// use glam::dvec3;
/// use isochore_mesh::{NoProgress, SelfIntersections, TriMesh};
///
/// // The second triangle pierces the first.
/// let positions = vec![
///     dvec3(0.0, 0.0, 0.0), dvec3(2.0, 0.0, 0.0), dvec3(0.0, 2.0, 0.0),
///     dvec3(0.5, 0.5, -1.0), dvec3(0.5, 0.5, 1.0), dvec3(3.0, 3.0, 0.0),
/// ];
/// let mesh = TriMesh::new(positions, vec![[0, 1, 2], [3, 4, 5]]);
/// let found = SelfIntersections::of(&mesh, &NoProgress)?;
/// assert_eq!(found.pairs(), [[0, 1]]);
/// # Ok::<(), isochore_mesh::SelfIntersectionError>(())
/// ```
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct SelfIntersections {
    pairs: Vec<[u32; 2]>,
    triangles: Vec<u32>,
    pairs_tested: u64,
}

impl SelfIntersections {
    /// Finds all pairs. The result is exact: predicates are evaluated as if without rounding.
    ///
    /// Corners at equal positions count as one vertex, even if their indices differ. Two triangles
    ///
    /// - without a common vertex intersect if they touch anywhere, even in a single point;
    /// - with one common vertex intersect if they touch anywhere else;
    /// - with a common edge intersect if they are in one plane on the same side of the edge;
    /// - with all vertices in common always intersect.
    ///
    /// Triangles without area are ignored.
    ///
    /// For a closed mesh the search takes at most 100 bytes per triangle, plus the result. Time and
    /// memory are linear in the number of triangles and the number of pairs whose boxes overlap.
    ///
    /// # Errors
    /// [`SelfIntersectionError::Mesh`] if the mesh has no triangles, an index out of range or a
    /// coordinate that is not finite; [`SelfIntersectionError::Cancelled`] if the monitor stops the
    /// work.
    pub fn of(mesh: &TriMesh, monitor: &dyn Monitor) -> Result<Self, SelfIntersectionError> {
        checked_bounds(&mesh.positions, &mesh.triangles)?;
        Ok(Self::among(&mesh.positions, &mesh.triangles, monitor)?)
    }

    /// Finds all pairs among `triangles`, of which there is at least one. Indices must be valid and
    /// corners finite.
    pub(crate) fn among(positions: &[DVec3], triangles: &[[u32; 3]], monitor: &dyn Monitor) -> Result<Self, Cancelled> {
        let corners = triangles.iter().flatten().map(|&vertex| positions[vertex as usize]);
        let frame = UnitFrame::around(Aabb::of(corners));
        let tree = BoxTree::new(positions, triangles, &frame);
        let in_order = tree.order.par_iter().map(|&triangle| triangles[triangle as usize]).collect();
        let search = Search { tree, points: scaled(positions, triangles, frame.scale()), triangles: in_order };

        let tasks = search.tree.node_pairs(TASKS);
        let chunks = tasks.len().div_ceil(TASKS_PER_CHUNK);
        let done = AtomicUsize::new(0);
        let found: Vec<Found> = (tasks.par_chunks(TASKS_PER_CHUNK))
            .map(|tasks| {
                let found = crossings_below(&search, tasks);
                let done = done.fetch_add(1, Ordering::Relaxed) + 1;
                monitor.check("self-intersections", done as f64 / chunks as f64)?;
                Ok(found)
            })
            .collect::<Result<_, Cancelled>>()?;

        let pairs_tested = found.iter().map(|found| found.pairs_tested).sum();
        let mut pairs: Vec<[u32; 2]> = (found.into_iter().flat_map(|found| found.crossings))
            .map(|slots| {
                let [a, b] = slots.map(|slot| search.tree.order[slot as usize]);
                [a.min(b), a.max(b)]
            })
            .collect();
        pairs.par_sort_unstable();
        let mut triangles: Vec<u32> = pairs.iter().flatten().copied().collect();
        triangles.par_sort_unstable();
        triangles.dedup();
        Ok(Self { pairs, triangles, pairs_tested })
    }

    /// Whether no two triangles intersect.
    pub fn is_empty(&self) -> bool {
        self.pairs.is_empty()
    }

    /// Pairs of triangle indices, the smaller first, in ascending order.
    pub fn pairs(&self) -> &[[u32; 2]] {
        &self.pairs
    }

    /// Indices of the triangles that intersect at least one other, in ascending order.
    pub fn triangles(&self) -> &[u32] {
        &self.triangles
    }

    /// Number of pairs of triangles with overlapping boxes, each of which was tested.
    pub fn pairs_tested(&self) -> u64 {
        self.pairs_tested
    }

    /// Total area of [`triangles`](Self::triangles), square model units.
    ///
    /// # Panics
    /// If `mesh` has fewer triangles than the mesh that was searched.
    pub fn area(&self, mesh: &TriMesh) -> f64 {
        (self.triangles.iter())
            .map(|&triangle| {
                let [a, b, c] = mesh.corners(triangle as usize);
                0.5 * (b - a).cross(c - a).length()
            })
            .fold(0.0, |sum, area| sum + area)
    }
}

/// Input of the search.
#[derive(Debug)]
struct Search {
    tree: BoxTree,
    /// Positions, scaled so that the mesh has about unit size.
    points: Vec<DVec3>,
    /// Vertex indices, in the order of the tree.
    triangles: Vec<[u32; 3]>,
}

/// Candidate pairs collected before they are processed. Larger: the list exceeds the caches.
/// Smaller: more switches between the stages.
const CANDIDATES: usize = 512;

/// A pair of triangles: their positions in the order of the tree, and their vertex indices with
/// common ones first.
#[derive(Debug, Clone, Copy)]
struct Pair {
    slots: [u32; 2],
    vertices: [[u32; 3]; 2],
}

/// Pairs that are not yet proved disjoint, by the number of their common corners.
#[derive(Debug)]
struct Waiting([Vec<Pair>; 4]);

/// Intersecting pairs, as positions in the order of the tree.
#[derive(Debug, Default)]
struct Found {
    crossings: Vec<[u32; 2]>,
    pairs_tested: u64,
}

/// Returns the intersecting pairs below these pairs of nodes.
#[multiversion(targets("x86_64+avx512f+avx512vl", "x86_64+avx2", "x86_64+sse4.1", "aarch64+neon"))]
fn crossings_below(search: &Search, tasks: &[NodePair]) -> Found {
    let (mut found, mut stack) = (Found::default(), Vec::new());
    let mut candidates = Vec::with_capacity(2 * CANDIDATES);
    let mut waiting = Waiting([const { Vec::new() }; 4]);
    for &task in tasks {
        stack.push(task);
        while search.tree.overlapping_pairs(CANDIDATES, &mut stack, &mut candidates) {
            found.pairs_tested += candidates.len() as u64;
            search.sort_by_common_corners(&candidates, &mut waiting);
            candidates.clear();
            search.decide(&mut waiting, LANES, &mut found.crossings);
        }
    }
    search.decide(&mut waiting, 1, &mut found.crossings);
    found
}

impl Search {
    /// Adds candidate pairs to the waiting pairs.
    #[inline(always)]
    fn sort_by_common_corners(&self, candidates: &[[u32; 2]], waiting: &mut Waiting) {
        for &slots in candidates {
            // Most common corners have equal indices. The few with equal positions but different
            // indices are found later, when no plane separates the pair.
            let (first, second) = (&self.triangles[slots[0] as usize], &self.triangles[slots[1] as usize]);
            waiting.push(CommonCorners::of(first, second), slots, [first, second]);
        }
    }

    /// Processes waiting pairs until fewer than `least` remain for each number of common corners.
    #[inline(always)]
    fn decide(&self, waiting: &mut Waiting, least: usize, crossings: &mut Vec<[u32; 2]>) {
        for shared in 0..3 {
            let mut block = PairBlock::EMPTY;
            while waiting.0[shared].len() >= least {
                let first = waiting.0[shared].len().saturating_sub(LANES);
                block.clear();
                for pair in &waiting.0[shared][first..] {
                    let [[a, b, c], [d, e, f]] = pair.vertices;
                    let point = |vertex: u32| &self.points[vertex as usize];
                    block.push(point(a), [point(b), point(c), point(d), point(e), point(f)]);
                }
                let are_separate = match shared {
                    0 => block.are_apart(),
                    1 => block.meet_in_corner(),
                    _ => block.meet_in_edge(),
                };
                if are_separate[..block.len()].contains(&false) {
                    self.decide_on(waiting, shared, first, &are_separate, crossings);
                }
                waiting.0[shared].truncate(first);
            }
        }
        for pair in std::mem::take(&mut waiting.0[3]) {
            self.decide_exactly(pair.slots, crossings);
        }
    }

    /// Decides the waiting pairs from `first` on that no plane separates.
    #[inline(never)]
    fn decide_on(
        &self,
        waiting: &mut Waiting,
        shared: usize,
        first: usize,
        are_separate: &[bool; LANES],
        crossings: &mut Vec<[u32; 2]>,
    ) {
        // Now compare positions instead of indices. If corners coincide after all, the pair needs
        // the test for that number of common corners.
        let count = waiting.0[shared].len() - first;
        for lane in (0..count).filter(|&lane| !are_separate[lane]) {
            let slots = waiting.0[shared][first + lane].slots;
            let [one, other] = slots.map(|slot| self.corners_at(slot));
            let common = CommonCorners::of(&one, &other);
            if shared == 0 && common.count > 0 {
                let triangles = [&self.triangles[slots[0] as usize], &self.triangles[slots[1] as usize]];
                waiting.push(common, slots, triangles);
            } else {
                self.decide_exactly(slots, crossings);
            }
        }
    }

    fn decide_exactly(&self, slots: [u32; 2], crossings: &mut Vec<[u32; 2]>) {
        let [first, second] = slots.map(|slot| ExactTriangle::new(self.corners_at(slot)));
        if first.intersects(&second) {
            crossings.push(slots);
        }
    }

    fn corners_at(&self, slot: u32) -> [DVec3; 3] {
        self.triangles[slot as usize].map(|vertex| self.points[vertex as usize])
    }
}

impl Waiting {
    #[inline(always)]
    fn push(&mut self, common: &CommonCorners, slots: [u32; 2], [one, other]: [&[u32; 3]; 2]) {
        // By reference, because reading so small a copy at once would stall on store forwarding.
        let ([i, j, k], [l, m, n]) = (common.first, common.second);
        let first = [one[i as usize], one[j as usize], one[k as usize]];
        let second = [other[l as usize], other[m as usize], other[n as usize]];
        self.0[common.count as usize].push(Pair { slots, vertices: [first, second] });
    }
}
