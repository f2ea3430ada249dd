//! Splits of long edges.

use glam::DVec3;

use super::{
    edits::Edits,
    pass::Pass,
    survey::{Limits, MayTouch, survey},
};

/// Rounds of splitting in one pass. Each halves the long edges, so ten rounds resolve edges a
/// thousand times too long. The next move splits the rest.
const MAX_ROUNDS: usize = 10;

/// How many times one stroke may halve an edge whose ends it has moved. Larger follows the flow
/// farther where it stirs without end, as at the rim of a core that crosses the surface, where each
/// halving may double the triangles; smaller leaves deep pulls coarse.
const MOST_HALVINGS: u8 = 4;

/// Result of splitting edges.
#[derive(Debug, Default)]
pub(super) struct Splits {
    /// Triangles at the inserted vertices.
    pub(super) triangles: Vec<u32>,
    /// Volume that each inserted vertex adds.
    pub(super) volumes: Vec<f64>,
    /// Whether the limit on triangles prevented splits.
    pub(super) is_limited: bool,
    /// Long edges that are not split because they were halved too often.
    pub(super) refused: usize,
    /// Evaluations of the field.
    pub(super) evaluations: u64,
}

impl From<Splits> for Edits {
    fn from(splits: Splits) -> Self {
        Self {
            triangles: splits.triangles,
            split_volumes: splits.volumes,
            is_limited: splits.is_limited,
            refused_splits: splits.refused,
            evaluations: splits.evaluations,
            ..Self::default()
        }
    }
}

impl Pass<'_> {
    /// Splits long edges, longest first, and then the long edges that this leaves, up to
    /// [`MAX_ROUNDS`] times.
    ///
    /// A new vertex starts in the middle of the edge on the surface at the beginning of the stroke.
    /// It is advected through all moves of the stroke so far, and so it is the image of that point
    /// and not the midpoint of the deformed edge.
    ///
    /// If the stroke stirs the surface, edges would be split without end. After [`MOST_HALVINGS`]
    /// an edge is refused instead.
    pub(super) fn split(&mut self, mut long: Vec<(f64, [u32; 2])>, may_touch: Option<MayTouch<'_>>) -> Splits {
        let mut splits = Splits::default();
        let mut refused = Vec::new();
        for _ in 0..MAX_ROUNDS {
            long.sort_unstable_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
            long.dedup_by_key(|(_, edge)| *edge);
            long.retain(|&(_, edge)| self.editable(edge).is_some());
            refused.extend(long.extract_if(.., |(_, ends)| self.halvings(*ends) > MOST_HALVINGS).map(|(_, ends)| ends));
            // A split adds two triangles.
            let capacity = self.limits.max_triangles.saturating_sub(self.surface.topology.alive()) / 2;
            splits.is_limited |= long.len() > capacity;
            long.truncate(capacity);
            if long.is_empty() {
                break;
            }
            let round = self.split_once(&long);
            let only_long = Limits { shortest2: 0.0, flip: false, ..self.limits };
            long = survey(self.surface, &round.triangles, &only_long, may_touch).long;
            splits.triangles.extend(round.triangles);
            splits.volumes.extend(round.volumes);
            splits.evaluations += round.evaluations;
        }
        refused.sort_unstable();
        refused.dedup();
        splits.refused = refused.len();
        splits
    }

    /// Splits each of the edges `long`, unless another split of this round has changed it.
    fn split_once(&mut self, long: &[(f64, [u32; 2])]) -> Splits {
        let mut splits = Splits::default();
        let bases: Vec<DVec3> = long.iter().map(|&(_, ends)| self.base_midpoint(ends)).collect();
        let mut images = bases.clone();
        splits.evaluations = self.stroke.advect(&mut images);
        for ((&(_, ends), base), image) in long.iter().zip(bases).zip(images) {
            // An image that overflows cannot be inserted.
            let Some(half_edge) = self.editable(ends).filter(|_| image.is_finite()) else { continue };
            let halvings = self.halvings(ends);
            let (split, volume) = self.surface.split(half_edge, image);
            self.surface.inserted.push(split.vertex, base, halvings);
            splits.volumes.push(volume);
            splits.triangles.extend(split.near.into_iter().chain(split.far.into_iter().flatten()));
        }
        splits
    }

    /// Midpoint of an edge on the surface at the beginning of the stroke.
    fn base_midpoint(&self, ends: [u32; 2]) -> DVec3 {
        let [a, b] = ends.map(|vertex| self.surface.base(vertex));
        0.5 * (a + b)
    }

    /// Number of halvings of a vertex inserted between two others.
    fn halvings(&self, ends: [u32; 2]) -> u8 {
        let has_moved = ends.iter().any(|&end| self.surface.base(end) != self.surface.position(end));
        let [one, other] = ends.map(|end| self.surface.inserted.halvings(end));
        one.max(other) + u8::from(has_moved)
    }
}
