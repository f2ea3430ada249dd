//! The flow of fields that change with time, by Runge-Kutta steps of equal length in world coordinates.
//!
//! A point whose four stages are in the rigid core of one body moves with that body, in closed form. A
//! point whose four stages are all beyond the support rests and keeps its bits. A sleeping point skips
//! steps through which it certainly rests, so sleep changes no bits.

use std::sync::Arc;

use glam::DVec3;
use isochore_mesh::{Aabb, LANES, PointBlock};

use super::movement::{MAX_STEPS, SLEEP_SLACK};
use crate::{
    fields::{
        Field, FieldBlock, Mask, MovingField, NO_CORE,
        mask::{masked_field::MaskedField, mirrored_field::MirroredField},
        pose::Placement,
    },
    flow::rk4::{Rk4Block, rk4_step},
};

/// A sequence of fields, each of which acts over its own time.
///
/// ```
/// use std::sync::Arc;
///
/// use glam::DVec3;
/// use isochore_field::{FieldStroke, Profile, Ring, RingShape, Stroke, advect_points};
/// use isochore_mesh::NoProgress;
///
/// let shape = RingShape {
///     center: DVec3::ZERO, axis: DVec3::Z, major: 1.0, minor: 0.2, support: 0.3, profile: Profile::Quintic,
/// };
/// let ring = Ring::new(shape, 0.5)?;
/// let stroke = Stroke::Field(FieldStroke::new(vec![Arc::new(ring)], 0.125)?);
/// // A point in the rigid core moves with the ring.
/// let images = advect_points(&[DVec3::X], &[stroke], &NoProgress)?;
/// assert!(images[0].distance(DVec3::new(1.0, 0.0, 0.5)) < 1e-14);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct FieldStroke {
    spans: Vec<Span>,
    step: f64,
    legs: Vec<Leg>,
}

/// Errors of [`FieldStroke::new`].
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum FieldStrokeError {
    /// The list of fields is empty.
    #[error("a field stroke needs at least one field")]
    NoField,
    /// The step is not a positive fraction.
    #[error("the step must be a positive fraction, not {0}")]
    Step(f64),
    /// A field takes too many steps.
    #[error("field {field} takes {steps:.0} steps; at most {MAX_STEPS} are allowed")]
    TooManySteps {
        /// Index of the field, from 0.
        field: usize,
        /// Steps it would take.
        steps: f64,
    },
}

/// A field and its end time, from 0 to 1.
#[derive(Debug, Clone)]
struct Span {
    field: Arc<dyn MovingField>,
    end: f64,
}

/// A span in steps of the integrator.
#[derive(Debug, Clone)]
struct Leg {
    /// The start and the midpoint of every step, and the end of the last.
    instants: Vec<Instant>,
    step_time: f64,
    approach_speed: f64,
}

/// The field at one time, and boxes outside all of which it is zero.
#[derive(Debug, Clone)]
struct Instant {
    field: Arc<dyn Field>,
    parts: Vec<Aabb>,
}

impl Instant {
    fn new(field: Box<dyn Field>) -> Self {
        Self { parts: field.parts(), field: Arc::from(field) }
    }

    /// Lower bound on the distance from a point to the nearest part; zero inside a part.
    fn clearance(&self, point: DVec3) -> f64 {
        self.parts.iter().map(|part| part.distance(point)).fold(f64::INFINITY, f64::min)
    }
}

impl FieldStroke {
    /// The flow of `fields`, one after the other.
    ///
    /// `step` bounds the travel of a field's core in one step of the integrator, as a fraction of the
    /// [feature size](MovingField::feature_size) of the field.
    ///
    /// # Errors
    /// - [`FieldStrokeError::Step`] if `step` is not positive and finite.
    /// - [`FieldStrokeError::NoField`] if `fields` is empty.
    /// - [`FieldStrokeError::TooManySteps`] if a field takes more than a million steps.
    pub fn new(fields: Vec<Arc<dyn MovingField>>, step: f64) -> Result<Self, FieldStrokeError> {
        Self::from_spans(fields.into_iter().map(|field| Span { field, end: 1.0 }).collect(), step)
    }

