//! Splits of edges that are too long or deviate too much.

use std::ops::AddAssign;

use isochore_mesh::NONE;

use super::{pass::Pass, survey::MayTouch};

/// Rounds of splitting in one pass. Each halves edges, so these rounds resolve edges a thousand
/// times too long. The next move splits the rest.
const MAX_ROUNDS: usize = 40;

/// Triangles between a bad edge and the edge that is split for it. Larger spreads splits farther
/// from the tool; smaller makes slivers.
const LONGEST_WALK: usize = 16;

/// Result of splitting edges.
#[derive(Debug, Default)]
pub(in crate::session) struct Splits {
    /// Triangles at the inserted vertices, in the order of the splits; a triangle may occur more
    /// than once.
    pub(in crate::session) triangles: Vec<u32>,
    /// Inserted vertices.
    pub(in crate::session) inserted: Vec<u32>,
    /// Volume that each inserted vertex adds.
    pub(in crate::session) volumes: Vec<f64>,
    /// Whether the limit on triangles prevented splits.
    pub(in crate::session) is_limited: bool,
    /// Bad edges that are not split because they are too short in the base; the maximum over all
    /// passes.
    pub(in crate::session) refused: usize,
    /// Evaluations of the field.
    pub(in crate::session) evaluations: u64,
}

impl AddAssign for Splits {
    fn add_assign(&mut self, other: Self) {
        self.triangles.extend(other.triangles);
        self.inserted.extend(other.inserted);
        self.volumes.extend(other.volumes);
        self.is_limited |= other.is_limited;
        self.refused = self.refused.max(other.refused);
        self.evaluations += other.evaluations;
    }
}

impl Pass<'_> {
    /// Splits bad edges of the triangles `active`, and then the bad edges that this leaves, up to
    /// [`MAX_ROUNDS`] times. See [`survey`](Self::survey) for `may_touch`.
    ///
    /// A new vertex starts in the middle of the edge on the base and is advected through the path,
    /// so it is the image of that point and not the midpoint of the deformed edge.
    ///
    /// For each bad edge, the longest edge around it is split, and the bad edge only once it is the
    /// longest of its triangles (M.-C. Rivara, *New longest-edge algorithms for the refinement
    /// and/or improvement of unstructured triangulations*, 1997). Otherwise shear would make ever
    /// thinner triangles. Lengths are those of the image, so that triangles that the flow has
    /// stretched are split across.
    pub(super) fn split(&mut self, mut active: Vec<u32>, may_touch: Option<MayTouch<'_>>) -> Splits {
        let mut splits = Splits::default();
        let mut refused = Vec::new();
        for _ in 0..MAX_ROUNDS {
            let survey = self.survey(&active, may_touch);
            splits.evaluations += survey.evaluations;
            refused.extend(survey.refused);
            let mut chosen: Vec<[u32; 2]> = survey.bad.iter().flat_map(|&bad| self.edges_to_split(bad)).collect();
            chosen.sort_unstable();
            chosen.dedup();
            // A split adds two triangles.
            let capacity = self.limits.max_triangles.saturating_sub(self.surface.topology.alive()) / 2;
            splits.is_limited |= chosen.len() > capacity;
            self.sort_by_length(&mut chosen);
            chosen.truncate(capacity);
            let round = self.split_all(&chosen);
            if round.volumes.is_empty() {
                break;
            }
            let remaining = survey.bad.iter().filter_map(|&bad| self.surface.half_edge(bad));
            let beside = remaining.flat_map(|half_edge| self.surface.triangles_beside(half_edge));
            active = beside.filter(|&triangle| triangle != NONE).chain(round.triangles.iter().copied()).collect();
            active.sort_unstable();
            active.dedup();
            splits += round;
        }
        refused.sort_unstable();
        refused.dedup();
        splits.refused = refused.len();
        splits
    }

    fn sort_by_length(&self, edges: &mut [[u32; 2]]) {
        let length = |ends: &[u32; 2]| self.surface.length(*ends);
        edges.sort_unstable_by(|a, b| length(b).total_cmp(&length(a)).then(a.cmp(b)));
    }

    /// Splits `edges`, unless another split of this call has changed them.
    pub(in crate::session) fn split_all(&mut self, edges: &[[u32; 2]]) -> Splits {
        let followed = self.midpoints.follow(self.surface, self.path, edges);
        let mut splits = Splits { evaluations: followed.evaluations, ..Splits::default() };
        for (&ends, image) in edges.iter().zip(followed.images) {
            // An image that overflows cannot be inserted.
            let Some(half_edge) = self.editable(ends).filter(|_| image.is_finite()) else { continue };
            let (base, start) = (self.surface.base_midpoint(ends), self.surface.start_midpoint(ends));
            let (split, volume) = self.surface.split(half_edge, image);
            self.surface.bases.insert(split.vertex, base, start);
            splits.inserted.push(split.vertex);
            splits.volumes.push(volume);
            splits.triangles.extend(split.near.into_iter().chain(split.far.into_iter().flatten()));
        }
        splits
    }

    /// The edges to split for the sake of a bad edge: for each of its triangles, the first edge on
    /// the walk across longest edges that is the longest of both of its triangles. The bad edge
    /// itself if that edge cannot be split.
    fn edges_to_split(&self, bad: [u32; 2]) -> Vec<[u32; 2]> {
        let Some(half_edge) = self.surface.half_edge(bad) else { return Vec::new() };
        let beside = self.surface.triangles_beside(half_edge).into_iter().filter(|&triangle| triangle != NONE);
        let found = beside.map(|triangle| {
            let longest = self.walk(triangle);
            if self.editable(longest).is_some() && self.is_divisible(longest) { longest } else { bad }
        });
        found.collect()
    }

    /// Walks across longest edges from a triangle. The last edge is the longest of both of its
    /// triangles, or at the boundary.
    fn walk(&self, mut triangle: u32) -> [u32; 2] {
        let surface = &*self.surface;
        let mut longest = surface.longest_edge(triangle);
        for _ in 0..LONGEST_WALK {
            let beside = surface.half_edge(longest).map(|half_edge| surface.triangles_beside(half_edge));
            let beyond = beside.and_then(|beside| beside.into_iter().find(|&other| other != triangle && other != NONE));
            let Some(beyond) = beyond else { break };
            let next = surface.longest_edge(beyond);
            if next == longest {
                break;
            }
            (triangle, longest) = (beyond, next);
        }
        longest
    }
}
