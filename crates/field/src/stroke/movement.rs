//! A tool that moves rigidly from pose to pose, and the flow of its field.
//!
//! Between neighboring keys the tool moves with a constant body twist, so that in tool coordinates y the field stands still
//! and a point follows the autonomous ẏ = V(y) − (v + ω×y), which is integrated by Runge-Kutta steps of equal length. A point
//! whose four stages all lie beyond the support rests: its world coordinates keep their bits through that step. Sleeping only
//! skips steps through which a point is certain to rest, so it changes no bit.

use std::sync::Arc;

use glam::DVec3;
use isochore_mesh::{Aabb, LANES, PointBlock};

use super::StrokeError;
use crate::{
    BodyTwist, MovingField, MovingTool, Pose, RigidField, Tool, pose::Placement, rigid_field::VelocityBlock,
    rk4::rk4_step,
};

/// Steps between two keys at most: more is a mistake in the recipe, and the table of poses must fit in memory.
pub(super) const MAX_STEPS: usize = 1_000_000;

/// Clearance that is given away to rounding when a point goes to sleep, as a share of the coordinates at hand.
/// Larger wakes points needlessly early; smaller than some units of f64 rounding could let a sleeping point miss the support.
pub(super) const SLEEP_SLACK: f64 = 1e-12;

/// A tool's way through a list of poses.
#[derive(Debug, Clone)]
pub struct Move {
    tool: Arc<Tool>,
    keys: Vec<Pose>,
    step: f64,
    segments: Vec<Segment>,
}

/// The way between two neighboring keys, one unit of time long.
#[derive(Debug, Clone)]
struct Segment {
    twist: BodyTwist,
    /// Where the tool is at the beginning of each step and at the end of the last.
    placements: Vec<Placement>,
    /// Upper bound on the speed of every point of the support.
    speed: f64,
    /// What is given away of clearances because distances may come in single precision: of the one that is measured, and of the
    /// one that is promised.
    rounding: f64,
}

impl Move {
    /// The way of `tool` through `keys` (world from tool), with constant body twist between neighbors: a screw of less than
    /// half a turn.
    ///
    /// `step` bounds the travel of the tool's fastest surface point in one step of the integrator, as a fraction of the
    /// [feature size](Tool::feature_size).
    ///
    /// # Errors
    /// [`StrokeError`]: fewer than two keys, neighbors exactly half a turn apart, a step that is no positive fraction, a way
    /// of too many steps, a number that is not finite.
    pub fn new(tool: Arc<Tool>, keys: Vec<Pose>, step: f64) -> Result<Self, StrokeError> {
        if !(step > 0.0 && step.is_finite()) {
            return Err(StrokeError::Step(step));
        }
        if keys.len() < 2 {
            return Err(StrokeError::TooFewKeys(keys.len()));
        }
        if keys.iter().any(|key| !(key.translation.is_finite() && key.rotation.is_finite())) {
            return Err(StrokeError::NotFinite("the poses of the path"));
        }
        let segments =
            (0..keys.len() - 1).map(|key| Segment::new(&tool, &keys, key, step)).collect::<Result<_, _>>()?;
        Ok(Self { tool, keys, step, segments })
    }

    /// The tool that moves.
    pub fn tool(&self) -> &Tool {
        &self.tool
    }

    /// The travel in one step, as a fraction of the feature size.
    pub fn step(&self) -> f64 {
        self.step
    }

    /// Steps of the integrator along the whole way.
    pub fn steps(&self) -> usize {
        self.segments.iter().map(Segment::steps).sum()
    }

    /// The field of each segment, in world coordinates.
    pub fn fields(&self) -> Vec<Arc<dyn MovingField>> {
        let starts = self.keys.iter().zip(&self.segments);
        let field = |(start, segment): (&Pose, &Segment)| MovingTool::new(self.tool.clone(), *start, segment.twist);
        starts.map(|start| Arc::new(field(start)) as _).collect()
    }

