//! Minimum and maximum for loops that run in vector registers.
//!
//! `f64::min` and `f64::max` also handle NaN, which costs three more instructions per call.

/// The smaller of two numbers; neither may be NaN.
#[inline(always)]
pub(crate) fn min<T: PartialOrd>(a: T, b: T) -> T {
    if a < b { a } else { b }
}

/// The larger of two numbers; neither may be NaN.
#[inline(always)]
pub(crate) fn max<T: PartialOrd>(a: T, b: T) -> T {
    if a > b { a } else { b }
}
