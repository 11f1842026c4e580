//! The functions that begin and end an instance, and lead it into a simulation and out of it.

use std::ffi::CStr;

use fmi::fmi2::binding::*;
use libc::c_char;

use super::calls::Call;
use super::float_environment::in_default;
use super::host::Host;
use super::{Component, contained, guarded, null, slice};
use crate::instance::{Fault, Instance, Interface};
use crate::model::Model;

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
            // SAFETY: the host's array holds `nCategories` texts, or is null.
            let categories = unsafe { slice(categories, nCategories, "categories") }?;
            let categories: Result<Vec<&CStr>, Fault> = categories
                .iter()
                // SAFETY: the host's text ends with NUL, or is null.
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
    // SAFETY: the host's text ends with NUL, or is null.
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
        // SAFETY: the host's text ends with NUL, or is null.
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
        // SAFETY: `fmi2Instantiate` has made it of a `Box`, and the host frees it once.
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

/// The component of the instance that `make` returns, or null. Every instance is created here. No panic leaves
/// it.
fn instantiated<M: Model>(
    host: Host,
    make: impl FnOnce() -> Result<Instance<M>, Fault>,
) -> fmi2Component {
    match contained(|| in_default(make), Err) {
        Ok(instance) => Box::into_raw(Box::new(Component { instance, host })).cast(),
        Err(fault) => {
            host.refuse("fmi2Instantiate", fault);
            std::ptr::null_mut()
        }
    }
}

/// Frees something that the host owned. No panic leaves it.
fn free<T>(owned: Box<T>) {
    // There is no host left to report a panic to.
    contained(|| drop(owned), |_| ());
}

/// A text.
///
/// # Safety
/// `text` must be null or point to characters that end with NUL and live
/// during the call.
unsafe fn text<'a>(text: *const c_char, what: &str) -> Result<&'a CStr, Fault> {
    if text.is_null() {
        return Err(null(what));
    }
    // SAFETY: not null, and characters that end with NUL, as the caller promises.
    Ok(unsafe { CStr::from_ptr(text) })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fmi2::*;
    use crate::instance::Interface;
    use crate::instance::Severity;
    use crate::nondimensional::Nondimensional;

    fn host() -> Host {
        let callbacks = fmi2CallbackFunctions {
            logger: None,
            allocateMemory: None,
            freeMemory: None,
            stepFinished: None,
            componentEnvironment: std::ptr::null_mut(),
        };
        Host::new(callbacks, c"actuator", true)
    }

    /// A call that panics is answered with Fatal, and so is every call after it;
    /// the instance can still be freed.
    #[test]
    fn a_panic_does_not_leave_the_library() {
        let component = instantiated(host(), || {
            Ok(Instance::<Nondimensional>::of(Interface::CoSimulation))
        });
        let status = guarded::<Nondimensional>(
            component,
            "fmi2SetupExperiment",
            Call::SetupExperiment,
            |_| panic!("what the test asks for"),
        );
        assert_eq!(status, fmi2Status_fmi2Fatal);
        let mut state = std::ptr::null_mut();
        // SAFETY: a live component, and arrays as long as they are said to be.
        unsafe {
            for status in [
                fmi2GetReal::<Nondimensional>(component, &0, 1, &mut 0.0),
                fmi2SetReal::<Nondimensional>(component, &0, 1, &0.1),
                fmi2EnterInitializationMode::<Nondimensional>(component),
                fmi2DoStep::<Nondimensional>(component, 0.0, 0.1, 1),
                fmi2GetFMUstate::<Nondimensional>(component, &mut state),
                fmi2Terminate::<Nondimensional>(component),
                fmi2Reset::<Nondimensional>(component),
            ] {
                assert_eq!(status, fmi2Status_fmi2Fatal);
            }
            fmi2FreeInstance::<Nondimensional>(component);
        }
        assert!(state.is_null());
    }

    /// A panic during instantiation is a fatal fault, and there is no component.
    #[test]
    fn a_panic_in_making_an_instance_leaves_none() {
        let panics =
            || -> Result<Instance<Nondimensional>, Fault> { panic!("what the test asks for") };
        let fault = contained(panics, Err).expect_err("a panic");
        assert_eq!(fault.severity, Severity::Fatal);
        assert!(fault.text.contains("internal error"), "{}", fault.text);
        assert!(instantiated(host(), panics).is_null());
    }

    #[test]
    fn a_panic_in_freeing_goes_no_further() {
        struct Stubborn;
        impl Drop for Stubborn {
            fn drop(&mut self) {
                panic!("what the test asks for");
            }
        }
        free(Box::new(Stubborn));
    }
}
