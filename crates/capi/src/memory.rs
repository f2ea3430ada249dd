//! Access to memory of the caller: handles, strings and arrays.

use std::{
    ffi::{CStr, CString, c_char},
    slice,
};

use bytemuck::{Pod, cast_slice};

use crate::error::Failure;

/// Dereferences a handle.
///
/// # Safety
/// `handle` is NULL or points to a value that does not change during `'a`.
pub(crate) unsafe fn reference<'a, T>(name: &str, handle: *const T) -> Result<&'a T, Failure> {
    // SAFETY: the caller guarantees it.
    unsafe { handle.as_ref() }.ok_or_else(|| Failure::argument(format!("{name} is NULL")))
}

/// Dereferences a handle mutably.
///
/// # Safety
/// `handle` is NULL or points to a value that is not accessed otherwise during `'a`.
pub(crate) unsafe fn reference_mut<'a, T>(name: &str, handle: *mut T) -> Result<&'a mut T, Failure> {
    // SAFETY: the caller guarantees it.
    unsafe { handle.as_mut() }.ok_or_else(|| Failure::argument(format!("{name} is NULL")))
}

/// Borrows a string of the caller.
///
/// # Safety
/// `text` is NULL or points to a NUL-terminated string that does not change during `'a`.
pub(crate) unsafe fn text<'a>(name: &str, text: *const c_char) -> Result<&'a str, Failure> {
    if text.is_null() {
        return Err(Failure::argument(format!("{name} is NULL")));
    }
    // SAFETY: the caller guarantees it.
    let text = unsafe { CStr::from_ptr(text) };
    text.to_str().map_err(|error| Failure::argument(format!("{name} is not valid UTF-8: {error}")))
}

/// Borrows an array of the caller. NULL is allowed if `count` is 0.
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
        return Err(Failure::argument(format!(
            "{name} is NULL, misaligned or too long for an array of {count} values"
        )));
    }
    // SAFETY: not NULL, aligned and not too long as checked above; the caller guarantees the rest.
    Ok(unsafe { slice::from_raw_parts(values, count) })
}

/// Copies `elements` elements of `each` numbers, all of which must be finite.
///
/// # Safety
/// `numbers` is NULL or points to `each` × `elements` numbers.
pub(crate) unsafe fn finite_values<N: Pod, T: Pod>(
    name: &str,
    numbers: *const N,
    each: usize,
    elements: usize,
    is_finite: impl Fn(N) -> bool,
) -> Result<Vec<T>, Failure> {
    // SAFETY: the caller guarantees it.
    let numbers = unsafe { array(name, numbers, each.saturating_mul(elements)) }?;
    match numbers.iter().position(|&number| !is_finite(number)) {
        Some(bad) => {
            let (element, index) = (bad / each, bad % each);
            Err(Failure::argument(format!("{name}: number {index} of element {element} is not finite")))
        }
        None => Ok(cast_slice(numbers).to_vec()),
    }
}

/// Allocates `value` and passes its ownership to the caller, who releases it through [`free`].
///
/// # Safety
/// `output` is NULL or writable.
pub(crate) unsafe fn hand_over<T>(name: &str, output: *mut *mut T, value: T) -> Result<(), Failure> {
    let handle = Box::into_raw(Box::new(value));
    // SAFETY: the caller guarantees it; on failure the new allocation is freed exactly once.
    unsafe { put(name, output, handle).inspect_err(|_| free(handle)) }
}

/// Writes a result through a required output pointer.
///
/// # Safety
/// `output` is NULL or writable.
pub(crate) unsafe fn put<T>(name: &str, output: *mut T, value: T) -> Result<(), Failure> {
    if output.is_null() {
        return Err(Failure::argument(format!("{name} is NULL")));
    }
    // SAFETY: the caller guarantees it.
    unsafe { output.write(value) };
    Ok(())
}

/// Writes a result through an output pointer that may be NULL.
///
/// # Safety
/// `output` is NULL or writable.
pub(crate) unsafe fn put_optional<T>(output: *mut T, value: T) {
    if !output.is_null() {
        // SAFETY: the caller guarantees it.
        unsafe { output.write(value) };
    }
}

/// Writes the address and the length of an array.
///
/// # Safety
/// `output` and `count` are NULL or writable.
pub(crate) unsafe fn put_slice<T>(
    name: &str,
    output: *mut *const T,
    count: *mut usize,
    values: &[T],
) -> Result<(), Failure> {
    // SAFETY: the caller guarantees it.
    unsafe {
        put(name, output, values.as_ptr())?;
        put("count", count, values.len())
    }
}

/// Copies values into an array of the caller.
///
/// # Safety
/// `output` is NULL or has space for all values.
pub(crate) unsafe fn copy_into<T: Copy>(name: &str, output: *mut T, values: &[T]) -> Result<(), Failure> {
    if values.is_empty() {
        return Ok(());
    }
    if output.is_null() || !output.is_aligned() {
        return Err(Failure::argument(format!("{name} is NULL or misaligned")));
    }
    // SAFETY: the caller guarantees it; the source belongs to this library and cannot overlap `output`.
    unsafe { output.copy_from_nonoverlapping(values.as_ptr(), values.len()) };
    Ok(())
}

/// Allocates a string and passes its ownership to the caller, who releases it through
/// [`isochore_text_free`].
///
/// # Safety
/// `output` is NULL or writable.
pub(crate) unsafe fn hand_over_text(name: &str, output: *mut *mut c_char, text: &str) -> Result<(), Failure> {
    let text = CString::new(text).map_err(|error| Failure::argument(format!("{name}: {error}")))?;
    let text = text.into_raw();
    // SAFETY: the caller guarantees it; on failure the new allocation is freed exactly once.
    unsafe { put(name, output, text).inspect_err(|_| isochore_text_free(text)) }
}

/// Frees a value that [`hand_over`] allocated.
///
/// # Safety
/// `handle` is NULL or came from [`hand_over`] and has not been freed.
pub(crate) unsafe fn free<T>(handle: *mut T) {
    if !handle.is_null() {
        // SAFETY: the caller guarantees it.
        drop(unsafe { Box::from_raw(handle) });
    }
}

/// Frees a string.
///
/// Preconditions: `text` is NULL or a string that this library allocated and that has not been
/// freed.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn isochore_text_free(text: *mut c_char) {
    if !text.is_null() {
        // SAFETY: the caller guarantees it.
        drop(unsafe { CString::from_raw(text) });
    }
}
