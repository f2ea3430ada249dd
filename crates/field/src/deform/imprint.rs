//! The passage of a surface through a stamp.

use glam::DVec3;
use isochore_mesh::Cancelled;
use web_time::Instant;

use super::{
    DeformError, StageSeconds,
    certificate::{Crossings, HALVINGS, Rewound, closest_sheets, crossing_place},
    passage::{Action, Context, StrokePass},
    press::{Outline, PressStop, Pressed, press},
    refine::Criteria,
    tessellation::{Tessellation, count_different},
};
use crate::flow::Stamp;

/// Presses a stamp, stroke number `index`, into the image. A stamp that makes the surface cross itself
/// ends at its last moment without new crossings.
pub(super) fn imprint(
    surface: &mut Tessellation,
    stamp: &Stamp,
    index: usize,
    context: &Context<'_>,
) -> Result<(StrokePass, u64), DeformError> {
    let begin = Instant::now();
    let mut imprint = Imprint { start: surface.clone(), stamp, context, pairs_tested: 0 };
    let (result, rewound) = imprint.find().map_err(|stop| DeformError::of_stamp(index, stop))?;
    let known = imprint.start.image.len();
    let moved = count_different(&imprint.start.image, &result.surface.image)
        + count_different(&result.surface.rest[known..], &result.surface.image[known..]);
    *surface = result.surface;
    let Pressed { refinement, has_touched, is_through } = result.pressed;
    let pass = StrokePass {
        action: Action::Stamp { has_touched, is_through },
        refinement,
        moved,
        seconds: StageSeconds { advect: begin.elapsed().as_secs_f64(), ..StageSeconds::default() },
        rewound,
        volume: context.volume.map(|_| surface.image_volume()),
    };
    Ok((pass, imprint.pairs_tested))
}

/// Most presses for the outline. Each leaves out the edges where the one before crossed. A larger value takes
/// longer; a smaller value leaves whole outlines jagged.
const MAX_OUTLINES: usize = 2;

/// A stamp that is being pressed.
struct Imprint<'a> {
    /// The surface before the stamp.
    start: Tessellation,
    stamp: &'a Stamp,
    context: &'a Context<'a>,
    /// Pairs of triangles that the certificates tested.
    pairs_tested: u64,
}

/// A surface after a stamp.
struct Attempt {
    surface: Tessellation,
    pressed: Pressed,
    outline: Outline,
    crossings: Crossings,
}

impl Imprint<'_> {
    /// The result, and where the stamp ended if it would have made the surface cross itself.
    fn find(&mut self) -> Result<(Attempt, Option<Rewound>), PressStop> {
        let whole = self.press(self.start.clone(), 1.0)?;
        // Without refinement the caller wants the flow of exactly these triangles.
        let Some(criteria) = self.context.criteria else { return Ok((whole, None)) };
        let (mut best, clean, place) =
            if whole.crossings.is_empty() { (whole, 1.0, None) } else { self.rewind(whole)? };
        self.sharpen(&mut best, clean, criteria)?;
        let rewound = place.map(|place| Rewound {
            stopped_at: clean,
            sheets: closest_sheets(&best.surface, &best.surface.image, place),
        });
        Ok((best, rewound))
    }

    /// Splits edges on the outline of the contact, and presses again up to `time`. Where the surface would
    /// cross itself, the outline keeps its teeth.
    fn sharpen(&mut self, best: &mut Attempt, time: f64, criteria: &Criteria) -> Result<(), Cancelled> {
        for _ in 0..MAX_OUTLINES {
            let mut outlined = best.surface.clone();
            let Some(split) = best.outline.split(&mut outlined, &self.start.image, criteria) else { break };
            let mut attempt = match self.press(outlined, time) {
                Ok(attempt) => attempt,
                Err(PressStop::Cancelled(cancelled)) => return Err(cancelled),
                Err(PressStop::Stamp(_)) => break,
            };
            best.pressed.refinement.evaluations += attempt.pressed.refinement.evaluations;
            if attempt.crossings.is_empty() {
                let evaluations = best.pressed.refinement.evaluations;
                attempt.pressed.refinement.add(&best.pressed.refinement);
                attempt.pressed.refinement.evaluations = evaluations;
                attempt.pressed.refinement.inserted += split.inserted();
                *best = attempt;
                break;
            }
            let triangles = attempt.crossings.triangles();
            let vertices = triangles.iter().flat_map(|&index| attempt.surface.triangles[index as usize]);
            if !best.outline.forget(&split, vertices) {
                break;
            }
        }
        Ok(())
    }

    /// The last attempt without new crossings, its time, and the place where the stamp crosses next. `whole`
    /// is the crossing attempt at the whole path.
    fn rewind(&mut self, whole: Attempt) -> Result<(Attempt, f64, Option<DVec3>), PressStop> {
        let place_of = |attempt: &Attempt| {
            let surface = &attempt.surface;
            attempt.crossings.pairs.first().map(|&pair| crossing_place(surface, &surface.image, pair))
        };
        let (mut clean, mut crossed) = (0.0, 1.0);
        let mut place = place_of(&whole);
        let mut best = Attempt {
            surface: self.start.clone(),
            pressed: Pressed::default(),
            outline: Outline::default(),
            crossings: Crossings::default(),
        };
        for _ in 0..HALVINGS {
            let time = 0.5 * (clean + crossed);
            let attempt = self.press(self.start.clone(), time)?;
            if attempt.crossings.is_empty() {
                (best, clean) = (attempt, time);
            } else {
                (crossed, place) = (time, place_of(&attempt));
            }
        }
        Ok((best, clean, place))
    }

    /// Presses the first part of the stamp's path, up to `time`, into `surface`.
    fn press(&mut self, mut surface: Tessellation, time: f64) -> Result<Attempt, PressStop> {
        let stamp = self.stamp.truncated(time);
        let (pressed, outline) = press(&mut surface, &stamp, self.context.criteria, self.context.monitor)?;
        let before = |vertex: usize| self.start.image.get(vertex).unwrap_or(&surface.rest[vertex]);
        let moved = surface.triangles_with(|vertex| surface.image[vertex] != *before(vertex));
        surface.take_unchecked();
        let crossings = Crossings::of(&surface, &surface.image, &moved, self.context)?;
        self.pairs_tested += crossings.pairs_tested;
        Ok(Attempt { surface, pressed, outline, crossings })
    }
}
