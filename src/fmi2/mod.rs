//! The C functions of FMI 2.0 (`fmi2Functions.h`): the only room with unsafe
//! code. Each function turns pointers into slices and delegates to one method
//! of the instance, inside the guard.
//!
//! In this file: the guard, the host's pointers, and what a simulation calls from step to step:
//! `fmi2SetReal`, `fmi2DoStep`, `fmi2GetReal`. Beside it:
//!
//! * `lifecycle`, `variables`, `exchange`, `status`, `state`: the other functions;
//! * `calls`: which call each phase permits;
//! * `host`: the host's log; `envelope`: a saved state as bytes with a checksum;
//! * [`float_environment`]: the host's traps, flags and rounding, kept;
//! * `signatures`: the names of all functions, checked against their types by the compiler.
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
mod host;
mod lifecycle;
mod signatures;
mod state;
mod status;
mod variables;

use std::panic::{AssertUnwindSafe, catch_unwind};

use fmi::fmi2::binding::*;

use crate::instance::{Fault, Instance, Message, Severity, Type};
use crate::model::Model;
use calls::Call;
pub use exchange::*;
use float_environment::in_default;
use host::Host;
pub use lifecycle::*;
pub use signatures::EXPORTED_NAMES;
pub use state::*;
pub use status::*;
pub use variables::*;

/// The C types of the standard, for the crates that export its functions.
pub mod c {
    pub use fmi::fmi2::binding::*;
    pub use libc::c_char;
}

// ---- The guard ----

/// What stands behind an `fmi2Component`: an instance with its host.
struct Component<M: Model> {
    instance: Instance<M>,
    host: Host,
}

/// Runs `body`. A panic in it is caught, and the result is then that of `failed` for a fatal fault.
#[inline(always)]
fn contained<T>(body: impl FnOnce() -> T, failed: impl FnOnce(Fault) -> T) -> T {
    catch_unwind(AssertUnwindSafe(body)).unwrap_or_else(|_| {
        failed(Fault {
            severity: Severity::Fatal,
            text: "an internal error; free this instance, if there is one, and report the fault"
                .into(),
        })
    })
}

/// Runs `body` on the component behind the pointer, if the phase permits the call: the way from C
/// into the instance. No panic leaves it.
#[inline(always)]
fn guarded<M: Model>(
    component: fmi2Component,
    function: &str,
    call: Call,
    mut body: impl FnMut(&mut Component<M>) -> Result<Option<Message>, Fault>,
) -> fmi2Status {
    guarded_call(component, function, call, &mut body)
}

/// What a call does, as one type for all calls.
type Body<'a, M> = &'a mut dyn FnMut(&mut Component<M>) -> Result<Option<Message>, Fault>;

/// [`guarded`] for most calls of a model: not inlined, so that the binary has it once.
#[inline(never)]
fn guarded_call<M: Model>(
    component: fmi2Component,
    function: &str,
    call: Call,
    body: Body<M>,
) -> fmi2Status {
    guarded_in_place(component, function, call, body)
}

/// [`guarded`], inlined: for calls that must be fast.
#[inline(always)]
fn guarded_in_place<M: Model>(
    component: fmi2Component,
    function: &str,
    call: Call,
    body: impl FnOnce(&mut Component<M>) -> Result<Option<Message>, Fault>,
) -> fmi2Status {
    // SAFETY: the pointer is the host's, as it came: null, or from `fmi2Instantiate`.
    let Some(component) = (unsafe { behind::<M>(component) }) else {
        return fmi2Status_fmi2Error;
    };
    if let Err(fault) = call.check(&component.instance) {
        return component.host.refuse(function, fault);
    }
    // Boxed, so that the usual result, which is nothing, is small.
    let body = || match body(component) {
        Ok(None) => None,
        told => Some(Box::new(told)),
    };
    match contained(|| in_default(body), |fault| Some(Box::new(Err(fault)))) {
        None => fmi2Status_fmi2OK,
        Some(told) => component.tell(function, *told),
    }
}

impl<M: Model> Component<M> {
    /// Tells the host what has happened in a call.
    #[cold]
    fn tell(&mut self, function: &str, told: Result<Option<Message>, Fault>) -> fmi2Status {
        match told {
            Ok(None) => fmi2Status_fmi2OK,
            Ok(Some(message)) => self.host.announce(function, message),
            Err(fault) => {
                if fault.severity == Severity::Fatal {
                    self.instance.give_up();
                }
                self.host.refuse(function, fault)
            }
        }
    }
}

/// Does a call by `at_once`, if that can. `at_once` compares and copies only, and cannot panic. It runs in the
/// host's floating-point environment: changing that takes longer than such a call. Returns whether the call
/// is done; if not, nothing has changed.
#[inline(always)]
fn done_at_once<M: Model>(
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
unsafe fn readable<'a, T>(values: *const T, count: usize) -> Option<&'a [T]> {
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
unsafe fn writable<'a, T>(values: *mut T, count: usize) -> Option<&'a mut [T]> {
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
unsafe fn slice<'a, T>(values: *const T, count: usize, what: &str) -> Result<&'a [T], Fault> {
    // SAFETY: null, or `count` values that live during the call, as the caller promises.
    unsafe { readable(values, count) }.ok_or_else(|| null(what))
}

/// `count` values to write; a null pointer is a fault.
///
/// # Safety
/// As for [`writable`].
unsafe fn slice_mut<'a, T>(values: *mut T, count: usize, what: &str) -> Result<&'a mut [T], Fault> {
    // SAFETY: null, or `count` values that nobody else uses, as the caller promises.
    unsafe { writable(values, count) }.ok_or_else(|| null(what))
}

/// One value to write.
///
/// # Safety
/// As for [`writable`] with one value.
unsafe fn place<'a, T>(value: *mut T, what: &str) -> Result<&'a mut T, Fault> {
    // SAFETY: null, or one value that nobody else uses, as the caller promises.
    unsafe { value.as_mut() }.ok_or_else(|| null(what))
}

// ---- From step to step ----

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
            _ => false,
        }
    };
    if done_at_once::<M>(c, Call::Set, at_once) {
        return fmi2Status_fmi2OK;
    }
    // SAFETY: the arguments are the host's, as they came.
    unsafe { set_real::<M>(c, vr, nvr, value) }
}

/// [`fmi2SetReal`] of other than one held input. It has the C calling convention, so that the compiler makes a jump
/// of its call.
#[inline(never)]
unsafe extern "C" fn set_real<M: Model>(
    c: fmi2Component,
    vr: *const fmi2ValueReference,
    nvr: usize,
    value: *const fmi2Real,
) -> fmi2Status {
    let at_once = |instance: &mut Instance<M>| {
        // SAFETY: the host's arrays hold `nvr` values each, or are null.
        match unsafe { (readable(vr, nvr), readable(value, nvr)) } {
            (Some(references), Some(values)) => instance.set_all_held(references, values),
            _ => false,
        }
    };
    if done_at_once::<M>(c, Call::Set, at_once) {
        return fmi2Status_fmi2OK;
    }
    // Where an input follows a polynomial, or the variable is not an input.
    // SAFETY: the arguments are the host's, as they came.
    unsafe {
        set::<M, _>(c, "fmi2SetReal", Type::Real, (vr, value, nvr), |value| {
            value
        })
    }
}

/// Sets variables of one type; `convert` makes our values of its.
#[inline(never)]
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

/// [`fmi2GetReal`] where a result must be computed. It has the C calling convention, so that the compiler makes
/// a jump of its call.
#[inline(never)]
unsafe extern "C" fn get_real<M: Model>(
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
