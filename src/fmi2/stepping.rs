//! The functions of co-simulation.

use fmi::fmi2::binding::*;

use super::component::{guarded, guarded_in_place};
use super::pointers::{place, slice, slice_mut};
use crate::instance::{Call, Fault};
use crate::model::Model;

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
            // SAFETY: see the head of this room.
            let references = unsafe { slice(vr, nvr, "vr") }?;
            // SAFETY: see the head of this room.
            let orders = unsafe { slice(order, nvr, "order") }?;
            // SAFETY: see the head of this room.
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
            // SAFETY: see the head of this room.
            let references = unsafe { slice(vr, nvr, "vr") }?;
            // SAFETY: see the head of this room.
            let orders = unsafe { slice(order, nvr, "order") }?;
            // SAFETY: see the head of this room.
            let values = unsafe { slice_mut(value, nvr, "value") }?;
            component
                .instance
                .output_derivatives(references, orders, |place, number| values[place] = number)?;
            Ok(None)
        },
    )
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
        // SAFETY: see the head of this room.
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
        // SAFETY: see the head of this room.
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
        // SAFETY: see the head of this room.
        let value = unsafe { place(value, "value") }?;
        if s != fmi2StatusKind_fmi2Terminated {
            return Err(no_such_status());
        }
        *value = component.instance.wants_to_terminate().into();
        Ok(None)
    })
}

/// Statuses of a type in which there is nothing to tell.
macro_rules! no_status {
    ($($function:ident: $value:ty;)*) => {$(
                pub unsafe extern "C" fn $function<M: Model>(
            c: fmi2Component,
            _s: fmi2StatusKind,
            value: *mut $value,
        ) -> fmi2Status {
            guarded::<M>(c, stringify!($function), Call::GetStatus, |_| {
                // SAFETY: see the head of this room.
                unsafe { place(value, "value") }?;
                Err(no_such_status())
            })
        }
    )*};
}

no_status! {
    fmi2GetIntegerStatus: fmi2Integer;
    fmi2GetStringStatus: fmi2String;
}

fn no_such_status() -> Fault {
    Fault::discard(
        "this status is not available: steps are done when fmi2DoStep returns; ask for \
         fmi2DoStepStatus (Status), fmi2LastSuccessfulTime (Real) or fmi2Terminated (Boolean)"
            .into(),
    )
}
