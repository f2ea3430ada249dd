//! The points that a segment may advect, and the state of each.

use glam::DVec3;
use isochore_mesh::{Aabb, LANES};

use crate::fields::pose::Placement;

/// Points during a segment, in world and tool coordinates.
pub(super) struct AdvectedPoints<'a> {
    pub(super) world: &'a mut [DVec3],
    pub(super) local: Vec<DVec3>,
    pub(super) state: Vec<State>,
    /// First step at which a resting point must be tested again.
    pub(super) wake: Vec<usize>,
    /// Whether a point that was due for a step has stopped moving in tool coordinates or in the world.
    pub(super) have_stopped: bool,
}

/// State of an advected point.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum State {
    /// At rest in the world.
    Resting,
    /// Moving in tool coordinates.
    Moving,
    /// At rest in tool coordinates until the end of the segment.
    Carried,
}

impl<'a> AdvectedPoints<'a> {
    pub(super) fn new(world: &'a mut [DVec3]) -> Self {
        let count = world.len();
        Self {
            world,
            local: vec![DVec3::ZERO; count],
            state: vec![State::Resting; count],
            wake: vec![0; count],
            have_stopped: false,
        }
    }

    /// Indices of the points that may move. `may_touch` tests a ball, by center and radius.
    pub(super) fn near(&mut self, may_touch: impl Fn(DVec3, f64) -> bool) -> Vec<u32> {
        self.wake.fill(0);
        let may_touch_all = |points: &[DVec3]| {
            let bounds = Aabb::of(points.iter().copied());
            may_touch(bounds.center(), 0.5 * bounds.size().length())
        };
        let mut near = Vec::new();
        if may_touch_all(self.world) {
            for (block, points) in self.world.chunks(LANES).enumerate().filter(|(_, points)| may_touch_all(points)) {
                near.extend((0..points.len()).map(|lane| (block * LANES + lane) as u32));
            }
        }
        near
    }

    /// Puts a point to rest in the world. `placement` is that of the tool at the start of the step.
    pub(super) fn rest(&mut self, index: usize, placement: &Placement, wake: usize) {
        if self.state[index] != State::Resting {
            self.world[index] = placement.to_world(self.local[index]);
            self.state[index] = State::Resting;
        }
        self.wake[index] = wake;
        self.have_stopped = true;
    }

    /// Puts a point to rest in tool coordinates.
    pub(super) fn carry(&mut self, index: usize) {
        self.state[index] = State::Carried;
        self.have_stopped = true;
    }

    /// Puts all points to rest at the end of the segment. `placement` is that of the tool at the end.
    pub(super) fn finish(&mut self, placement: &Placement) {
        for index in 0..self.world.len() {
            self.rest(index, placement, 0);
        }
    }
}
