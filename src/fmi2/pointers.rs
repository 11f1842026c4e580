//! Pointers of the host as slices and texts; a null one is a fault.

use std::ffi::CStr;

use libc::c_char;

use crate::instance::Fault;

fn null(what: &str) -> Fault {
    Fault::error(format!("{what} is a null pointer"))
}

/// `count` values to read.
///
/// # Safety
/// `values` must be null or point to `count` values that live during the call.
pub unsafe fn slice<'a, T>(values: *const T, count: usize, what: &str) -> Result<&'a [T], Fault> {
    match (count, values.is_null()) {
        (0, _) => Ok(&[]),
        (_, true) => Err(null(what)),
        // SAFETY: not null, and as many values as the host says (the caller's promise).
        _ => Ok(unsafe { std::slice::from_raw_parts(values, count) }),
    }
}

/// `count` values to write.
///
/// # Safety
/// `values` must be null or point to `count` values that live during the call
/// and that nobody else uses.
pub unsafe fn slice_mut<'a, T>(
    values: *mut T,
    count: usize,
    what: &str,
) -> Result<&'a mut [T], Fault> {
    match (count, values.is_null()) {
        (0, _) => Ok(&mut []),
        (_, true) => Err(null(what)),
        // SAFETY: not null, and as many values as the host says (the caller's promise).
        _ => Ok(unsafe { std::slice::from_raw_parts_mut(values, count) }),
    }
}

/// One value to write.
///
/// # Safety
/// As for [`slice_mut`] with one value.
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
