//! Refinement options. Their defaults are those of [`field::RefineOptions`], which has the numbers.

use isochore_field as field;

use crate::recipe::Refine;

impl Default for Refine {
    fn default() -> Self {
        let field::RefineOptions { volume, deviation, max_edge, max_triangles } = field::RefineOptions::default();
        Self { enabled: true, volume, deviation, max_edge, max_triangles }
    }
}

/// The options for [`field::deform`], or `None` if refinement is disabled.
pub(super) fn options(refine: &Refine) -> Option<field::RefineOptions> {
    let Refine { enabled, volume, deviation, max_edge, max_triangles } = *refine;
    enabled.then_some(field::RefineOptions { volume, deviation, max_edge, max_triangles })
}
