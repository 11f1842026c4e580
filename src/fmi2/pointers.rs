//! Pointers of the host as slices and texts; a null one is a fault.

use std::ffi::CStr;

use libc::c_char;

use crate::instance::Fault;

#[cold]
fn null(what: &str) -> Fault {
    Fault::error(format!("{what} is a null pointer"))
}

/// `count` values to read; nothing for a null pointer.
///
/// # Safety
/// `values` must be null or point to `count` values that live during the call.
#[inline]
pub unsafe fn readable<'a, T>(values: *const T, count: usize) -> Option<&'a [T]> {
    match (count, values.is_null()) {
        (0, _) => Some(&[]),
        (_, true) => None,
        // SAFETY: not null, and as many values as the host says (the caller's promise).
        _ => Some(unsafe { std::slice::from_raw_parts(values, count) }),
    }
}

/// `count` values to write; nothing for a null pointer.
///
/// # Safety
/// `values` must be null or point to `count` values that live during the call
/// and that nobody else uses.
#[inline]
pub unsafe fn writable<'a, T>(values: *mut T, count: usize) -> Option<&'a mut [T]> {
    match (count, values.is_null()) {
        (0, _) => Some(&mut []),
        (_, true) => None,
        // SAFETY: not null, and as many values as the host says (the caller's promise).
        _ => Some(unsafe { std::slice::from_raw_parts_mut(values, count) }),
    }
}

/// `count` values to read; a null pointer is a fault.
///
/// # Safety
/// As for [`readable`].
pub unsafe fn slice<'a, T>(values: *const T, count: usize, what: &str) -> Result<&'a [T], Fault> {
    // SAFETY: the caller's promise.
    unsafe { readable(values, count) }.ok_or_else(|| null(what))
}

/// `count` values to write; a null pointer is a fault.
///
/// # Safety
/// As for [`writable`].
pub unsafe fn slice_mut<'a, T>(
    values: *mut T,
    count: usize,
    what: &str,
) -> Result<&'a mut [T], Fault> {
    // SAFETY: the caller's promise.
    unsafe { writable(values, count) }.ok_or_else(|| null(what))
}

/// One value to write.
///
/// # Safety
/// As for [`writable`] with one value.
pub unsafe fn place<'a, T>(value: *mut T, what: &str) -> Result<&'a mut T, Fault> {
    // SAFETY: the caller's promise.
    unsafe { value.as_mut() }.ok_or_else(|| null(what))
}

/// A text.
///
/// # Safety
/// `text` must be null or point to characters that end with NUL and live
/// during the call.
pub unsafe fn text<'a>(text: *const c_char, what: &str) -> Result<&'a CStr, Fault> {
    if text.is_null() {
        return Err(null(what));
    }
    // SAFETY: not null and NUL-terminated (the caller's promise).
    Ok(unsafe { CStr::from_ptr(text) })
}
