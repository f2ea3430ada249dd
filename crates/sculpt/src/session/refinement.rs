//! Splits, collapses and flips during a stroke, over the triangles that it touches and no others.

mod collapses;
mod flips;
mod splits;

use glam::DVec3;
use isochore_field::Mask;
use isochore_mesh::{Aabb, NONE};
use rayon::prelude::*;

use super::{
    InteractiveRefinement, MoveReceipt, SessionError, SessionTool,
    stroke::{ActiveStroke, Segment},
    surface::Surface,
};

/// Share of the tool's feature size that edges may have by default. Larger lets the field slip through between vertices and lies
/// farther off the curved image, by the square; smaller makes triangles that nobody sees.
const LONGEST: f64 = 0.125;

/// Triangles that one task looks at.
const CHUNK: usize = 2048;

/// Lengths that decide, model units, squared.
#[derive(Debug, Clone, Copy)]
pub(super) struct Limits {
    longest2: f64,
    shortest2: f64,
    flip: bool,
    max_triangles: usize,
}

/// Edges by their ends, the smaller first.
#[derive(Debug, Clone, Default)]
struct Survey {
    /// With squared lengths.
    long: Vec<(f64, [u32; 2])>,
    short: Vec<(f64, [u32; 2])>,
    /// Opposite to obtuse angles.
    obtuse: Vec<[u32; 2]>,
}

impl InteractiveRefinement {
    pub(super) fn check(&self) -> Result<(), SessionError> {
        if self.longest.is_some_and(|longest| !(longest > 0.0 && longest.is_finite())) {
            return Err(SessionError::Refinement("the longest edge must be a positive length"));
        }
        if !(0.0..=MOST_COLLAPSE).contains(&self.collapse) {
            return Err(SessionError::Refinement("edges may be collapsed below a share from 0 to 0.4 of the longest"));
        }
        let is_ball = |(center, radius): &(DVec3, f64)| center.is_finite() && *radius >= 0.0 && radius.is_finite();
        if !self.keep.iter().all(is_ball) {
            return Err(SessionError::Refinement("balls that are kept must have a finite center and radius"));
        }
        Ok(())
    }

    pub(super) fn limits(&self, tool: &SessionTool) -> Limits {
        let longest = self.longest.unwrap_or(LONGEST * tool.tool().feature_size());
        let shortest = self.collapse * longest;
        Limits {
            longest2: longest * longest,
            shortest2: shortest * shortest,
            flip: self.flip,
            max_triangles: self.max_triangles,
        }
    }

    /// Whether the edge between two points lies, or may lie, in a ball that is kept.
    fn is_kept(&self, [a, b]: [DVec3; 2]) -> bool {
        let middle = 0.5 * (a + b);
        let half = 0.5 * a.distance(b);
        self.keep.iter().any(|&(center, radius)| center.distance(middle) <= radius + half)
    }
}

/// Larger, and what a split leaves is collapsed again: half of an edge just too long is half as long as the longest.
const MOST_COLLAPSE: f64 = 0.4;

/// What one pass works with.
pub(super) struct Pass<'a> {
    pub(super) surface: &'a mut Surface,
    pub(super) stroke: &'a mut ActiveStroke,
    pub(super) mask: Option<&'a Mask>,
    /// Triangles that were edited, in the order in which that happened, some more than once.
    pub(super) edited: &'a mut Vec<u32>,
    pub(super) done: &'a mut MoveReceipt,
}

