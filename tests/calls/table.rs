//! Every function in every phase.

use super::*;

/// What co-simulation and model exchange go through.
pub const KINDS: [(fmi2Type, [&str; 5]); 2] = [
    (
        fmi2Type_fmi2CoSimulation,
        [
            "instantiated",
            "initialization",
            "stepping",
            "failed",
            "terminated",
        ],
    ),
    (
        fmi2Type_fmi2ModelExchange,
        [
            "instantiated",
            "initialization",
            "event",
            "continuous",
            "terminated",
        ],
    ),
];

type Function = fn(fmi2Component) -> fmi2Status;

const ANY: &str = "instantiated initialization stepping failed terminated event continuous";
const INITIALIZED: &str = "initialization stepping failed terminated event continuous";
const NEVER: &str = "";

/// The tables of FMI 2.0.4, sections 4.2.4 (co-simulation) and 3.2.3 (model
/// exchange): the phases of each in which the function is allowed. A call with
/// good arguments is then answered with OK.
pub const TABLE: [(&str, Function, &str, &str); 42] = [
    // SAFETY, for all rows: a live component, and arrays as long as the counts.
    (
        "fmi2SetDebugLogging",
        |c| unsafe { fmi2SetDebugLogging(c, 1, 0, null()) },
        ANY,
        ANY,
    ),
    (
        "fmi2SetupExperiment",
        |c| unsafe { fmi2SetupExperiment(c, 0, 0.0, 0.0, 0, 0.0) },
        "instantiated",
        "instantiated",
    ),
    (
        "fmi2EnterInitializationMode",
        |c| unsafe { fmi2EnterInitializationMode(c) },
        "instantiated",
        "instantiated",
    ),
    (
        "fmi2ExitInitializationMode",
        |c| unsafe { fmi2ExitInitializationMode(c) },
        "initialization",
        "initialization",
    ),
    (
        "fmi2Terminate",
        |c| unsafe { fmi2Terminate(c) },
        "stepping failed",
        "event continuous",
    ),
    ("fmi2Reset", |c| unsafe { fmi2Reset(c) }, ANY, ANY),
    (
        "fmi2GetReal",
        |c| unsafe { fmi2GetReal(c, &0, 1, &mut 0.0) },
        INITIALIZED,
        INITIALIZED,
    ),
    (
        "fmi2GetInteger",
        |c| unsafe { fmi2GetInteger(c, &reference("on_pull_in"), 1, &mut 0) },
        INITIALIZED,
        INITIALIZED,
    ),
    (
        "fmi2GetBoolean",
        |c| unsafe { fmi2GetBoolean(c, &reference("pulled_in"), 1, &mut 0) },
        INITIALIZED,
        INITIALIZED,
    ),
    (
        "fmi2GetString",
        |c| unsafe { fmi2GetString(c, null(), 0, null_mut()) },
        INITIALIZED,
        INITIALIZED,
    ),
    (
        "fmi2SetReal of an input",
        |c| unsafe { fmi2SetReal(c, &0, 1, &0.1) },
        "instantiated initialization stepping",
        "instantiated initialization event continuous",
    ),
    (
        "fmi2SetReal of a tunable parameter",
        |c| unsafe { fmi2SetReal(c, &reference("gamma_s"), 1, &0.1) },
        "instantiated initialization stepping",
        // In continuous-time mode too, beyond the standard: FMPy does so.
        "instantiated initialization event continuous",
    ),
    (
        "fmi2SetReal of a fixed parameter",
        |c| unsafe { fmi2SetReal(c, &reference("lambda_start"), 1, &1.1) },
        "instantiated initialization",
        "instantiated initialization",
    ),
    (
        "fmi2SetInteger",
        |c| unsafe { fmi2SetInteger(c, &reference("on_pull_in"), 1, &1) },
        "instantiated initialization",
        "instantiated initialization",
    ),
    (
        "fmi2SetBoolean",
        |c| unsafe { fmi2SetBoolean(c, &reference("record_extremes"), 1, &1) },
        "instantiated initialization",
        "instantiated initialization",
    ),
    (
        "fmi2SetString",
        |c| unsafe { fmi2SetString(c, null(), 0, null()) },
        "instantiated initialization stepping",
        "instantiated initialization event continuous",
    ),
    ("fmi2GetFMUstate", |c| with_state(c, |_, _| OK), ANY, ANY),
    (
        "fmi2SetFMUstate",
        |c| with_state(c, |c, state| unsafe { fmi2SetFMUstate(c, state) }),
        ANY,
        ANY,
    ),
    (
        "fmi2FreeFMUstate",
        |c| unsafe { fmi2FreeFMUstate(c, &mut null_mut()) },
        ANY,
        ANY,
    ),
    (
        "fmi2SerializedFMUstateSize",
        |c| {
            with_state(c, |c, state| unsafe {
                fmi2SerializedFMUstateSize(c, state, &mut 0)
            })
        },
        ANY,
        ANY,
    ),
    (
        "fmi2SerializeFMUstate",
        |c| {
            with_state(c, |c, state| unsafe {
                let mut size = 0;
                fmi2SerializedFMUstateSize(c, state, &mut size);
                let mut bytes = vec![0; size];
                fmi2SerializeFMUstate(c, state, bytes.as_mut_ptr(), size)
            })
        },
        ANY,
        ANY,
    ),
    (
        "fmi2DeSerializeFMUstate",
        |c| {
            with_state(c, |c, state| unsafe {
                let mut size = 0;
                fmi2SerializedFMUstateSize(c, state, &mut size);
                let mut bytes = vec![0; size];
                fmi2SerializeFMUstate(c, state, bytes.as_mut_ptr(), size);
                let mut copy = null_mut();
                let status = fmi2DeSerializeFMUstate(c, bytes.as_ptr(), size, &mut copy);
                fmi2FreeFMUstate(c, &mut copy);
                status
            })
        },
        ANY,
        ANY,
    ),
    (
        "fmi2GetDirectionalDerivative",
        |c| unsafe {
            fmi2GetDirectionalDerivative(c, &reference("lambda_ddot"), 1, &0, 1, &1.0, &mut 0.0)
        },
        INITIALIZED,
        INITIALIZED,
    ),
    (
        "fmi2SetRealInputDerivatives",
        |c| unsafe { fmi2SetRealInputDerivatives(c, &0, 1, &1, &0.1) },
        "instantiated initialization stepping",
        NEVER,
    ),
    (
        "fmi2GetRealOutputDerivatives",
        |c| unsafe { fmi2GetRealOutputDerivatives(c, &reference("lambda"), 1, &1, &mut 0.0) },
        "stepping failed terminated",
        NEVER,
    ),
    (
        "fmi2DoStep",
        |c| unsafe { fmi2DoStep(c, 0.0, 0.1, 1) },
        "stepping",
        NEVER,
    ),
    (
        "fmi2CancelStep",
        |c| unsafe { fmi2CancelStep(c) },
        NEVER,
        NEVER,
    ),
    (
        "fmi2GetStatus",
        |c| unsafe { fmi2GetStatus(c, fmi2StatusKind_fmi2DoStepStatus, &mut 0) },
        "stepping failed terminated",
        NEVER,
    ),
    (
        "fmi2GetRealStatus",
        |c| unsafe { fmi2GetRealStatus(c, fmi2StatusKind_fmi2LastSuccessfulTime, &mut 0.0) },
        "stepping failed terminated",
        NEVER,
    ),
    (
        "fmi2GetIntegerStatus, for which there is no kind",
        |c| refused_or(DISCARD, unsafe { fmi2GetIntegerStatus(c, 0, &mut 0) }),
        "stepping failed terminated",
        NEVER,
    ),
    (
        "fmi2GetBooleanStatus",
        |c| unsafe { fmi2GetBooleanStatus(c, fmi2StatusKind_fmi2Terminated, &mut 0) },
        "stepping failed terminated",
        NEVER,
    ),
    (
        "fmi2GetStringStatus, whose kind is for pending steps",
        |c| {
            let kind = fmi2StatusKind_fmi2PendingStatus;
            refused_or(DISCARD, unsafe {
                fmi2GetStringStatus(c, kind, &mut null())
            })
        },
        "stepping failed terminated",
        NEVER,
    ),
    (
        "fmi2EnterEventMode",
        |c| unsafe { fmi2EnterEventMode(c) },
        NEVER,
        "event continuous",
    ),
    (
        "fmi2NewDiscreteStates",
        |c| unsafe { fmi2NewDiscreteStates(c, &mut exchange::no_info()) },
        NEVER,
        "event",
    ),
    (
        "fmi2EnterContinuousTimeMode",
        |c| unsafe { fmi2EnterContinuousTimeMode(c) },
        NEVER,
        "event",
    ),
    (
        "fmi2CompletedIntegratorStep",
        |c| unsafe { fmi2CompletedIntegratorStep(c, 1, &mut 0, &mut 0) },
        NEVER,
        "continuous",
    ),
    (
        "fmi2SetTime",
        |c| unsafe { fmi2SetTime(c, 0.0) },
        NEVER,
        "event continuous",
    ),
    (
        "fmi2SetContinuousStates",
        |c| unsafe { fmi2SetContinuousStates(c, [1.0, 0.0].as_ptr(), 2) },
        NEVER,
        "continuous",
    ),
    (
        "fmi2GetDerivatives",
        |c| unsafe { fmi2GetDerivatives(c, [0.0; 2].as_mut_ptr(), 2) },
        NEVER,
        "initialization event continuous terminated",
    ),
    (
        "fmi2GetEventIndicators",
        |c| unsafe { fmi2GetEventIndicators(c, [0.0; 2].as_mut_ptr(), 2) },
        NEVER,
        "initialization event continuous terminated",
    ),
    (
        "fmi2GetContinuousStates",
        |c| unsafe { fmi2GetContinuousStates(c, [0.0; 2].as_mut_ptr(), 2) },
        NEVER,
        "initialization event continuous terminated",
    ),
    (
        "fmi2GetNominalsOfContinuousStates",
        |c| unsafe { fmi2GetNominalsOfContinuousStates(c, [0.0; 2].as_mut_ptr(), 2) },
        NEVER,
        "instantiated event continuous terminated",
    ),
];

