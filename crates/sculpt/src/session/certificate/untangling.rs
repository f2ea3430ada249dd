//! Splits that remove crossings.

use isochore_mesh::{NONE, triangles_intersect};
use rustc_hash::{FxHashMap, FxHashSet};

use super::crossings::{Pair, area, triangles_of};
use crate::session::{
    Session,
    refinement::{Pass, distance_to_segment},
    stroke::ActiveStroke,
    surface::Surface,
};

/// Most rounds. Each halves edges of crossing triangles. The limit only ends a loop that the other
/// limits keep alive.
const MAX_ROUNDS: usize = 60;

/// The rounds end after this number of rounds without a new minimum of the area or the number of
/// crossing triangles. Larger spends triangles on sheets that touch; smaller gives up on folds whose
/// first splits only move the crossing.
const PATIENCE: usize = 8;

/// The same number once the splits have added more than [`SOFT_GROWTH`].
const LEAST_PATIENCE: usize = 2;

/// Over the whole stroke, splits may add this fraction of the triangles in reach, and more while
/// every second round brings a new minimum. Larger and smaller as [`PATIENCE`].
const SOFT_GROWTH: f64 = 0.5;

/// Over the whole stroke, splits never add more than this fraction of the triangles in reach. Less
/// than for recipes, because a stroke that stirs the same place draws out films without end. Larger
/// makes hosts wait; smaller stops strokes that have drawn out thin films.
const HARD_GROWTH: f64 = 1.0;

/// The number of triangles in reach counts as at least this. Larger lets strokes on coarse meshes
/// add many triangles; smaller stops strokes that touch few triangles.
const LEAST_REACH: usize = 1000;

/// Fraction of the limit on triangles that is reserved for untangling. Larger exceeds the limit that
/// the host has set by more; smaller stops strokes at the limit.
const RESERVE: f64 = 0.1;

/// Edges are split that deviate at least this fraction of the largest deviation in their triangle.
/// Larger makes slivers; smaller splits edges in vain.
const SIGNIFICANT: f64 = 0.5;

/// A triangle whose ancestors and itself have crossed in this number of rounds splits all edges.
/// Larger takes more rounds where the inside of a triangle crosses; smaller splits edges in vain.
const STUBBORN: u8 = 4;

/// Edges of the base that are shorter than this fraction of the shortest edge that is split for its
/// deviation are not split. Larger stops strokes that draw out thin films; smaller makes triangles so
/// small that rounding decides whether they cross.
const LEAST_IN_BASE: f64 = 1.0 / 1024.0;

/// From this round on, the longest edge of a triangle is that of the base. Larger follows the shape
/// of the image longer; smaller makes more triangles.
const BASE_ROUND: usize = 12;

/// From this round on, crossings that are in the base too end the rounds: where sheets of the base
/// touch up to rounding, splits make more of them cross. Larger wastes triangles; smaller takes time.
const TOUCHING_ROUND: usize = 3;

/// Result of untangling.
pub(super) struct Untangled {
    /// The pairs that remain.
    pub(super) crossing: Vec<Pair>,
    /// Vertices of triangles that were split.
    pub(super) changed: Vec<u32>,
}

/// The progress of untangling.
struct Progress {
    area: f64,
    count: usize,
    /// Rounds since the last minimum.
    stalled: usize,
}

impl Session {
    /// Splits triangles that newly cross until none do.
    pub(super) fn untangle(&mut self, stroke: &mut ActiveStroke) -> Untangled {
        let mut pairs = self.surface.new_crossings(stroke.phase.triangles.items(), Surface::position);
        let mut changed = Vec::new();
        let Some(options) = stroke.refine.clone() else { return Untangled { crossing: pairs, changed } };
        let reach = stroke.touched.items().len().saturating_sub(stroke.untangling).max(LEAST_REACH) as f64;
        // The number of triangles without those that untangling has added.
        let before = self.surface.topology.alive().saturating_sub(stroke.untangling);
        let most = (before + (HARD_GROWTH * reach) as usize)
            .min(options.max_triangles.saturating_add((RESERVE * options.max_triangles as f64) as usize));
        let mut progress = Progress { area: f64::INFINITY, count: usize::MAX, stalled: 0 };
        let mut ages: FxHashMap<u32, u8> = FxHashMap::default();
        for round in 0..MAX_ROUNDS {
            let crossing = triangles_of(&pairs);
            let growth = (self.surface.topology.alive() - before) as f64 / reach;
            if round >= TOUCHING_ROUND && self.crosses_in_base(&pairs) {
                break;
            }
            if crossing.is_empty() || !progress.goes_on(&self.surface, &crossing, growth) {
                break;
            }
            crossing.iter().for_each(|&triangle| *ages.entry(triangle).or_insert(0) += 1);
            let mut pass = stroke.pass(&mut self.surface, self.mask.as_deref(), &options);
            let is_stubborn = |triangle: u32| ages[&triangle] > STUBBORN;
            let chosen = pass.edges_to_untangle(&crossing, is_stubborn, round >= BASE_ROUND);
            if chosen.is_empty() || pass.surface.topology.alive() + 2 * chosen.len() > most {
                stroke.receipt.is_limited |= !chosen.is_empty() && most >= options.max_triangles;
                break;
            }
            let splits = pass.split_all(&chosen);
            for pieces in splits.triangles.chunks_exact(2) {
                if let Some(&age) = ages.get(&pieces[0]) {
                    ages.insert(pieces[1], age);
                }
            }
            let split = self.surface.triangles_around(&[], &splits.triangles);
            stroke.note(&self.surface, &split, &splits);
            stroke.untangling = self.surface.topology.alive() - before;
            stroke.receipt.inserted_vertices += splits.volumes.len();
            stroke.receipt.evaluations += splits.evaluations;
            self.surface.update_tree(&split);
            changed.extend(self.surface.vertices_of(&split));
            pairs.retain(|pair| pair.iter().all(|triangle| split.binary_search(triangle).is_err()));
            pairs.extend(self.surface.new_crossings(&split, Surface::position));
        }
        Untangled { crossing: pairs, changed }
    }
}

