//! What cannot be meant is refused with the variable, the value, the limit and what to do.

use super::host::{Host, row};
use dielectric_elastomer_actuator::instance::{Interface, Saved, Type};
use dielectric_elastomer_actuator::model::Model;
use dielectric_elastomer_actuator::model::variables::{Access, Kind, Meant};
use dielectric_elastomer_actuator::si::Si;

/// A wrong power of ten meets a limit, and the message names the range and the unit.
#[test]
fn unphysical_values_are_refused() {
    let mut host = Host::initializing(Interface::CoSimulation, &[]);
    for (name, value, part) in [
        ("H", 10.0, "10 um are 10e-6"),
        ("H", 0.01, "above its maximum 0.005 m"),
        ("H", 0.0, "below its minimum 1e-8 m"),
        ("H", -1e-5, "set a value from 1e-8 to 0.005 m"),
        ("mu", 0.3, "0.3 MPa are 0.3e6"),
        ("mu", 303.0, "below its minimum 1000 Pa"),
        ("rho", 1.1, "1.1 g/cm3 are 1100"),
        ("rho", 0.0, "below its minimum"),
        ("R_s", -1.0, "below its minimum"),
        ("R_s", 1e-9, "neither 0 nor above its minimum 0.001 Ohm"),
        ("eps_r", 0.5, "below its minimum"),
        ("L", 20.0, "20 mm are 20e-3"),
        ("voltage", f64::NAN, "not a finite number"),
        ("voltage", 60e6, "set a value from -200000 to 200000 V"),
        ("charge_imposed", 1.2, "1 nC is 1e-9"),
        ("current", 5.0, "1 mA is 1e-3"),
        ("tau_1", 0.0, "3 ms are 3e-3"),
        ("mu_1", 26.0, "0 or a value from 100 to 1000000000 Pa"),
        ("E_breakdown", 80.0, "80 V/um are 80e6"),
        ("E_conduction", 40.0, "40 V/um are 40e6"),
        ("n_layers", 2.5, "not a whole number"),
        ("source_number", 1.5, "a whole number from 0 to 3"),
    ] {
        let before = host.get(name);
        let fault = host.set(name, value).expect_err(name);
        let text = format!("{fault:?}");
        assert!(text.contains(name) && text.contains(part), "{text}");
        assert_eq!(host.get(name), before);
    }
}

/// Every number of the table just outside its limits, and no number at all: the message has the
/// variable, the value, the limit and the unit, and nothing has changed.
#[test]
fn every_number_outside_its_limits_is_refused() {
    let mut host = Host::initializing(Interface::CoSimulation, &[]);
    let mut count = 0;
    for variable in Si::VARIABLES {
        let (Kind::Real { min, max, .. }, Access::Setting { .. } | Access::Input { .. }) =
            (variable.kind, variable.access)
        else {
            continue;
        };
        let name = variable.name;
        let before = host.get(name);
        let beyond = |limit: f64| limit.abs().max(1e-3) * 0.1;
        let mut bad = vec![
            (min - beyond(min), min),
            (max + beyond(max), max),
            (f64::NAN, max),
            (f64::INFINITY, max),
        ];
        if let Meant::NoneOrFrom(smallest) = variable.meant {
            bad.push((0.5 * smallest, smallest));
        }
        for (value, limit) in bad {
            let fault = host.set(name, value).expect_err(name);
            let unit = match variable.unit.name {
                "1" => "",
                unit => unit,
            };
            let short = |number: f64| format!("{number:?}").trim_end_matches(".0").to_owned();
            for part in [name, &short(value), &short(limit), unit] {
                assert!(fault.text.contains(part), "{part}: {}", fault.text);
            }
            assert_eq!(host.get(name), before, "{name}");
        }
        count += 1;
    }
    assert!(count > 50, "{count}");
}

