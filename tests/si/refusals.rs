//! What cannot be meant is refused with the variable, the value, the limit and what to do.

use crate::host::Host;
use dielectric_elastomer_actuator::instance::Interface;

/// A wrong power of ten meets a limit, and the message names the unit.
#[test]
fn unphysical_values_are_refused() {
    let mut host = Host::initializing(Interface::CoSimulation, &[]);
    for (name, value, part) in [
        ("H", 10.0, "10 um are 10e-6"),
        ("H", 0.0, "below its minimum"),
        ("H", -1e-5, "below its minimum"),
        ("mu", 0.3, "0.3 MPa are 0.3e6"),
        ("rho", 1.1, "1.1 g/cm3 are 1100"),
        ("rho", 0.0, "below its minimum"),
        ("R_s", -1.0, "below its minimum"),
        ("eps_r", 0.5, "below its minimum"),
        ("L", 20.0, "20 mm are 20e-3"),
        ("voltage", f64::NAN, "not a finite number"),
        ("tau_1", 0.0, "3 ms are 3e-3"),
    ] {
        let before = host.get(name);
        let fault = host.set(name, value).expect_err(name);
        let text = format!("{fault:?}");
        assert!(text.contains(name) && text.contains(part), "{text}");
        assert_eq!(host.get(name), before);
    }
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
        (vec![("k1", -0.2)], ["k1", "lambda_max = 10"]),
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
