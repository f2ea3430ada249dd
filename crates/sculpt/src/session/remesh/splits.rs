//! Splits of long edges, which do not move the surface.

use isochore_mesh::{NONE, next_half_edge, previous_half_edge};

use super::{
    change::{Change, Replacement},
    lines::Freedom,
    passes::Action,
    remesher::Remesher,
    shape::direction,
};

/// An edge is split if it is longer than this multiple of its target length: its halves are then
/// nearer to the target than the whole (M. Botsch, L. Kobbelt, *A Remeshing Approach to
/// Multiresolution Modeling*, 2004). Larger: coarser than the target. Smaller: halves are collapsed
/// again.
pub(super) const LONG: f64 = 4.0 / 3.0;

/// Number of times that halves are split again in one pass. Larger: very long edges are made short
/// in one pass, before any other edit improves their triangles. Smaller: more passes.
const MOST_HALVINGS: usize = 8;

impl Remesher<'_> {
    /// Splits edges of `triangles` that are too long, the longest relative to its target first.
    pub(super) fn split(&mut self, mut triangles: Vec<u32>) {
        for _ in 0..MOST_HALVINGS {
            let long = self.ranked_edges(&triangles, |edge| Some(self.ratio(edge)).filter(|&ratio| ratio > LONG));
            triangles = self.edit(&long, |remesher, ends, change| remesher.plan_split(ends, change));
            if triangles.is_empty() || self.tally.is_limited {
                break;
            }
        }
    }

    fn plan_split(&self, ends: [u32; 2], change: &mut Change) -> Option<(u32, Action)> {
        let half_edge = self.half_edge(ends)?;
        let [one, other] = ends.map(|vertex| self.freedoms[vertex as usize]);
        let is_kept = one == Freedom::Frozen || other == Freedom::Frozen || [one, other] == [Freedom::Held; 2];
        if is_kept || self.ratio(half_edge) <= LONG {
            return None;
        }
        let topology = &self.surface.topology;
        let [a, b] = ends.map(|vertex| self.surface.position(vertex));
        let middle = 0.5 * (a + b);
        change.clear();
        for edge in [half_edge, topology.twin(half_edge)].into_iter().filter(|&edge| edge != NONE) {
            let triangle = edge / 3;
            let [from, to, apex] = [edge, next_half_edge(edge), previous_half_edge(edge)]
                .map(|corner| self.surface.position(topology.start(corner)));
            let before = direction(&[from, to, apex]);
            let anchor = self.anchors[triangle as usize];
            change.old.push(triangle);
            // The numbers of added triangles follow when the edit is made.
            change.new.push(Replacement { triangle, corners: [from, middle, apex], before, anchor });
            change.new.push(Replacement { triangle, corners: [middle, to, apex], before, anchor });
        }
        self.allows_flat(change).then_some((half_edge, Action::Split))
    }

    pub(super) fn perform_split(&mut self, half_edge: u32, change: &mut Change) {
        let topology = &self.surface.topology;
        let twin = topology.twin(half_edge);
        let ends = [topology.start(half_edge), topology.end(half_edge)];
        let middle = change.new[1].corners[0];
        let is_line = self.lines.is_line(half_edge);
        let (split, _) = self.surface.split(half_edge, middle);
        self.lines.follow_split(&split, half_edge, twin);
        // The near triangle keeps the start of the half-edge, and so does the far one.
        change.new[1].triangle = split.near[1];
        if let Some([_, added]) = split.far {
            change.new[2].triangle = added;
        }
        self.add_vertex(split.vertex, ends, if is_line { Freedom::OnLine } else { Freedom::Free });
        self.tally.splits += 1;
    }
}
