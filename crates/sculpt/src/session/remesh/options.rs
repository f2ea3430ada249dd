//! Options and result of a remesh.

use crate::session::{LockSkipped, SessionError};

/// Options of [`Session::remesh`](crate::session::Session::remesh).
///
/// ```
/// use isochore_mesh::{NoProgress, primitives::icosphere};
/// use isochore_sculpt::session::{RemeshOptions, Session, SessionOptions};
///
/// let mut session = Session::open(icosphere(1.0, 4), SessionOptions::default())?;
/// let options = RemeshOptions { edge_length: Some(0.2), ..RemeshOptions::default() };
/// let receipt = session.remesh(&options, &NoProgress)?;
/// assert!(receipt.triangles_after < receipt.triangles_before);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct RemeshOptions {
    /// Length of the edges, model units. `None`: as long as the deviation allows, so that flat
    /// regions get fewer triangles than curved ones.
    pub edge_length: Option<f64>,
    /// Largest distance between the surfaces before and after the remesh, as a fraction of the
    /// longest side of the bounding box of the mesh as opened. By default 1e-3, or a tenth of the
    /// edge length if that is given.
    pub deviation: Option<f64>,
    /// Maximum number of triangles; splits stop before they exceed it.
    pub max_triangles: usize,
}

/// Default deviation, as a fraction of the longest side.
const DEVIATION: f64 = 1e-3;

/// Default deviation, as a fraction of the edge length. Larger: details as large as an edge are
/// smoothed. Smaller: edges in curved regions stay shorter than asked for.
const DEVIATION_PER_EDGE: f64 = 0.1;

/// Longest sides of meshes, model units. Beyond, products of four lengths could overflow or vanish.
const SIZES: std::ops::RangeInclusive<f64> = 1e-60..=1e60;

/// Smallest allowed deviation, as a fraction of the longest side. Larger: precise meshes cannot be
/// remeshed precisely. Smaller: rounding errors count as deviations, and no edit is allowed.
const LEAST_ALLOWANCE: f64 = 1e-12;

impl Default for RemeshOptions {
    fn default() -> Self {
        Self { edge_length: None, deviation: None, max_triangles: 20_000_000 }
    }
}

impl RemeshOptions {
    /// The allowed deviation in model units, for a mesh with this longest side.
    ///
    /// # Errors
    /// [`SessionError::Remesh`].
    pub(super) fn allowance(&self, longest_side: f64) -> Result<f64, SessionError> {
        if !SIZES.contains(&longest_side) {
            return Err(SessionError::Remesh(
                "the longest side of the mesh must be from 1e-60 to 1e60; scale the mesh",
            ));
        }
        let is_positive = |number: f64| number > 0.0 && number.is_finite();
        if self.edge_length.is_some_and(|length| !is_positive(length)) {
            return Err(SessionError::Remesh("the edge length must be a positive, finite number"));
        }
        if self.deviation.is_some_and(|deviation| !is_positive(deviation)) {
            return Err(SessionError::Remesh("the deviation must be a positive, finite number"));
        }
        let allowance = match (self.deviation, self.edge_length) {
            (Some(deviation), _) => deviation * longest_side,
            (None, Some(length)) => DEVIATION_PER_EDGE * length,
            (None, None) => DEVIATION * longest_side,
        };
        Ok(allowance.clamp(LEAST_ALLOWANCE * longest_side, longest_side))
    }
}

/// Result of [`Session::remesh`](crate::session::Session::remesh).
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct RemeshReceipt {
    /// Number of triangles before.
    pub triangles_before: usize,
    /// Number of triangles after.
    pub triangles_after: usize,
    /// Edges that were split.
    pub splits: usize,
    /// Edges that were collapsed.
    pub collapses: usize,
    /// Edges that were flipped.
    pub flips: usize,
    /// Whether the limit on triangles prevented splits.
    pub is_limited: bool,
    /// Allowed distance between the surfaces before and after, model units.
    pub allowance: f64,
    /// Signed change of the volume before the lock, cubic model units. `None` if the surface is open.
    pub unlocked_volume_change: Option<f64>,
    /// Signed change of the volume, cubic model units. `None` if the surface is open.
    pub volume_change: Option<f64>,
    /// Longest displacement by the lock, model units. `None` if the lock was skipped.
    pub lock_max_shift: Option<f64>,
    /// Reason why the lock was skipped. `None` if it acted.
    pub lock_skipped: Option<LockSkipped>,
    /// Wall time, seconds; zero on platforms without a clock.
    pub seconds: f64,
    /// Bytes that undo holds for this remesh.
    pub undo_bytes: usize,
    /// Number of oldest steps that undo has forgotten to stay within its memory.
    pub forgotten_strokes: usize,
}
