//! The passage of a surface through strokes.

use isochore_mesh::{Cancelled, Monitor};
use web_time::Instant;

use super::{
    DeformError, StageSeconds,
    certificate::{Input, Rewound, Verdict, certify, rewind},
    coarsening::coarsen,
    guard::{StepChoice, WORTHWHILE, choose_step, refine_to_volume},
    imprint::imprint,
    refine::{Criteria, Refined, Refinement, estimate_facet_error, refine, resolve_field},
    tessellation::{Tessellation, count_different},
};
use crate::flow::Stroke;

/// Conditions that are the same for all passes over a mesh.
#[derive(Clone, Copy)]
pub(super) struct Context<'a> {
    /// The input mesh, whose crossings are not new.
    pub(super) input: &'a Input<'a>,
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
    /// Volume of the base of the current phase.
    base_volume: f64,
    /// Change of the volume since the base that the facet error does not explain.
    time_error: f64,
    /// Pairs of triangles that the certificates tested.
    pub(super) pairs_tested: u64,
    /// Wall time of the last refinement for the volume and of rebases, seconds.
    pub(super) finishing: f64,
    pub(super) rebases: usize,
    /// Sum over the rebases of the largest distance by which each moved the surface, model units.
    pub(super) rebase_deviation: f64,
}

/// Result of one attempt at a stroke.
#[derive(Debug)]
struct Attempt {
    pass: StrokePass,
    verdict: Verdict,
    /// Estimated signed volume that the flat triangles lack.
    facet_error: f64,
    /// Change of the volume since the base that the facet error does not explain.
    time_error: f64,
}

/// Fraction of the asked change of the volume that the time step of one stroke may cause. A larger value
/// leaves less for the facets; a smaller value takes finer steps.
const TIME_FRACTION: f64 = 0.25;

/// Result of one stroke.
#[derive(Debug, Clone, Copy)]
pub(super) struct StrokePass {
    pub(super) action: Action,
    /// Refinement, with all evaluations of fields or distances.
    pub(super) refinement: Refinement,
    /// Vertices that the stroke moved.
    pub(super) moved: usize,
    pub(super) seconds: StageSeconds,
    /// Where the stroke ended, if it would have made the surface cross itself.
    pub(super) rewound: Option<Rewound>,
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
            let mut begin = 0;
            while begin < flows.len() {
                let part = flow(surface, &mut flows[begin..], context, passage.rebases > 0)?;
                begin += part.strokes.len();
                passage.add(part);
                // After a rebase the map is not exact anyway, so triangles are merged at the end too.
                if begin < flows.len() || passage.rebases > 0 {
                    passage.rebase(surface, context)?;
                }
            }
            if let Some(stamp) = stamp {
                let index = passage.strokes.len();
                let (pass, pairs_tested) = imprint(surface, stamp, index, context)?;
                passage.strokes.push(pass);
                passage.pairs_tested += pairs_tested;
            }
        }
        Ok(passage)
    }

    fn add(&mut self, other: Self) {
        self.strokes.extend(other.strokes);
        self.facet_error += other.facet_error;
        self.time_error += other.time_error;
        self.pairs_tested += other.pairs_tested;
        self.finishing += other.finishing;
        self.rebases += other.rebases;
        self.rebase_deviation += other.rebase_deviation;
    }
}

/// Advects the surface through the first of `strokes`, until a rebase is due. `has_rebased` is whether one
/// has been made before. `strokes` must not include a stamp.
fn flow(
    surface: &mut Tessellation,
    strokes: &mut [Stroke],
    context: &Context<'_>,
    has_rebased: bool,
) -> Result<Passage, Cancelled> {
    let volume = surface.image_volume();
    let mut passage = Passage { base_volume: volume, ..Passage::default() };
    let mut done = 0;
    while done < strokes.len() {
        done += 1;
        passage.add_stroke(surface, &mut strokes[..done], context)?;
        let vertices = surface.image.len();
        if context.criteria.is_some_and(|criteria| criteria.rebase().is_due(vertices, done, has_rebased)) {
            break;
        }
    }
    let strokes = &mut strokes[..done];
    if let Some(criteria) = context.criteria {
        let begin = Instant::now();
        let coarse = surface.clone();
        let facet_error = refine_to_volume(surface, strokes, criteria, volume, passage.facet_error, context.monitor)?;
        let verdict = certify(surface, strokes, context)?;
        passage.pairs_tested += verdict.pairs_tested;
        if verdict.crossings.is_empty() {
            passage.facet_error = facet_error;
        } else {
            // Finer triangles cross, and the coarser ones do not.
            *surface = coarse;
        }
        passage.finishing = begin.elapsed().as_secs_f64();
    }
    Ok(passage)
}

impl Passage {
    /// Makes the image the base, and merges triangles that nothing needs any more.
    fn rebase(&mut self, surface: &mut Tessellation, context: &Context<'_>) -> Result<(), Cancelled> {
        let Some(criteria) = context.criteria else { return Ok(()) };
        let begin = Instant::now();
        let (facet_error, deviation) = (criteria.allowed_facet_error(surface), surface.largest_deviation());
        surface.freeze();
        let coarsened = coarsen(surface, criteria, facet_error, context)?;
        self.rebases += 1;
        self.rebase_deviation += deviation + coarsened.deviation;
        self.pairs_tested += coarsened.pairs_tested;
        self.finishing += begin.elapsed().as_secs_f64();
        Ok(())
    }

