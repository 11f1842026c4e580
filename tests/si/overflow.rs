//! Results that lead beyond the largest number: the law σ exp(E/E_c) of the conductivity does, in a field far above E_c.

use super::host::{Host, row};
use dielectric_elastomer_actuator::instance::{Fault, Interface, Saved, Severity, Type};
use dielectric_elastomer_actuator::model::Model;
use dielectric_elastomer_actuator::model::variables::Kind;
use dielectric_elastomer_actuator::si::Si;

const INTERFACES: [Interface; 2] = [Interface::CoSimulation, Interface::ModelExchange];

/// What is discarded, of all real variables: the rest are finite, or +inf where their description says so.
fn discarded(host: &Host) -> Vec<&'static str> {
    let mut names = Vec::new();
    for variable in Si::VARIABLES {
        let Kind::Real { .. } = variable.kind else {
            continue;
        };
        let mut value = f64::NAN;
        let read = host
            .instance
            .get(Type::Real, &[row(variable.name).0], |_, number| {
                value = number
            });
        match read {
            Ok(()) => {
                let there_is_none = value == f64::INFINITY && variable.description.contains("+inf");
                assert!(
                    value.is_finite() || there_is_none,
                    "{} = {value}",
                    variable.name
                );
            }
            Err(fault) => {
                is_explained(&fault, variable.name);
                names.push(variable.name);
            }
        }
    }
    names
}

/// The message names the setting and its limit.
fn is_explained(fault: &Fault, what: &str) {
    assert_eq!(fault.severity, Severity::Discard, "{what}: {fault:?}");
    for part in [
        "E_conduction = 10000 V/m is out of proportion to electric_field = ",
        "set 0 or at least ",
    ] {
        assert!(fault.text.contains(part), "{what}: {fault:?}");
    }
}

/// In the field of a source that is ideal, leakage changes the current and not the motion: only what follows from the
/// current is discarded, and the steps go on.
#[test]
fn a_leak_that_overflows_discards_what_follows_from_it() {
    for (source, name, value) in [
        (1.0, "voltage", 600.0),
        (3.0, "charge_imposed", 2.7e-11),
        (3.0, "charge_imposed", -2.7e-11),
    ] {
        for interface in INTERFACES {
            let values = [
                ("source", source),
                (name, 0.0),
                ("sigma", 1e-9),
                ("E_conduction", 1e4),
            ];
            let mut host = Host::initializing(interface, &values);
            host.instance.exit_initialization().expect("a start");
            assert_eq!(discarded(&host), [""; 0]);
            host.set(name, value).expect(name);
            let saved = host.instance.save(Saved::default()).expect("a state");
            let mut expected = vec!["supply_current", "electrical_power", "lost_power"];
            if source == 3.0 {
                expected.insert(1, "supply_voltage");
                expected.push("pull_in_margin");
            }
            assert_eq!(discarded(&host), expected, "{interface:?}");
            let again = host.instance.save(Saved::default()).expect("a state");
            assert_eq!(again, saved);
            let current = [row("supply_current").0];
            let instance = &host.instance;
            let fault = instance.output_derivatives(&current, &[1], |_, _| ());
            is_explained(&fault.expect_err("no number"), "the derivative");
            let fault =
                instance.directional_derivative(&current, &[row(name).0], &[1.0], |_, _| ());
            is_explained(&fault.expect_err("no number"), "the directional derivative");
            if interface == Interface::CoSimulation {
                host.step(1e-7);
                assert_eq!(discarded(&host), expected);
            }
            host.set(name, 0.0).expect(name);
            assert_eq!(discarded(&host), [""; 0]);
        }
    }
}

/// A host that integrates may try any charge.
#[test]
fn a_charge_whose_leak_overflows_is_discarded() {
    let values = [
        ("source", 2.0),
        ("sigma", 1e-9),
        ("E_conduction", 1e4),
        ("current", 1.0),
    ];
    for charge in [2.7e-11, -2.7e-11] {
        let mut host = Host::initializing(Interface::ModelExchange, &values);
        host.instance.exit_initialization().expect("a start");
        host.set("charge_state", charge).expect("a charge");
        let found = discarded(&host);
        assert_eq!(found.first(), Some(&"charge_state_dot"));
        assert!(found.contains(&"lost_power"), "{found:?}");
        let fault = host.instance.derivatives(&mut [0.0; Si::STATES.len()]);
        is_explained(&fault.expect_err("no motion"), "the derivatives");
        host.set("charge_state", 0.0).expect("a charge");
        assert_eq!(discarded(&host), [""; 0]);
    }
}

/// What would overflow from the first instant is refused there, whatever the source.
#[test]
fn a_start_in_too_high_a_field_is_refused() {
    for (values, cause) in [
        (
            vec![("source", 3.0), ("charge_imposed", 2.7e-11)],
            "charge_imposed",
        ),
        (
            vec![("source", 2.0), ("charge_start", 2.7e-11)],
            "charge_start",
        ),
        (
            vec![("voltage", 0.0), ("R_s", 1e6), ("charge_start", -2.7e-11)],
            "charge_start",
        ),
        (vec![("voltage", 5.0), ("lambda_start", 9.0)], "voltage"),
    ] {
        for interface in INTERFACES {
            let mut host = Host::initializing(interface, &values);
            host.set("E_conduction", 1e4).expect("a field");
            let fault = host.instance.exit_initialization().expect_err(cause);
            for part in [
                "E_conduction = 10000 V/m",
                "electric_field at the start",
                cause,
            ] {
                assert!(fault.text.contains(part), "{fault:?}");
            }
        }
    }
}

/// Energies that overflow end the step, and the message says why. So does that of a parameter that is refused.
#[test]
fn steps_and_parameters_that_overflow_say_why() {
    let mut host = Host::begun(&[
        ("sigma", 1e-9),
        ("E_conduction", 1e7),
        ("record_energy", 1.0),
    ]);
    host.step(1e-7);
    host.set("voltage", 15e3).expect("a voltage");
    let fault = host.instance.do_step(host.time, 1e-7).expect_err("the end");
    assert_eq!(fault.severity, Severity::Discard);
    assert!(
        fault.text.contains("E_conduction = 10000000 V/m"),
        "{fault:?}"
    );
    let mut host = Host::begun(&[("sigma", 1e-9), ("R_s", 1e6)]);
    host.step(1e-6);
    let fault = host.set("E_conduction", 1e4).expect_err("no motion");
    assert_eq!(fault.severity, Severity::Error);
    assert!(fault.text.contains("set 0 or at least"), "{fault:?}");
    assert_eq!(host.get("E_conduction"), 0.0);
    host.step(1e-6);
}

/// A host's integrator tries a state from which no energies follow, and comes back.
#[test]
fn a_step_from_far_out_leaves_the_energies_numbers() {
    let mut host = Host::initializing(Interface::ModelExchange, &[("record_energy", 1.0)]);
    let instance = &mut host.instance;
    instance.exit_initialization().expect("a start");
    instance.new_discrete_states().expect("an update");
    instance.enter_continuous_time();
    for (time, stretch) in [(1e-7, 0.0), (2e-7, 1.0)] {
        instance.set_time(time).expect("a time");
        let state = [stretch, 0.0, 0.0, 1.0, 1.0, 1.0];
        instance.set_continuous_states(&state).expect("states");
        instance.completed_integrator_step().expect("a step");
    }
    let saved = host.instance.save(Saved::default()).expect("a state");
    host.instance.saved(saved.bytes()).expect("sound bytes");
    assert!(host.get("supplied_electrical") > 0.0);
    assert_eq!(host.get("lost_damping"), 0.0);
}