    fn from_spans(spans: Vec<Span>, step: f64) -> Result<Self, FieldStrokeError> {
        if !(step > 0.0 && step.is_finite()) {
            return Err(FieldStrokeError::Step(step));
        }
        if spans.is_empty() {
            return Err(FieldStrokeError::NoField);
        }
        let legs =
            spans.iter().enumerate().map(|(index, span)| Leg::new(span, index, step)).collect::<Result<_, _>>()?;
        Ok(Self { spans, step, legs })
    }

    /// The fields, one after the other.
    pub fn fields(&self) -> impl Iterator<Item = &Arc<dyn MovingField>> {
        self.spans.iter().map(|span| &span.field)
    }

    /// Number of steps of the integrator over all fields.
    pub fn steps(&self) -> usize {
        self.legs.iter().map(Leg::steps).sum()
    }

    /// The travel in one step, as a fraction of the feature size.
    pub fn step(&self) -> f64 {
        self.step
    }

    /// Smallest length over which a field changes in a ball.
    pub(super) fn feature_size_near(&self, center: DVec3, radius: f64) -> f64 {
        self.fields().map(|field| field.feature_size_near(center, radius)).fold(f64::INFINITY, f64::min)
    }

    /// The same fields, multiplied by a mask.
    pub(super) fn masked(&self, mask: &Arc<Mask>, bounds: Aabb) -> Result<Self, FieldStrokeError> {
        let masked = |span: &Span| {
            let mut field = Arc::clone(&span.field);
            if !mask.mirrors().is_empty() {
                field = Arc::new(MirroredField::new(field, mask.mirrors()));
            }
            if mask.holds() {
                field = Arc::new(MaskedField::new(field, Arc::clone(mask), bounds));
            }
            Span { field, end: span.end }
        };
        Self::from_spans(self.spans.iter().map(masked).collect(), self.step)
    }

    pub(super) fn advect_chunk(&self, points: &mut [DVec3]) -> u64 {
        let mut wake = vec![0; points.len()];
        self.legs.iter().map(|leg| leg.advect_chunk(points, &mut wake)).sum()
    }

    /// Whether the support may touch a resting ball at any time. `false` is certain.
    pub(super) fn may_touch(&self, center: DVec3, radius: f64) -> bool {
        self.legs.iter().any(|leg| leg.may_touch(center, radius))
    }

    /// Box in the world that contains the support at all times.
    pub(super) fn reach(&self) -> Aabb {
        self.legs.iter().map(Leg::reach).fold(Aabb::EMPTY, Aabb::union)
    }

    pub(super) fn with_half_step(&self) -> Result<Self, FieldStrokeError> {
        Self::from_spans(self.spans.clone(), 0.5 * self.step)
    }

    pub(super) fn truncated(&self, fraction: f64) -> Self {
        let mut time_left = fraction * self.spans.iter().map(|span| span.end).sum::<f64>();
        let mut spans = Vec::new();
        for span in &self.spans {
            let end = time_left.min(span.end);
            if end > 0.0 || spans.is_empty() {
                spans.push(Span { field: Arc::clone(&span.field), end });
            }
            time_left -= end;
        }
        // A part of a valid stroke is valid: it is shorter.
        Self::from_spans(spans, self.step).unwrap_or_else(|_| self.clone())
    }
}

impl Leg {
    fn new(span: &Span, index: usize, step: f64) -> Result<Self, FieldStrokeError> {
        let Span { field, end } = span;
        let travel = field.core_speed() * end;
        let count = (travel / (step * field.feature_size())).ceil().max(1.0);
        if count.is_nan() || count > MAX_STEPS as f64 {
            return Err(FieldStrokeError::TooManySteps { field: index, steps: count });
        }
        let halves = 2 * count as usize;
        let instants = (0..=halves).map(|half| Instant::new(field.at(end * (half as f64 / halves as f64)))).collect();
        Ok(Self { instants, step_time: end / count, approach_speed: field.approach_speed() })
    }

    fn steps(&self) -> usize {
        self.instants.len() / 2
    }