    /// Times at which the steps end, in order; the way between two keys takes one unit of time.
    pub(crate) fn step_ends(&self) -> Vec<f64> {
        let ends = |(key, segment): (usize, &Segment)| {
            let count = segment.steps();
            (1..=count).map(move |step| key as f64 + step as f64 / count as f64)
        };
        self.segments.iter().enumerate().flat_map(ends).collect()
    }

    /// Where the tool is at a time from zero to the number of segments.
    pub(crate) fn pose_at(&self, time: f64) -> Pose {
        let key = (time as usize).min(self.segments.len() - 1);
        let since = time - key as f64;
        if since == 1.0 { self.keys[key + 1] } else { self.keys[key].moved(&self.segments[key].twist, since) }
    }

    pub(super) fn advance(&self, points: &mut [DVec3]) -> u64 {
        let mut travelers = Travelers::new(points);
        self.segments.iter().map(|segment| segment.advance(&self.tool, &mut travelers)).sum()
    }

    /// Whether the support may touch the ball, as it stands, at any time; false is certain.
    pub(super) fn may_touch(&self, center: DVec3, radius: f64) -> bool {
        self.segments.iter().any(|segment| segment.may_touch(&self.tool, center, radius))
    }

    /// Box in the world that holds the support at all times.
    pub(super) fn reach(&self) -> Aabb {
        self.segments.iter().map(|segment| segment.reach(&self.tool)).fold(Aabb::EMPTY, Aabb::union)
    }

    pub(super) fn with_half_step(&self) -> Result<Self, StrokeError> {
        Self::new(self.tool.clone(), self.keys.clone(), 0.5 * self.step)
    }

    pub(super) fn truncated(&self, fraction: f64) -> Self {
        let time = fraction * self.segments.len() as f64;
        let whole = (time as usize).min(self.segments.len() - 1);
        let mut keys = self.keys[..=whole].to_vec();
        keys.push(self.keys[whole].moved(&self.segments[whole].twist, time - whole as f64));
        // A part of a legal way is legal: shorter, and turned by less.
        Self::new(self.tool.clone(), keys, self.step).unwrap_or_else(|_| self.clone())
    }
}

impl Segment {
    fn new(tool: &Tool, keys: &[Pose], key: usize, step: f64) -> Result<Self, StrokeError> {
        let [start, end] = [&keys[key], &keys[key + 1]];
        // A pause: the logarithm of a rotation and its inverse would leave a rounding that moves what it should not.
        let rest = BodyTwist { linear: DVec3::ZERO, angular: DVec3::ZERO };
        let twist = if start == end { rest } else { start.twist_to(end).ok_or(StrokeError::HalfTurn { key })? };
        let travel = twist.top_speed(tool.reference());
        let count = (travel / (step * tool.feature_size())).ceil().max(1.0);
        if count.is_nan() || count > MAX_STEPS as f64 {
            return Err(StrokeError::TooManySteps { key, steps: count });
        }
        let steps = count as usize;
        let mut placements: Vec<Placement> =
            (0..steps).map(|index| Placement::from(&start.moved(&twist, index as f64 / steps as f64))).collect();
        placements.push(Placement::from(end));
        let speed = twist.top_speed(tool.support_bounds());
        Ok(Self { twist, placements, speed, rounding: 2.0 * tool.distance().single_error() })
    }

    fn steps(&self) -> usize {
        self.placements.len() - 1
    }

    /// Length of a step, as a share of the segment's time.
    fn step_time(&self) -> f64 {
        1.0 / self.steps() as f64
    }

