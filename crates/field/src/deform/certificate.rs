//! The certificate: no stroke leaves a crossing that the input mesh did not have.
//!
//! A flow map does not make a surface cross itself. New crossings are flat triangles that cut
//! through a neighboring sheet, so splits remove them ([`untangle()`]). If splits do not suffice
//! within their budget, the stroke ends at its last moment without crossings ([`rewind()`]).

mod detect;
mod input;
mod mark_grid;
mod rewind;
mod sheets;
mod untangle;

use isochore_mesh::Cancelled;

use super::{passage::Context, refine::Refinement, tessellation::Tessellation};
use crate::flow::Stroke;
pub(super) use detect::Crossings;
pub(super) use input::Input;
pub(super) use rewind::{HALVINGS, Rewound, rewind};
pub use sheets::Sheets;
pub(super) use sheets::{closest_sheets, crossing_place};
use untangle::untangle;

/// Result of searching a surface for new crossings and splitting the triangles that cross.
#[derive(Debug, Default)]
pub(super) struct Verdict {
    /// New crossings that remain.
    pub(super) crossings: Crossings,
    /// The splits.
    pub(super) refinement: Refinement,
    /// Pairs of triangles with overlapping boxes that were tested.
    pub(super) pairs_tested: u64,
}

/// Searches the triangles that changed since the last call for new crossings, and splits those that
/// cross. `strokes` lead from the base to the image. Without refinement nothing is searched: the caller
/// wants the flow of exactly these triangles, and the receipt counts those that cross.
pub(super) fn certify(
    mesh: &mut Tessellation,
    strokes: &[Stroke],
    context: &Context<'_>,
) -> Result<Verdict, Cancelled> {
    let changed = mesh.take_unchecked();
    let Some(criteria) = context.criteria else { return Ok(Verdict::default()) };
    let crossings = Crossings::of(mesh, &mesh.image, &changed, context)?;
    let mut verdict = Verdict { pairs_tested: crossings.pairs_tested, crossings, ..Verdict::default() };
    if !verdict.crossings.is_empty() {
        untangle(mesh, strokes, criteria, changed.len(), &mut verdict, context)?;
    }
    Ok(verdict)
}
