//! The flow map: points carried through strokes, in parallel, each on its own.

use std::sync::atomic::{AtomicU64, AtomicUsize, Ordering};

use glam::DVec3;
use isochore_mesh::{Aabb, Cancelled, Monitor};
use rayon::prelude::*;

use crate::flow::Stroke;

/// Points that one task carries through all strokes. Larger balances worse and hears a cancellation later; smaller fills the
/// lanes of the kernel less well.
pub(crate) const CHUNK: usize = 256;

/// Where the strokes, one after the other, carry `points`. Points that nothing touches keep their bits, and the result does
/// not depend on the number of threads nor on the order of the points.
///
/// # Errors
/// [`AdvectError`].
pub fn advect_points(points: &[DVec3], strokes: &[Stroke], monitor: &dyn Monitor) -> Result<Vec<DVec3>, AdvectError> {
    if let Some(stroke) = strokes.iter().position(|stroke| matches!(stroke, Stroke::Stamp(_))) {
        return Err(AdvectError::Stamp { stroke });
    }
    let mut carried = points.to_vec();
    advect(&mut carried, strokes, monitor)?;
    Ok(carried)
}

/// Why points cannot be carried.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum AdvectError {
    /// The monitor stopped it.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
    /// A stroke needs a surface.
    #[error("stroke {stroke} is a stamp, which presses into a surface and raises it elsewhere; points alone have none")]
    Stamp {
        /// Index of the stroke, from 0.
        stroke: usize,
    },
}

/// What one stroke did to points.
#[derive(Debug, Default)]
pub(crate) struct Advected {
    /// Evaluations of the field.
    pub(crate) evaluations: u64,
    /// Indices of the points that it moved, in ascending order.
    pub(crate) moved: Vec<u32>,
}

/// Carries `points` through `strokes` in place, and returns the number of evaluations of the fields.
pub(crate) fn advect(points: &mut [DVec3], strokes: &[Stroke], monitor: &dyn Monitor) -> Result<u64, Cancelled> {
    let reaches: Vec<Aabb> = strokes.iter().map(Stroke::reach).collect();
    let evaluations = AtomicU64::new(0);
    for_each_chunk(points, monitor, |_, chunk| {
        let mut bounds = bounds(chunk);
        for (stroke, &reach) in strokes.iter().zip(&reaches) {
            if bounds.overlaps(reach) {
                evaluations.fetch_add(stroke.advect_chunk(chunk), Ordering::Relaxed);
                bounds = self::bounds(chunk);
            }
        }
    })?;
    Ok(evaluations.into_inner())
}

/// Carries `points` through one stroke in place. `bounds` are the boxes around each [`CHUNK`] of them.
pub(crate) fn advect_once(
    points: &mut [DVec3],
    bounds: &[Aabb],
    stroke: &Stroke,
    monitor: &dyn Monitor,
) -> Result<Advected, Cancelled> {
    let reach = stroke.reach();
    let passages = for_each_chunk(points, monitor, |index, chunk| {
        if !bounds[index].overlaps(reach) {
            return Advected::default();
        }
        let before = chunk.to_vec();
        let evaluations = stroke.advect_chunk(chunk);
        let is_moved = |place: &usize| bits(before[*place]) != bits(chunk[*place]);
        let moved = (0..chunk.len()).filter(is_moved).map(|place| (index * CHUNK + place) as u32).collect();
        Advected { evaluations, moved }
    })?;
    Ok(Advected {
        evaluations: passages.iter().map(|passage| passage.evaluations).sum(),
        moved: passages.into_iter().flat_map(|passage| passage.moved).collect(),
    })
}

/// What `work` gives for each chunk, by its number.
fn for_each_chunk<T: Send>(
    points: &mut [DVec3],
    monitor: &dyn Monitor,
    work: impl Fn(usize, &mut [DVec3]) -> T + Sync,
) -> Result<Vec<T>, Cancelled> {
    let done = AtomicUsize::new(0);
    let count = points.len() as f64;
    let chunks = points.par_chunks_mut(CHUNK).enumerate().map(|(index, chunk)| {
        let result = work(index, chunk);
        let done = done.fetch_add(chunk.len(), Ordering::Relaxed) + chunk.len();
        monitor.check("advect", done as f64 / count)?;
        Ok(result)
    });
    chunks.collect()
}

fn bounds(points: &[DVec3]) -> Aabb {
    Aabb::of(points.iter().copied())
}

/// By which the zeros of either sign are told apart.
pub(crate) fn bits(point: DVec3) -> [u64; 3] {
    point.to_array().map(f64::to_bits)
}
