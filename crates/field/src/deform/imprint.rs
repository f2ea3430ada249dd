//! The passage of a surface through a stamp.

use web_time::Instant;

use super::{
    DeformError, StageSeconds,
    certificate::{Crossings, HALVINGS, Rewound, closest_sheets, crossing_place},
    passage::{Action, Context, StrokePass},
    press::{Pressed, press},
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
    let start = surface.clone();
    let mut pairs_tested = 0;
    let mut press_until = |surface: &mut Tessellation, time: f64| -> Result<(Pressed, Crossings), DeformError> {
        let pressed = press(surface, &stamp.truncated(time), context.criteria, context.monitor)
            .map_err(|stop| DeformError::of_stamp(index, stop))?;
        let before = |vertex: usize| start.image.get(vertex).unwrap_or(&surface.rest[vertex]);
        let moved = surface.triangles_with(|vertex| surface.image[vertex] != *before(vertex));
        surface.take_unchecked();
        let crossings = Crossings::of(surface, &surface.image, &moved, context)?;
        pairs_tested += crossings.pairs_tested;
        Ok((pressed, crossings))
    };
    let (mut pressed, mut crossings) = press_until(surface, 1.0)?;
    let mut rewound = None;
    // Without refinement the caller wants the flow of exactly these triangles.
    if !crossings.is_empty() && context.criteria.is_some() {
        let (mut clean, mut crossed) = (0.0, 1.0);
        let mut best = start.clone();
        let mut place = crossing_place(surface, &surface.image, crossings.pairs[0]);
        for _ in 0..HALVINGS {
            let time = 0.5 * (clean + crossed);
            *surface = start.clone();
            let shorter;
            (shorter, crossings) = press_until(surface, time)?;
            if crossings.is_empty() {
                (clean, pressed) = (time, shorter);
                best = surface.clone();
            } else {
                crossed = time;
                place = crossing_place(surface, &surface.image, crossings.pairs[0]);
            }
        }
        if clean == 0.0 {
            pressed = Pressed::default();
        }
        *surface = best;
        rewound = Some(Rewound { stopped_at: clean, sheets: closest_sheets(surface, &surface.image, place) });
    }
    let known = start.image.len();
    let moved = count_different(&start.image, &surface.image)
        + count_different(&surface.rest[known..], &surface.image[known..]);
    let Pressed { refinement, has_touched, is_through } = pressed;
    let pass = StrokePass {
        action: Action::Stamp { has_touched, is_through },
        refinement,
        moved,
        seconds: StageSeconds { advect: begin.elapsed().as_secs_f64(), ..StageSeconds::default() },
        rewound,
        volume: context.volume.map(|_| surface.image_volume()),
    };
    Ok((pass, pairs_tested))
}
