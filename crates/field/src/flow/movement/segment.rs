//! The motion of a tool between two keys, and the points that it advects.

use glam::DVec3;
use isochore_mesh::{Aabb, LANES, PointBlock};

use super::{
    advected_points::{AdvectedPoints, State},
    error::{MAX_STEPS, MoveError},
};
use crate::{
    fields::{BodyTwist, Pose, RigidField, Tool, VelocityBlock, pose::Placement},
    flow::rk4::{Rk4Block, rk4_step},
};

/// Margin for rounding in the clearance of a sleeping point, as a fraction of its coordinates. A larger
/// value wakes points too early; a value below a few roundings of `f64` lets a sleeping point miss the
/// support.
pub(in crate::flow) const SLEEP_SLACK: f64 = 1e-12;

/// Blocks that take a step together. With one block, each stage waits for the results of the stage
/// before; with many, the blocks no longer fit in the cache.
pub(super) const BATCH: usize = 2;

/// Steps of sleep for each lane.
type Sleep = [usize; LANES];

/// The motion between two neighboring keys, which takes one unit of time.
#[derive(Debug, Clone)]
pub(super) struct Segment {
    pub(super) twist: BodyTwist,
    /// Placements of the tool at the start of each step and at the end of the last.
    pub(super) placements: Vec<Placement>,
    /// Upper bound on the speed of every point of the support.
    speed: f64,
    /// Margin of clearances for distances in single precision: once for the measured distance, and once
    /// for its bound.
    rounding: f64,
}

impl Segment {
    pub(super) fn new(tool: &Tool, keys: &[Pose], key: usize, step: f64) -> Result<Self, MoveError> {
        let [start, end] = [&keys[key], &keys[key + 1]];
        // For a pause the twist is exactly zero. The logarithm of a rotation times its inverse would leave
        // a rounding error, which moves points.
        let rest = BodyTwist { linear: DVec3::ZERO, angular: DVec3::ZERO };
        let twist = if start == end { rest } else { start.twist_to(end).ok_or(MoveError::HalfTurn { key })? };
        let travel = twist.top_speed(tool.reference());
        let count = (travel / (step * tool.feature_size())).ceil().max(1.0);
        if count.is_nan() || count > MAX_STEPS as f64 {
            return Err(MoveError::TooManySteps { key, steps: count });
        }
        let steps = count as usize;
        let mut placements: Vec<Placement> =
            (0..steps).map(|index| Placement::from(&start.moved(&twist, index as f64 / steps as f64))).collect();
        placements.push(Placement::from(end));
        let speed = twist.top_speed(tool.support_bounds());
        Ok(Self { twist, placements, speed, rounding: 2.0 * tool.distance().single_error() })
    }

    pub(super) fn steps(&self) -> usize {
        self.placements.len() - 1
    }

    /// Duration of a step.
    fn step_time(&self) -> f64 {
        1.0 / self.steps() as f64
    }

    pub(super) fn advect_chunk(&self, tool: &Tool, advected: &mut AdvectedPoints<'_>) -> u64 {
        let bounds = tool.support_bounds();
        let mut resting =
            advected.near(|center, radius| self.comes_near(center, radius, |local| bounds.distance(local)));
        if resting.is_empty() {
            return 0;
        }
        let mut due = Vec::new();
        let field = RigidField::new(tool, self.twist);
        let mut blocks = [Rk4Block::new(VelocityBlock::REST); BATCH];
        let mut evaluations = 0;
        for (step, placement) in self.placements[..self.steps()].iter().enumerate() {
            resting.retain(|&index| {
                let point = index as usize;
                if advected.wake[point] > step {
                    return true;
                }
                let local = placement.to_local(advected.world[point]);
                let sleep = self.resting_steps(bounds.distance(local), local, 0.0);
                if sleep > 0 {
                    advected.wake[point] = step + sleep;
                } else {
                    advected.local[point] = local;
                    due.push(index);
                }
                sleep > 0
            });
            advected.have_stopped = false;
            for due in due.chunks(BATCH * LANES) {
                evaluations += self.step_blocks(&field, step, due, advected, &mut blocks);
            }
            if advected.have_stopped {
                due.retain(|&index| match advected.state[index as usize] {
                    State::Moving => true,
                    State::Carried => false,
                    State::Resting => {
                        resting.push(index);
                        false
                    }
                });
            }
        }
        advected.finish(&self.placements[self.steps()]);
        evaluations
    }

    /// Advects the points with indices `due` from the start of `step` to its end. Their local positions are
    /// those at the start. `blocks` is scratch memory.
    pub(super) fn step_blocks(
        &self,
        field: &RigidField<'_>,
        step: usize,
        due: &[u32],
        advected: &mut AdvectedPoints<'_>,
        blocks: &mut [Rk4Block<VelocityBlock>; BATCH],
    ) -> u64 {
        let mut evaluations = 0;
        let mut moving: [(&[u32], Sleep); BATCH] = [(&[], [0; LANES]); BATCH];
        let mut count = 0;
        for members in due.chunks(LANES) {
            let Rk4Block { start, stages: [first, ..], .. } = &mut blocks[count];
            for lane in 0..LANES {
                // Lanes beyond the members repeat the last one and are not read.
                start.set(lane, advected.local[members[lane.min(members.len() - 1)] as usize]);
            }
            field.evaluate_into(start, first);
            evaluations += members.len() as u64;
            if let Some(sleep) = self.sleep(field.tool(), step, members, start, first, advected) {
                moving[count] = (members, sleep);
                count += 1;
            }
        }

        let blocks = &mut blocks[..count];
        rk4_step(blocks, self.step_time(), |stage| &stage.relative, |_, points, out| field.evaluate_into(points, out));
        for (Rk4Block { stages, end, .. }, (members, sleep)) in blocks.iter().zip(moving) {
            evaluations += 3 * members.len() as u64;
            for (lane, &index) in members.iter().enumerate() {
                let index = index as usize;
                if stages.iter().all(|stage| stage.is_outside[lane]) {
                    advected.rest(index, &self.placements[step], step + sleep[lane].max(1));
                } else if advected.state[index] != State::Carried {
                    advected.local[index] = end.get(lane);
                    advected.state[index] = State::Moving;
                }
            }
        }
        evaluations
    }

