//! The C functions of FMI 2.0 (`fmi2Functions.h`): the only room with unsafe
//! code. Each function turns pointers into slices and delegates to one method
//! of the instance, inside the guard of `guard`.
//!
//! In this file: what a simulation calls from step to step. What begins and ends it is in
//! `lifecycle`, what is asked about a step in `status`.
//!
//! Safety of all of them: the host owes what the standard says, that is,
//! components from `fmi2Instantiate` that have not been freed and are used by
//! one call at a time, and arrays as long as their counts say. Null pointers
//! are answered with an error everywhere.
#![expect(unsafe_code, reason = "this room speaks C")]
#![expect(
    missing_docs,
    reason = "the FMI 2.0 standard documents these functions"
)]
#![expect(
    clippy::missing_safety_doc,
    reason = "said once, for all of them, above"
)]
#![expect(non_snake_case, reason = "names of the standard")]

mod calls;
mod envelope;
mod exchange;
pub mod float_environment;
mod guard;
mod host;
mod lifecycle;
mod signatures;
mod state;
mod status;

use fmi::fmi2::binding::*;

use crate::instance::{Instance, Type};
use crate::model::Model;
use calls::Call;
pub use exchange::*;
use guard::{done_at_once, guarded, guarded_in_place, readable, slice, slice_mut, writable};
pub use lifecycle::*;
pub use signatures::EXPORTED_NAMES;
pub use state::*;
pub use status::*;

/// The C types of the standard, for the crates that export its functions.
pub mod c {
    pub use fmi::fmi2::binding::*;
    pub use libc::c_char;
}

// ---- Get variables ----

pub unsafe extern "C" fn fmi2GetReal<M: Model>(
    c: fmi2Component,
    vr: *const fmi2ValueReference,
    nvr: usize,
    value: *mut fmi2Real,
) -> fmi2Status {
    let at_once = |instance: &mut Instance<M>| {
        // SAFETY: the host's arrays hold `nvr` values each, or are null.
        match unsafe { (readable(vr, nvr), writable(value, nvr)) } {
            (Some(&[reference]), Some([value])) => instance.get_stored(reference, value),
            _ => false,
        }
    };
    if done_at_once::<M>(c, Call::Get, at_once) {
        return fmi2Status_fmi2OK;
    }
    // SAFETY: the arguments are the host's, as they came.
    unsafe { get_real::<M>(c, vr, nvr, value) }
}

/// [`fmi2GetReal`] where something is to be worked out.
#[inline(never)]
unsafe fn get_real<M: Model>(
    c: fmi2Component,
    vr: *const fmi2ValueReference,
    nvr: usize,
    value: *mut fmi2Real,
) -> fmi2Status {
    guarded_in_place::<M>(c, "fmi2GetReal", Call::Get, |component| {
        // SAFETY: the host's array holds `nvr` value references, or is null.
        let references = unsafe { slice(vr, nvr, "vr") }?;
        // SAFETY: the host's array has room for `nvr` values, or is null.
        let values = unsafe { slice_mut(value, nvr, "value") }?;
        let store = |place: usize, number| values[place] = number;
        component.instance.get(Type::Real, references, store)?;
        Ok(None)
    })
}

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

pub unsafe extern "C" fn fmi2SetReal<M: Model>(
    c: fmi2Component,
    vr: *const fmi2ValueReference,
    nvr: usize,
    value: *const fmi2Real,
) -> fmi2Status {
    let at_once = |instance: &mut Instance<M>| {
        // SAFETY: the host's arrays hold `nvr` values each, or are null.
        match unsafe { (readable(vr, nvr), readable(value, nvr)) } {
            (Some(&[reference]), Some(&[value])) => instance.set_held(reference, value),
            (Some(references), Some(values)) => instance.set_all_held(references, values),
            _ => false,
        }
    };
    if done_at_once::<M>(c, Call::Set, at_once) {
        return fmi2Status_fmi2OK;
    }
    // Where an input does not keep its value, or is none.
    // SAFETY: the arguments are the host's, as they came.
    unsafe {
        set::<M, _>(c, "fmi2SetReal", Type::Real, (vr, value, nvr), |value| {
            value
        })
    }
}

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

/// Sets variables of one type; `convert` makes our values of its.
unsafe fn set<M: Model, T: Copy>(
    c: fmi2Component,
    function: &str,
    of: Type,
    (vr, value, nvr): (*const fmi2ValueReference, *const T, usize),
    convert: fn(T) -> f64,
) -> fmi2Status {
    guarded::<M>(c, function, Call::Set, |component| {
        // SAFETY: the host's array holds `nvr` value references, or is null.
        let references = unsafe { slice(vr, nvr, "vr") }?;
        // SAFETY: the host's array holds `nvr` values, or is null.
        let values = unsafe { slice(value, nvr, "value") }?;
        // One function for all types.
        let value: &dyn Fn(usize) -> f64 = &|place| convert(values[place]);
        component.instance.set(of, references, value)?;
        Ok(None)
    })
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

// ---- Step ----

pub unsafe extern "C" fn fmi2DoStep<M: Model>(
    c: fmi2Component,
    currentCommunicationPoint: fmi2Real,
    communicationStepSize: fmi2Real,
    _noSetFMUStatePriorToCurrentPoint: fmi2Boolean,
) -> fmi2Status {
    guarded_in_place::<M>(c, "fmi2DoStep", Call::DoStep, |component| {
        component
            .instance
            .do_step(currentCommunicationPoint, communicationStepSize)
    })
}

// ---- Export ----

/// Defines the C functions of FMI 2.0 for a model: all that the crate of an FMU needs.
#[macro_export]
macro_rules! export_fmi2 {
    ($model:ty) => {
        use $crate::fmi2::c::*;

        $crate::fmi2_functions!($crate::define_fmi2; $model);
    };
}

#[doc(hidden)]
#[macro_export]
macro_rules! define_fmi2 {
    ($model:ty; $($name:ident: $type:ident = ($($argument:ident: $of:ty),* $(,)?) $(-> $result:ty)?;)*) => {$(
        /// The function of the standard.
        ///
        /// # Safety
        /// The host owes what FMI 2.0 says.
        #[unsafe(no_mangle)]
        pub unsafe extern "C" fn $name($($argument: $of),*) $(-> $result)? {
            // SAFETY: the host's promise, passed on.
            unsafe { $crate::fmi2::$name::<$model>($($argument),*) }
        }

        const _: $type = Some($name);
    )*};
}