    fn advance(&self, tool: &Tool, travelers: &mut Travelers<'_>) -> u64 {
        let (center, radius) = travelers.ball();
        if !self.may_touch(tool, center, radius) {
            return 0;
        }
        let field = RigidField::new(tool, self.twist);
        let bounds = tool.support_bounds();
        let mut evaluations = 0;
        travelers.wake.fill(0);
        let mut stages = [VelocityBlock::REST; 4];
        let mut due = Vec::new();
        for step in 0..self.steps() {
            due.clear();
            for index in 0..travelers.world.len() {
                match travelers.state[index] {
                    State::Moving => due.push(index as u32),
                    State::Resting if travelers.wake[index] <= step => {
                        let local = self.placements[step].to_local(travelers.world[index]);
                        let sleep = self.resting_steps(bounds.distance(local), local, 0.0);
                        if sleep > 0 {
                            travelers.wake[index] = step + sleep;
                        } else {
                            travelers.local[index] = local;
                            due.push(index as u32);
                        }
                    }
                    State::Resting | State::Carried => {}
                }
            }
            for block in due.chunks(LANES) {
                evaluations += self.step_block(&field, step, block, travelers, &mut stages);
            }
        }
        travelers.arrive(&self.placements[self.steps()]);
        evaluations
    }

    /// Takes the travelers named in `block`, whose local positions are those at the beginning of `step`, to its end. `stages` are
    /// scratch.
    fn step_block(
        &self,
        field: &RigidField<'_>,
        step: usize,
        block: &[u32],
        travelers: &mut Travelers<'_>,
        stages: &mut [VelocityBlock; 4],
    ) -> u64 {
        let mut start = PointBlock::ZERO;
        for lane in 0..LANES {
            // Lanes beyond the block repeat its last point, and nobody reads them.
            start.set(lane, travelers.local[block[lane.min(block.len() - 1)] as usize]);
        }
        field.evaluate_into(&start, &mut stages[0]);
        let tool = field.tool();
        let (mut sleep, mut is_going_on) = ([0; LANES], false);
        for (lane, &index) in block.iter().enumerate() {
            let first = &stages[0];
            if !first.is_outside[lane] {
                // Where the field does not leave the tool behind, all stages are the first, in this step and in all that follow.
                if first.relative.get(lane) == DVec3::ZERO {
                    travelers.state[index as usize] = State::Carried;
                } else {
                    is_going_on = true;
                }
            } else {
                if first.distance[lane].is_finite() {
                    let clearance = (first.distance[lane] - tool.support()) / tool.distance().lipschitz();
                    sleep[lane] = self.resting_steps(clearance, start.get(lane), 0.0);
                }
                is_going_on |= sleep[lane] == 0;
            }
        }
        if !is_going_on {
            for (lane, &index) in block.iter().enumerate() {
                if sleep[lane] > 0 {
                    travelers.rest(index as usize, &self.placements[step], step + sleep[lane]);
                }
            }
            return block.len() as u64;
        }
        let evaluate = |points: &PointBlock, stage: &mut VelocityBlock| field.evaluate_into(points, stage);
        let end = rk4_step(&start, stages, self.step_time(), |stage| &stage.relative, evaluate);
        for (lane, &index) in block.iter().enumerate() {
            let index = index as usize;
            if stages.iter().all(|stage| stage.is_outside[lane]) {
                travelers.rest(index, &self.placements[step], step + sleep[lane].max(1));
            } else if travelers.state[index] != State::Carried {
                travelers.local[index] = end.get(lane);
                travelers.state[index] = State::Moving;
            }
        }
        4 * block.len() as u64
    }

