//! The passage of a surface through strokes.

use isochore_mesh::{Cancelled, Monitor};
use web_time::Instant;

use super::{
    DeformError, StageSeconds,
    guard::{StepChoice, choose_step, refine_to_volume},
    press::{PressStop, Pressed, press},
    refine::{Criteria, Refined, Refinement, estimate_facet_error, refine, resolve_field, untangle},
    tessellation::{Tessellation, count_different},
};
use crate::flow::{Stamp, Stroke};

/// Conditions that are the same for all passes over a mesh.
#[derive(Clone, Copy)]
pub(super) struct Context<'a> {
    /// When to split, or `None` to keep the triangles.
    pub(super) criteria: Option<&'a Criteria>,
    /// Volume at rest, or `None` for an open mesh.
    pub(super) volume: Option<f64>,
    pub(super) monitor: &'a dyn Monitor,
}

/// Result of the passage through all strokes.
#[derive(Debug, Default)]
pub(super) struct Passage {
    pub(super) strokes: Vec<StrokePass>,
    /// Estimated signed volume that the flat triangles lack.
    pub(super) facet_error: f64,
    /// Wall time of untangling, seconds.
    pub(super) untangling: f64,
}

/// Result of one stroke.
#[derive(Debug, Clone, Copy)]
pub(super) struct StrokePass {
    pub(super) action: Action,
    /// Refinement, with all evaluations of fields or distances.
    pub(super) refinement: Refinement,
    /// Vertices that the stroke moved.
    pub(super) moved: usize,
    pub(super) seconds: StageSeconds,
    /// Volume of the image after the stroke, or `None` for an open mesh.
    pub(super) volume: Option<f64>,
}

/// The part of a result that differs between flows and stamps.
#[derive(Debug, Clone, Copy)]
pub(super) enum Action {
    Flow(StepChoice),
    Stamp { has_touched: bool, is_through: bool },
}

impl Passage {
    /// Takes the surface through the strokes, and refines their time steps.
    ///
    /// A stamp is not a flow. It acts on the surface that the strokes before it leave, and the strokes
    /// after it start from the surface that it leaves.
    pub(super) fn through(
        surface: &mut Tessellation,
        strokes: &mut [Stroke],
        context: &Context<'_>,
    ) -> Result<Self, DeformError> {
        let mut passage = Self::default();
        for phase in strokes.split_inclusive_mut(|stroke| matches!(stroke, Stroke::Stamp(_))) {
            let (flows, stamp) = match phase {
                [flows @ .., Stroke::Stamp(stamp)] => (flows, Some(&*stamp)),
                flows => (flows, None),
            };
            passage.add(flow(surface, flows, context)?);
            if let Some(stamp) = stamp {
                let index = passage.strokes.len();
                passage.strokes.push(imprint(surface, stamp, index, context)?);
            }
        }
        Ok(passage)
    }

    fn add(&mut self, other: Self) {
        self.strokes.extend(other.strokes);
        self.facet_error += other.facet_error;
        self.untangling += other.untangling;
    }
}

/// Advects the surface through `strokes`, which must not include a stamp.
fn flow(surface: &mut Tessellation, strokes: &mut [Stroke], context: &Context<'_>) -> Result<Passage, Cancelled> {
    let Context { criteria, monitor, .. } = *context;
    let mut passage = Passage::default();
    let volume = surface.image_volume();
    for index in 0..strokes.len() {
        let step = choose_step(&mut strokes[index], surface, monitor)?;
        let (stroke, facet_error) = advect_last(surface, &strokes[..=index], step, context)?;
        passage.strokes.push(stroke);
        passage.facet_error = facet_error;
    }
    if let Some(criteria) = criteria {
        passage.facet_error = refine_to_volume(surface, strokes, criteria, volume, passage.facet_error, monitor)?;
        let begin = Instant::now();
        if untangle(surface, strokes, criteria, monitor)?.inserted > 0 {
            passage.facet_error = estimate_facet_error(surface, strokes, monitor)?.volume;
        }
        passage.untangling = begin.elapsed().as_secs_f64();
    }
    Ok(passage)
}

/// Advects the surface through the last of `strokes`, with refinement before and after. Returns the
/// result and the facet error.
fn advect_last(
    surface: &mut Tessellation,
    strokes: &[Stroke],
    step: StepChoice,
    context: &Context<'_>,
) -> Result<(StrokePass, f64), Cancelled> {
    let Context { criteria, volume, monitor } = *context;
    let (past, stroke) = (&strokes[..strokes.len() - 1], &strokes[strokes.len() - 1]);
    let begin = Instant::now();
    let resolved = match criteria {
        Some(criteria) => resolve_field(surface, past, stroke, criteria, monitor)?,
        None => Refinement::default(),
    };
    let resolve_end = Instant::now();
    let advected = surface.advect(stroke, monitor)?;
    let advect_end = Instant::now();
    let known = surface.image.len();
    let Refined { mut refinement, facet_error } = match criteria {
        Some(criteria) => refine(surface, strokes, criteria, monitor)?,
        None => estimate_facet_error(surface, strokes, monitor)?.into(),
    };
    let moved = advected.moved + count_different(&surface.rest[known..], &surface.image[known..]);
    let end = Instant::now();
    refinement.add(&resolved);
    refinement.evaluations += advected.evaluations;
    let pass = StrokePass {
        action: Action::Flow(step),
        refinement,
        moved,
        seconds: StageSeconds {
            advect: (advect_end - resolve_end).as_secs_f64(),
            refine: (resolve_end - begin + (end - advect_end)).as_secs_f64(),
            lock: 0.0,
        },
        volume: volume.map(|_| surface.image_volume()),
    };
    Ok((pass, facet_error))
}

/// Presses a stamp, stroke number `index`, into the image.
fn imprint(
    surface: &mut Tessellation,
    stamp: &Stamp,
    index: usize,
    context: &Context<'_>,
) -> Result<StrokePass, DeformError> {
    let begin = Instant::now();
    let before = surface.image.clone();
    let Pressed { refinement, has_touched, is_through } = press(surface, stamp, context.criteria, context.monitor)
        .map_err(|stop| match stop {
            PressStop::Cancelled(cancelled) => DeformError::Cancelled(cancelled),
            PressStop::Stamp(source) => DeformError::Stamp { stroke: index, source },
        })?;
    let known = before.len();
    let moved =
        count_different(&before, &surface.image) + count_different(&surface.rest[known..], &surface.image[known..]);
    Ok(StrokePass {
        action: Action::Stamp { has_touched, is_through },
        refinement,
        moved,
        seconds: StageSeconds { advect: begin.elapsed().as_secs_f64(), ..StageSeconds::default() },
        volume: context.volume.map(|_| surface.image_volume()),
    })
}