    fn advect_chunk(&self, points: &mut [DVec3], wake: &mut [usize]) -> u64 {
        let mut evaluations = 0;
        wake.fill(0);
        let mut due = Vec::new();
        for step in 0..self.steps() {
            let instant = &self.instants[2 * step];
            due.clear();
            for (index, (point, wake)) in points.iter().zip(&mut *wake).enumerate() {
                if *wake <= step {
                    match self.resting_steps(instant.clearance(*point), *point) {
                        0 => due.push(index as u32),
                        sleep => *wake = step + sleep,
                    }
                }
            }
            for block in due.chunks(LANES) {
                evaluations += self.step_block(step, block, points, wake);
            }
        }
        evaluations
    }

    /// Advects the points with indices `block` from the start of `step` to its end.
    fn step_block(&self, step: usize, block: &[u32], points: &mut [DVec3], wake: &mut [usize]) -> u64 {
        let [begin, middle, end] = [0, 1, 2].map(|half| &*self.instants[2 * step + half].field);
        let mut rk4 = Rk4Block::new(FieldBlock::ZERO);
        rk4.start = PointBlock::gather(&block.iter().map(|&index| points[index as usize]).collect::<Vec<_>>());
        begin.evaluate_into(&rk4.start, &mut rk4.stages[0]);
        let sleep: [usize; LANES] =
            std::array::from_fn(|lane| self.resting_steps(rk4.stages[0].clearance[lane], rk4.start.get(lane)));
        if sleep[..block.len()].iter().all(|&steps| steps > 0) {
            block.iter().zip(sleep).for_each(|(&index, sleep)| wake[index as usize] = step + sleep);
            return block.len() as u64;
        }
        let fields = [begin, middle, middle, end];
        rk4_step(
            std::slice::from_mut(&mut rk4),
            self.step_time,
            |stage| &stage.velocity,
            |stage, points, out| fields[stage].evaluate_into(points, out),
        );
        let Rk4Block { start, stages, end: arrived } = &rk4;
        let is_still = |lane: usize| stages.iter().all(|stage| stage.clearance[lane] > 0.0);
        let core = |lane: usize| {
            let core = stages[0].core[lane];
            if stages.iter().all(|stage| stage.core[lane] == core) { core } else { NO_CORE }
        };
        for (lane, &index) in block.iter().enumerate() {
            let point = &mut points[index as usize];
            if is_still(lane) {
                wake[index as usize] = step + sleep[lane].max(1);
            } else if arrived.get(lane) == start.get(lane) {
                // The point is held by a mask, or its body pauses. Not even the sign of a zero may change.
            } else if core(lane) == NO_CORE {
                *point = arrived.get(lane);
            } else {
                let [from, to] = [begin, end].map(|field| Placement::from(&field.core_pose(core(lane))));
                *point = to.to_world(from.to_local(*point));
            }
        }
        4 * block.len() as u64
    }

    /// Number of steps through which a resting point, at least `clearance` from the support, certainly stays
    /// beyond it.
    fn resting_steps(&self, clearance: f64, point: DVec3) -> usize {
        let slack = SLEEP_SLACK * (point.abs().max_element() + clearance);
        let steps = (clearance - slack) / (self.approach_speed * self.step_time);
        // A field at rest does not approach: infinity means all remaining steps.
        if steps >= 1.0 { (steps as usize).min(self.steps()) } else { 0 }
    }

    fn reach(&self) -> Aabb {
        let bounds =
            self.instants.iter().flat_map(|instant| instant.parts.iter().copied()).fold(Aabb::EMPTY, Aabb::union);
        // Instants are half a step apart, so each time is within a quarter of a step of one.
        bounds.expanded(0.25 * self.approach_speed * self.step_time)
    }

    fn may_touch(&self, center: DVec3, radius: f64) -> bool {
        let mut step = 0;
        while step <= self.steps() {
            let instant = &self.instants[2 * step];
            let mut clearance = instant.clearance(center) - radius;
            if clearance <= 0.0 {
                let mut block = FieldBlock::ZERO;
                instant.field.evaluate_into(&PointBlock::splat(center), &mut block);
                clearance = block.clearance[0] - radius;
            }
            let sleep = self.resting_steps(clearance, center);
            // If the point cannot sleep through one step, the support may touch it before the next test.
            if sleep == 0 {
                return true;
            }
            step += sleep;
        }
        false
    }
}

#[cfg(test)]
mod tests;
