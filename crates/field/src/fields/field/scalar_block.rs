//! A scalar function of space at the points of a block.

use isochore_mesh::{LANES, PointBlock};

/// Values and gradients of a scalar function at the points of a block.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ScalarBlock {
    /// Values.
    pub value: [f64; LANES],
    /// Gradients.
    pub gradient: PointBlock,
}

impl ScalarBlock {
    /// Zero everywhere.
    pub const ZERO: Self = Self { value: [0.0; LANES], gradient: PointBlock::ZERO };

    /// One everywhere.
    pub const ONE: Self = Self { value: [1.0; LANES], gradient: PointBlock::ZERO };
}
