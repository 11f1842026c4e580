//! Model exchange against co-simulation, and what only model exchange has.

use super::host::{Host, row};
use super::integrator::{Integrator, STATES};
use dielectric_elastomer_actuator::instance::Interface;
use dielectric_elastomer_actuator::model::Model;
use dielectric_elastomer_actuator::si::Si;

/// Numbers between 0 and 1.
struct Random(u64);

impl Random {
    fn next(&mut self) -> f64 {
        self.0 = self
            .0
            .wrapping_mul(6364136223846793005)
            .wrapping_add(1442695040888963407);
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.next()
    }

    fn chance(&mut self) -> bool {
        self.next() < 0.4
    }
}

/// A device of everything, where each part is there or not; its period is near 5 µs.
fn scene(seed: u64) -> Vec<(&'static str, f64)> {
    let mut random = Random(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15));
    random.next();
    let mut all = vec![
        ("record_energy", 1.0),
        ("record_extremes", 1.0),
        ("lambda_max", 2.5),
        ("voltage", random.between(50.0, 400.0)),
    ];
    let laws: &[_] = match seed % 4 {
        0 => &[("J_m", 20.0, 120.0)],
        1 => &[("kappa2", -0.1, 0.1), ("kappa3", 0.0, 0.05)],
        _ => &[],
    };
    let parts = [
        ("k1", -0.1, 0.1),
        ("k2", -0.1, 0.1),
        ("eta", 0.001, 0.05),
        ("b", 1e-9, 1e-7),
        ("R_s", 1e6, 1e8),
        ("G_p", 1e-10, 1e-8),
        ("sigma", 1e-8, 1e-6),
        ("force", -2e-5, 4e-5),
        ("m_load", 1e-14, 1e-12),
        ("k_load", 0.1, 2.0),
        ("mu_1", 1e4, 4e5),
        ("mu_2", 1e4, 4e5),
        ("mu_3", 1e4, 4e5),
    ];
    for (name, low, high) in laws.iter().copied().chain(parts) {
        if random.chance() {
            all.push((name, random.between(low, high)));
        }
    }
    for (time, start) in [
        ("tau_1", "xi1_start"),
        ("tau_2", "xi2_start"),
        ("tau_3", "xi3_start"),
    ] {
        all.push((time, random.between(1e-6, 1e-5)));
        all.push((start, random.between(0.98, 1.02)));
    }
    match seed % 5 {
        0 => all.extend([("source", 2.0), ("current", random.between(0.0, 4e-6))]),
        1 => all.extend([
            ("source", 3.0),
            ("charge_imposed", random.between(0.0, 1e-11)),
        ]),
        _ => all.extend([
            ("V_ac", random.between(0.0, 100.0)),
            ("f_ac", random.between(1e5, 4e5)),
        ]),
    }
    all
}

/// Random devices: the host's integration against ours, in states, ports, energies and extremes.
#[test]
fn a_host_that_integrates_meets_the_co_simulation() {
    for seed in 0..40 {
        let values = scene(seed);
        let mut ours = Host::begun(&values);
        let mut theirs = Integrator::begun(&values);
        let step = 2.5e-9;
        for round in 0..8 {
            for _ in 0..300 {
                let event = theirs.step(step);
                assert!(!event, "{seed}: {values:?}");
            }
            ours.step(300.0 * step);
            for (name, size) in [
                ("lambda", 1.0),
                ("lambda_dot", 1e5),
                ("edge_acceleration", 1e6),
                ("charge", 1e-11),
                ("supply_current", 1e-5),
                ("electrical_power", 1e-2),
                ("xi1", 1.0),
                ("xi2", 1.0),
                ("xi3", 1.0),
                ("lost_power", 1e-2),
                ("frequency", 1e5),
            ] {
                let [a, b] = [ours.get(name), theirs.host.get(name)];
                assert!(
                    (a - b).abs() < 1e-8 * size,
                    "{seed} {round} {name}: {a} {b} {values:?}"
                );
            }
            for name in [
                "lost_damping",
                "lost_branches",
                "lost_resistance",
                "lost_leakage",
                "supplied_electrical",
                "supplied_mechanical",
            ] {
                let [a, b] = [ours.get(name), theirs.host.get(name)];
                assert!(
                    (a - b).abs() < 1e-6 * 1e-9,
                    "{seed} {round} {name}: {a} {b} {values:?}"
                );
            }
            for name in ["lambda_lowest", "lambda_highest"] {
                let [a, b] = [ours.get(name), theirs.host.get(name)];
                assert!((a - b).abs() < 1e-8, "{seed} {name}: {a} {b}");
            }
        }
    }
}

