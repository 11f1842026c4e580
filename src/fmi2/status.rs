//! What a host may ask about a step. A step is complete when `fmi2DoStep` returns, so a host can
//! neither wait for one nor cancel it.

use fmi::fmi2::binding::*;

use super::calls::Call;
use super::{guarded, place};
use crate::instance::{Fault, Instance};
use crate::model::Model;

pub unsafe extern "C" fn fmi2CancelStep<M: Model>(c: fmi2Component) -> fmi2Status {
    // No phase permits it, since no step is ever in progress.
    guarded::<M>(c, "fmi2CancelStep", Call::CancelStep, |_| Ok(None))
}

pub unsafe extern "C" fn fmi2GetStatus<M: Model>(
    c: fmi2Component,
    s: fmi2StatusKind,
    value: *mut fmi2Status,
) -> fmi2Status {
    let of = |instance: &Instance<M>| {
        let status = if instance.last_step_was_discarded() {
            fmi2Status_fmi2Discard
        } else {
            fmi2Status_fmi2OK
        };
        (s == fmi2StatusKind_fmi2DoStepStatus).then_some(status)
    };
    // SAFETY: the arguments are the host's, as they came.
    unsafe { get::<M, _>(c, "fmi2GetStatus", value, of) }
}

pub unsafe extern "C" fn fmi2GetRealStatus<M: Model>(
    c: fmi2Component,
    s: fmi2StatusKind,
    value: *mut fmi2Real,
) -> fmi2Status {
    let of = |instance: &Instance<M>| {
        (s == fmi2StatusKind_fmi2LastSuccessfulTime).then(|| instance.last_successful_time())
    };
    // SAFETY: the arguments are the host's, as they came.
    unsafe { get::<M, _>(c, "fmi2GetRealStatus", value, of) }
}

pub unsafe extern "C" fn fmi2GetBooleanStatus<M: Model>(
    c: fmi2Component,
    s: fmi2StatusKind,
    value: *mut fmi2Boolean,
) -> fmi2Status {
    let of = |instance: &Instance<M>| {
        (s == fmi2StatusKind_fmi2Terminated).then(|| instance.wants_to_terminate().into())
    };
    // SAFETY: the arguments are the host's, as they came.
    unsafe { get::<M, _>(c, "fmi2GetBooleanStatus", value, of) }
}

pub unsafe extern "C" fn fmi2GetIntegerStatus<M: Model>(
    c: fmi2Component,
    _s: fmi2StatusKind,
    value: *mut fmi2Integer,
) -> fmi2Status {
    // SAFETY: the arguments are the host's, as they came.
    unsafe { get::<M, _>(c, "fmi2GetIntegerStatus", value, |_| None) }
}

pub unsafe extern "C" fn fmi2GetStringStatus<M: Model>(
    c: fmi2Component,
    _s: fmi2StatusKind,
    value: *mut fmi2String,
) -> fmi2Status {
    // SAFETY: the arguments are the host's, as they came.
    unsafe { get::<M, _>(c, "fmi2GetStringStatus", value, |_| None) }
}

/// Gets a status, where there is one of the type and kind that is asked for.
unsafe fn get<M: Model, T>(
    c: fmi2Component,
    function: &str,
    value: *mut T,
    of: impl Fn(&Instance<M>) -> Option<T>,
) -> fmi2Status {
    guarded::<M>(c, function, Call::GetStatus, |component| {
        // SAFETY: the host points to a place for one value, or passes null.
        let value = unsafe { place(value, "value") }?;
        *value = of(&component.instance).ok_or_else(no_such_status)?;
        Ok(None)
    })
}

fn no_such_status() -> Fault {
    Fault::discard(
        "this status is not available: steps are done when fmi2DoStep returns; ask for \
         fmi2DoStepStatus (Status), fmi2LastSuccessfulTime (Real) or fmi2Terminated (Boolean)"
            .into(),
    )
}
