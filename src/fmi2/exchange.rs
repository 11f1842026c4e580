//! The functions of model exchange.

use fmi::fmi2::binding::*;

use super::calls::Call;
use super::guard::{guarded, place, slice, slice_mut};

use crate::model::Model;

pub unsafe extern "C" fn fmi2EnterEventMode<M: Model>(c: fmi2Component) -> fmi2Status {
    guarded::<M>(c, "fmi2EnterEventMode", Call::EnterEventMode, |component| {
        component.instance.enter_event_mode();
        Ok(None)
    })
}

pub unsafe extern "C" fn fmi2NewDiscreteStates<M: Model>(
    c: fmi2Component,
    fmi2eventInfo: *mut fmi2EventInfo,
) -> fmi2Status {
    guarded::<M>(c, "fmi2NewDiscreteStates", Call::HandleEvent, |component| {
        // SAFETY: the host points to its structure, or passes null.
        let info = unsafe { place(fmi2eventInfo, "fmi2eventInfo") }?;
        let update = component.instance.new_discrete_states()?;
        *info = fmi2EventInfo {
            newDiscreteStatesNeeded: false.into(),
            terminateSimulation: update.terminate.into(),
            nominalsOfContinuousStatesChanged: false.into(),
            valuesOfContinuousStatesChanged: update.states_changed.into(),
            nextEventTimeDefined: false.into(),
            nextEventTime: 0.0,
        };
        Ok(update.event)
    })
}

pub unsafe extern "C" fn fmi2EnterContinuousTimeMode<M: Model>(c: fmi2Component) -> fmi2Status {
    guarded::<M>(
        c,
        "fmi2EnterContinuousTimeMode",
        Call::HandleEvent,
        |component| {
            component.instance.enter_continuous_time();
            Ok(None)
        },
    )
}

pub unsafe extern "C" fn fmi2CompletedIntegratorStep<M: Model>(
    c: fmi2Component,
    _noSetFMUStatePriorToCurrentPoint: fmi2Boolean,
    enterEventMode: *mut fmi2Boolean,
    terminateSimulation: *mut fmi2Boolean,
) -> fmi2Status {
    guarded::<M>(
        c,
        "fmi2CompletedIntegratorStep",
        Call::Integrate,
        |component| {
            // SAFETY: the host points to a place for one value, or passes null.
            let event = unsafe { place(enterEventMode, "enterEventMode") }?;
            // SAFETY: the host points to a place for one value, or passes null.
            let terminate = unsafe { place(terminateSimulation, "terminateSimulation") }?;
            *event = component.instance.completed_integrator_step()?.into();
            *terminate = false.into();
            Ok(None)
        },
    )
}

pub unsafe extern "C" fn fmi2SetTime<M: Model>(c: fmi2Component, time: fmi2Real) -> fmi2Status {
    guarded::<M>(c, "fmi2SetTime", Call::SetTime, |component| {
        component.instance.set_time(time)?;
        Ok(None)
    })
}

pub unsafe extern "C" fn fmi2SetContinuousStates<M: Model>(
    c: fmi2Component,
    x: *const fmi2Real,
    nx: usize,
) -> fmi2Status {
    guarded::<M>(c, "fmi2SetContinuousStates", Call::Integrate, |component| {
        // SAFETY: the host's array holds `nx` values, or is null.
        let states = unsafe { slice(x, nx, "x") }?;
        component.instance.set_continuous_states(states)?;
        Ok(None)
    })
}

pub unsafe extern "C" fn fmi2GetDerivatives<M: Model>(
    c: fmi2Component,
    derivatives: *mut fmi2Real,
    nx: usize,
) -> fmi2Status {
    guarded::<M>(c, "fmi2GetDerivatives", Call::GetContinuous, |component| {
        // SAFETY: the host's array has room for `nx` values, or is null.
        let values = unsafe { slice_mut(derivatives, nx, "derivatives") }?;
        component.instance.derivatives(values)?;
        Ok(None)
    })
}

pub unsafe extern "C" fn fmi2GetEventIndicators<M: Model>(
    c: fmi2Component,
    eventIndicators: *mut fmi2Real,
    ni: usize,
) -> fmi2Status {
    guarded::<M>(
        c,
        "fmi2GetEventIndicators",
        Call::GetContinuous,
        |component| {
            // SAFETY: the host's array has room for `ni` values, or is null.
            let values = unsafe { slice_mut(eventIndicators, ni, "eventIndicators") }?;
            component.instance.event_indicators(values)?;
            Ok(None)
        },
    )
}

pub unsafe extern "C" fn fmi2GetContinuousStates<M: Model>(
    c: fmi2Component,
    x: *mut fmi2Real,
    nx: usize,
) -> fmi2Status {
    guarded::<M>(
        c,
        "fmi2GetContinuousStates",
        Call::GetContinuous,
        |component| {
            // SAFETY: the host's array has room for `nx` values, or is null.
            let values = unsafe { slice_mut(x, nx, "x") }?;
            component.instance.continuous_states(values)?;
            Ok(None)
        },
    )
}

pub unsafe extern "C" fn fmi2GetNominalsOfContinuousStates<M: Model>(
    c: fmi2Component,
    x_nominal: *mut fmi2Real,
    nx: usize,
) -> fmi2Status {
    guarded::<M>(
        c,
        "fmi2GetNominalsOfContinuousStates",
        Call::GetNominals,
        |component| {
            // SAFETY: the host's array has room for `nx` values, or is null.
            let values = unsafe { slice_mut(x_nominal, nx, "x_nominal") }?;
            component.instance.nominals_of_states(values)?;
            Ok(None)
        },
    )
}