#[test]
fn contradictory_choices_say_which_to_change() {
    for (values, parts) in [
        (
            vec![("J_m", 100.0), ("kappa2", 0.1)],
            ["J_m = 100", "set one of them to 0"],
        ),
        (
            vec![("source", 2.0), ("V_ac", 10.0)],
            ["V_ac = 10", "source"],
        ),
        (
            vec![("J_m", 10.0), ("lambda_start", 4.0)],
            ["lambda_start = 4", "locking"],
        ),
        (
            vec![("current", 1e-6)],
            ["current = 1e-6 A", "set source to current, or current to 0"],
        ),
        (
            vec![("source", 2.0), ("charge_imposed", 1e-12)],
            ["charge_imposed = 1e-12 C", "the source imposes the current"],
        ),
        (
            vec![("voltage", 6e4)],
            [
                "voltage = 60000 V",
                "set a value between -11000 and 11000 V",
            ],
        ),
        (vec![("force", 2.0)], ["force = 2 N", "0.03 N"]),
        (
            vec![("k1", -0.9), ("k2", 0.2), ("lambda_max", 6.0)],
            [
                "k1 = -0.9, k2 = 0.2 and k3 = 0",
                "where the stretch is 3.25",
            ],
        ),
        (vec![("k1", -0.2)], ["k1 = -0.2", "lambda_max = 10"]),
        (
            vec![("E_conduction", 1e4), ("G_p", 1e-10)],
            ["E_conduction = 10000 V/m", "at least 660000 V/m"],
        ),
        (
            vec![("lambda_start", 20.0)],
            ["lambda_start = 20", "lambda_max = 10"],
        ),
        (
            vec![("mu_1", 1e5), ("J_1", 5.0), ("xi1_start", 0.2)],
            ["xi1_start = 0.2", "locking"],
        ),
    ] {
        let mut host = Host::initializing(Interface::CoSimulation, &values);
        let fault = host.instance.exit_initialization().expect_err("a fault");
        let text = format!("{fault:?}");
        assert!(parts.iter().all(|part| text.contains(part)), "{text}");
    }
}

/// What is beyond the largest number is named, with the state and what to do; the rest can be read.
#[test]
fn a_result_that_is_no_number_is_named() {
    let values = [("voltage", 0.0), ("E_conduction", 1e4), ("sigma", 1e-9)];
    let mut host = Host::begun(&values);
    host.set("voltage", 600.0).expect("a voltage");
    let (reference, _) = row("lost_power");
    let fault = host.instance.get(Type::Real, &[reference], |_, _| ());
    let text = fault.expect_err("no number").text;
    for part in [
        "lost_power",
        "lambda = 1,",
        "charge_state = 0",
        "1.7976931348623157e308",
    ] {
        assert!(text.contains(part), "{text}");
    }
    host.step(1e-7);
    assert!(host.get("lambda") > 1.0);
}

/// A parameter with which there is no motion from where the actuator is: refused, and the motion
/// goes on bit for bit as if nothing had been tried.
#[test]
fn a_parameter_that_does_not_go_with_the_present_is_refused() {
    for interface in [Interface::CoSimulation, Interface::ModelExchange] {
        let values = [("J_m", 60.0), ("lambda_start", 1.5), ("lambda_max", 3.0)];
        let mut host = Host::initializing(interface, &values);
        let mut undisturbed = Host::initializing(interface, &values);
        for host in [&mut host, &mut undisturbed] {
            host.instance.exit_initialization().expect("a start");
            if interface == Interface::CoSimulation {
                host.step(1e-7);
            }
        }
        for (name, value, part) in [("J_m", 0.5, "lambda = 1."), ("k1", -3.0, "permittivity")] {
            let before = host.get(name);
            let saved = host.instance.save(Saved::default()).expect("a state");
            let fault = host.set(name, value).expect_err(name);
            assert!(
                fault.text.contains(&format!("{name} = {value}")),
                "{fault:?}"
            );
            assert!(fault.text.contains(part), "{fault:?}");
            assert_eq!(host.get(name), before);
            assert_eq!(
                host.instance.save(Saved::default()).expect("a state"),
                saved
            );
        }
        if interface == Interface::CoSimulation {
            host.step(3e-7);
            undisturbed.step(3e-7);
        }
        let [ours, theirs] = [&host, &undisturbed].map(|host| host.get("lambda").to_bits());
        assert_eq!(ours, theirs);
    }
}