/// A supply that is stepped at an event: what the step exchanges is booked.
#[test]
fn a_step_of_the_source_at_an_event_is_booked() {
    let values = [("record_energy", 1.0), ("charge_start", 1e-12)];
    let mut ours = Host::begun(&values);
    let mut theirs = Integrator::begun(&values);
    for voltage in [500.0, 200.0, 0.0, 450.0] {
        for _ in 0..100 {
            theirs.step(5e-9);
        }
        ours.step(5e-7);
        theirs.host.instance.enter_event_mode();
        theirs.host.set("voltage", voltage).expect("a voltage");
        theirs.handle_events();
        ours.set("voltage", voltage).expect("a voltage");
    }
    theirs.step(5e-9);
    ours.step(5e-9);
    for name in ["supplied_electrical", "lost_resistance"] {
        let [a, b] = [ours.get(name), theirs.host.get(name)];
        assert!((a - b).abs() < 1e-7 * a.abs(), "{name}: {a} {b}");
        assert!(a > 1e-9, "{name}: {a}");
    }
}

/// Breakdown is awaited as an event whatever follows from it, and reported.
#[test]
fn breakdown_is_seen_in_model_exchange() {
    for choice in [1.0, 2.0, 3.0] {
        let values = [("E_breakdown", 62e6), ("on_breakdown_number", choice)];
        let mut ours = Host::begun(&values[..1]);
        ours.follow(1e-6, 1e-8);
        let time = ours.get("breakdown_time");
        assert!(time > 0.0 && time < 1e-6, "{time}");
        let mut theirs = Integrator::begun(&values);
        let mut ended = false;
        while theirs.host.time < 2e-6 && !ended {
            let (before, known) = (theirs.indicators()[2], theirs.host.get("broken_down"));
            let asked = theirs.step(1e-9);
            // Nothing but an event changes what is discrete, nor makes an indicator jump.
            let crossed = before * theirs.indicators()[2] <= 0.0;
            if choice == 1.0 {
                assert_eq!(theirs.host.get("broken_down"), known);
            }
            // Where the simulation is to end, breakdown can be read before its event has been handled.
            assert!(asked == crossed || choice == 3.0);
            if asked {
                theirs.host.instance.enter_event_mode();
                ended = theirs.handle_events();
                let found = theirs.host.get("breakdown_time");
                assert!((found - time).abs() < 1.1e-9, "{found} {time}");
                assert_eq!(theirs.host.get("broken_down"), 1.0);
                assert_eq!(theirs.indicators()[2], 1.0);
            }
        }
        assert_eq!(ended, choice == 3.0);
        assert_eq!(theirs.host.get("broken_down"), 1.0);
        let moves = theirs.host.get("lambda_dot") != 0.0;
        assert_eq!(moves, choice != 2.0, "{choice}");
    }
}

/// States may be set by their value references, as `set_continuous_states` does.
#[test]
fn states_are_set_by_value_reference() {
    let mut integrator = Integrator::begun(&[("R_s", 1e7), ("mu_1", 1e5), ("tau_1", 1e-6)]);
    for (name, value) in [
        ("lambda", 1.04),
        ("lambda_dot", 2e4),
        ("charge_state", 3e-12),
        ("xi1", 1.01),
    ] {
        integrator.host.set(name, value).expect(name);
    }
    let mut states = [0.0; STATES];
    let host = &integrator.host;
    host.instance
        .continuous_states(&mut states)
        .expect("states");
    let place = |name: &str| Si::STATES.iter().position(|state| *state == row(name).0);
    for (name, value) in [("lambda", 1.04), ("charge_state", 3e-12), ("xi1", 1.01)] {
        assert_eq!(states[place(name).expect("a state")], value);
        assert!((host.get(name) - value).abs() < 1e-15 * value);
    }
    assert!((host.get("charge") - 3e-12).abs() < 1e-26);
}

/// The charge becomes a state on the way: it is the one that was on the electrodes, and the host is told.
#[test]
fn a_resistance_switched_on_keeps_the_charge() {
    let mut integrator = Integrator::begun(&[("force", 1e-5)]);
    for _ in 0..100 {
        integrator.step(5e-9);
    }
    let before = integrator.host.get("charge");
    let instance = &mut integrator.host.instance;
    instance.enter_event_mode();
    assert!(
        !instance
            .new_discrete_states()
            .expect("an update")
            .states_changed
    );
    integrator.host.set("R_s", 1e7).expect("a resistance");
    let instance = &mut integrator.host.instance;
    assert!(
        instance
            .new_discrete_states()
            .expect("an update")
            .states_changed
    );
    assert!(
        !instance
            .new_discrete_states()
            .expect("an update")
            .states_changed
    );
    for name in ["charge", "charge_state"] {
        let after = integrator.host.get(name);
        assert!(
            before > 1e-12 && (after / before - 1.0).abs() < 1e-14,
            "{name}: {after} {before}"
        );
    }
    // Without a voltage across the resistance no current flows.
    assert!(integrator.host.get("supply_current").abs() < 1e-16);
}

