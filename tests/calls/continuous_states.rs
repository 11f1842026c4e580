//! Model exchange: the continuous states as a host sets them, also by value reference and far out.

use super::exchange::EXCHANGE;
use super::*;
use dielectric_elastomer_actuator::model::variables::Kind;

#[test]
fn bad_arguments_are_refused_and_change_nothing() {
    let host = Host::in_phase_of(EXCHANGE, "continuous");
    let c = host.component;
    unsafe {
        for time in [f64::NAN, f64::INFINITY] {
            assert_eq!(fmi2SetTime(c, time), ERROR);
        }
        for states in [[f64::NAN, 0.0], [1.0, f64::NEG_INFINITY]] {
            assert_eq!(fmi2SetContinuousStates(c, states.as_ptr(), 2), ERROR);
        }
        assert_eq!(fmi2SetContinuousStates(c, [1.5].as_ptr(), 1), ERROR);
        assert_eq!(fmi2SetContinuousStates(c, null(), 2), ERROR);
        assert_eq!(fmi2CompletedIntegratorStep(c, 1, null_mut(), &mut 0), ERROR);
        assert_eq!(fmi2CompletedIntegratorStep(c, 1, &mut 0, null_mut()), ERROR);
        let fill: [unsafe extern "C" fn(fmi2Component, *mut f64, usize) -> fmi2Status; 4] = [
            fmi2GetDerivatives,
            fmi2GetEventIndicators,
            fmi2GetContinuousStates,
            fmi2GetNominalsOfContinuousStates,
        ];
        for function in fill {
            assert_eq!(function(c, null_mut(), 2), ERROR);
            assert_eq!(function(c, [0.0; 3].as_mut_ptr(), 3), ERROR);
            assert_eq!(function(c, [0.0; 3].as_mut_ptr(), 0), ERROR);
        }
        assert_eq!(host.fill(fmi2GetContinuousStates), [1.0, 0.0]);
        assert_eq!(host.fill(fmi2GetNominalsOfContinuousStates), [1.0, 0.1]);
        // A trial of the host's integrator that is no motion: it may try again.
        for states in [[0.0, 0.0], [-0.5, 1.0], [1e200, 1e200]] {
            assert_eq!(fmi2SetContinuousStates(c, states.as_ptr(), 2), OK);
            assert_eq!(fmi2GetDerivatives(c, [0.0; 2].as_mut_ptr(), 2), DISCARD);
        }
        assert_eq!(fmi2EnterEventMode(c), OK);
        assert_eq!(fmi2NewDiscreteStates(c, null_mut()), ERROR);
    }
}

/// What a host's integrator has tried is named, in few digits, by the number that is at fault.
#[test]
fn a_trial_is_refused_with_the_number_that_is_at_fault() {
    let host = Host::in_phase_of(EXCHANGE, "continuous");
    for (states, fault) in [
        ([1e200, 0.0], "no motion at the stretch 1e200;"),
        ([1e200, 1e200], "no motion at the stretch 1e200;"),
        ([-1e200, 0.0], "no motion at the stretch -1e200;"),
        ([0.0, 0.0], "no motion at the stretch 0;"),
        ([1.1, 1e200], "no motion at the stretch rate 1e200;"),
        ([0.9, -1e180], "no motion at the stretch rate -1e180;"),
    ] {
        let status = unsafe {
            assert_eq!(
                fmi2SetContinuousStates(host.component, states.as_ptr(), 2),
                OK
            );
            fmi2GetDerivatives(host.component, [0.0; 2].as_mut_ptr(), 2)
        };
        let line = host.last_line();
        assert_eq!(status, DISCARD, "{states:?}");
        assert!(line.contains(fault), "{states:?}: {line}");
        assert!(line.len() < 120, "{states:?}: {line}");
    }
}