/// A wrong power of ten within the limits of the variable, which the size of the actuator gives away.
#[test]
fn loads_out_of_proportion_are_refused_at_the_start() {
    for (values, part) in [
        (
            vec![("voltage", 60e3)],
            "voltage = 60000 V is out of proportion",
        ),
        (vec![("force", 0.3)], "force = 0.3 N is out of proportion"),
        (
            vec![("source_number", 3.0), ("charge_imposed", 10e-6)],
            "charge_imposed = 1e-5 C is out of proportion to n_layers*L^2*sqrt(eps*mu)",
        ),
        (
            vec![("R_s", 1e6), ("charge_start", -1e-6)],
            "charge_start = -1e-6 C is out of proportion",
        ),
        (
            vec![("source_number", 2.0), ("charge_start", 1e-6)],
            "charge_start = 1e-6 C is out of proportion",
        ),
    ] {
        let mut host = Host::initializing(Interface::CoSimulation, &values);
        let text = host.instance.exit_initialization().expect_err(part).text;
        assert!(text.contains(part), "{text}");
        assert!(text.contains("set a value between -"), "{text}");
    }
}

/// A material that locks so suddenly that no number holds how near it comes to its locking stretch: the message says so.
#[test]
fn a_material_that_locks_too_suddenly_is_named() {
    for (limit, force) in [(1e-3, 0.03), (1e-3, -0.03)] {
        let mut host = Host::begun(&[("J_m", limit), ("force", force)]);
        let fault = host.instance.do_step(0.0, 2e-6).expect_err("the end");
        let text = format!("{fault:?}");
        assert!(text.contains("where the material locks"), "{text}");
        assert!(text.contains("J_m is too small"), "{text}");
        // It would turn where 1 - I/J is exp(-2 W/J), at a work W of the force of 1.8: far below the smallest number.
        let work = 100.0 * 2.0 * (host.get("lambda") - 1.0).abs();
        assert!((-2.0 * work / limit).exp() == 0.0, "{work}");
    }
}

/// Breakdown is a flag, holds the actuator, or ends the simulation.
#[test]
fn breakdown_has_three_consequences() {
    let broken = [("E_breakdown", 62e6), ("lambda_max", 3.0)];
    for (choice, moves) in [(1.0, true), (2.0, false)] {
        let mut values = broken.to_vec();
        values.push(("on_breakdown", choice));
        let mut host = Host::begun(&values);
        host.follow(4e-6, 1e-7);
        assert_eq!(host.get("broken_down"), 1.0);
        assert_eq!(host.get("breakdown"), 1.0);
        assert_eq!(host.get("pulled_in"), 0.0);
        let time = host.get("breakdown_time");
        assert!(time > 0.0 && time < 2e-6, "{time}");
        // 600 V over 10 um times λ² is 62 V/um.
        let exact = (62.0_f64 / 60.0).sqrt();
        assert_eq!((host.get("lambda") - exact).abs() > 1e-6, moves);
    }
    let mut values = broken.to_vec();
    values.push(("on_breakdown", 3.0));
    let mut host = Host::begun(&values);
    let fault = host.instance.do_step(0.0, 1e-5).expect_err("the end");
    assert!(format!("{fault:?}").contains("broke down"), "{fault:?}");
}

