//! The lesser and the greater of two numbers, for loops that run in vector registers.
//!
//! `min` and `max` of the standard library also say what becomes of NaN, which costs three instructions more a time.

/// The lesser of two numbers, neither of which is NaN.
#[inline(always)]
pub(crate) fn lesser<T: PartialOrd>(a: T, b: T) -> T {
    if a < b { a } else { b }
}

/// The greater of two numbers, neither of which is NaN.
#[inline(always)]
pub(crate) fn greater<T: PartialOrd>(a: T, b: T) -> T {
    if a > b { a } else { b }
}
