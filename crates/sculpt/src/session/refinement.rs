//! Refinement by a stroke, restricted to the triangles that it touches.
//!
//! During the stroke, edges are split. A split halves an edge of the base, the surface from which
//! the flow starts, and so never bends the base. Collapses and flips would: they follow where the
//! image becomes the next base, at the end of the stroke and of its phases.

mod collapses;
mod flips;
mod midpoints;
mod pass;
mod splits;
mod survey;
mod tidying;

use glam::DVec3;
use isochore_mesh::Aabb;

use super::{InteractiveRefinement, SessionError, SessionTool, path::Segment};

pub(super) use midpoints::Midpoints;
pub(super) use pass::Pass;
pub(super) use splits::Splits;
pub(super) use survey::distance_to_segment;

use pass::is_held;

/// Default length of the longest edges in the tool's reach, as a fraction of the tool's feature
/// size. Larger lets the field slip through between vertices; smaller makes triangles that flat
/// surface does not need.
const LONGEST: f64 = 0.5;

/// Default of the largest deviation, as a fraction of the tool's feature size. Larger leaves visible
/// facets on what the tool shapes; smaller makes triangles that nobody sees.
const DEVIATION: f64 = 1.0 / 256.0;

/// Edges up to this fraction of the tool's feature size, or up to the longest allowed length if that
/// is less, are not split for their deviation. Larger cuts off sharp bends; smaller spends triangles
/// on the thin films that a tool draws out.
const FINEST: f64 = 0.125;

/// Edges of the base that are shorter than this fraction of the shortest edge that is split are not
/// split, however long their image is. Larger leaves long pulls coarse; smaller follows the flow
/// farther where it stirs without end, as at the rim of a core that crosses the surface.
const LEAST_IN_BASE: f64 = 1.0 / 32.0;

/// Largest allowed `collapse`. Larger, and edges that a split leaves are collapsed again: half of
/// an edge just too long is half as long as the longest.
const MOST_COLLAPSE: f64 = 0.4;

/// Thresholds, model units.
#[derive(Debug, Clone, Copy)]
pub(in crate::session) struct Limits {
    /// Longer edges in the tool's reach are split.
    longest: f64,
    /// Shorter edges are collapsed if the stroke has squeezed them.
    shortest: f64,
    /// Shorter edges are not examined for their deviation.
    pub(in crate::session) finest: f64,
    /// Largest distance of the image of a midpoint from the edge between the images of the ends.
    deviation: f64,
    /// Shorter edges of the base are not split.
    least_in_base: f64,
    max_triangles: usize,
}

impl InteractiveRefinement {
    pub(super) fn check(&self) -> Result<(), SessionError> {
        if self.longest.is_some_and(|longest| !(longest > 0.0 && longest.is_finite())) {
            return Err(SessionError::Refinement("the longest edge must be a positive, finite length"));
        }
        if self.deviation.is_some_and(|deviation| deviation.is_nan() || deviation <= 0.0) {
            return Err(SessionError::Refinement("the deviation must be a positive length"));
        }
        if !(0.0..=MOST_COLLAPSE).contains(&self.collapse) {
            return Err(SessionError::Refinement("the collapse fraction must be from 0 to 0.4 of the longest edge"));
        }
        let is_ball = |(center, radius): &(DVec3, f64)| center.is_finite() && *radius >= 0.0 && radius.is_finite();
        if !self.keep.iter().all(is_ball) {
            return Err(SessionError::Refinement(
                "balls to keep must have a finite center and a finite radius of 0 or more",
            ));
        }
        Ok(())
    }

    fn limits(&self, tool: &SessionTool) -> Limits {
        let size = tool.tool().feature_size();
        let longest = self.longest.unwrap_or(LONGEST * size);
        let finest = longest.min(FINEST * size);
        Limits {
            longest,
            shortest: self.collapse * longest,
            finest,
            deviation: self.deviation.unwrap_or(DEVIATION * size),
            least_in_base: LEAST_IN_BASE * finest,
            max_triangles: self.max_triangles,
        }
    }

    /// Whether the edge between two points intersects, or may intersect, a ball to keep.
    fn is_kept(&self, [a, b]: [DVec3; 2]) -> bool {
        let middle = 0.5 * (a + b);
        let half = 0.5 * a.distance(b);
        self.keep.iter().any(|&(center, radius)| center.distance(middle) <= radius + half)
    }
}

impl Pass<'_> {
    /// Splits long edges before the tool moves along `segment`: edges of those of `triangles` that
    /// it may touch.
    pub(super) fn split_ahead(&mut self, triangles: &[u32], segment: &Segment) -> Splits {
        let mask = self.mask;
        let is_held = |corners: [DVec3; 3]| (0..3).all(|side| is_held(mask, [corners[side], corners[(side + 1) % 3]]));
        let may_touch = |corners: [DVec3; 3]| segment.may_touch(Aabb::of(corners)) && !is_held(corners);
        self.limits.finest = self.limits.longest;
        self.split(triangles.to_vec(), Some(&may_touch))
    }

    /// Splits edges of `triangles`, which have moved: those that the flow has lengthened too much, and
    /// those that deviate.
    pub(super) fn split_behind(&mut self, triangles: &[u32]) -> Splits {
        self.split(triangles.to_vec(), None)
    }
}