#[test]
fn results_that_are_no_numbers_are_discarded() {
    let host = Host::in_phase_of(EXCHANGE, "continuous");
    let states = [
        (0.0, 0.0),
        (1e-310, 0.0),
        (-3.5e285, 0.0),
        (1.0, 0.1),
        (-1e-30, 1e30),
        (1e30, -1e30),
    ];
    for (place, state) in states
        .map(|(position, rate)| [position, rate])
        .iter()
        .enumerate()
    {
        assert_eq!(
            unsafe { fmi2SetContinuousStates(host.component, state.as_ptr(), 2) },
            OK
        );
        let mut discarded = 0;
        let reals = VARIABLES
            .iter()
            .filter(|variable| matches!(variable.kind, Kind::Real { .. }));
        for variable in reals {
            let (mut value, reference) = (0.0, reference(variable.name));
            let status = unsafe { fmi2GetReal(host.component, &reference, 1, &mut value) };
            let means_none = value == f64::INFINITY && variable.description.contains("+inf");
            let expected = if value.is_finite() || means_none {
                OK
            } else {
                DISCARD
            };
            assert_eq!(status, expected, "{} at {state:?}", variable.name);
            discarded += usize::from(status == DISCARD);
        }
        assert_eq!(discarded > 0, place < 3, "{state:?}");
    }
}

/// A host that knows the states by their value references, as one does that
/// optimizes: setting them is `fmi2SetContinuousStates`.
#[test]
fn states_are_set_by_value_reference() {
    let names = [
        "lambda",
        "lambda_dot",
        "lambda_ddot",
        "lambda3",
        "electric_field",
    ];
    for phase in ["event", "continuous"] {
        let host = Host::in_phase_of(EXCHANGE, phase);
        let twin = Host::in_phase_of(EXCHANGE, "continuous");
        for actuator in [&host, &twin] {
            assert_eq!(actuator.set("phi", 0.4), OK);
        }
        let references = ["stretch", "phi", "lambda_dot"].map(reference);
        assert_eq!(references[0], reference("lambda"));
        for (stretch, rate) in [(1.3, 0.2), (0.4, -3.0), (25.0, 0.0)] {
            let c = host.component;
            let values = [stretch, 0.4, rate];
            assert_eq!(
                unsafe { fmi2SetReal(c, references.as_ptr(), 3, values.as_ptr()) },
                OK
            );
            twin.put(0.0, [stretch, rate]);
            assert_eq!(host.fill(fmi2GetContinuousStates), [stretch, rate]);
            assert_eq!(host.fill(fmi2GetDerivatives), twin.fill(fmi2GetDerivatives));
            assert_eq!(
                names.map(|name| host.get(name)),
                names.map(|name| twin.get(name))
            );
        }
        // All or nothing.
        for bad in [f64::NAN, f64::INFINITY] {
            let values = [1.1, 0.3, bad];
            let c = host.component;
            assert_eq!(
                unsafe { fmi2SetReal(c, references.as_ptr(), 3, values.as_ptr()) },
                ERROR
            );
            assert!(
                host.last_line().contains("lambda_dot"),
                "{}",
                host.last_line()
            );
            assert_eq!(host.fill(fmi2GetContinuousStates), [25.0, 0.0]);
            assert_eq!(host.get("phi"), 0.4);
        }
        assert_eq!(host.set("lambda3", 0.5), ERROR);
    }
    for (kind, phase) in [
        (EXCHANGE, "initialization"),
        (EXCHANGE, "terminated"),
        (fmi2Type_fmi2CoSimulation, "initialization"),
        (fmi2Type_fmi2CoSimulation, "stepping"),
    ] {
        let host = Host::in_phase_of(kind, phase);
        assert_eq!(host.set("lambda", 1.1), ERROR, "{phase}");
    }
}

/// Differences of what is read after a state was set are the directional derivatives.
#[test]
fn jacobians_follow_states_set_by_value_reference() {
    let host = Host::in_phase_of(EXCHANGE, "continuous");
    for (name, value) in [("phi", 0.4), ("S", 0.2), ("c", 3.0), ("E_s", 0.1)] {
        assert_eq!(host.set(name, value), OK);
    }
    for (known, at) in [("lambda", 1.25), ("lambda_dot", 0.3)] {
        assert_eq!(host.set("lambda", 1.25), OK);
        assert_eq!(host.set("lambda_dot", 0.3), OK);
        let mut slope = f64::NAN;
        let (unknown, by) = (reference("lambda_ddot"), reference(known));
        unsafe {
            let c = host.component;
            fmi2GetDirectionalDerivative(c, &unknown, 1, &by, 1, &1.0, &mut slope);
        }
        let [below, above] = [at - 1e-5, at + 1e-5].map(|value| {
            assert_eq!(host.set(known, value), OK);
            host.get("lambda_ddot")
        });
        let difference = (above - below) / 2e-5;
        assert!(
            (slope - difference).abs() < 1e-9,
            "{slope} and {difference}"
        );
    }
}
