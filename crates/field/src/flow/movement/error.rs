//! The errors of a motion.

/// Most steps between two keys. A longer path is a mistake in the recipe, and the table of poses must fit
/// in memory.
pub(in crate::flow) const MAX_STEPS: usize = 1_000_000;

/// Errors of [`Move::new`](super::Move::new).
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum MoveError {
    /// The step is not a positive fraction.
    #[error("the step must be a positive fraction, not {0}")]
    Step(f64),
    /// A path needs two poses at least.
    #[error("the path needs at least two keys, not {0}")]
    TooFewKeys(usize),
    /// A coordinate of a pose is infinite or NaN.
    #[error("the poses of the path must be finite")]
    NotFinite,
    /// Two keys are half a turn apart.
    #[error(
        "keys {key} and {} are exactly 180° apart, so the direction of rotation is ambiguous; add a key between them",
        .key + 1
    )]
    HalfTurn {
        /// Index of the first of the two, from 0.
        key: usize,
    },
    /// The path is too long for its step.
    #[error("the path from key {key} takes {steps:.0} steps; at most {MAX_STEPS} are allowed")]
    TooManySteps {
        /// Index of the key at the start of the segment, from 0.
        key: usize,
        /// Steps it would take.
        steps: f64,
    },
}
