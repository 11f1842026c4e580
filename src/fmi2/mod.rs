//! The C functions of FMI 2.0 (`fmi2Functions.h`): the only room with unsafe
//! code. Each function turns pointers into slices and delegates to one method
//! of the instance, inside the guard of `component`.
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

mod component;
mod envelope;
mod exchange;
mod export;
pub mod float_environment;
mod pointers;
mod state;
mod stepping;

use std::ffi::CStr;

use fmi::fmi2::binding::*;
use libc::c_char;

use crate::instance::{Call, Fault, Instance, Interface, Type};
use crate::model::Model;
use component::{Component, Host, done_at_once, free, guarded, guarded_in_place, instantiated};
pub use exchange::*;
pub use export::EXPORTED_NAMES;
use pointers::{readable, slice, slice_mut, text, writable};
pub use state::*;
pub use stepping::*;

/// The C types of the standard, for the crates that export its functions.
pub mod c {
    pub use fmi::fmi2::binding::*;
    pub use libc::c_char;
}

// ---- Inquire version, create and destroy ----

pub unsafe extern "C" fn fmi2GetTypesPlatform<M: Model>() -> *const c_char {
    c"default".as_ptr()
}

pub unsafe extern "C" fn fmi2GetVersion<M: Model>() -> *const c_char {
    c"2.0".as_ptr()
}

pub unsafe extern "C" fn fmi2SetDebugLogging<M: Model>(
    c: fmi2Component,
    loggingOn: fmi2Boolean,
    nCategories: usize,
    categories: *const fmi2String,
) -> fmi2Status {
    guarded::<M>(
        c,
        "fmi2SetDebugLogging",
        Call::SetDebugLogging,
        |component| {
            // SAFETY: see the head of this file.
            let categories = unsafe { slice(categories, nCategories, "categories") }?;
            let categories: Result<Vec<&CStr>, Fault> = categories
                .iter()
                // SAFETY: see the head of this file.
                .map(|&category| unsafe { text(category, "a category") })
                .collect();
            component.host.set_logging(loggingOn != 0, &categories?)?;
            Ok(None)
        },
    )
}

pub unsafe extern "C" fn fmi2Instantiate<M: Model>(
    instanceName: fmi2String,
    fmuType: fmi2Type,
    fmuGUID: fmi2String,
    _fmuResourceLocation: fmi2String,
    functions: *const fmi2CallbackFunctions,
    _visible: fmi2Boolean,
    loggingOn: fmi2Boolean,
) -> fmi2Component {
    // SAFETY: null, or the host's structure (FMI 2.0, section 2.1.5).
    let Some(&callbacks) = (unsafe { functions.as_ref() }) else {
        return std::ptr::null_mut();
    };
    // SAFETY: see the head of this file.
    let name = unsafe { text(instanceName, "the instance name") };
    let host = Host::new(callbacks, name.as_ref().unwrap_or(&c""), loggingOn != 0);
    instantiated(host, || {
        if name?.is_empty() {
            return Err(Fault::error("the instance name is empty".into()));
        }
        let interface = if fmuType == fmi2Type_fmi2CoSimulation {
            Interface::CoSimulation
        } else if fmuType == fmi2Type_fmi2ModelExchange {
            Interface::ModelExchange
        } else {
            return Err(Fault::error(format!(
                "there is no FMU type {fmuType}; co-simulation and model exchange are offered"
            )));
        };
        // SAFETY: see the head of this file.
        let guid = unsafe { text(fmuGUID, "the GUID") }?;
        if guid.to_bytes() != M::GUID.as_bytes() {
            return Err(Fault::error(format!(
                "the GUID is not {}: binary and modelDescription.xml do not belong together",
                M::GUID
            )));
        }
        Ok(Instance::<M>::of(interface))
    })
}

pub unsafe extern "C" fn fmi2FreeInstance<M: Model>(c: fmi2Component) {
    if !c.is_null() {
        // SAFETY: made by `fmi2Instantiate`, and freed once (see the head).
        free(unsafe { Box::from_raw(c.cast::<Component<M>>()) });
    }
}

// ---- Enter and exit initialization, terminate, reset ----

pub unsafe extern "C" fn fmi2SetupExperiment<M: Model>(
    c: fmi2Component,
    toleranceDefined: fmi2Boolean,
    tolerance: fmi2Real,
    startTime: fmi2Real,
    stopTimeDefined: fmi2Boolean,
    stopTime: fmi2Real,
) -> fmi2Status {
    guarded::<M>(
        c,
        "fmi2SetupExperiment",
        Call::SetupExperiment,
        |component| {
            let tolerance = (toleranceDefined != 0).then_some(tolerance);
            let stop_time = (stopTimeDefined != 0).then_some(stopTime);
            component
                .instance
                .setup_experiment(tolerance, startTime, stop_time)
        },
    )
}

pub unsafe extern "C" fn fmi2EnterInitializationMode<M: Model>(c: fmi2Component) -> fmi2Status {
    guarded::<M>(
        c,
        "fmi2EnterInitializationMode",
        Call::EnterInitialization,
        |component| {
            component.instance.enter_initialization();
            Ok(None)
        },
    )
}

pub unsafe extern "C" fn fmi2ExitInitializationMode<M: Model>(c: fmi2Component) -> fmi2Status {
    guarded::<M>(
        c,
        "fmi2ExitInitializationMode",
        Call::ExitInitialization,
        |component| {
            component.instance.exit_initialization()?;
            Ok(None)
        },
    )
}

