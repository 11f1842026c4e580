//! What a run does that is driven through the C functions.

use super::*;

#[test]
fn a_collapse_is_held_and_told_once() {
    let host = Host::in_phase("stepping");
    assert_eq!(host.set("phi", 0.7), OK);
    for step in 0..10 {
        assert_eq!(host.step(10.0 * f64::from(step), 10.0), OK);
    }
    let told: Vec<String> = host.log.lock().expect("one thread").clone();
    assert_eq!(
        told.iter()
            .filter(|line| line.contains("pulled in"))
            .count(),
        1,
        "{told:?}"
    );
    assert_eq!(host.get("lambda"), 10.0);
    assert_eq!(host.get("lambda_dot"), 0.0);
    assert!((host.get("pull_in_time") - 38.6).abs() < 0.1);
    let mut pulled_in = 0;
    let status =
        unsafe { fmi2GetBoolean(host.component, &reference("pulled_in"), 1, &mut pulled_in) };
    assert_eq!((status, pulled_in), (OK, 1));
}

#[test]
fn a_collapse_that_terminates_tells_its_time() {
    let host = Host::in_phase("failed");
    let (mut terminated, mut time) = (0, 0.0);
    unsafe {
        let c = host.component;
        assert_eq!(
            fmi2GetBooleanStatus(c, fmi2StatusKind_fmi2Terminated, &mut terminated),
            OK
        );
        assert_eq!(
            fmi2GetRealStatus(c, fmi2StatusKind_fmi2LastSuccessfulTime, &mut time),
            OK
        );
    }
    assert_eq!(terminated, 1);
    assert_eq!(time, host.get("pull_in_time"));
    assert!(time < 50.0);
}

#[test]
fn reset_gives_the_same_run_bit_for_bit() {
    let host = Host::in_phase("stepping");
    let c = host.component;
    let run = || {
        assert_eq!(host.set("phi", 0.6), OK);
        assert_eq!(host.step(0.0, 3.7), OK);
        assert_eq!(host.set("S", 0.3), OK);
        assert_eq!(host.step(3.7, 1.1), OK);
        host.get("lambda")
    };
    let first = run();
    unsafe {
        assert_eq!(fmi2Reset(c), OK);
        assert_eq!(fmi2EnterInitializationMode(c), OK);
        assert_eq!(host.get("S"), 0.0);
        assert_eq!(fmi2ExitInitializationMode(c), OK);
    }
    assert_eq!(run(), first);
}

/// An input that is a cubic in time, once by its derivatives in two long steps
/// and once held in many short ones: the holds converge to the derivatives.
#[test]
fn input_derivatives_are_followed_inside_a_step() {
    let cubic = |t: f64| 0.3 + 0.05 * t - 0.01 * t * t + 0.001 * t * t * t;
    let exact = Host::in_phase("stepping");
    assert_eq!(exact.set("phi", cubic(0.0)), OK);
    let (phi, orders, values) = ([0, 0, 0], [1, 2, 3], [0.05, -0.02, 0.006]);
    let status = unsafe {
        fmi2SetRealInputDerivatives(
            exact.component,
            phi.as_ptr(),
            3,
            orders.as_ptr(),
            values.as_ptr(),
        )
    };
    assert_eq!(status, OK);
    assert_eq!(exact.step(0.0, 3.0), OK);
    assert_eq!(exact.step(3.0, 5.0), OK);
    assert!((exact.get("phi") - cubic(8.0)).abs() < 1e-14);
    let error = |count: u32| {
        let held = Host::in_phase("stepping");
        let step = 8.0 / f64::from(count);
        for i in 0..count {
            let time = step * f64::from(i);
            // In the middle of each step, so that holding is of second order.
            assert_eq!(held.set("phi", cubic(time + 0.5 * step)), OK);
            assert_eq!(held.step(time, step), OK);
        }
        (held.get("lambda") - exact.get("lambda")).abs()
    };
    let (coarse, fine) = (error(100), error(1000));
    assert!(
        fine < 1e-7 && (coarse / fine - 100.0).abs() < 5.0,
        "{coarse} and {fine}"
    );
}

