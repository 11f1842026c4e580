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