    /// Advects the surface through the last of `strokes`. If new crossings remain, truncates the stroke
    /// to its last moment without them.
    fn add_stroke(
        &mut self,
        surface: &mut Tessellation,
        strokes: &mut [Stroke],
        context: &Context<'_>,
    ) -> Result<(), Cancelled> {
        let Some(last) = strokes.len().checked_sub(1) else { return Ok(()) };
        let start = surface.clone();
        let step = choose_step(&mut strokes[last], surface, context.monitor)?;
        let mut attempt = self.attempt(surface, strokes, step, context)?;
        if let Some(asked) = context.criteria.and_then(Criteria::asked_volume) {
            attempt = self.refine_step(surface, &start, strokes, attempt, asked, context)?;
        }
        let Attempt { mut pass, verdict, facet_error, time_error } = attempt;
        (self.facet_error, self.time_error) = (facet_error, time_error);
        if !verdict.crossings.is_empty() {
            let rewound = rewind(surface, strokes, &verdict.crossings, context)?;
            strokes[last] = strokes[last].truncated(rewound.stopped_at);
            pass = self.stop(surface, start, strokes, pass, context)?;
            pass.rewound = Some(rewound);
        }
        self.strokes.push(pass);
        Ok(())
    }

    /// Advects the surface through the last of `strokes`, which is truncated to a moment at which
    /// `surface` does not cross. `start` is the surface before the stroke, and `whole` the result of the
    /// whole stroke.
    fn stop(
        &mut self,
        surface: &mut Tessellation,
        start: Tessellation,
        strokes: &[Stroke],
        whole: StrokePass,
        context: &Context<'_>,
    ) -> Result<StrokePass, Cancelled> {
        // From the start again, because splits for the whole stroke were in vain.
        let split = std::mem::replace(surface, start);
        let Action::Flow(step) = whole.action else { return Ok(whole) };
        let Attempt { pass, verdict, facet_error, .. } = self.attempt(surface, strokes, step, context)?;
        if verdict.crossings.is_empty() {
            self.facet_error = facet_error;
            return Ok(pass);
        }
        *surface = split;
        surface.advect_again(&strokes[..strokes.len() - 1], context.monitor)?;
        let before = surface.image.clone();
        surface.advect_again(strokes, context.monitor)?;
        surface.take_unchecked();
        self.facet_error = estimate_facet_error(surface, strokes, context.monitor)?.volume;
        let moved = count_different(&before, &surface.image);
        Ok(StrokePass { moved, volume: context.volume.map(|_| surface.image_volume()), ..whole })
    }

    /// Advects the surface through the last of `strokes`, and searches for new crossings.
    fn attempt(
        &mut self,
        surface: &mut Tessellation,
        strokes: &[Stroke],
        step: StepChoice,
        context: &Context<'_>,
    ) -> Result<Attempt, Cancelled> {
        let (mut pass, mut facet_error) = advect_last(surface, strokes, step, context)?;
        let begin = Instant::now();
        let verdict = certify(surface, strokes, context)?;
        pass.refinement.add(&verdict.refinement);
        self.pairs_tested += verdict.pairs_tested;
        if verdict.refinement.inserted > 0 {
            facet_error = estimate_facet_error(surface, strokes, context.monitor)?.volume;
            pass.volume = context.volume.map(|_| surface.image_volume());
        }
        pass.seconds.refine += begin.elapsed().as_secs_f64();
        let time_error = surface.image_volume() + facet_error - self.base_volume;
        Ok(Attempt { pass, verdict, facet_error, time_error })
    }

    /// Halves the time step of the last of `strokes` while it changes the volume by more than a fraction
    /// of the `asked` change. `start` is the surface before the stroke.
    fn refine_step(
        &mut self,
        surface: &mut Tessellation,
        start: &Tessellation,
        strokes: &mut [Stroke],
        mut best: Attempt,
        asked: f64,
        context: &Context<'_>,
    ) -> Result<Attempt, Cancelled> {
        let last = strokes.len() - 1;
        let error_of = |attempt: &Attempt, before: f64| (attempt.time_error - before).abs();
        while let Action::Flow(step) = best.pass.action
            && error_of(&best, self.time_error) > TIME_FRACTION * asked
            && let Some(finer) = step.halved(&strokes[last])
        {
            let (finer, step) = finer;
            let kept = (std::mem::replace(surface, start.clone()), std::mem::replace(&mut strokes[last], finer));
            let next = self.attempt(surface, strokes, step, context)?;
            if error_of(&next, self.time_error) > WORTHWHILE * error_of(&best, self.time_error) {
                (*surface, strokes[last]) = kept;
                break;
            }
            best = next;
        }
        Ok(best)
    }
}

/// Advects the surface through the last of `strokes`, with refinement before and after. Returns the
/// result and the facet error.
fn advect_last(
    surface: &mut Tessellation,
    strokes: &[Stroke],
    step: StepChoice,
    context: &Context<'_>,
) -> Result<(StrokePass, f64), Cancelled> {
    let Context { criteria, volume, monitor, .. } = *context;
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
        rewound: None,
        volume: volume.map(|_| surface.image_volume()),
    };
    Ok((pass, facet_error))
}