    /// The number of steps through which each member certainly rests, from its position in `start`. Returns
    /// `None` if no member moves relative to both the world and the tool; then their states are updated.
    fn sleep(
        &self,
        tool: &Tool,
        step: usize,
        members: &[u32],
        start: &PointBlock,
        first: &VelocityBlock,
        advected: &mut AdvectedPoints<'_>,
    ) -> Option<Sleep> {
        let (mut sleep, mut is_moving) = ([0; LANES], false);
        for (lane, &index) in members.iter().enumerate() {
            if first.is_outside[lane] {
                if first.distance[lane].is_finite() {
                    let clearance = (first.distance[lane] - tool.support()) / tool.distance().lipschitz();
                    sleep[lane] = self.resting_steps(clearance, start.get(lane), 0.0);
                }
                is_moving |= sleep[lane] == 0;
            } else if first.relative.get(lane) == DVec3::ZERO {
                // All stages coincide, in this step and in all that follow.
                advected.carry(index as usize);
            } else {
                is_moving = true;
            }
        }
        if is_moving {
            return Some(sleep);
        }
        for (&index, sleep) in members.iter().zip(sleep).filter(|&(_, sleep)| sleep > 0) {
            advected.rest(index as usize, &self.placements[step], step + sleep);
        }
        None
    }

    /// Number of steps through which all four Runge-Kutta stages of a resting point, or of the points in a
    /// ball about it, are certainly beyond the support. The point is now at `local`, at least `clearance`
    /// from the support.
    ///
    /// In the world the support approaches by at most speed × time. In tool coordinates the point moves on
    /// a circle, and the stages follow its tangents. Their error is less than
    /// (step time)² |ω| |v + ω×y|, where |v + ω×y| is constant on the circle.
    fn resting_steps(&self, clearance: f64, local: DVec3, radius: f64) -> usize {
        if clearance <= 0.0 {
            return 0;
        }
        let time = self.step_time();
        let own_speed = self.own_speed(local, radius);
        let stage_error = time * time * self.twist.angular.length() * own_speed;
        let slack = SLEEP_SLACK * (local.abs().max_element() + clearance) + self.rounding;
        // Two bounds on the approach: the speed of the fastest point of the support, and the speed of the
        // point itself past the tool.
        let speed = self.speed.min(own_speed);
        let steps = (clearance - stage_error - slack) / (speed * time);
        // A tool at rest does not approach. Then 1/0 is infinite and means all remaining steps; 0/0 is NaN
        // and means none.
        if steps >= 1.0 { (steps as usize).min(self.steps()) } else { 0 }
    }

    /// Upper bound on the speed past the tool of the resting points in a ball about `local`. They move on
    /// circles at constant speed. An unbounded tool has no other bound.
    fn own_speed(&self, local: DVec3, radius: f64) -> f64 {
        self.twist.velocity(local).length() + self.twist.angular.length() * radius
    }

    pub(super) fn reach(&self, tool: &Tool) -> Aabb {
        let support = tool.support_bounds();
        let corners =
            self.placements.iter().flat_map(|placement| support.corners().map(|corner| placement.to_world(corner)));
        // Between two placements, a point of the support is at most half a step's travel from the nearer
        // one. The other term is the error of the stages of a resting point, as in `resting_steps`.
        let travel = self.speed * self.step_time();
        let bounds = Aabb::of(corners).expanded(travel * (0.5 + self.step_time() * self.twist.angular.length()));
        // An unbounded support stays unbounded when it turns, although its corners become NaN.
        if support.size().is_finite() { bounds } else { Aabb { min: DVec3::NEG_INFINITY, max: DVec3::INFINITY } }
    }

    pub(super) fn may_touch(&self, tool: &Tool, center: DVec3, radius: f64) -> bool {
        let bounds = tool.support_bounds();
        self.comes_near(center, radius, |local| {
            let clearance = bounds.distance(local);
            let (distance, _) = tool.distance().sample(local);
            if distance.is_infinite() {
                return clearance;
            }
            // The corners of the box are far from most supports.
            let nearer = (distance - tool.support()) / tool.distance().lipschitz();
            if clearance > radius { clearance.max(nearer) } else { nearer }
        })
    }

    /// Whether a resting point of a ball may have to move; `false` is certain. `clearance` is a lower bound
    /// on the distance from the support to a point in tool coordinates.
    fn comes_near(&self, center: DVec3, radius: f64, clearance: impl Fn(DVec3) -> f64) -> bool {
        let mut step = 0;
        while step < self.steps() && self.speed > 0.0 {
            let local = self.placements[step].to_local(center);
            match self.resting_steps(clearance(local) - radius, local, radius) {
                0 => return true,
                sleep => step += sleep,
            }
        }
        false
    }
}
