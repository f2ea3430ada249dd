//! The motion of a stamp's tool during one step.

use crate::{
    fields::{Tool, pose::Placement},
    flow::Stamp,
};

/// Rounding error of a distance, in units of the rounding of the coordinates. A larger value leaves the
/// tool inside the surface; a smaller value sees contacts that are rounding alone.
const ROUNDINGS: f64 = 64.0;

/// Fewest edges across the support at the rim. A larger value costs triangles; a smaller value makes an
/// angular rim.
const EDGES_ACROSS_RIM: f64 = 8.0;

/// One step of a stamp's path.
#[derive(Debug)]
pub(super) struct StepMotion<'a> {
    pub(super) tool: &'a Tool,
    pub(super) start: Placement,
    pub(super) end: Placement,
    /// Longest edge at the contact, model units.
    pub(super) relief: f64,
    /// Distances up to this one are zero up to rounding, model units.
    pub(super) rounding: f64,
}

impl<'a> StepMotion<'a> {
    pub(super) fn new(stamp: &'a Stamp, from: f64, to: f64) -> Self {
        let path = stamp.path();
        let [start, end] = [from, to].map(|time| path.pose_at(time));
        let bounds = path.tool().support_bounds();
        let extent = bounds.min.abs().max(bounds.max.abs()).max_element()
            + start.translation.abs().max(end.translation.abs()).max_element();
        Self {
            tool: path.tool(),
            start: Placement::from(&start),
            end: Placement::from(&end),
            relief: stamp.relief(),
            rounding: ROUNDINGS * f64::EPSILON * extent,
        }
    }

    /// Longest edge at the rim, model units.
    pub(super) fn rim_edge(&self) -> f64 {
        self.tool.support() / EDGES_ACROSS_RIM
    }
}