    /// Number of steps through which a point at rest, or a ball of this radius about it, now at `local` and at least `clearance` away from the support, is certain
    /// to have all four Runge-Kutta stages beyond the support.
    ///
    /// In the world the support comes closer by at most speed × time. The stages follow the point's circle in tool
    /// coordinates along tangents: off by less than (step time)² |ω| |v + ω×y|, where |v + ω×y| does not change along the way.
    fn resting_steps(&self, clearance: f64, local: DVec3, radius: f64) -> usize {
        let time = self.step_time();
        let own_speed = self.own_speed(local, radius);
        let stage_error = time * time * self.twist.angular.length() * own_speed;
        let slack = SLEEP_SLACK * (local.abs().max_element() + clearance) + self.rounding;
        // The support comes no faster than its fastest point, nor than the point itself goes past the tool.
        let speed = self.speed.min(own_speed);
        let steps = (clearance - stage_error - slack) / (speed * time);
        // A tool that stands still comes no closer: 0/0 and 1/0 both mean all remaining steps, or none when in reach.
        if steps >= 1.0 { (steps as usize).min(self.steps()) } else { 0 }
    }

    /// Upper bound on the speed at which what rests in a ball about `local` goes past the tool, on circles whose speed does not
    /// change. A tool without end has no other bound.
    fn own_speed(&self, local: DVec3, radius: f64) -> f64 {
        self.twist.velocity(local).length() + self.twist.angular.length() * radius
    }

    fn reach(&self, tool: &Tool) -> Aabb {
        let support = tool.support_bounds();
        let corners =
            self.placements.iter().flat_map(|placement| support.corners().map(|corner| placement.to_world(corner)));
        // Between two placements no point of the support is farther from the nearer one than it gets in half a step; and the
        // stages of a point at rest stray from it as told at `resting_steps`.
        let travel = self.speed * self.step_time();
        let bounds = Aabb::of(corners).expanded(travel * (0.5 + self.step_time() * self.twist.angular.length()));
        // What has no end has none either when it is turned, where its corners are no numbers.
        if support.size().is_finite() { bounds } else { Aabb { min: DVec3::NEG_INFINITY, max: DVec3::INFINITY } }
    }

    fn may_touch(&self, tool: &Tool, center: DVec3, radius: f64) -> bool {
        if self.speed == 0.0 {
            return false;
        }
        let bounds = tool.support_bounds();
        let mut step = 0;
        while step < self.steps() {
            let local = self.placements[step].to_local(center);
            let mut clearance = bounds.distance(local) - radius;
            if clearance <= 0.0 {
                let (distance, _) = tool.distance().sample(local);
                if distance.is_finite() {
                    clearance = (distance - tool.support()) / tool.distance().lipschitz() - radius;
                }
            }
            match self.resting_steps(clearance, local, radius) {
                0 => return true,
                sleep => step += sleep,
            }
        }
        false
    }
}

/// Points on their way through a segment.
struct Travelers<'a> {
    world: &'a mut [DVec3],
    local: Vec<DVec3>,
    state: Vec<State>,
    /// First step at which a resting point must be looked at again.
    wake: Vec<usize>,
}

/// What a traveler does.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum State {
    /// It stands still in the world.
    Resting,
    /// It moves in tool coordinates.
    Moving,
    /// It stands still in tool coordinates until the end of the segment.
    Carried,
}

impl<'a> Travelers<'a> {
    fn new(world: &'a mut [DVec3]) -> Self {
        let count = world.len();
        Self { world, local: vec![DVec3::ZERO; count], state: vec![State::Resting; count], wake: vec![0; count] }
    }

    /// A ball that holds all where they are in the world.
    fn ball(&self) -> (DVec3, f64) {
        let bounds = Aabb::of(self.world.iter().copied());
        (bounds.center(), 0.5 * bounds.size().length())
    }

    /// Lets a point rest where it is at the beginning of the step with this placement.
    fn rest(&mut self, index: usize, placement: &Placement, wake: usize) {
        if self.state[index] != State::Resting {
            self.world[index] = placement.to_world(self.local[index]);
            self.state[index] = State::Resting;
        }
        self.wake[index] = wake;
    }

    /// Lets all rest that come with the tool, whose way ends with this placement.
    fn arrive(&mut self, placement: &Placement) {
        for index in 0..self.world.len() {
            self.rest(index, placement, 0);
        }
    }
}

#[cfg(test)]
mod tests;
