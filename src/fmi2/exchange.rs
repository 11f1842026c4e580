//! The functions of model exchange.

use fmi::fmi2::binding::*;

use super::component::guarded;
use super::pointers::{place, slice, slice_mut};
use crate::instance::Call;
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
        // SAFETY: see the head of this room.
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
            // SAFETY: see the head of this room.
            let event = unsafe { place(enterEventMode, "enterEventMode") }?;
            // SAFETY: see the head of this room.
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
        // SAFETY: see the head of this room.
        let states = unsafe { slice(x, nx, "x") }?;
        component.instance.set_continuous_states(states)?;
        Ok(None)
    })
}

/// Functions that fill an array of the host by a method of the instance.
macro_rules! fill {
    ($($function:ident($array:ident, $count:ident) by $method:ident as $call:ident;)*) => {$(
                pub unsafe extern "C" fn $function<M: Model>(
            c: fmi2Component,
            $array: *mut fmi2Real,
            $count: usize,
        ) -> fmi2Status {
            guarded::<M>(c, stringify!($function), Call::$call, |component| {
                // SAFETY: see the head of this room.
                let values = unsafe { slice_mut($array, $count, stringify!($array)) }?;
                component.instance.$method(values)?;
                Ok(None)
            })
        }
    )*};
}

fill! {
    fmi2GetDerivatives(derivatives, nx) by derivatives as GetContinuous;
    fmi2GetEventIndicators(eventIndicators, ni) by event_indicators as GetContinuous;
    fmi2GetContinuousStates(x, nx) by continuous_states as GetContinuous;
    fmi2GetNominalsOfContinuousStates(x_nominal, nx) by nominals_of_states as GetNominals;
}