impl Pass<'_> {
    /// Splits edges that are too long of those of `triangles` that the last segment of the way may touch.
    pub(super) fn resolve(&mut self, triangles: &[u32], options: &InteractiveRefinement, segment: &Segment) {
        let limits = options.limits(&self.stroke.tool);
        let mask = self.mask;
        let is_held = |corners: [DVec3; 3]| (0..3).all(|side| is_held(mask, [corners[side], corners[(side + 1) % 3]]));
        let may_touch = |corners: [DVec3; 3]| segment.may_touch(Aabb::of(corners)) && !is_held(corners);
        let surveyed =
            survey(self.surface, triangles, &Limits { shortest2: 0.0, flip: false, ..limits }, Some(&may_touch));
        self.split(surveyed.long, options, &limits, Some(&may_touch));
    }

    /// Splits, collapses and flips edges of `triangles`, which have moved.
    pub(super) fn improve(&mut self, triangles: &[u32], options: &InteractiveRefinement) {
        let limits = options.limits(&self.stroke.tool);
        let surveyed = survey(self.surface, triangles, &limits, None);
        let known = self.edited.len();
        if limits.flip {
            // Shear only turns: there another edge is short where this one is too long, and a split would add what no flow asks for.
            self.flip(surveyed.long.iter().map(|&(_, edge)| edge).collect(), flips::FOR_LENGTH, options, &limits);
        }
        self.split(surveyed.long, options, &limits, None);
        self.collapse(surveyed.short, options, &limits);
        if limits.flip {
            let mut obtuse = surveyed.obtuse;
            let edited = self.edited[known..].to_vec();
            let again = Limits { longest2: f64::INFINITY, shortest2: 0.0, ..limits };
            obtuse.extend(survey(self.surface, &edited, &again, None).obtuse);
            self.flip(obtuse, flips::FOR_SHAPE, options, &limits);
        }
    }

    /// The half-edge between two vertices, if it is there, no end of it is frozen, no ball keeps it, and no mask holds it.
    fn editable(&self, [a, b]: [u32; 2], options: &InteractiveRefinement) -> Option<u32> {
        let topology = &self.surface.topology;
        let is_fixed = |vertex: u32| topology.outgoing(vertex) == NONE || self.surface.is_frozen(vertex);
        if is_fixed(a) || is_fixed(b) {
            return None;
        }
        let ends = [a, b].map(|vertex| self.surface.position(vertex));
        if !options.keep.is_empty() && options.is_kept(ends) || is_held(self.mask, ends) {
            return None;
        }
        // At the boundary the edge has a half-edge in one direction only.
        topology.half_edge(a, b).or_else(|| topology.half_edge(b, a))
    }
}

/// Whether a mask holds an edge: its ends, and what lies between them.
fn is_held(mask: Option<&Mask>, [a, b]: [DVec3; 2]) -> bool {
    mask.is_some_and(|mask| [a, b, 0.5 * (a + b)].iter().all(|&point| mask.is_held(point)))
}

type MayTouch<'a> = &'a (dyn Fn([DVec3; 3]) -> bool + Sync);

/// Looks at `triangles`; only those count whose edges are too long if they also `may_touch`.
fn survey(surface: &Surface, triangles: &[u32], limits: &Limits, may_touch: Option<MayTouch<'_>>) -> Survey {
    let parts: Vec<Survey> = triangles
        .par_chunks(CHUNK)
        .map(|chunk| {
            let mut survey = Survey::default();
            chunk.iter().for_each(|&triangle| survey.look_at(surface, triangle, limits, may_touch));
            survey
        })
        .collect();
    let mut all = Survey::default();
    for part in parts {
        all.long.extend(part.long);
        all.short.extend(part.short);
        all.obtuse.extend(part.obtuse);
    }
    all
}

impl Survey {
    fn look_at(&mut self, surface: &Surface, triangle: u32, limits: &Limits, may_touch: Option<MayTouch<'_>>) {
        let Some(corners) = surface.corners_of(triangle) else { return };
        let lengths2: [f64; 3] = std::array::from_fn(|side| corners[side].distance_squared(corners[(side + 1) % 3]));
        let is_beyond = |length2: &f64| *length2 > limits.longest2 || *length2 < limits.shortest2;
        let sum: f64 = lengths2.iter().sum();
        let longest = (0..3).fold(0, |longest, side| if lengths2[side] > lengths2[longest] { side } else { longest });
        // The law of cosines: beyond a right angle the longest square is more than the other two together.
        let is_obtuse = limits.flip && lengths2[longest] > flips::OBTUSE * (sum - lengths2[longest]);
        if !(is_obtuse || lengths2.iter().any(is_beyond)) {
            return;
        }
        let vertices = surface.topology.triangles()[triangle as usize].vertices;
        let edge = |side: usize| {
            let (a, b) = (vertices[side], vertices[(side + 1) % 3]);
            [a.min(b), a.max(b)]
        };
        let is_long = lengths2.iter().any(|&length2| length2 > limits.longest2);
        let counts = is_long && may_touch.is_none_or(|may_touch| may_touch(corners));
        for side in 0..3 {
            if counts && lengths2[side] > limits.longest2 {
                self.long.push((lengths2[side], edge(side)));
            }
            if lengths2[side] < limits.shortest2 {
                self.short.push((lengths2[side], edge(side)));
            }
        }
        if is_obtuse {
            self.obtuse.push(edge(longest));
        }
    }
}
