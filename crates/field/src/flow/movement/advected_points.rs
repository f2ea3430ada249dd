//! Points that a segment of a way may carry, and what each of them does.

use glam::DVec3;
use isochore_mesh::{Aabb, LANES};

use crate::fields::pose::Placement;

/// Points on their way through a segment.
pub(super) struct AdvectedPoints<'a> {
    pub(super) world: &'a mut [DVec3],
    pub(super) local: Vec<DVec3>,
    pub(super) state: Vec<State>,
    /// First step at which a resting point must be looked at again.
    pub(super) wake: Vec<usize>,
    /// Whether one that moved, or was about to, no longer does.
    pub(super) have_stopped: bool,
}

/// What a traveler does.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum State {
    /// It stands still in the world.
    Resting,
    /// It moves in tool coordinates.
    Moving,
    /// It stands still in tool coordinates until the end of the segment.
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

    /// Those in whose neighborhood, a ball by center and radius, something may happen.
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

    /// Lets a point rest where it is at the beginning of the step with this placement.
    pub(super) fn rest(&mut self, index: usize, placement: &Placement, wake: usize) {
        if self.state[index] != State::Resting {
            self.world[index] = placement.to_world(self.local[index]);
            self.state[index] = State::Resting;
        }
        self.wake[index] = wake;
        self.have_stopped = true;
    }

    /// Lets a point stand still in tool coordinates.
    pub(super) fn carry(&mut self, index: usize) {
        self.state[index] = State::Carried;
        self.have_stopped = true;
    }

    /// Lets all rest that come with the tool, whose way ends with this placement.
    pub(super) fn arrive(&mut self, placement: &Placement) {
        for index in 0..self.world.len() {
            self.rest(index, placement, 0);
        }
    }
}
