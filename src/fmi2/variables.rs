//! The functions that get and set variables but for `fmi2SetReal` and `fmi2GetReal`, and those of derivatives.

use fmi::fmi2::binding::*;

use super::calls::Call;
use super::{guarded, set, slice, slice_mut};
use crate::instance::Type;
use crate::model::Model;

// ---- Get variables ----

pub unsafe extern "C" fn fmi2GetInteger<M: Model>(
    c: fmi2Component,
    vr: *const fmi2ValueReference,
    nvr: usize,
    value: *mut fmi2Integer,
) -> fmi2Status {
    let convert = |number| number as fmi2Integer;
    // SAFETY: the arguments are the host's, as they came.
    unsafe {
        get::<M, _>(
            c,
            "fmi2GetInteger",
            Type::Integer,
            (vr, value, nvr),
            convert,
        )
    }
}

pub unsafe extern "C" fn fmi2GetBoolean<M: Model>(
    c: fmi2Component,
    vr: *const fmi2ValueReference,
    nvr: usize,
    value: *mut fmi2Boolean,
) -> fmi2Status {
    let convert = |number| number as fmi2Boolean;
    // SAFETY: the arguments are the host's, as they came.
    unsafe {
        get::<M, _>(
            c,
            "fmi2GetBoolean",
            Type::Boolean,
            (vr, value, nvr),
            convert,
        )
    }
}

/// No model has a String variable: any value reference is refused.
pub unsafe extern "C" fn fmi2GetString<M: Model>(
    c: fmi2Component,
    vr: *const fmi2ValueReference,
    nvr: usize,
    value: *mut fmi2String,
) -> fmi2Status {
    let convert = |_| std::ptr::null();
    // SAFETY: the arguments are the host's, as they came.
    unsafe { get::<M, _>(c, "fmi2GetString", Type::String, (vr, value, nvr), convert) }
}

/// Gets variables of one type; `convert` makes its values of ours.
unsafe fn get<M: Model, T>(
    c: fmi2Component,
    function: &str,
    of: Type,
    (vr, value, nvr): (*const fmi2ValueReference, *mut T, usize),
    convert: fn(f64) -> T,
) -> fmi2Status {
    guarded::<M>(c, function, Call::Get, |component| {
        // SAFETY: the host's array holds `nvr` value references, or is null.
        let references = unsafe { slice(vr, nvr, "vr") }?;
        // SAFETY: the host's array has room for `nvr` values, or is null.
        let values = unsafe { slice_mut(value, nvr, "value") }?;
        // One function for all types.
        let store: &mut dyn FnMut(usize, f64) =
            &mut |place, number| values[place] = convert(number);
        component.instance.get(of, references, store)?;
        Ok(None)
    })
}

// ---- Set variables ----

pub unsafe extern "C" fn fmi2SetInteger<M: Model>(
    c: fmi2Component,
    vr: *const fmi2ValueReference,
    nvr: usize,
    value: *const fmi2Integer,
) -> fmi2Status {
    // SAFETY: the arguments are the host's, as they came.
    unsafe {
        set::<M, _>(
            c,
            "fmi2SetInteger",
            Type::Integer,
            (vr, value, nvr),
            f64::from,
        )
    }
}

pub unsafe extern "C" fn fmi2SetBoolean<M: Model>(
    c: fmi2Component,
    vr: *const fmi2ValueReference,
    nvr: usize,
    value: *const fmi2Boolean,
) -> fmi2Status {
    // SAFETY: the arguments are the host's, as they came.
    unsafe {
        set::<M, _>(
            c,
            "fmi2SetBoolean",
            Type::Boolean,
            (vr, value, nvr),
            f64::from,
        )
    }
}

/// No model has a String variable: any value reference is refused.
pub unsafe extern "C" fn fmi2SetString<M: Model>(
    c: fmi2Component,
    vr: *const fmi2ValueReference,
    nvr: usize,
    value: *const fmi2String,
) -> fmi2Status {
    // SAFETY: the arguments are the host's, as they came.
    unsafe { set::<M, _>(c, "fmi2SetString", Type::String, (vr, value, nvr), |_| 0.0) }
}

// ---- Derivatives ----

pub unsafe extern "C" fn fmi2GetDirectionalDerivative<M: Model>(
    c: fmi2Component,
    vUnknown_ref: *const fmi2ValueReference,
    nUnknown: usize,
    vKnown_ref: *const fmi2ValueReference,
    nKnown: usize,
    dvKnown: *const fmi2Real,
    dvUnknown: *mut fmi2Real,
) -> fmi2Status {
    guarded::<M>(
        c,
        "fmi2GetDirectionalDerivative",
        Call::DirectionalDerivative,
        |component| {
            // SAFETY: the host's array holds `nUnknown` value references, or is null.
            let unknowns = unsafe { slice(vUnknown_ref, nUnknown, "vUnknown_ref") }?;
            // SAFETY: the host's array holds `nKnown` value references, or is null.
            let knowns = unsafe { slice(vKnown_ref, nKnown, "vKnown_ref") }?;
            // SAFETY: the host's array holds `nKnown` values, or is null.
            let changes = unsafe { slice(dvKnown, nKnown, "dvKnown") }?;
            // SAFETY: the host's array has room for `nUnknown` values, or is null.
            let derivatives = unsafe { slice_mut(dvUnknown, nUnknown, "dvUnknown") }?;
            component.instance.directional_derivative(
                unknowns,
                knowns,
                changes,
                |place, value| derivatives[place] = value,
            )?;
            Ok(None)
        },
    )
}

pub unsafe extern "C" fn fmi2SetRealInputDerivatives<M: Model>(
    c: fmi2Component,
    vr: *const fmi2ValueReference,
    nvr: usize,
    order: *const fmi2Integer,
    value: *const fmi2Real,
) -> fmi2Status {
    guarded::<M>(
        c,
        "fmi2SetRealInputDerivatives",
        Call::SetInputDerivatives,
        |component| {
            // SAFETY: the host's array holds `nvr` value references, or is null.
            let references = unsafe { slice(vr, nvr, "vr") }?;
            // SAFETY: the host's array holds `nvr` orders, or is null.
            let orders = unsafe { slice(order, nvr, "order") }?;
            // SAFETY: the host's array holds `nvr` values, or is null.
            let values = unsafe { slice(value, nvr, "value") }?;
            component
                .instance
                .set_input_derivatives(references, orders, values)?;
            Ok(None)
        },
    )
}

pub unsafe extern "C" fn fmi2GetRealOutputDerivatives<M: Model>(
    c: fmi2Component,
    vr: *const fmi2ValueReference,
    nvr: usize,
    order: *const fmi2Integer,
    value: *mut fmi2Real,
) -> fmi2Status {
    guarded::<M>(
        c,
        "fmi2GetRealOutputDerivatives",
        Call::GetOutputDerivatives,
        |component| {
            // SAFETY: the host's array holds `nvr` value references, or is null.
            let references = unsafe { slice(vr, nvr, "vr") }?;
            // SAFETY: the host's array holds `nvr` orders, or is null.
            let orders = unsafe { slice(order, nvr, "order") }?;
            // SAFETY: the host's array has room for `nvr` values, or is null.
            let values = unsafe { slice_mut(value, nvr, "value") }?;
            component
                .instance
                .output_derivatives(references, orders, |place, number| values[place] = number)?;
            Ok(None)
        },
    )
}
