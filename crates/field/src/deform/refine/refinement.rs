//! One round of splitting, and the sum of all rounds.

use isochore_mesh::{Cancelled, Monitor};

use super::criteria::Criteria;
use crate::{
    deform::{
        curved_triangle::edge_lengths,
        tessellation::{ChosenEdges, SplitTriangles, Tessellation},
    },
    flow::Stroke,
};

/// Most rounds of splitting. Each round halves the edges that it splits, so this many reach the rounding
/// of any mesh. The limit only ends a loop that a defect would keep alive.
pub(super) const MAX_ROUNDS: usize = 40;

/// Result of rounds of splitting.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Refinement {
    /// Number of inserted vertices.
    pub(crate) inserted: usize,
    /// Evaluations of the fields.
    pub(crate) evaluations: u64,
    /// Whether the limit on triangles ended the rounds.
    pub(crate) is_limited: bool,
}

impl Refinement {
    /// Adds the result of other rounds.
    pub(crate) fn add(&mut self, other: &Self) {
        self.inserted += other.inserted;
        self.evaluations += other.evaluations;
        self.is_limited |= other.is_limited;
    }

    /// Splits the chosen edges and the longest edges of the triangles at them. Returns the new
    /// triangles, or `None` if nothing is chosen or the split would exceed the limit on triangles.
    pub(crate) fn split(
        &mut self,
        mesh: &mut Tessellation,
        strokes: &[Stroke],
        mut chosen: ChosenEdges,
        criteria: &Criteria,
        closure: LongestEdge,
        monitor: &dyn Monitor,
    ) -> Result<Option<SplitTriangles>, Cancelled> {
        if chosen.half_edges().is_empty() {
            return Ok(None);
        }
        add_longest_edges(mesh, &mut chosen, closure);
        self.evaluations += mesh.advect_followed(strokes, monitor)?;
        self.is_limited = mesh.triangles.len() + chosen.added() > criteria.max_triangles();
        if self.is_limited {
            return Ok(None);
        }
        self.inserted += chosen.half_edges().len();
        Ok(Some(mesh.split(&chosen)))
    }
}

/// The surface in which the longest edge of a triangle is looked for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum LongestEdge {
    /// The image, and the base for triangles that are slivers there.
    OfImage,
    OfBase,
}

/// Adds the longest edge of each triangle that is split, and propagates to the neighbors.
///
/// Source: M.-C. Rivara, *Algorithms for refining triangular grids suitable for adaptive and
/// multigrid techniques*, 1984 (longest-edge bisection).
///
/// Without this rule a triangle can split its two shorter edges again and again while the longest
/// just meets the criteria, and become an ever thinner sliver. A stretched image can still make
/// slivers in the base; those split their longest edge in the base.
fn add_longest_edges(mesh: &mut Tessellation, chosen: &mut ChosenEdges, closure: LongestEdge) {
    let mut index = 0;
    while let Some(&first) = chosen.half_edges().get(index) {
        let mut half_edge = first;
        loop {
            let triangle = half_edge as usize / 3;
            let lengths = if closure == LongestEdge::OfBase || mesh.is_sliver_in_base(triangle) {
                edge_lengths(&mesh.base_of(triangle))
            } else {
                edge_lengths(&mesh.image_of(triangle))
            };
            let longest = (0..3).fold(0, |longest, edge| if lengths[edge] > lengths[longest] { edge } else { longest });
            chosen.choose(mesh, (3 * triangle + longest) as u32);
            half_edge = mesh.next_around(half_edge);
            if half_edge == first {
                break;
            }
        }
        index += 1;
    }
}
