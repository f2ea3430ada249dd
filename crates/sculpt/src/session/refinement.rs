//! Splits, collapses and flips during a stroke, restricted to the triangles that it touches.

mod collapses;
mod edits;
mod flips;
mod pass;
mod splits;
mod survey;

use glam::DVec3;
use isochore_mesh::Aabb;

use super::{InteractiveRefinement, SessionError, SessionTool, stroke::Segment};

pub(super) use edits::Edits;
pub(super) use pass::Pass;

use pass::is_held;
use survey::{Limits, survey};

/// Default length of the longest edges, as a fraction of the tool's feature size. Larger lets the
/// field slip through between vertices, and the facet error grows with the square; smaller makes
/// triangles that nobody sees.
const LONGEST: f64 = 0.125;

/// Largest allowed `collapse`. Larger, and edges that a split leaves are collapsed again: half of
/// an edge just too long is half as long as the longest.
const MOST_COLLAPSE: f64 = 0.4;

impl InteractiveRefinement {
    pub(super) fn check(&self) -> Result<(), SessionError> {
        if self.longest.is_some_and(|longest| !(longest > 0.0 && longest.is_finite())) {
            return Err(SessionError::Refinement("the longest edge must be a positive, finite length"));
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
        let longest = self.longest.unwrap_or(LONGEST * tool.tool().feature_size());
        let shortest = self.collapse * longest;
        Limits {
            longest2: longest * longest,
            shortest2: shortest * shortest,
            flip: self.flip,
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
    pub(super) fn split_ahead(&mut self, triangles: &[u32], segment: &Segment) -> Edits {
        let mask = self.mask;
        let is_held = |corners: [DVec3; 3]| (0..3).all(|side| is_held(mask, [corners[side], corners[(side + 1) % 3]]));
        let may_touch = |corners: [DVec3; 3]| segment.may_touch(Aabb::of(corners)) && !is_held(corners);
        let only_long = Limits { shortest2: 0.0, flip: false, ..self.limits };
        let surveyed = survey(self.surface, triangles, &only_long, Some(&may_touch));
        self.split(surveyed.long, Some(&may_touch)).into()
    }

    /// Splits, collapses and flips edges of `triangles`, which have moved.
    pub(super) fn improve(&mut self, triangles: &[u32]) -> Edits {
        let surveyed = survey(self.surface, triangles, &self.limits, None);
        let mut edits = Edits::default();
        if self.limits.flip {
            // Shear lengthens one edge of a pair of triangles and shortens the other. Flipping
            // costs nothing; a split would insert a vertex that the flow does not need.
            let long = surveyed.long.iter().map(|&(_, edge)| edge).collect();
            edits += self.flip(long, flips::FOR_LENGTH).into();
        }
        edits += self.split(surveyed.long, None).into();
        edits += self.collapse(surveyed.short).into();
        if self.limits.flip {
            let mut obtuse = surveyed.obtuse;
            let only_obtuse = Limits { longest2: f64::INFINITY, shortest2: 0.0, ..self.limits };
            obtuse.extend(survey(self.surface, &edits.triangles, &only_obtuse, None).obtuse);
            edits += self.flip(obtuse, flips::FOR_SHAPE).into();
        }
        edits
    }
}
