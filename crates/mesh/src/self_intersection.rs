//! Triangles of a mesh that cross each other, found exactly.
//!
//! Boxes say which triangles are near each other; a plane between them, found in vector registers, says for most of these that
//! they do not cross; exact predicates say it for the rest.

mod box_tree;
mod common_corners;
mod exact_triangle;
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
use separation::{LANES, PairBlock};

/// Pairs of nodes of the hierarchy that the work is divided into, if there are as many. More costs time to list them; fewer
/// balances worse and hears a cancellation later.
const TASKS: usize = 4096;

/// Tasks between two looks at the monitor.
const TASKS_PER_CHUNK: usize = 64;

/// Why self-intersections could not be found.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum SelfIntersectionError {
    /// The mesh cannot be searched.
    #[error(transparent)]
    Mesh(#[from] BvhError),
    /// The monitor stopped the work.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

/// Pairs of triangles of one mesh that have points in common beyond the vertices and edges that they share.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct SelfIntersections {
    pairs: Vec<[u32; 2]>,
    triangles: Vec<u32>,
}

impl SelfIntersections {
    /// Finds all pairs. The answer is exact: predicates are evaluated as if without rounding.
    ///
    /// Corners at equal positions count as one vertex, whatever their indices. Of two triangles
    ///
    /// - without a common vertex, any contact counts, be it in a point;
    /// - with a common vertex, any contact elsewhere;
    /// - with a common edge, only that both lie in one plane on the same side of the edge;
    /// - with all vertices in common, they always count.
    ///
    /// Triangles without area have no inside to be crossed and are left out.
    ///
    /// While it works it holds at most 100 bytes a triangle of a closed mesh, and what it finds: time and memory are linear
    /// in the numbers of triangles and of pairs whose boxes overlap.
    ///
    /// # Errors
    /// See [`SelfIntersectionError`].
    pub fn of(mesh: &TriMesh, monitor: &dyn Monitor) -> Result<Self, SelfIntersectionError> {
        checked_bounds(&mesh.positions, &mesh.triangles)?;
        Ok(Self::among(&mesh.positions, &mesh.triangles, monitor)?)
    }

    /// Finds all pairs among one triangle or more with valid indices and finite corners.
    pub(crate) fn among(positions: &[DVec3], triangles: &[[u32; 3]], monitor: &dyn Monitor) -> Result<Self, Cancelled> {
        let corners = triangles.iter().flatten().map(|&vertex| positions[vertex as usize]);
        let frame = UnitFrame::around(Aabb::of(corners));
        let tree = BoxTree::new(positions, triangles, &frame);
        let in_order = tree.order.par_iter().map(|&triangle| triangles[triangle as usize]).collect();
        let search = Search { tree, points: scaled(positions, triangles, frame.scale()), triangles: in_order };

        let tasks = search.tree.node_pairs(TASKS);
        let chunks = tasks.len().div_ceil(TASKS_PER_CHUNK);
        let done = AtomicUsize::new(0);
        let found: Vec<Vec<[u32; 2]>> = (tasks.par_chunks(TASKS_PER_CHUNK))
            .map(|tasks| {
                let pairs = crossings_below(&search, tasks);
                let done = done.fetch_add(1, Ordering::Relaxed) + 1;
                monitor.check("self-intersections", done as f64 / chunks as f64)?;
                Ok(pairs)
            })
            .collect::<Result<_, Cancelled>>()?;

        let mut pairs: Vec<[u32; 2]> = (found.into_iter().flatten())
            .map(|places| {
                let [a, b] = places.map(|place| search.tree.order[place as usize]);
                [a.min(b), a.max(b)]
            })
            .collect();
        pairs.par_sort_unstable();
        let mut triangles: Vec<u32> = pairs.iter().flatten().copied().collect();
        triangles.par_sort_unstable();
        triangles.dedup();
        Ok(Self { pairs, triangles })
    }

    /// Whether no triangle crosses another.
    pub fn is_empty(&self) -> bool {
        self.pairs.is_empty()
    }

    /// Pairs of triangle indices, the smaller first, in ascending order.
    pub fn pairs(&self) -> &[[u32; 2]] {
        &self.pairs
    }

    /// Indices of the triangles that cross at least one other, in ascending order.
    pub fn triangles(&self) -> &[u32] {
        &self.triangles
    }

