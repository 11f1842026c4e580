//! What a host may ask about a step. Steps are done when `fmi2DoStep` returns: there is none to
//! wait for or to cancel.

use fmi::fmi2::binding::*;

use super::calls::Call;
use super::guard::{guarded, place};
use crate::instance::Fault;
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
    guarded::<M>(c, "fmi2GetStatus", Call::GetStatus, |component| {
        // SAFETY: the host points to a place for one value, or passes null.
        let value = unsafe { place(value, "value") }?;
        if s != fmi2StatusKind_fmi2DoStepStatus {
            return Err(no_such_status());
        }
        *value = if component.instance.last_step_was_discarded() {
            fmi2Status_fmi2Discard
        } else {
            fmi2Status_fmi2OK
        };
        Ok(None)
    })
}

pub unsafe extern "C" fn fmi2GetRealStatus<M: Model>(
    c: fmi2Component,
    s: fmi2StatusKind,
    value: *mut fmi2Real,
) -> fmi2Status {
    guarded::<M>(c, "fmi2GetRealStatus", Call::GetStatus, |component| {
        // SAFETY: the host points to a place for one value, or passes null.
        let value = unsafe { place(value, "value") }?;
        if s != fmi2StatusKind_fmi2LastSuccessfulTime {
            return Err(no_such_status());
        }
        *value = component.instance.last_successful_time();
        Ok(None)
    })
}

pub unsafe extern "C" fn fmi2GetBooleanStatus<M: Model>(
    c: fmi2Component,
    s: fmi2StatusKind,
    value: *mut fmi2Boolean,
) -> fmi2Status {
    guarded::<M>(c, "fmi2GetBooleanStatus", Call::GetStatus, |component| {
        // SAFETY: the host points to a place for one value, or passes null.
        let value = unsafe { place(value, "value") }?;
        if s != fmi2StatusKind_fmi2Terminated {
            return Err(no_such_status());
        }
        *value = component.instance.wants_to_terminate().into();
        Ok(None)
    })
}

pub unsafe extern "C" fn fmi2GetIntegerStatus<M: Model>(
    c: fmi2Component,
    _s: fmi2StatusKind,
    value: *mut fmi2Integer,
) -> fmi2Status {
    // SAFETY: the arguments are the host's, as they came.
    unsafe { get_no_status::<M, _>(c, "fmi2GetIntegerStatus", value) }
}

pub unsafe extern "C" fn fmi2GetStringStatus<M: Model>(
    c: fmi2Component,
    _s: fmi2StatusKind,
    value: *mut fmi2String,
) -> fmi2Status {
    // SAFETY: the arguments are the host's, as they came.
    unsafe { get_no_status::<M, _>(c, "fmi2GetStringStatus", value) }
}

/// Gets a status of a type in which there is nothing to tell.
unsafe fn get_no_status<M: Model, T>(
    c: fmi2Component,
    function: &str,
    value: *mut T,
) -> fmi2Status {
    guarded::<M>(c, function, Call::GetStatus, |_| {
        // SAFETY: the host points to a place for one value, or passes null.
        unsafe { place(value, "value") }?;
        Err(no_such_status())
    })
}

fn no_such_status() -> Fault {
    Fault::discard(
        "this status is not available: steps are done when fmi2DoStep returns; ask for \
         fmi2DoStepStatus (Status), fmi2LastSuccessfulTime (Real) or fmi2Terminated (Boolean)"
            .into(),
    )
}