impl Session {
    /// Whether triangles of some pairs cross in the base.
    fn crosses_in_base(&self, pairs: &[Pair]) -> bool {
        let records = self.surface.topology.triangles();
        let corners = |triangle: u32| records[triangle as usize].vertices.map(|vertex| self.surface.base(vertex));
        pairs.iter().any(|&[one, other]| triangles_intersect(corners(one), corners(other)))
    }
}

impl Progress {
    /// Notes the crossing triangles of a round. Returns whether it is worthwhile to go on after
    /// splits have added the fraction `growth`.
    fn goes_on(&mut self, surface: &Surface, crossing: &[u32], growth: f64) -> bool {
        let corners = crossing.iter().filter_map(|&triangle| surface.corners_of(triangle));
        let total: f64 = corners.map(area).sum();
        let is_better = total < self.area || crossing.len() < self.count;
        self.stalled = if is_better { 0 } else { self.stalled + 1 };
        self.area = self.area.min(total);
        self.count = self.count.min(crossing.len());
        self.stalled < if growth > SOFT_GROWTH { LEAST_PATIENCE } else { PATIENCE }
    }
}

impl Pass<'_> {
    /// The edges to split because the triangles `crossing` cross, longest first.
    fn edges_to_untangle(
        &mut self,
        crossing: &[u32],
        is_stubborn: impl Fn(u32) -> bool,
        is_by_base: bool,
    ) -> Vec<[u32; 2]> {
        let all: Vec<[u32; 2]> = crossing.iter().flat_map(|&triangle| self.surface.edges_of(triangle)).collect();
        let images = self.midpoints.follow(self.surface, self.path, &all).images;
        let deviation =
            |index: usize| distance_to_segment(images[index], all[index].map(|end| self.surface.position(end)));
        let mut chosen = Vec::new();
        for (index, &triangle) in crossing.iter().enumerate() {
            let deviations = [0, 1, 2].map(|side| deviation(3 * index + side));
            let worst = deviations.into_iter().fold(0.0, f64::max);
            for side in 0..3 {
                if worst > 0.0 && (is_stubborn(triangle) || deviations[side] >= SIGNIFICANT * worst) {
                    chosen.push(all[3 * index + side]);
                }
            }
        }
        let at = |vertex: u32| if is_by_base { self.surface.base(vertex) } else { self.surface.position(vertex) };
        let length2 = |[a, b]: [u32; 2]| at(a).distance_squared(at(b));
        self.add_longest(&mut chosen, length2);
        chosen.sort_unstable_by(|&a, &b| length2(b).total_cmp(&length2(a)).then(a.cmp(&b)));
        chosen
    }

    /// Removes duplicates and edges that cannot be split. Adds the longest edges of the triangles at
    /// the remaining ones, and so on.
    ///
    /// Source: M.-C. Rivara, *Algorithms for refining triangular grids suitable for adaptive and
    /// multigrid techniques*, 1984.
    fn add_longest(&self, chosen: &mut Vec<[u32; 2]>, length2: impl Fn([u32; 2]) -> f64) {
        let mut known: FxHashSet<[u32; 2]> = FxHashSet::default();
        chosen.retain(|&ends| self.is_splittable(ends) && known.insert(ends));
        let mut index = 0;
        while let Some(&ends) = chosen.get(index) {
            index += 1;
            let beside = self.surface.half_edge(ends).map(|half_edge| self.surface.triangles_beside(half_edge));
            for triangle in beside.into_iter().flatten().filter(|&triangle| triangle != NONE) {
                let edges = self.surface.edges_of(triangle);
                let longer = |&a: &[u32; 2], &b: &[u32; 2]| length2(a).total_cmp(&length2(b)).then(a.cmp(&b));
                let longest = edges.into_iter().max_by(longer);
                let longest = longest.filter(|&ends| self.is_splittable(ends) && known.insert(ends));
                chosen.extend(longest);
            }
        }
    }

    /// Whether an edge may be split, and is not too short in the base.
    fn is_splittable(&self, ends: [u32; 2]) -> bool {
        let [a, b] = ends.map(|end| self.surface.base(end));
        self.editable(ends).is_some() && a.distance(b) > LEAST_IN_BASE * self.limits.finest
    }
}
