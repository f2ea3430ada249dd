//! The errors of a deformation.

use isochore_mesh::{Cancelled, MeshError};

use super::{PressError, press::PressStop};

/// Errors of [`deform()`](crate::deform()).
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum DeformError {
    /// The monitor cancelled the deformation.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
    /// The mesh has an index out of range or a coordinate that is not finite.
    #[error(transparent)]
    Mesh(#[from] MeshError),
    /// A coordinate is beyond the range of `f64`.
    #[error("vertex {vertex} is moved beyond the range of f64; coordinates or strokes are too large")]
    Overflow {
        /// Index of the vertex, inserted ones included.
        vertex: usize,
    },
    /// A stamp cannot be pressed.
    #[error("stroke {stroke}: {source}")]
    Stamp {
        /// Index of the stroke, from 0.
        stroke: usize,
        /// Cause.
        source: PressError,
    },
    /// The volume of the input mesh is not finite.
    #[error("the volume is beyond the range of f64; coordinates are too large")]
    VolumeOverflow,
}

impl DeformError {
    /// The error of a stamp, stroke number `stroke`.
    pub(super) fn of_stamp(stroke: usize, stop: PressStop) -> Self {
        match stop {
            PressStop::Cancelled(cancelled) => Self::Cancelled(cancelled),
            PressStop::Stamp(source) => Self::Stamp { stroke, source },
        }
    }
}
