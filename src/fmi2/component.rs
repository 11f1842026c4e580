//! What stands behind an `fmi2Component`: an instance and its host; and the
//! guard through which every call goes.

use std::ffi::{CStr, CString};
use std::panic::{AssertUnwindSafe, catch_unwind};

use fmi::fmi2::binding::{
    fmi2CallbackFunctions, fmi2Component, fmi2Status, fmi2Status_fmi2Discard, fmi2Status_fmi2Error,
    fmi2Status_fmi2Fatal, fmi2Status_fmi2OK, fmi2Status_fmi2Warning,
};

use super::float_environment::FloatEnvironment;
use crate::description::LOG_CATEGORIES;
use crate::instance::{Call, Event, Fault, Instance, Severity};
use crate::model::Model;

/// Log categories by their place in [`LOG_CATEGORIES`].
const EVENTS: usize = 0;
const WARNINGS: usize = 1;
const ERRORS: usize = 2;

/// An instance with its host.
pub struct Component<M: Model> {
    pub instance: Instance<M>,
    pub host: Host,
}

/// The host's side: who is told what.
pub struct Host {
    /// Copied by value: hosts may free or reuse the structure that they passed.
    callbacks: fmi2CallbackFunctions,
    name: CString,
    enabled: [bool; LOG_CATEGORIES.len()],
}

impl Host {
    pub fn new(callbacks: fmi2CallbackFunctions, name: &CStr, logging_on: bool) -> Host {
        let mut enabled = [true; LOG_CATEGORIES.len()];
        enabled[EVENTS] = logging_on;
        Host {
            callbacks,
            name: name.to_owned(),
            enabled,
        }
    }

    /// Switches categories on or off; none listed means all. Those that are
    /// not listed are switched off when others are switched on.
    pub fn set_logging(&mut self, on: bool, categories: &[&CStr]) -> Result<(), Fault> {
        let mut enabled = if on && !categories.is_empty() {
            [false; LOG_CATEGORIES.len()]
        } else if categories.is_empty() {
            [on; LOG_CATEGORIES.len()]
        } else {
            self.enabled
        };
        for wanted in categories {
            let known = LOG_CATEGORIES
                .iter()
                .position(|(name, _)| name.as_bytes() == wanted.to_bytes());
            let Some(place) = known else {
                let names = LOG_CATEGORIES.map(|(name, _)| name).join(", ");
                return Err(Fault::error(format!(
                    "there is no log category of that name; there are {names}"
                )));
            };
            enabled[place] = on;
        }
        self.enabled = enabled;
        Ok(())
    }

    fn log(&self, status: fmi2Status, category: usize, text: &str) {
        let Some(logger) = self.callbacks.logger else {
            return;
        };
        if !self.enabled[category] {
            return;
        }
        // The host takes the text for a printf format.
        let text: String = text.chars().filter(|&c| c != '%' && c != '\0').collect();
        let (Ok(category), Ok(text)) =
            (CString::new(LOG_CATEGORIES[category].0), CString::new(text))
        else {
            return;
        };
        // SAFETY: the logger is a function of the host with this signature
        // (FMI 2.0, section 2.1.5), all texts end with NUL and outlive the
        // call, and the format has no conversion that would ask for arguments.
        unsafe {
            logger(
                self.callbacks.componentEnvironment,
                self.name.as_ptr(),
                status,
                category.as_ptr(),
                text.as_ptr(),
            );
        }
    }

    /// Tells the host why a call was not done, and gives its status.
    #[cold]
    pub fn refuse(&self, function: &str, fault: Fault) -> fmi2Status {
        let (status, category) = match fault.severity {
            Severity::Discard => (fmi2Status_fmi2Discard, WARNINGS),
            Severity::Error => (fmi2Status_fmi2Error, ERRORS),
            Severity::Fatal => (fmi2Status_fmi2Fatal, ERRORS),
        };
        self.log(status, category, &format!("{function}: {}", fault.text));
        status
    }

    /// Tells the host of something in a call that was done, and gives its status.
    #[cold]
    fn announce(&self, function: &str, event: Event) -> fmi2Status {
        let (status, category) = if event.warning {
            (fmi2Status_fmi2Warning, WARNINGS)
        } else {
            (fmi2Status_fmi2OK, EVENTS)
        };
        self.log(status, category, &format!("{function}: {}", event.text));
        status
    }
}

