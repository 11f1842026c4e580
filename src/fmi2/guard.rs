//! The way from C into an instance: the guard through which every call goes, and the host's
//! pointers as slices and texts.

use std::ffi::CStr;
use std::panic::{AssertUnwindSafe, catch_unwind};

use fmi::fmi2::binding::{fmi2Component, fmi2Status, fmi2Status_fmi2Error, fmi2Status_fmi2OK};
use libc::c_char;

use super::calls::Call;
use super::float_environment::FloatEnvironment;
use super::host::Host;
use crate::instance::{Event, Fault, Instance, Severity};
use crate::model::Model;

/// What stands behind an `fmi2Component`: an instance with its host.
pub struct Component<M: Model> {
    pub instance: Instance<M>,
    pub host: Host,
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
    // SAFETY: the pointer is the host's, as it came: null, or from `fmi2Instantiate`.
    let Some(component) = (unsafe { behind::<M>(component) }) else {
        return fmi2Status_fmi2Error;
    };
    if let Err(fault) = call.check(&component.instance) {
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
    // SAFETY: the pointer is the host's, as it came: null, or from `fmi2Instantiate`.
    match unsafe { behind::<M>(component) } {
        Some(component) => {
            call.is_permitted(&component.instance) && at_once(&mut component.instance)
        }
        None => false,
    }
}

/// The component behind a pointer, if it is not null.
///
/// # Safety
/// One that is not null comes from `fmi2Instantiate`, was not freed, and is used by one call at
/// a time: the host owes it to us (FMI 2.0, sections 2.1.6 and 2.1.7).
unsafe fn behind<'a, M: Model>(component: fmi2Component) -> Option<&'a mut Component<M>> {
    // SAFETY: null, or a live component that no other call uses, as the caller promises.
    unsafe { component.cast::<Component<M>>().as_mut() }
}

// ---- The host's pointers; a null one is a fault ----

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
        // SAFETY: not null, and `count` values that live during the call, as the caller promises.
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
        // SAFETY: not null, and `count` values that live during the call, as the caller promises.
        _ => Some(unsafe { std::slice::from_raw_parts_mut(values, count) }),
    }
}

/// `count` values to read; a null pointer is a fault.
///
/// # Safety
/// As for [`readable`].
pub unsafe fn slice<'a, T>(values: *const T, count: usize, what: &str) -> Result<&'a [T], Fault> {
    // SAFETY: null, or `count` values that live during the call, as the caller promises.
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
    // SAFETY: null, or `count` values that nobody else uses, as the caller promises.
    unsafe { writable(values, count) }.ok_or_else(|| null(what))
}

/// One value to write.
///
/// # Safety
/// As for [`writable`] with one value.
pub unsafe fn place<'a, T>(value: *mut T, what: &str) -> Result<&'a mut T, Fault> {
    // SAFETY: null, or one value that nobody else uses, as the caller promises.
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
    // SAFETY: not null, and characters that end with NUL, as the caller promises.
    Ok(unsafe { CStr::from_ptr(text) })
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
