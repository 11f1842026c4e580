//! The names and signatures of the functions of the standard, in one list that the compiler holds
//! against the bindings of the header.

use fmi::fmi2::binding::*;

use super::*;
use crate::nondimensional::Nondimensional;

/// Calls a macro with the list and further arguments.
#[doc(hidden)]
#[macro_export]
macro_rules! fmi2_functions {
    ($callback:path; $($given:tt)*) => {
        $callback! {
            $($given)*;
            fmi2GetTypesPlatform: fmi2GetTypesPlatformTYPE = () -> *const c_char;
            fmi2GetVersion: fmi2GetVersionTYPE = () -> *const c_char;
            fmi2SetDebugLogging: fmi2SetDebugLoggingTYPE = (
                c: fmi2Component,
                loggingOn: fmi2Boolean,
                nCategories: usize,
                categories: *const fmi2String,
            ) -> fmi2Status;
            fmi2Instantiate: fmi2InstantiateTYPE = (
                instanceName: fmi2String,
                fmuType: fmi2Type,
                fmuGUID: fmi2String,
                fmuResourceLocation: fmi2String,
                functions: *const fmi2CallbackFunctions,
                visible: fmi2Boolean,
                loggingOn: fmi2Boolean,
            ) -> fmi2Component;
            fmi2FreeInstance: fmi2FreeInstanceTYPE = (c: fmi2Component);
            fmi2SetupExperiment: fmi2SetupExperimentTYPE = (
                c: fmi2Component,
                toleranceDefined: fmi2Boolean,
                tolerance: fmi2Real,
                startTime: fmi2Real,
                stopTimeDefined: fmi2Boolean,
                stopTime: fmi2Real,
            ) -> fmi2Status;
            fmi2EnterInitializationMode: fmi2EnterInitializationModeTYPE = (
                c: fmi2Component,
            ) -> fmi2Status;
            fmi2ExitInitializationMode: fmi2ExitInitializationModeTYPE = (
                c: fmi2Component,
            ) -> fmi2Status;
            fmi2Terminate: fmi2TerminateTYPE = (c: fmi2Component) -> fmi2Status;
            fmi2Reset: fmi2ResetTYPE = (c: fmi2Component) -> fmi2Status;
            fmi2GetReal: fmi2GetRealTYPE = (
                c: fmi2Component,
                vr: *const fmi2ValueReference,
                nvr: usize,
                value: *mut fmi2Real,
            ) -> fmi2Status;
            fmi2GetInteger: fmi2GetIntegerTYPE = (
                c: fmi2Component,
                vr: *const fmi2ValueReference,
                nvr: usize,
                value: *mut fmi2Integer,
            ) -> fmi2Status;
            fmi2GetBoolean: fmi2GetBooleanTYPE = (
                c: fmi2Component,
                vr: *const fmi2ValueReference,
                nvr: usize,
                value: *mut fmi2Boolean,
            ) -> fmi2Status;
            fmi2GetString: fmi2GetStringTYPE = (
                c: fmi2Component,
                vr: *const fmi2ValueReference,
                nvr: usize,
                value: *mut fmi2String,
            ) -> fmi2Status;
            fmi2SetReal: fmi2SetRealTYPE = (
                c: fmi2Component,
                vr: *const fmi2ValueReference,
                nvr: usize,
                value: *const fmi2Real,
            ) -> fmi2Status;
            fmi2SetInteger: fmi2SetIntegerTYPE = (
                c: fmi2Component,
                vr: *const fmi2ValueReference,
                nvr: usize,
                value: *const fmi2Integer,
            ) -> fmi2Status;
            fmi2SetBoolean: fmi2SetBooleanTYPE = (
                c: fmi2Component,
                vr: *const fmi2ValueReference,
                nvr: usize,
                value: *const fmi2Boolean,
            ) -> fmi2Status;
            fmi2SetString: fmi2SetStringTYPE = (
                c: fmi2Component,
                vr: *const fmi2ValueReference,
                nvr: usize,
                value: *const fmi2String,
            ) -> fmi2Status;
            fmi2GetFMUstate: fmi2GetFMUstateTYPE = (
                c: fmi2Component,
                FMUstate: *mut fmi2FMUstate,
            ) -> fmi2Status;
            fmi2SetFMUstate: fmi2SetFMUstateTYPE = (
                c: fmi2Component,
                FMUstate: fmi2FMUstate,
            ) -> fmi2Status;
            fmi2FreeFMUstate: fmi2FreeFMUstateTYPE = (
                c: fmi2Component,
                FMUstate: *mut fmi2FMUstate,
            ) -> fmi2Status;
            fmi2SerializedFMUstateSize: fmi2SerializedFMUstateSizeTYPE = (
                c: fmi2Component,
                FMUstate: fmi2FMUstate,
                size: *mut usize,
            ) -> fmi2Status;
            fmi2SerializeFMUstate: fmi2SerializeFMUstateTYPE = (
                c: fmi2Component,
                FMUstate: fmi2FMUstate,
                serializedState: *mut fmi2Byte,
                size: usize,
            ) -> fmi2Status;
            fmi2DeSerializeFMUstate: fmi2DeSerializeFMUstateTYPE = (
                c: fmi2Component,
                serializedState: *const fmi2Byte,
                size: usize,
                FMUstate: *mut fmi2FMUstate,
            ) -> fmi2Status;
            fmi2GetDirectionalDerivative: fmi2GetDirectionalDerivativeTYPE = (
                c: fmi2Component,
                vUnknown_ref: *const fmi2ValueReference,
                nUnknown: usize,
                vKnown_ref: *const fmi2ValueReference,
                nKnown: usize,
                dvKnown: *const fmi2Real,
                dvUnknown: *mut fmi2Real,
            ) -> fmi2Status;
            fmi2EnterEventMode: fmi2EnterEventModeTYPE = (c: fmi2Component) -> fmi2Status;
            fmi2NewDiscreteStates: fmi2NewDiscreteStatesTYPE = (
                c: fmi2Component,
                fmi2eventInfo: *mut fmi2EventInfo,
            ) -> fmi2Status;
            fmi2EnterContinuousTimeMode: fmi2EnterContinuousTimeModeTYPE = (
                c: fmi2Component,
            ) -> fmi2Status;
            fmi2CompletedIntegratorStep: fmi2CompletedIntegratorStepTYPE = (
                c: fmi2Component,
                noSetFMUStatePriorToCurrentPoint: fmi2Boolean,
                enterEventMode: *mut fmi2Boolean,
                terminateSimulation: *mut fmi2Boolean,
            ) -> fmi2Status;
            fmi2SetTime: fmi2SetTimeTYPE = (c: fmi2Component, time: fmi2Real) -> fmi2Status;
            fmi2SetContinuousStates: fmi2SetContinuousStatesTYPE = (
                c: fmi2Component,
                x: *const fmi2Real,
                nx: usize,
            ) -> fmi2Status;
            fmi2GetDerivatives: fmi2GetDerivativesTYPE = (
                c: fmi2Component,
                derivatives: *mut fmi2Real,
                nx: usize,
            ) -> fmi2Status;
            fmi2GetEventIndicators: fmi2GetEventIndicatorsTYPE = (
                c: fmi2Component,
                eventIndicators: *mut fmi2Real,
                ni: usize,
            ) -> fmi2Status;
            fmi2GetContinuousStates: fmi2GetContinuousStatesTYPE = (
                c: fmi2Component,
                x: *mut fmi2Real,
                nx: usize,
            ) -> fmi2Status;
            fmi2GetNominalsOfContinuousStates: fmi2GetNominalsOfContinuousStatesTYPE = (
                c: fmi2Component,
                x_nominal: *mut fmi2Real,
                nx: usize,
            ) -> fmi2Status;
            fmi2SetRealInputDerivatives: fmi2SetRealInputDerivativesTYPE = (
                c: fmi2Component,
                vr: *const fmi2ValueReference,
                nvr: usize,
                order: *const fmi2Integer,
                value: *const fmi2Real,
            ) -> fmi2Status;
            fmi2GetRealOutputDerivatives: fmi2GetRealOutputDerivativesTYPE = (
                c: fmi2Component,
                vr: *const fmi2ValueReference,
                nvr: usize,
                order: *const fmi2Integer,
                value: *mut fmi2Real,
            ) -> fmi2Status;
            fmi2DoStep: fmi2DoStepTYPE = (
                c: fmi2Component,
                currentCommunicationPoint: fmi2Real,
                communicationStepSize: fmi2Real,
                noSetFMUStatePriorToCurrentPoint: fmi2Boolean,
            ) -> fmi2Status;
            fmi2CancelStep: fmi2CancelStepTYPE = (c: fmi2Component) -> fmi2Status;
            fmi2GetStatus: fmi2GetStatusTYPE = (
                c: fmi2Component,
                s: fmi2StatusKind,
                value: *mut fmi2Status,
            ) -> fmi2Status;
            fmi2GetRealStatus: fmi2GetRealStatusTYPE = (
                c: fmi2Component,
                s: fmi2StatusKind,
                value: *mut fmi2Real,
            ) -> fmi2Status;
            fmi2GetIntegerStatus: fmi2GetIntegerStatusTYPE = (
                c: fmi2Component,
                s: fmi2StatusKind,
                value: *mut fmi2Integer,
            ) -> fmi2Status;
            fmi2GetBooleanStatus: fmi2GetBooleanStatusTYPE = (
                c: fmi2Component,
                s: fmi2StatusKind,
                value: *mut fmi2Boolean,
            ) -> fmi2Status;
            fmi2GetStringStatus: fmi2GetStringStatusTYPE = (
                c: fmi2Component,
                s: fmi2StatusKind,
                value: *mut fmi2String,
            ) -> fmi2Status;
        }
    };
}

macro_rules! listed {
    (; $($name:ident: $type:ident = ($($argument:ident: $of:ty),* $(,)?) $(-> $result:ty)?;)*) => {
        $(const _: $type = Some($name::<Nondimensional>);)*

        /// Every name that the shared library exports, in the order of the header.
        pub const EXPORTED_NAMES: &[&str] = &[$(stringify!($name)),*];
    };
}

fmi2_functions!(listed;);