/// Of the actuator that it is: its charge unit, and a swing by its length in a period.
#[test]
fn nominals_are_those_of_the_actuator() {
    for (side, thickness) in [(100e-6, 10e-6), (20e-3, 100e-6)] {
        let host = Host::initializing(Interface::ModelExchange, &[("L", side), ("H", thickness)]);
        let mut nominals = [0.0; STATES];
        host.instance
            .nominals_of_states(&mut nominals)
            .expect("nominals");
        let permittivity = 2.8 * 8.854_187_818_8e-12;
        let charge = side * side * f64::sqrt(permittivity * 303e3);
        let frequency =
            f64::sqrt(72.0 * 303e3 / (1100.0 * (side * side + 2.0 * thickness * thickness)));
        for (place, expected) in [(0, 1.0), (1, frequency), (2, charge), (3, 1.0)] {
            assert!(
                (nominals[place] / expected - 1.0).abs() < 1e-12,
                "{place}: {nominals:?}"
            );
        }
    }
}

/// A changed frequency leaves the voltage where it is.
#[test]
fn the_phase_runs_on_through_a_changed_frequency() {
    let mut host = Host::begun(&[("V_ac", 100.0), ("f_ac", 2e5), ("phase_ac", 0.3)]);
    let mut angle = 0.3;
    let mut frequency = 2e5;
    for k in 0..200 {
        host.step(0.7e-6);
        angle += std::f64::consts::TAU * frequency * 0.7e-6;
        let expected = 600.0 + 100.0 * f64::sin(angle);
        let before = host.get("supply_voltage");
        assert!((before - expected).abs() < 1e-9, "{k}: {before} {expected}");
        frequency = 1e5 + 1e3 * f64::from(k);
        host.set("f_ac", frequency).expect("a frequency");
        let after = host.get("supply_voltage");
        assert!((after - before).abs() < 1e-9, "{k}: {before} {after}");
    }
}

/// The typical sizes of the states follow from parameters that can be tuned: the host is told at the next event.
#[test]
fn nominals_that_change_are_announced() {
    let mut host = Integrator::begun(&[]).host;
    let announced = |host: &mut Host| {
        host.instance.enter_event_mode();
        let update = host.instance.new_discrete_states().expect("an update");
        update.nominals_changed
    };
    let nominals = |host: &Host| {
        let mut nominals = [0.0; STATES];
        host.instance
            .nominals_of_states(&mut nominals)
            .expect("nominals");
        nominals
    };
    let before = nominals(&host);
    host.set("eta", 0.01).expect("legal");
    assert!(!announced(&mut host) && nominals(&host) == before);
    host.set("L", 2e-3).expect("legal");
    assert!(nominals(&host) != before);
    assert!(announced(&mut host));
    assert!(!announced(&mut host));
}

/// A state may jump in event mode only: between events the host would overwrite it, and the charge would be lost.
#[test]
fn a_resistance_is_switched_on_in_event_mode_only() {
    let mut host = Integrator::begun(&[]).host;
    let charge = host.get("charge");
    let fault = host.set("R_s", 1e5).expect_err("a jump");
    assert!(
        fault.text.contains("R_s = 100000 cannot be set"),
        "{fault:?}"
    );
    assert!(fault.text.contains("event mode"), "{fault:?}");
    host.instance.enter_event_mode();
    host.set("R_s", 1e5).expect("a resistance");
    assert!((host.get("charge_state") / charge - 1.0).abs() < 1e-14);
    host.instance.enter_continuous_time();
    host.set("R_s", 2e5).expect("no jump");
}

/// Held at breakdown, the stretch is still a state that the host sets, and results follow it; at a limit of the stretch
/// they do not.
#[test]
fn derivatives_of_a_held_actuator_are_those_of_what_is_read() {
    for (settings, follows) in [
        ([("E_breakdown", 62e6), ("on_breakdown_number", 2.0)], true),
        ([("lambda_max", 1.01), ("terminate_on_pull_in", 0.0)], false),
    ] {
        let mut integrator = Integrator::begun(&settings);
        while integrator.host.time < 1e-6 {
            if integrator.step(1e-9) {
                integrator.host.instance.enter_event_mode();
                integrator.handle_events();
            }
        }
        let host = &mut integrator.host;
        assert_eq!(host.get("lambda_dot"), 0.0);
        let (state, result) = (row("lambda").0, row("charge").0);
        let mut slope = f64::NAN;
        host.instance
            .directional_derivative(&[result], &[state], &[1.0], |_, value| slope = value)
            .expect("a derivative");
        let at = host.get("lambda");
        let mut charge = |stretch: f64| {
            host.set("lambda", stretch).expect("a state");
            host.get("charge")
        };
        let quotient = (charge(at + 1e-5) - charge(at - 1e-5)) / 2e-5;
        assert_eq!(quotient != 0.0, follows);
        let error = (slope - quotient).abs();
        assert!(error <= 1e-8 * quotient.abs(), "{slope} {quotient}");
    }
}
