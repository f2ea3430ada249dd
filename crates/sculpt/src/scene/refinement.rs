//! Refinement options. Their defaults are those of [`field::RefineOptions`], which has the numbers.

use isochore_field as field;

use crate::recipe::{Rebase, RebaseRule, Refine};

impl Default for Refine {
    fn default() -> Self {
        let field::RefineOptions { volume, deviation, max_edge, max_triangles, rebase } =
            field::RefineOptions::default();
        let rebase = match rebase {
            field::Rebase::Never => Rebase::Rule(RebaseRule::Never),
            field::Rebase::Auto => Rebase::Rule(RebaseRule::Auto),
            field::Rebase::Every(strokes) => Rebase::Every(u32::try_from(strokes).unwrap_or(u32::MAX)),
        };
        Self { enabled: true, volume, deviation, max_edge, max_triangles, rebase }
    }
}

/// The options for [`field::deform`], or `None` if refinement is disabled.
pub(super) fn options(refine: &Refine) -> Option<field::RefineOptions> {
    let Refine { enabled, volume, deviation, max_edge, max_triangles, rebase } = *refine;
    let rebase = match rebase {
        Rebase::Rule(RebaseRule::Never) => field::Rebase::Never,
        Rebase::Rule(RebaseRule::Auto) => field::Rebase::Auto,
        Rebase::Every(strokes) => field::Rebase::Every(strokes as usize),
    };
    enabled.then_some(field::RefineOptions { volume, deviation, max_edge, max_triangles, rebase })
}
