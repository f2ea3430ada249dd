//! A tool that moves rigidly from pose to pose, and the flow of its field.
//!
//! Between neighboring keys the tool moves with a constant body twist, so that in tool coordinates y the field stands still
//! and a point follows the autonomous ẏ = V(y) − (v + ω×y), which is integrated by Runge-Kutta steps of equal length. A point
//! whose four stages all lie beyond the support rests: its world coordinates keep their bits through that step. Sleeping only
//! skips steps through which a point is certain to rest, so it changes no bit.

mod advected_points;

use std::sync::Arc;

use glam::DVec3;
use isochore_mesh::{Aabb, LANES, PointBlock};

use crate::{
    fields::{BodyTwist, MovingField, MovingTool, Pose, RigidField, Tool, VelocityBlock, pose::Placement},
    flow::rk4::{Rk4Block, rk4_step},
};
use advected_points::{AdvectedPoints, State};

/// Steps between two keys at most: more is a mistake in the recipe, and the table of poses must fit in memory.
pub(super) const MAX_STEPS: usize = 1_000_000;

/// Clearance that is given away to rounding when a point goes to sleep, as a share of the coordinates at hand.
/// Larger wakes points needlessly early; smaller than some units of f64 rounding could let a sleeping point miss the support.
pub(super) const SLEEP_SLACK: f64 = 1e-12;

/// Blocks that take a step side by side. With one, each stage waits for the last digits of the one before; more than enough to
/// fill that time only fill the cache.
const ABREAST: usize = 2;

/// Steps to rest for each lane.
type Sleep = [usize; LANES];

/// A tool's way through a list of poses.
#[derive(Debug, Clone)]
pub struct Move {
    tool: Arc<Tool>,
    keys: Vec<Pose>,
    step: f64,
    segments: Vec<Segment>,
}

/// Errors of [`Move::new`].
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum MoveError {
    /// The step is not a positive fraction.
    #[error("the step must be a positive fraction, not {0}")]
    Step(f64),
    /// A path needs two poses at least.
    #[error("the path needs at least two keys, not {0}")]
    TooFewKeys(usize),
    /// A coordinate of a pose is infinite or NaN.
    #[error("the poses of the path must be finite")]
    NotFinite,
    /// Two keys are half a turn apart.
    #[error(
        "keys {key} and {} are exactly 180° apart, so the direction of rotation is ambiguous; add a key between them",
        .key + 1
    )]
    HalfTurn {
        /// Index of the first of the two, from 0.
        key: usize,
    },
    /// The path is too long for its step.
    #[error("the path from key {key} takes {steps:.0} steps; at most {MAX_STEPS} are allowed")]
    TooManySteps {
        /// Index of the key at the start of the segment, from 0.
        key: usize,
        /// Steps it would take.
        steps: f64,
    },
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
    /// [`MoveError`]: fewer than two keys, neighbors exactly half a turn apart, a step that is no positive fraction, a way
    /// of too many steps, a number that is not finite.
    pub fn new(tool: Arc<Tool>, keys: Vec<Pose>, step: f64) -> Result<Self, MoveError> {
        if !(step > 0.0 && step.is_finite()) {
            return Err(MoveError::Step(step));
        }
        if keys.len() < 2 {
            return Err(MoveError::TooFewKeys(keys.len()));
        }
        if keys.iter().any(|key| !(key.translation.is_finite() && key.rotation.is_finite())) {
            return Err(MoveError::NotFinite);
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

    pub(super) fn advect_chunk(&self, points: &mut [DVec3]) -> u64 {
        let mut advected = AdvectedPoints::new(points);
        self.segments.iter().map(|segment| segment.advect_chunk(&self.tool, &mut advected)).sum()
    }

    /// Whether the support may touch the ball, as it stands, at any time; false is certain.
    pub(super) fn may_touch(&self, center: DVec3, radius: f64) -> bool {
        self.segments.iter().any(|segment| segment.may_touch(&self.tool, center, radius))
    }

    /// Box in the world that holds the support at all times.
    pub(super) fn reach(&self) -> Aabb {
        self.segments.iter().map(|segment| segment.reach(&self.tool)).fold(Aabb::EMPTY, Aabb::union)
    }

    pub(super) fn with_half_step(&self) -> Result<Self, MoveError> {
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
    fn new(tool: &Tool, keys: &[Pose], key: usize, step: f64) -> Result<Self, MoveError> {
        let [start, end] = [&keys[key], &keys[key + 1]];
        // A pause: the logarithm of a rotation and its inverse would leave a rounding that moves what it should not.
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

    fn steps(&self) -> usize {
        self.placements.len() - 1
    }

    /// Length of a step, as a share of the segment's time.
    fn step_time(&self) -> f64 {
        1.0 / self.steps() as f64
    }

    fn advect_chunk(&self, tool: &Tool, advected: &mut AdvectedPoints<'_>) -> u64 {
        let bounds = tool.support_bounds();
        let mut resting =
            advected.near(|center, radius| self.comes_near(center, radius, |local| bounds.distance(local)));
        if resting.is_empty() {
            return 0;
        }
        let mut due = Vec::new();
        let field = RigidField::new(tool, self.twist);
        let mut blocks = [Rk4Block::new(VelocityBlock::REST); ABREAST];
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
            for due in due.chunks(ABREAST * LANES) {
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
        advected.arrive(&self.placements[self.steps()]);
        evaluations
    }

    /// Takes the advected named in `due`, whose local positions are those at the beginning of `step`, to its end. `blocks` are
    /// scratch.
    fn step_blocks(
        &self,
        field: &RigidField<'_>,
        step: usize,
        due: &[u32],
        advected: &mut AdvectedPoints<'_>,
        blocks: &mut [Rk4Block<VelocityBlock>; ABREAST],
    ) -> u64 {
        let mut evaluations = 0;
        let mut moving: [(&[u32], Sleep); ABREAST] = [(&[], [0; LANES]); ABREAST];
        let mut count = 0;
        for members in due.chunks(LANES) {
            let Rk4Block { start, stages: [first, ..], .. } = &mut blocks[count];
            for lane in 0..LANES {
                // Lanes beyond the members repeat the last one, and nobody reads them.
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

    /// The number of steps through which each of the members is certain to rest, as seen from where they `start`; none, and all
    /// is done, if each of them rests or goes with the tool.
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
                // All stages are where the first is, in this step and in all that follow.
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

    /// Number of steps through which a point at rest, or a ball of this radius about it, now at `local` and at least `clearance` away from the support, is certain
    /// to have all four Runge-Kutta stages beyond the support.
    ///
    /// In the world the support comes closer by at most speed × time. The stages follow the point's circle in tool
    /// coordinates along tangents: off by less than (step time)² |ω| |v + ω×y|, where |v + ω×y| does not change along the way.
    fn resting_steps(&self, clearance: f64, local: DVec3, radius: f64) -> usize {
        if clearance <= 0.0 {
            return 0;
        }
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
        let bounds = tool.support_bounds();
        self.comes_near(center, radius, |local| {
            let clearance = bounds.distance(local);
            let (distance, _) = tool.distance().sample(local);
            if clearance > radius || distance.is_infinite() {
                clearance
            } else {
                (distance - tool.support()) / tool.distance().lipschitz()
            }
        })
    }

    /// Whether what rests in a ball may have to move, judged by lower bounds on the distance from the support to a point in tool
    /// coordinates; false is certain.
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

#[cfg(test)]
mod tests;