/// A host may set derivatives of inputs before it says when the simulation
/// starts; an input that is then set has the value that was set.
#[test]
fn input_derivatives_set_early_count_from_the_start_time() {
    let host = Host::new();
    let c = host.component;
    let phi = reference("phi");
    unsafe {
        assert_eq!(fmi2SetRealInputDerivatives(c, &phi, 1, &1, &1.92), OK);
        assert_eq!(fmi2SetupExperiment(c, 0, 0.0, 1.343, 0, 0.0), OK);
        assert_eq!(fmi2EnterInitializationMode(c), OK);
        assert_eq!(fmi2SetReal(c, &phi, 1, &0.25), OK);
        assert_eq!(host.get("phi"), 0.25);
        assert_eq!(fmi2ExitInitializationMode(c), OK);
        assert_eq!(host.get("phi"), 0.25);
        assert_eq!(fmi2DoStep(c, 1.343, 0.125, 1), OK);
    }
    assert!((host.get("phi") - (0.25 + 0.125 * 1.92)).abs() < 1e-15);
}

/// A built-in voltage of frequency 0 holds its phase: it is a part of a constant voltage, in steps of all kinds.
#[test]
fn a_drive_of_frequency_0_adds_its_sine() {
    let start = |name: &str, value: f64| {
        let host = Host::in_phase("initialization");
        for (name, value) in [("c", 100.0), ("E_s", 0.2), (name, value)] {
            assert_eq!(host.set(name, value), OK);
        }
        host
    };
    let sine = 0.3 * 1.0_f64.sin();
    for step in [0.01, 0.3, 3.0, 8.0] {
        let (driven, plain) = (start("phi_ac", 0.3), start("phi_ac", 0.0));
        assert_eq!(driven.set("omega_ac", 0.0), OK);
        assert_eq!(driven.set("phase_ac", 1.0), OK);
        for host in [&driven, &plain] {
            assert_eq!(unsafe { fmi2ExitInitializationMode(host.component) }, OK);
        }
        for k in 0..40 {
            let phi = 0.2 + 0.05 * f64::from(k).sin();
            assert_eq!(driven.set("phi", phi), OK);
            assert_eq!(plain.set("phi", phi + sine), OK);
            for host in [&driven, &plain] {
                assert_eq!(host.step(host.time(), step), OK);
            }
            let [ours, theirs] = [&driven, &plain].map(|host| host.get("lambda"));
            assert!((ours - theirs).abs() < 1e-8, "{step}: {ours} {theirs}");
        }
    }
}

/// A drive that is tuned to a stop keeps the voltage at which it has stopped, in long steps as in short ones.
#[test]
fn a_drive_tuned_to_a_stop_keeps_its_voltage() {
    let long = Host::in_phase("stepping");
    for (name, value) in [("phi", 0.2), ("phi_ac", 0.3), ("omega_ac", 0.1)] {
        assert_eq!(long.set(name, value), OK);
    }
    assert_eq!(long.step(0.0, 12.0), OK);
    assert_eq!(long.set("omega_ac", 0.0), OK);
    let stopped = long.get("phi_total");
    assert!((stopped - 0.2 - 0.3 * 1.2_f64.sin()).abs() < 1e-15);
    let short = Host::new();
    assert_eq!(short.restored(&long.serialized()), OK);
    for k in 0..20 {
        for (host, steps) in [(&long, 1), (&short, 300)] {
            assert_eq!(host.set("S", 1e-3 * f64::from(k)), OK);
            for _ in 0..steps {
                assert_eq!(host.step(host.time(), 3.0 / f64::from(steps)), OK);
            }
            assert_eq!(host.get("phi_total"), stopped);
        }
        let [ours, theirs] = [&long, &short].map(|host| host.get("lambda"));
        assert!((ours - theirs).abs() < 1e-7, "{ours} {theirs}");
    }
}