/// Runs `body`; a panic in it becomes a fatal fault, and goes no further.
#[inline(always)]
fn contained<T>(body: impl FnOnce() -> Result<T, Fault>) -> Result<T, Fault> {
    catch_unwind(AssertUnwindSafe(body)).unwrap_or_else(|_| {
        Err(Fault {
            severity: Severity::Fatal,
            text: "an internal error; free this instance, if there is one, and report the fault"
                .into(),
        })
    })
}

/// Runs `body` in the default floating-point environment, the host's put back after it.
#[inline(always)]
fn computing<T>(body: impl FnOnce() -> T) -> T {
    let _environment = FloatEnvironment::entered();
    body()
}

/// The component of an instance that `make` makes, or null: the one way into an
/// instance's life. No panic leaves it.
pub fn instantiated<M: Model>(
    host: Host,
    make: impl FnOnce() -> Result<Instance<M>, Fault>,
) -> fmi2Component {
    match contained(|| computing(make)) {
        Ok(instance) => Box::into_raw(Box::new(Component { instance, host })).cast(),
        Err(fault) => {
            host.refuse("fmi2Instantiate", fault);
            std::ptr::null_mut()
        }
    }
}

/// Frees what a host has had, and the way out. No panic leaves it.
pub fn free<T>(owned: Box<T>) {
    // Nobody is left who could be told.
    let _ = contained(|| {
        drop(owned);
        Ok(())
    });
}

/// Runs `body` on the component behind the pointer, if the phase permits the call: the way from C
/// into the instance. No panic leaves it.
#[inline(always)]
pub fn guarded<M: Model>(
    component: fmi2Component,
    function: &str,
    call: Call,
    mut body: impl FnMut(&mut Component<M>) -> Result<Option<Event>, Fault>,
) -> fmi2Status {
    guarded_call(component, function, call, &mut body)
}

/// What a call does, as one type for all calls.
type Body<'a, M> = &'a mut dyn FnMut(&mut Component<M>) -> Result<Option<Event>, Fault>;

/// [`guarded`] for all calls of a model: once in the binary.
#[inline(never)]
fn guarded_call<M: Model>(
    component: fmi2Component,
    function: &str,
    call: Call,
    body: Body<M>,
) -> fmi2Status {
    guarded_in_place(component, function, call, body)
}

/// [`guarded`], the guard being compiled into the caller: for calls that must be fast.
#[inline(always)]
pub fn guarded_in_place<M: Model>(
    component: fmi2Component,
    function: &str,
    call: Call,
    body: impl FnOnce(&mut Component<M>) -> Result<Option<Event>, Fault>,
) -> fmi2Status {
    // SAFETY: see `behind`.
    let Some(component) = (unsafe { behind::<M>(component) }) else {
        return fmi2Status_fmi2Error;
    };
    if let Err(fault) = component.instance.check(call) {
        return component.host.refuse(function, fault);
    }
    match contained(|| computing(|| body(component))) {
        Ok(None) => fmi2Status_fmi2OK,
        Ok(Some(event)) => component.host.announce(function, event),
        Err(fault) => {
            if fault.severity == Severity::Fatal {
                component.instance.give_up();
            }
            component.host.refuse(function, fault)
        }
    }
}

/// Does a call without any arithmetic, where `at_once` can: it compares and copies only, and
/// cannot panic. It runs in the host's floating-point environment, which costs more to find out
/// than such a call takes. Returns whether the call is done; if not, nothing has changed.
#[inline(always)]
pub fn done_at_once<M: Model>(
    component: fmi2Component,
    call: Call,
    at_once: impl FnOnce(&mut Instance<M>) -> bool,
) -> bool {
    // SAFETY: see `behind`.
    match unsafe { behind::<M>(component) } {
        Some(component) => component.instance.permits(call) && at_once(&mut component.instance),
        None => false,
    }
}

/// The component behind a pointer, if it is not null.
///
/// # Safety
/// One that is not null comes from `fmi2Instantiate`, was not freed, and is used by one call at
/// a time: the host owes it to us (FMI 2.0, sections 2.1.6 and 2.1.7).
unsafe fn behind<'a, M: Model>(component: fmi2Component) -> Option<&'a mut Component<M>> {
    // SAFETY: the caller's promise.
    unsafe { component.cast::<Component<M>>().as_mut() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fmi2::*;
    use crate::instance::Interface;
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

    /// What panics while it is made is a fatal fault, and no component.
    #[test]
    fn a_panic_in_making_an_instance_leaves_none() {
        let panics =
            || -> Result<Instance<Nondimensional>, Fault> { panic!("what the test asks for") };
        let fault = contained(panics).expect_err("a panic");
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