pub unsafe extern "C" fn fmi2Terminate<M: Model>(c: fmi2Component) -> fmi2Status {
    guarded::<M>(c, "fmi2Terminate", Call::Terminate, |component| {
        component.instance.terminate();
        Ok(None)
    })
}

pub unsafe extern "C" fn fmi2Reset<M: Model>(c: fmi2Component) -> fmi2Status {
    guarded::<M>(c, "fmi2Reset", Call::Reset, |component| {
        component.instance.reset();
        Ok(None)
    })
}

// ---- Get and set variables ----

/// The getter of one type; `$convert` makes its values of ours.
macro_rules! getter {
    ($function:ident, $value:ty, $type:expr, $convert:expr) => {
        pub unsafe extern "C" fn $function<M: Model>(
            c: fmi2Component,
            vr: *const fmi2ValueReference,
            nvr: usize,
            value: *mut $value,
        ) -> fmi2Status {
            guarded::<M>(c, stringify!($function), Call::Get, |component| {
                // SAFETY: see the head of this file.
                let references = unsafe { slice(vr, nvr, "vr") }?;
                // SAFETY: see the head of this file.
                let values = unsafe { slice_mut(value, nvr, "value") }?;
                let convert: fn(f64) -> $value = $convert;
                // One function for all types.
                let store: &mut dyn FnMut(usize, f64) =
                    &mut |place, number| values[place] = convert(number);
                component.instance.get($type, references, store)?;
                Ok(None)
            })
        }
    };
}

/// The setter of one type; `$convert` makes our values of its.
macro_rules! setter {
    ($visible:vis $function:ident, $name:literal, $value:ty, $type:expr, $convert:expr) => {
        $visible unsafe extern "C" fn $function<M: Model>(
            c: fmi2Component,
            vr: *const fmi2ValueReference,
            nvr: usize,
            value: *const $value,
        ) -> fmi2Status {
            guarded::<M>(c, $name, Call::Set, |component| {
                // SAFETY: see the head of this file.
                let references = unsafe { slice(vr, nvr, "vr") }?;
                // SAFETY: see the head of this file.
                let values = unsafe { slice(value, nvr, "value") }?;
                let convert: fn($value) -> f64 = $convert;
                // One function for all types.
                let value: &dyn Fn(usize) -> f64 = &|place| convert(values[place]);
                component.instance.set($type, references, value)?;
                Ok(None)
            })
        }
    };
}

getter!(fmi2GetInteger, fmi2Integer, Type::Integer, |number| number
    as fmi2Integer);
getter!(fmi2GetBoolean, fmi2Boolean, Type::Boolean, |number| number
    as fmi2Boolean);
getter!(fmi2GetString, fmi2String, Type::String, |_| std::ptr::null(
));
// Where an input does not keep its value, or is none.
setter!(set_real, "fmi2SetReal", fmi2Real, Type::Real, |value| value);
setter!(pub fmi2SetInteger, "fmi2SetInteger", fmi2Integer, Type::Integer, f64::from);
setter!(pub fmi2SetBoolean, "fmi2SetBoolean", fmi2Boolean, Type::Boolean, f64::from);
setter!(pub fmi2SetString, "fmi2SetString", fmi2String, Type::String, |_| 0.0);

pub unsafe extern "C" fn fmi2GetReal<M: Model>(
    c: fmi2Component,
    vr: *const fmi2ValueReference,
    nvr: usize,
    value: *mut fmi2Real,
) -> fmi2Status {
    let at_once = |instance: &mut Instance<M>| {
        // SAFETY: see the head of this file.
        match unsafe { (readable(vr, nvr), writable(value, nvr)) } {
            (Some(&[reference]), Some([value])) => instance.get_stored(reference, value),
            _ => false,
        }
    };
    if done_at_once::<M>(c, Call::Get, at_once) {
        return fmi2Status_fmi2OK;
    }
    // SAFETY: see the head of this file.
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
        // SAFETY: see the head of this file.
        let references = unsafe { slice(vr, nvr, "vr") }?;
        // SAFETY: see the head of this file.
        let values = unsafe { slice_mut(value, nvr, "value") }?;
        let store = |place: usize, number| values[place] = number;
        component.instance.get(Type::Real, references, store)?;
        Ok(None)
    })
}

pub unsafe extern "C" fn fmi2SetReal<M: Model>(
    c: fmi2Component,
    vr: *const fmi2ValueReference,
    nvr: usize,
    value: *const fmi2Real,
) -> fmi2Status {
    let at_once = |instance: &mut Instance<M>| {
        // SAFETY: see the head of this file.
        match unsafe { (readable(vr, nvr), readable(value, nvr)) } {
            (Some(&[reference]), Some(&[value])) => instance.set_held(reference, value),
            (Some(references), Some(values)) => instance.set_all_held(references, values),
            _ => false,
        }
    };
    if done_at_once::<M>(c, Call::Set, at_once) {
        return fmi2Status_fmi2OK;
    }
    // SAFETY: see the head of this file.
    unsafe { set_real::<M>(c, vr, nvr, value) }
}

// ---- Directional derivatives ----

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
            // SAFETY: see the head of this file.
            let unknowns = unsafe { slice(vUnknown_ref, nUnknown, "vUnknown_ref") }?;
            // SAFETY: see the head of this file.
            let knowns = unsafe { slice(vKnown_ref, nKnown, "vKnown_ref") }?;
            // SAFETY: see the head of this file.
            let changes = unsafe { slice(dvKnown, nKnown, "dvKnown") }?;
            // SAFETY: see the head of this file.
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
