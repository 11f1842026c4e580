//! The functions of model exchange.

use fmi::fmi2::binding::*;

use super::calls::Call;
use super::{guarded, place, slice, slice_mut};
use crate::instance::{Fault, Instance};
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
            nominalsOfContinuousStatesChanged: update.nominals_changed.into(),
            valuesOfContinuousStatesChanged: update.states_changed.into(),
            nextEventTimeDefined: false.into(),
            nextEventTime: 0.0,
        };
        Ok(update.message)
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
    let (call, array) = (Call::GetContinuous, (derivatives, nx, "derivatives"));
    // SAFETY: the arguments are the host's, as they came.
    unsafe { fill::<M>(c, "fmi2GetDerivatives", call, array, Instance::derivatives) }
}

pub unsafe extern "C" fn fmi2GetEventIndicators<M: Model>(
    c: fmi2Component,
    eventIndicators: *mut fmi2Real,
    ni: usize,
) -> fmi2Status {
    let (call, array) = (
        Call::GetContinuous,
        (eventIndicators, ni, "eventIndicators"),
    );
    let of = Instance::event_indicators;
    // SAFETY: the arguments are the host's, as they came.
    unsafe { fill::<M>(c, "fmi2GetEventIndicators", call, array, of) }
}

pub unsafe extern "C" fn fmi2GetContinuousStates<M: Model>(
    c: fmi2Component,
    x: *mut fmi2Real,
    nx: usize,
) -> fmi2Status {
    let (call, array) = (Call::GetContinuous, (x, nx, "x"));
    let of = Instance::continuous_states;
    // SAFETY: the arguments are the host's, as they came.
    unsafe { fill::<M>(c, "fmi2GetContinuousStates", call, array, of) }
}

pub unsafe extern "C" fn fmi2GetNominalsOfContinuousStates<M: Model>(
    c: fmi2Component,
    x_nominal: *mut fmi2Real,
    nx: usize,
) -> fmi2Status {
    let (call, array) = (Call::GetNominals, (x_nominal, nx, "x_nominal"));
    let of = Instance::nominals_of_states;
    // SAFETY: the arguments are the host's, as they came.
    unsafe { fill::<M>(c, "fmi2GetNominalsOfContinuousStates", call, array, of) }
}

/// Fills an array of the host, given with its length and its name, with what the instance tells.
unsafe fn fill<M: Model>(
    c: fmi2Component,
    function: &str,
    call: Call,
    (array, count, name): (*mut fmi2Real, usize, &str),
    of: fn(&Instance<M>, &mut [f64]) -> Result<(), Fault>,
) -> fmi2Status {
    guarded::<M>(c, function, call, |component| {
        // SAFETY: the host's array has room for `count` values, or is null.
        let values = unsafe { slice_mut(array, count, name) }?;
        of(&component.instance, values)?;
        Ok(None)
    })
}