    /// Sum of the areas of these triangles, square model units.
    ///
    /// # Panics
    /// If `mesh` has fewer triangles than the one that was searched.
    pub fn area(&self, mesh: &TriMesh) -> f64 {
        (self.triangles.iter())
            .map(|&triangle| {
                let [a, b, c] = mesh.corners(triangle as usize);
                0.5 * (b - a).cross(c - a).length()
            })
            .fold(0.0, |sum, area| sum + area)
    }
}

/// What is searched.
#[derive(Debug)]
struct Search {
    tree: BoxTree,
    /// Positions, scaled so that the mesh is about as large as one.
    points: Vec<DVec3>,
    /// Vertex indices, in the order of the tree.
    triangles: Vec<[u32; 3]>,
}

/// Pairs whose boxes overlap that are collected before they are looked at. Larger leaves the caches; smaller spends time on going
/// back and forth.
const CANDIDATES: usize = 512;

/// A pair of triangles, by their places and by the vertices of the first and the second, common ones first.
#[derive(Debug, Clone, Copy)]
struct Pair {
    places: [u32; 2],
    vertices: [[u32; 3]; 2],
}

/// Pairs that wait for a proof that they do not cross, by the number of corners that they share.
#[derive(Debug)]
struct Waiting([Vec<Pair>; 4]);

/// Pairs of places of triangles that cross, below these pairs of nodes.
#[multiversion(targets("x86_64+avx512f+avx512vl", "x86_64+avx2", "x86_64+sse4.1", "aarch64+neon"))]
fn crossings_below(search: &Search, tasks: &[NodePair]) -> Vec<[u32; 2]> {
    let (mut crossings, mut stack) = (Vec::new(), Vec::new());
    let mut candidates = Vec::with_capacity(2 * CANDIDATES);
    let mut waiting = Waiting([const { Vec::new() }; 4]);
    for &task in tasks {
        stack.push(task);
        while search.tree.overlapping_places(CANDIDATES, &mut stack, &mut candidates) {
            search.sort_by_common_corners(&candidates, &mut waiting);
            candidates.clear();
            search.decide(&mut waiting, LANES, &mut crossings);
        }
    }
    search.decide(&mut waiting, 1, &mut crossings);
    crossings
}

impl Search {
    /// Puts pairs of places among those that wait.
    #[inline(always)]
    fn sort_by_common_corners(&self, candidates: &[[u32; 2]], waiting: &mut Waiting) {
        for &places in candidates {
            // Most common corners have one index; the few pairs with others are found where no plane separates them.
            let (first, second) = (&self.triangles[places[0] as usize], &self.triangles[places[1] as usize]);
            waiting.push(CommonCorners::of(first, second), places, [first, second]);
        }
    }

    /// Decides waiting pairs until less than `least` are left of each kind.
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
            self.decide_exactly(pair.places, crossings);
        }
    }

    /// Decides those of the waiting pairs from `first` on that no plane separates.
    #[inline(never)]
    fn decide_on(
        &self,
        waiting: &mut Waiting,
        shared: usize,
        first: usize,
        are_separate: &[bool; LANES],
        crossings: &mut Vec<[u32; 2]>,
    ) {
        let count = waiting.0[shared].len() - first;
        for lane in (0..count).filter(|&lane| !are_separate[lane]) {
            let places = waiting.0[shared][first + lane].places;
            let [one, other] = places.map(|place| self.corners_at(place));
            let common = CommonCorners::of(&one, &other);
            if shared == 0 && common.count > 0 {
                let triangles = [&self.triangles[places[0] as usize], &self.triangles[places[1] as usize]];
                waiting.push(common, places, triangles);
            } else {
                self.decide_exactly(places, crossings);
            }
        }
    }

    fn decide_exactly(&self, places: [u32; 2], crossings: &mut Vec<[u32; 2]>) {
        let [first, second] = places.map(|place| ExactTriangle::new(self.corners_at(place)));
        if first.intersects(&second) {
            crossings.push(places);
        }
    }

    fn corners_at(&self, place: u32) -> [DVec3; 3] {
        self.triangles[place as usize].map(|vertex| self.points[vertex as usize])
    }
}

impl Waiting {
    #[inline(always)]
    fn push(&mut self, common: &CommonCorners, places: [u32; 2], [one, other]: [&[u32; 3]; 2]) {
        // By reference: a copy of so few bytes, read at once, would wait for itself to be written.
        let ([i, j, k], [l, m, n]) = (common.first, common.second);
        let first = [one[i as usize], one[j as usize], one[k as usize]];
        let second = [other[l as usize], other[m as usize], other[n as usize]];
        self.0[common.count as usize].push(Pair { places, vertices: [first, second] });
    }
}
