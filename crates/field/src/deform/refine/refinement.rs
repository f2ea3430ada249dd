//! One round of splitting, and the sum of all rounds.

use isochore_mesh::{Cancelled, Monitor};

use super::criteria::Criteria;
use crate::{
    deform::{
        curved_triangle::edge_lengths,
        tessellation::{ChosenEdges, Tessellation},
    },
    flow::Stroke,
};

/// A round divides what it splits by two, so this many divide any edge of a representable mesh down to rounding; it only ends
/// what a defect would keep going.
pub(super) const MAX_ROUNDS: usize = 40;

/// What the passes over one stroke have done.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Refinement {
    /// Vertices inserted.
    pub(crate) inserted: usize,
    /// Evaluations of the fields.
    pub(crate) evaluations: u64,
    /// Whether the limit on triangles ended it.
    pub(crate) is_limited: bool,
}

impl Refinement {
    /// Adds up what was spent.
    pub(crate) fn add(&mut self, other: &Self) {
        self.inserted += other.inserted;
        self.evaluations += other.evaluations;
        self.is_limited |= other.is_limited;
    }

    /// Splits the chosen edges, and the longest ones of the triangles at them, unless there is nothing to split or that would
    /// pass the limit on triangles. Returns the triangles that it made.
    pub(super) fn split(
        &mut self,
        mesh: &mut Tessellation,
        strokes: &[Stroke],
        mut chosen: ChosenEdges,
        criteria: &Criteria,
        monitor: &dyn Monitor,
    ) -> Result<Option<Vec<u32>>, Cancelled> {
        if chosen.half_edges().is_empty() {
            return Ok(None);
        }
        add_longest_edges(mesh, &mut chosen);
        self.evaluations += mesh.advect_followed(strokes, monitor)?;
        self.is_limited = mesh.triangles.len() + chosen.added() > criteria.max_triangles();
        if self.is_limited {
            return Ok(None);
        }
        self.inserted += chosen.half_edges().len();
        Ok(Some(mesh.split(&chosen)))
    }
}

/// Wherever a triangle is split, has the longest edge of its image split too, and so on through the neighbors: a bisection at
/// least, as M.-C. Rivara, *Algorithms for refining triangular grids suitable for adaptive and multigrid techniques*, 1984.
///
/// Without this a triangle can lose its two shorter edges again and again, its longest always just within the criteria, and
/// shrink to a sliver along it, to no end. Where the image is so stretched that this happens in the base all the same, the
/// longest edge there is split.
fn add_longest_edges(mesh: &mut Tessellation, chosen: &mut ChosenEdges) {
    let mut place = 0;
    while let Some(&first) = chosen.half_edges().get(place) {
        let mut half_edge = first;
        loop {
            let triangle = half_edge as usize / 3;
            let lengths = if mesh.is_sliver_in_base(triangle) {
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
        place += 1;
    }
}
