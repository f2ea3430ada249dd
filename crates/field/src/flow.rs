//! The flow map: points carried through strokes, in parallel, each on its own.

use std::sync::atomic::{AtomicU64, Ordering};

use glam::DVec3;
use isochore_mesh::{Cancelled, Monitor};
use rayon::prelude::*;

use crate::Stroke;

/// Points that one task carries through all strokes. Larger balances worse and hears a cancellation later; smaller fills the
/// lanes of the kernel less well.
const CHUNK: usize = 256;

/// Where the strokes, one after the other, carry `points`. Points that nothing touches keep their bits, and the result does
/// not depend on the number of threads nor on the order of the points.
///
/// # Errors
/// [`FlowError`].
pub fn flow_points(points: &[DVec3], strokes: &[Stroke], monitor: &dyn Monitor) -> Result<Vec<DVec3>, FlowError> {
    if let Some(stroke) = strokes.iter().position(|stroke| matches!(stroke, Stroke::Stamp(_))) {
        return Err(FlowError::Stamp { stroke });
    }
    let mut carried = points.to_vec();
    advance(&mut carried, strokes, monitor)?;
    Ok(carried)
}

/// Why points cannot be carried.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum FlowError {
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

/// Carries `points` through `strokes` in place, and returns the number of evaluations of the fields.
pub(crate) fn advance(points: &mut [DVec3], strokes: &[Stroke], monitor: &dyn Monitor) -> Result<u64, Cancelled> {
    let (evaluations, done) = (AtomicU64::new(0), AtomicU64::new(0));
    let count = points.len() as f64;
    points.par_chunks_mut(CHUNK).try_for_each(|chunk| {
        for stroke in strokes {
            evaluations.fetch_add(stroke.advance(chunk), Ordering::Relaxed);
        }
        let done = done.fetch_add(chunk.len() as u64, Ordering::Relaxed) + chunk.len() as u64;
        monitor.check("advect", done as f64 / count)
    })?;
    Ok(evaluations.into_inner())
}
