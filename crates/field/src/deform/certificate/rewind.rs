//! Rewinding: ends a stroke at its last moment without new crossings.

use glam::DVec3;
use isochore_mesh::Cancelled;

use super::{Crossings, Sheets, closest_sheets, crossing_place};
use crate::{
    deform::{passage::Context, tessellation::Tessellation},
    flow::{Stroke, advection::advect},
};

/// Halvings of the time in which the last moment is searched. A larger value keeps a little more of
/// the stroke; a smaller value ends it earlier.
pub(in crate::deform) const HALVINGS: usize = 5;

/// The last moment of a stroke without new crossings.
#[derive(Debug, Clone, Copy)]
pub(in crate::deform) struct Rewound {
    /// The moment, as a fraction of the time of the stroke.
    pub(in crate::deform) stopped_at: f64,
    /// The closest sheets at this moment among those that cross later.
    pub(in crate::deform) sheets: Option<Sheets>,
}

/// Finds the last moment of the last of `strokes` without new crossings. `crossings` are those at its
/// end, at least one. The surface does not change.
pub(in crate::deform) fn rewind(
    mesh: &Tessellation,
    strokes: &[Stroke],
    crossings: &Crossings,
    context: &Context<'_>,
) -> Result<Rewound, Cancelled> {
    let monitor = context.monitor;
    let [past @ .., stroke] = strokes else { return Ok(Rewound { stopped_at: 1.0, sheets: None }) };
    let mut start = mesh.base.clone();
    advect(&mut start, past, monitor)?;
    let at = |time: f64| -> Result<Vec<DVec3>, Cancelled> {
        let mut image = start.clone();
        advect(&mut image, &[stroke.truncated(time)], monitor)?;
        Ok(image)
    };
    let moved: Vec<u32> = (0..mesh.triangles.len() as u32).filter(|&index| mesh.has_moved(index as usize)).collect();
    let (mut clean, mut crossed) = (0.0, 1.0);
    let mut image = start.clone();
    let mut place = crossing_place(mesh, &mesh.image, crossings.pairs[0]);
    for halving in 0..HALVINGS {
        monitor.check("untangle", halving as f64 / HALVINGS as f64)?;
        let time = 0.5 * (clean + crossed);
        let positions = at(time)?;
        let found = Crossings::of(mesh, &positions, &moved, context)?;
        if found.is_empty() {
            (clean, image) = (time, positions);
        } else {
            (crossed, place) = (time, crossing_place(mesh, &positions, found.pairs[0]));
        }
    }
    Ok(Rewound { stopped_at: clean, sheets: closest_sheets(mesh, &image, place) })
}