/// Runs `body` with a state of the component, which is null if it gives none.
fn with_state(c: fmi2Component, body: fn(fmi2Component, fmi2FMUstate) -> fmi2Status) -> fmi2Status {
    unsafe {
        let mut state = null_mut();
        let saved = fmi2GetFMUstate(c, &mut state);
        let status = if saved == OK { body(c, state) } else { saved };
        fmi2FreeFMUstate(c, &mut state);
        status
    }
}

/// OK for a call that was allowed and answered as it must be.
fn refused_or(expected: fmi2Status, status: fmi2Status) -> fmi2Status {
    if status == expected { OK } else { status }
}

#[test]
fn each_function_is_allowed_in_the_phases_of_the_standard_only() {
    for (which, (kind, phases)) in KINDS.into_iter().enumerate() {
        for (name, function, co_simulation, model_exchange) in TABLE {
            let allowed = [co_simulation, model_exchange][which];
            for phase in phases {
                let host = Host::in_phase_of(kind, phase);
                let expected = if allowed.split(' ').any(|p| p == phase) {
                    OK
                } else {
                    ERROR
                };
                let status = function(host.component);
                let told = host.last_line();
                assert_eq!(status, expected, "{name} in {phase} of {which}: {told}");
                if status == ERROR {
                    let function = name.split([' ', ',']).next().expect("a name");
                    assert!(told.contains(function), "{told}");
                }
            }
        }
    }
}
