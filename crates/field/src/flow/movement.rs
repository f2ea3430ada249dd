//! A tool that moves rigidly from pose to pose, and the flow of its field.
//!
//! Between neighboring keys the tool moves with a constant body twist. In tool coordinates y the field
//! is constant in time, and a point follows the autonomous equation ẏ = V(y) − (v + ω×y), which is
//! integrated by Runge-Kutta steps of equal length.
//!
//! A point whose four stages are all beyond the support rests: its world coordinates keep their bits
//! through that step. A sleeping point skips steps through which it certainly rests, so sleep changes
//! no bits.

mod advected_points;
mod error;
mod segment;

use std::sync::Arc;

use glam::DVec3;
use isochore_mesh::Aabb;

pub(super) use error::MAX_STEPS;
pub use error::MoveError;
pub(super) use segment::SLEEP_SLACK;

use crate::fields::{MovingField, MovingTool, Pose, Tool};
use advected_points::AdvectedPoints;
use segment::Segment;

/// A tool that moves through a list of poses.
///
/// ```
/// use std::sync::Arc;
///
/// use glam::DVec3;
/// use isochore_field::{Move, Pose, Profile, Stroke, Tool, advect_points};
/// use isochore_mesh::{NoProgress, Sphere};
///
/// let ball = Arc::new(Tool::new(Arc::new(Sphere::new(0.5)?), 0.5, Profile::Quintic)?);
/// let keys = vec![Pose::IDENTITY, Pose::at(DVec3::X)];
/// let stroke = Stroke::Move(Move::new(ball, keys, 0.125)?);
/// // A point in the rigid core moves with the tool, and a point beyond the support rests.
/// let points = [DVec3::ZERO, DVec3::new(0.5, 1.5, 0.0)];
/// let images = advect_points(&points, &[stroke], &NoProgress)?;
/// assert_eq!(images, [DVec3::X, points[1]]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct Move {
    tool: Arc<Tool>,
    keys: Vec<Pose>,
    step: f64,
    segments: Vec<Segment>,
}

impl Move {
    /// A motion of `tool` through `keys` (world from tool), with a constant body twist between neighbors:
    /// a screw motion of less than half a turn.
    ///
    /// `step` bounds the travel of the tool's fastest surface point in one step of the integrator, as a
    /// fraction of the [feature size](Tool::feature_size). A larger value is faster; the error is of
    /// order four in `step`.
    ///
    /// # Errors
    /// - [`MoveError::Step`] if `step` is not positive and finite.
    /// - [`MoveError::TooFewKeys`] for fewer than two keys.
    /// - [`MoveError::NotFinite`] if a pose is not finite.
    /// - [`MoveError::HalfTurn`] if two neighboring keys are exactly half a turn apart.
    /// - [`MoveError::TooManySteps`] if a path between two keys takes more than a million steps.
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

    /// Number of steps of the integrator along the whole path.
    pub fn steps(&self) -> usize {
        self.segments.iter().map(Segment::steps).sum()
    }

    /// The field of each segment, in world coordinates.
    pub fn fields(&self) -> Vec<Arc<dyn MovingField>> {
        let starts = self.keys.iter().zip(&self.segments);
        let field = |(start, segment): (&Pose, &Segment)| MovingTool::new(self.tool.clone(), *start, segment.twist);
        starts.map(|start| Arc::new(field(start)) as _).collect()
    }

    /// The end times of the steps, in order. Each segment takes one unit of time.
    pub(crate) fn step_ends(&self) -> Vec<f64> {
        let ends = |(key, segment): (usize, &Segment)| {
            let count = segment.steps();
            (1..=count).map(move |step| key as f64 + step as f64 / count as f64)
        };
        self.segments.iter().enumerate().flat_map(ends).collect()
    }

    /// Pose of the tool at a time from zero to the number of segments.
    pub(crate) fn pose_at(&self, time: f64) -> Pose {
        let key = (time as usize).min(self.segments.len() - 1);
        let since = time - key as f64;
        if since == 1.0 { self.keys[key + 1] } else { self.keys[key].moved(&self.segments[key].twist, since) }
    }

    pub(super) fn advect_chunk(&self, points: &mut [DVec3]) -> u64 {
        let mut advected = AdvectedPoints::new(points);
        self.segments.iter().map(|segment| segment.advect_chunk(&self.tool, &mut advected)).sum()
    }

    /// Whether the support may touch a resting ball at any time. `false` is certain.
    pub(super) fn may_touch(&self, center: DVec3, radius: f64) -> bool {
        self.segments.iter().any(|segment| segment.may_touch(&self.tool, center, radius))
    }

    /// Box in the world that contains the support at all times.
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
        // A part of a valid path is valid: it is shorter and turns by less.
        Self::new(self.tool.clone(), keys, self.step).unwrap_or_else(|_| self.clone())
    }
}

#[cfg(test)]
mod tests;
