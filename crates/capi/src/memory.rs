//! What comes over the border: handles, texts and arrays of the caller.

use std::{
    ffi::{CStr, CString, c_char},
    slice,
};

use bytemuck::{Pod, cast_slice};

use crate::error::Failure;

/// The value that a handle stands for.
///
/// # Safety
/// `handle` is NULL or points to a value that nobody changes during `'a`.
pub(crate) unsafe fn reference<'a, T>(name: &str, handle: *const T) -> Result<&'a T, Failure> {
    // SAFETY: as the caller promises.
    unsafe { handle.as_ref() }.ok_or_else(|| Failure::argument(format!("{name} is NULL")))
}

/// The value that a handle stands for, to be changed.
///
/// # Safety
/// `handle` is NULL or points to a value that nobody else uses during `'a`.
pub(crate) unsafe fn reference_mut<'a, T>(name: &str, handle: *mut T) -> Result<&'a mut T, Failure> {
    // SAFETY: as the caller promises.
    unsafe { handle.as_mut() }.ok_or_else(|| Failure::argument(format!("{name} is NULL")))
}

/// A text of the caller's.
///
/// # Safety
/// `text` is NULL or points to a text that ends with a zero and does not change during `'a`.
pub(crate) unsafe fn text<'a>(name: &str, text: *const c_char) -> Result<&'a str, Failure> {
    if text.is_null() {
        return Err(Failure::argument(format!("{name} is NULL")));
    }
    // SAFETY: as the caller promises.
    let text = unsafe { CStr::from_ptr(text) };
    text.to_str().map_err(|error| Failure::argument(format!("{name} is not text in UTF-8: {error}")))
}

/// An array of the caller's; NULL stands for an empty one.
///
/// # Safety
/// `values` is NULL or points to `count` values that do not change during `'a`.
pub(crate) unsafe fn array<'a, T>(name: &str, values: *const T, count: usize) -> Result<&'a [T], Failure> {
    if count == 0 {
        return Ok(&[]);
    }
    if values.is_null()
        || !values.is_aligned()
        || size_of::<T>().checked_mul(count).is_none_or(|n| n > isize::MAX as usize)
    {
        return Err(Failure::argument(format!("{name} is no array of {count} values")));
    }
    // SAFETY: neither NULL nor unaligned nor too long; the rest as the caller promises.
    Ok(unsafe { slice::from_raw_parts(values, count) })
}

/// Values of `elements` elements with so many numbers each, all of which must be finite.
///
/// # Safety
/// `numbers` is NULL or points to as many numbers.
pub(crate) unsafe fn finite_values<N: Pod, T: Pod>(
    name: &str,
    numbers: *const N,
    each: usize,
    elements: usize,
    is_finite: impl Fn(N) -> bool,
) -> Result<Vec<T>, Failure> {
    // SAFETY: as the caller promises.
    let numbers = unsafe { array(name, numbers, each.saturating_mul(elements)) }?;
    match numbers.iter().position(|&number| !is_finite(number)) {
        Some(bad) => {
            let (element, place) = (bad / each, bad % each);
            Err(Failure::argument(format!("{name}: number {place} of element {element} is not finite")))
        }
        None => Ok(cast_slice(numbers).to_vec()),
    }
}

/// Hands `value` to the caller, who gives it back to [`free`].
///
/// # Safety
/// `place` is NULL or can be written to.
pub(crate) unsafe fn hand_over<T>(name: &str, place: *mut *mut T, value: T) -> Result<(), Failure> {
    let handle = Box::into_raw(Box::new(value));
    // SAFETY: as the caller promises; what could not be put there was just made.
    unsafe { put(name, place, handle).inspect_err(|_| free(handle)) }
}

/// Writes a result where the caller wants it.
///
/// # Safety
/// `place` is NULL or can be written to.
pub(crate) unsafe fn put<T>(name: &str, place: *mut T, value: T) -> Result<(), Failure> {
    if place.is_null() {
        return Err(Failure::argument(format!("{name} is NULL")));
    }
    // SAFETY: as the caller promises.
    unsafe { place.write(value) };
    Ok(())
}

/// Writes a result where the caller wants it, if anywhere.
///
/// # Safety
/// `place` is NULL or can be written to.
pub(crate) unsafe fn put_if_wanted<T>(place: *mut T, value: T) {
    if !place.is_null() {
        // SAFETY: as the caller promises.
        unsafe { place.write(value) };
    }
}

/// Writes where values lie and how many there are.
///
/// # Safety
/// `place` and `count` are NULL or can be written to.
pub(crate) unsafe fn put_slice<T>(
    name: &str,
    place: *mut *const T,
    count: *mut usize,
    values: &[T],
) -> Result<(), Failure> {
    // SAFETY: as the caller promises.
    unsafe {
        put(name, place, values.as_ptr())?;
        put("count", count, values.len())
    }
}

/// Copies values where the caller wants them.
///
/// # Safety
/// `place` is NULL or can be written to as many times as there are values.
pub(crate) unsafe fn fill<T: Copy>(name: &str, place: *mut T, values: &[T]) -> Result<(), Failure> {
    if values.is_empty() {
        return Ok(());
    }
    if place.is_null() || !place.is_aligned() {
        return Err(Failure::argument(format!("{name} is no array")));
    }
    // SAFETY: as the caller promises; what is read is memory of ours, which the caller cannot write to.
    unsafe { place.copy_from_nonoverlapping(values.as_ptr(), values.len()) };
    Ok(())
}

/// Hands a text to the caller, who gives it back to [`isochore_text_free`].
///
/// # Safety
/// `place` is NULL or can be written to.
pub(crate) unsafe fn hand_over_text(name: &str, place: *mut *mut c_char, text: &str) -> Result<(), Failure> {
    let text = CString::new(text).map_err(|error| Failure::argument(format!("{name}: {error}")))?;
    let text = text.into_raw();
    // SAFETY: as the caller promises; what could not be put there was just made.
    unsafe { put(name, place, text).inspect_err(|_| isochore_text_free(text)) }
}

/// Takes back what was [handed over](hand_over).
///
/// # Safety
/// `handle` is NULL or came from [`hand_over`] and was not taken back yet.
pub(crate) unsafe fn free<T>(handle: *mut T) {
    if !handle.is_null() {
        // SAFETY: as the caller promises.
        drop(unsafe { Box::from_raw(handle) });
    }
}

/// Gives a text back.
///
/// # Safety
/// `text` is NULL or came from a function of this library, and was not given back yet.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn isochore_text_free(text: *mut c_char) {
    if !text.is_null() {
        // SAFETY: as the caller promises.
        drop(unsafe { CString::from_raw(text) });
    }
}