/// Where the field is beyond breakdown as soon as the voltage is set, the step ends where it began: never before.
#[test]
fn a_step_that_ends_at_once_does_not_lead_back_in_time() {
    for k in 1..200 {
        let values = [("E_breakdown", 62e6), ("on_breakdown", 3.0)];
        let mut host = Host::begun(&values);
        let step = 1e-15 * f64::from(k);
        host.instance.do_step(0.0, step).expect("below breakdown");
        host.set("voltage", 700.0).expect("legal");
        host.instance.do_step(step, step).expect_err("the end");
        let reached = host.instance.last_successful_time();
        assert!(
            (step..=step * (1.0 + 1e-9)).contains(&reached),
            "{step:e}: {reached:e}"
        );
    }
}

/// A field that is beyond breakdown at the start broke down at the start time, in both interfaces and in each phase.
#[test]
fn a_breakdown_at_the_start_is_at_the_start_time() {
    for interface in [Interface::CoSimulation, Interface::ModelExchange] {
        let mut host = Host::initializing(interface, &[("E_breakdown", 1e6)]);
        for begun in [false, true] {
            if begun {
                host.instance.exit_initialization().expect("a start");
            }
            assert_eq!(host.get("broken_down"), 1.0, "{interface:?} {begun}");
            assert_eq!(host.get("breakdown_time"), 0.0);
        }
    }
    for choice in [2.0, 3.0] {
        let mut host = Host::begun(&[("E_breakdown", 1e6), ("on_breakdown", choice)]);
        let ends = host.instance.do_step(0.0, 1e-7).is_err();
        assert_eq!(ends, choice == 3.0);
        assert_eq!(host.get("breakdown_time"), 0.0, "{choice}");
    }
}

/// What the start refuses is refused later too, and the setting is named that it comes from.
#[test]
fn settings_that_exclude_each_other_are_refused_at_any_time() {
    type Settings = &'static [(&'static str, f64)];
    let cases: [(Settings, Settings, &str); 6] = [
        (
            &[],
            &[("k1", -10.0)],
            "k1 = -10 cannot be set: k1 = -10, k2",
        ),
        (
            &[("kappa2", 0.1)],
            &[("J_m", 100.0)],
            "J_m = 100 cannot be set: J_m = 100 chooses",
        ),
        (
            &[("J_m", 100.0)],
            &[("kappa2", 0.1), ("rho", 1200.0)],
            "kappa2 = 0.1 cannot be set",
        ),
        (
            &[("source", 3.0)],
            &[("V_ac", 100.0)],
            "V_ac = 100 cannot be set: V_ac = 100 V is added",
        ),
        (
            &[],
            &[("E_conduction", 1e4), ("sigma", 1e-6)],
            "sigma = 1e-6 cannot be set: E_conduction = 10000 V/m is out of proportion",
        ),
        // Each alone is refused, both together are not.
        (&[("J_m", 100.0)], &[("kappa2", 0.1), ("J_m", 0.0)], ""),
    ];
    for (start, tuned, part) in cases {
        let mut host = Host::begun(start);
        host.step(1e-7);
        let names: Vec<u32> = tuned.iter().map(|(name, _)| row(name).0).collect();
        let before: Vec<f64> = tuned.iter().map(|(name, _)| host.get(name)).collect();
        let set = host
            .instance
            .set(Type::Real, &names, |place| tuned[place].1);
        if part.is_empty() {
            set.expect("settings that go with each other");
            continue;
        }
        let fault = set.expect_err(part);
        assert!(fault.text.contains(part), "{}", fault.text);
        let after: Vec<f64> = tuned.iter().map(|(name, _)| host.get(name)).collect();
        assert_eq!(before, after);
    }
    // The permittivity is looked at before the field, which it decides.
    let values = [("k1", -8.0), ("lambda_start", 1.125), ("source", 3.0)];
    let mut host = Host::initializing(Interface::CoSimulation, &values);
    host.set("sigma", 1e-9).expect("legal");
    host.set("E_conduction", 1e6).expect("legal");
    let text = host
        .instance
        .exit_initialization()
        .expect_err("no charge holds")
        .text;
    assert!(text.contains("k1 = -8"), "{text}");
}
