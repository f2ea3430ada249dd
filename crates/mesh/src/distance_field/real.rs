//! The floating-point types of the kernels.

use std::ops::{Add, AddAssign, Mul, Neg, Sub};

/// `f32` or `f64`.
pub(super) trait Real:
    Copy + PartialOrd + Add<Output = Self> + AddAssign + Sub<Output = Self> + Mul<Output = Self> + Neg<Output = Self>
{
    const ZERO: Self;

    /// Rounds to the nearest representable number.
    fn of(value: f64) -> Self;

    /// Converts exactly; every implementation includes `f32`.
    fn of_single(value: f32) -> Self;

    fn to_f64(self) -> f64;
}

impl Real for f32 {
    const ZERO: Self = 0.0;

    #[inline(always)]
    fn of(value: f64) -> Self {
        value as Self
    }

    #[inline(always)]
    fn of_single(value: f32) -> Self {
        value
    }

    #[inline(always)]
    fn to_f64(self) -> f64 {
        f64::from(self)
    }
}

impl Real for f64 {
    const ZERO: Self = 0.0;

    #[inline(always)]
    fn of(value: f64) -> Self {
        value
    }

    #[inline(always)]
    fn of_single(value: f32) -> Self {
        Self::from(value)
    }

    #[inline(always)]
    fn to_f64(self) -> f64 {
        self
    }
}
