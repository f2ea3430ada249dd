//! The surface, the rules and the permission to split.

use glam::DVec3;
use isochore_field::Mask;
use isochore_mesh::NONE;

use super::{Limits, Midpoints};
use crate::session::{InteractiveRefinement, SessionTool, path::Path, surface::Surface};

/// The surface to refine, and the rules. A pass edits only the surface and the midpoints; its
/// result says what it did.
pub(in crate::session) struct Pass<'a> {
    pub(in crate::session) surface: &'a mut Surface,
    pub(in crate::session) midpoints: &'a mut Midpoints,
    /// The path of the tool since the base.
    pub(in crate::session) path: &'a Path,
    pub(super) mask: Option<&'a Mask>,
    pub(super) options: &'a InteractiveRefinement,
    pub(in crate::session) limits: Limits,
}

impl<'a> Pass<'a> {
    pub(in crate::session) fn new(
        surface: &'a mut Surface,
        midpoints: &'a mut Midpoints,
        path: &'a Path,
        mask: Option<&'a Mask>,
        options: &'a InteractiveRefinement,
        tool: &SessionTool,
    ) -> Self {
        Self { surface, midpoints, path, mask, options, limits: options.limits(tool) }
    }

    /// The half-edge between two vertices, or `None` if it does not exist, an end is frozen, or a
    /// ball or the mask keeps the edge.
    pub(in crate::session) fn editable(&self, [a, b]: [u32; 2]) -> Option<u32> {
        let topology = &self.surface.topology;
        let is_fixed = |vertex: u32| topology.outgoing(vertex) == NONE || self.surface.is_frozen(vertex);
        if is_fixed(a) || is_fixed(b) {
            return None;
        }
        let ends = [a, b].map(|vertex| self.surface.position(vertex));
        if !self.options.keep.is_empty() && self.options.is_kept(ends) || is_held(self.mask, ends) {
            return None;
        }
        self.surface.half_edge([a, b])
    }
}

/// Whether a mask holds an edge: both ends and the midpoint.
pub(super) fn is_held(mask: Option<&Mask>, [a, b]: [DVec3; 2]) -> bool {
    mask.is_some_and(|mask| [a, b, 0.5 * (a + b)].iter().all(|&point| mask.is_held(point)))
}
