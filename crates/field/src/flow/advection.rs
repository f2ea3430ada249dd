//! Advection: the flow map of strokes, applied to points in parallel.

use std::sync::atomic::{AtomicU64, AtomicUsize, Ordering};

use glam::DVec3;
use isochore_mesh::{Aabb, Cancelled, Monitor};
use rayon::prelude::*;

use crate::flow::Stroke;

/// Points that one task advects through all strokes. A larger value balances the load less well and
/// notices a cancellation later; a smaller value fills the lanes of the kernel less well.
pub(crate) const CHUNK: usize = 256;

/// Advects `points` through the strokes, one after the other.
///
/// A point that no stroke touches keeps its bits. The result does not depend on the number of threads
/// or on the order of the points.
///
/// ```
/// use glam::DVec3;
/// use isochore_field::{Stroke, Twist, advect_points};
/// use isochore_mesh::NoProgress;
///
/// let twist = |rate| Twist::new(DVec3::ZERO, DVec3::Z, rate).map(Stroke::Twist);
/// let points = [DVec3::new(0.3, -0.2, 0.7)];
/// let images = advect_points(&points, &[twist(1.0)?, twist(-1.0)?], &NoProgress)?;
/// assert!(images[0].distance(points[0]) < 1e-15);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`AdvectError::Stamp`] if a stroke is a stamp, [`AdvectError::Cancelled`] if `monitor` cancels.
pub fn advect_points(points: &[DVec3], strokes: &[Stroke], monitor: &dyn Monitor) -> Result<Vec<DVec3>, AdvectError> {
    if let Some(stroke) = strokes.iter().position(|stroke| matches!(stroke, Stroke::Stamp(_))) {
        return Err(AdvectError::Stamp { stroke });
    }
    let mut images = points.to_vec();
    advect(&mut images, strokes, monitor)?;
    Ok(images)
}

/// Errors of [`advect_points`].
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum AdvectError {
    /// The monitor cancelled the advection.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
    /// A stroke is a stamp, which needs a surface.
    #[error("stroke {stroke} is a stamp, which needs a surface and cannot advect points alone; remove it")]
    Stamp {
        /// Index of the stroke, from 0.
        stroke: usize,
    },
}

/// Result of advecting points through one stroke.
#[derive(Debug, Default)]
pub(crate) struct Advected {
    /// Evaluations of the field.
    pub(crate) evaluations: u64,
    /// Indices of the moved points, in ascending order.
    pub(crate) moved: Vec<u32>,
}

/// Advects `points` through `strokes` in place and returns the number of evaluations of the fields.
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

/// Advects `points` through one stroke in place. `bounds` holds a box around each [`CHUNK`] of points.
pub(crate) fn advect_once(
    points: &mut [DVec3],
    bounds: &[Aabb],
    stroke: &Stroke,
    monitor: &dyn Monitor,
) -> Result<Advected, Cancelled> {
    let reach = stroke.reach();
    let chunks = for_each_chunk(points, monitor, |index, chunk| {
        if !bounds[index].overlaps(reach) {
            return Advected::default();
        }
        let before = chunk.to_vec();
        let evaluations = stroke.advect_chunk(chunk);
        let is_moved = |point: &usize| bits(before[*point]) != bits(chunk[*point]);
        let moved = (0..chunk.len()).filter(is_moved).map(|point| (index * CHUNK + point) as u32).collect();
        Advected { evaluations, moved }
    })?;
    Ok(Advected {
        evaluations: chunks.iter().map(|chunk| chunk.evaluations).sum(),
        moved: chunks.into_iter().flat_map(|chunk| chunk.moved).collect(),
    })
}

/// The results of `work` for all chunks, in order. `work` receives the index of the chunk.
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

/// Bit patterns, so that +0 and −0 compare different.
pub(crate) fn bits(point: DVec3) -> [u64; 3] {
    point.to_array().map(f64::to_bits)
}
