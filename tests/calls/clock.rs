//! Hosts whose clock is not ours: of single precision, summed, from before 0, drifting.

use super::*;

fn started(start: f64, stop: Option<f64>, values: &[(&str, f64)]) -> Host {
    let host = Host::new();
    let (c, ends) = (host.component, i32::from(stop.is_some()));
    let stop = stop.unwrap_or(0.0);
    unsafe {
        assert_eq!(fmi2SetupExperiment(c, 0, 0.0, start, ends, stop), OK);
        assert_eq!(fmi2EnterInitializationMode(c), OK);
        for (name, value) in values {
            assert_eq!(host.set(name, *value), OK);
        }
        assert_eq!(fmi2ExitInitializationMode(c), OK);
    }
    host
}

#[track_caller]
fn step(host: &Host, time: f64, step: f64) {
    assert_eq!(host.step(time, step), OK, "{}", host.last_line());
}

/// The clocks of hosts that step by 0.02: by what they do from one step to the next.
type Clock = fn(f64, u32, f64) -> f64;
const H: f64 = 0.02;
const CLOCKS: [(&str, Clock); 5] = [
    ("sums in single precision", |time, _, _| {
        f64::from(time as f32 + H as f32)
    }),
    ("products in single precision", |_, k, start| {
        f64::from(start as f32 + k as f32 * H as f32)
    }),
    ("sums in double precision", |time, _, _| time + H),
    ("a time rounded to microseconds", |_, k, start| {
        ((start + f64::from(k) * H) * 1e6).round() / 1e6
    }),
    ("a time that grows by more than the step", |time, _, _| {
        time + 1.003 * H
    }),
];

/// The steps are as long as the host says, and the time is what it says.
#[test]
fn a_clock_of_another_precision_is_taken_over() {
    for start in [0.0, -1000.0, -7.5, 3000.0] {
        let exact = started(start, None, &[("phi", 0.6)]);
        for k in 0..4000 {
            step(&exact, start + f64::from(k) * H, H);
        }
        for (what, clock) in CLOCKS {
            let host = started(start, None, &[("phi", 0.6)]);
            let mut time = start;
            for k in 1..=4000 {
                step(&host, time, H);
                let rounding = 2e-14 * time.abs() + 1e-12;
                assert!(
                    (host.time() - time - H).abs() < rounding,
                    "{what} from {start}"
                );
                time = clock(time, k, start);
            }
            let difference = host.get("lambda") - exact.get("lambda");
            assert!(
                difference.abs() < 1e-13,
                "{what} from {start}: {difference:e}"
            );
        }
    }
}

/// Under an alternating voltage the angle follows the time that the host sees. The reference
/// steps the same motion with the phase set anew, so that its own clock does not matter.
#[test]
fn the_angle_of_the_drive_follows_the_hosts_time() {
    let drive = [("phi_ac", 0.3), ("omega_ac", 0.7)];
    for (what, clock) in CLOCKS {
        let (host, reference) = (started(-3.0, None, &drive), started(-3.0, None, &drive));
        let mut time = -3.0;
        for k in 1..=500 {
            step(&host, time, H);
            let exact = -3.0 + f64::from(k - 1) * H;
            assert_eq!(reference.set("phase_ac", 0.7 * (time - exact)), OK);
            step(&reference, exact, H);
            time = clock(time, k, -3.0);
        }
        let difference = host.get("lambda") - reference.get("lambda");
        // Ten times the tolerance: the two do not restart at the same times.
        assert!(difference.abs() < 1e-9, "{what}: {difference:e}");
    }
}

#[test]
fn the_time_of_a_collapse_is_the_hosts() {
    let exact = started(0.0, None, &[("phi", 0.7)]);
    step(&exact, 0.0, 50.0);
    let after = exact.get("pull_in_time");
    let host = started(0.0, None, &[("phi", 0.7)]);
    let drift = 1.004;
    for k in 0..500 {
        step(&host, f64::from(k) * 0.1 * drift, 0.1);
    }
    let steps = (after / 0.1).floor();
    let seen = steps * 0.1 * drift + (after - steps * 0.1);
    assert!((host.get("pull_in_time") - seen).abs() < 1e-9);
}

/// An input with derivatives is a function of the host's time, whenever it was set.
#[test]
fn inputs_with_derivatives_follow_the_hosts_time() {
    let host = started(0.0, None, &[]);
    let (h, drift) = (0.1, 1.005);
    let slope = |name: &str, value: f64| unsafe {
        let status = fmi2SetRealInputDerivatives(host.component, &reference(name), 1, &1, &value);
        assert_eq!(status, OK);
    };
    assert_eq!(host.set("S", 0.1), OK);
    slope("S", 0.01);
    for k in 0..200 {
        let time = f64::from(k) * h * drift;
        if k % 7 == 0 {
            assert_eq!(host.set("phi", 0.2), OK);
            slope("phi", -0.03);
        }
        step(&host, time, h);
        assert!(
            (host.get("S") - (0.1 + 0.01 * (time + h))).abs() < 1e-12,
            "step {k}"
        );
        let since = f64::from(k - k % 7) * h * drift;
        assert!((host.get("phi") - (0.2 - 0.03 * (time + h - since))).abs() < 1e-12);
    }
}

#[test]
fn a_forgotten_or_doubled_step_is_refused_on_any_clock() {
    for start in [0.0, -1000.0, 3000.0] {
        for (what, clock) in CLOCKS {
            let host = started(
                start,
                None,
                &[("phi", 0.5), ("phi_ac", 0.1), ("omega_ac", 1.0)],
            );
            let (mut last, mut time) = (start, start);
            for k in 1..=300 {
                step(&host, time, H);
                (last, time) = (time, clock(time, k, start));
            }
            let before = host.serialized();
            for wrong in [
                last,
                clock(time, 301, start),
                time + H,
                time - H,
                time + 0.6 * H,
            ] {
                assert_eq!(host.step(wrong, H), ERROR, "{what} from {start}: {wrong}");
                assert_eq!(host.serialized(), before);
            }
            step(&host, time, H);
        }
    }
}

/// The stop time is met by the host's clock, or by the sum of its steps.
#[test]
fn a_clock_that_runs_away_reaches_the_stop_time() {
    for (what, clock) in &CLOCKS[..4] {
        let host = started(0.0, Some(200.0), &[("phi", 0.5)]);
        let mut time = 0.0;
        for k in 1..=10_000 {
            assert_eq!(host.step(time, H), OK, "{what}, {k}: {}", host.last_line());
            time = clock(time, k, 0.0);
        }
        assert_eq!(host.step(time, H), ERROR, "{what}: beyond the stop time");
        assert!(host.last_line().contains("goes beyond the stop time 200"));
    }
}

#[test]
fn a_run_may_be_without_an_end() {
    let host = Host::new();
    let setup =
        |start, stop| unsafe { fmi2SetupExperiment(host.component, 0, 0.0, start, 1, stop) };
    for stop in [f64::NAN, f64::NEG_INFINITY, -1.0] {
        assert_eq!(setup(0.0, stop), ERROR);
    }
    assert_eq!(setup(f64::INFINITY, f64::INFINITY), ERROR);
    assert_eq!(setup(0.0, f64::INFINITY), OK);
    unsafe {
        assert_eq!(fmi2EnterInitializationMode(host.component), OK);
        assert_eq!(fmi2ExitInitializationMode(host.component), OK);
    }
    step(&host, 0.0, 1e9);
    step(&host, 1e9, 1e9);
}

/// Numbers whose powers are none are refused where they come in, and the actuator's own bytes
/// are always good.
#[test]
fn numbers_out_of_all_range_are_refused_at_the_door() {
    let host = Host::in_phase("stepping");
    let c = host.component;
    for (name, order, value) in [("S", 4, 1e300), ("phi", 1, -1e308), ("S", 2, f64::NAN)] {
        let status = unsafe { fmi2SetRealInputDerivatives(c, &reference(name), 1, &order, &value) };
        assert_eq!(status, ERROR, "{name}: {value}");
    }
    for (h, words) in [
        (1e-320, "1e-320 is not between 1e-100 and 1e50"),
        (5e-324, "5e-324 is not between"),
        (1e-200, "1e-200 is not between"),
        (f64::MAX, "1.7976931348623157e308 is not between"),
    ] {
        assert_eq!(host.step(0.0, h), ERROR);
        assert!(host.last_line().contains(words), "{}", host.last_line());
    }
    let setup = unsafe { fmi2SetupExperiment(Host::new().component, 0, 0.0, 1e300, 0, 0.0) };
    assert_eq!(setup, ERROR);
    for slope in [1e50, -1e50, 1e20, 1e-320] {
        for order in 1..=4 {
            for h in [1e-100, 1e-60, 1e-30, 1e-9, 1.0, 1e9, 1e50] {
                let host = Host::in_phase("stepping");
                for name in ["S", "phi"] {
                    let c = host.component;
                    let reference = reference(name);
                    let status =
                        unsafe { fmi2SetRealInputDerivatives(c, &reference, 1, &order, &slope) };
                    assert_eq!(status, OK);
                }
                for _ in 0..3 {
                    let status = host.step(host.time(), h);
                    let what = format!("{slope:e}, order {order}, step {h:e}: {status}");
                    assert!(
                        status == OK || status == DISCARD,
                        "{what}: {}",
                        host.last_line()
                    );
                    for name in ["S", "phi", "lambda", "lambda_dot"] {
                        assert!(host.get(name).is_finite(), "{name} after {what}");
                    }
                    let bytes = host.serialized();
                    assert_eq!(Host::new().restored(&bytes), OK, "{what}");
                    if status == DISCARD {
                        break;
                    }
                }
            }
        }
    }
}

/// A periodic motion stays within its limits in steps of any length, one after the other.
#[test]
fn the_longest_steps_leave_no_limits() {
    for values in [
        &[("phi", 0.5)][..],
        &[("S", 0.3)],
        &[("phi", 0.1), ("c", 1e6)],
        &[("phi", 0.5), ("lambda_start", 1.1)],
        &[("gamma_s", 0.1), ("tau_s", 0.2), ("E_s", 0.3), ("phi", 0.2)],
    ] {
        for exponent in 0..=50 {
            let host = started(0.0, None, values);
            for h in [10_f64.powi(exponent), 0.7 * 10_f64.powi(exponent), 0.01] {
                let status = host.step(host.time(), h);
                // Next to a long time no clock can show a short step.
                if status != OK {
                    assert!(h < host.time() * 1e-10, "{h:e}: {}", host.last_line());
                    break;
                }
                let stretch = host.get("lambda");
                assert!(
                    (0.5..2.0).contains(&stretch),
                    "{values:?}, {h:e}: {stretch:e}"
                );
            }
            assert_eq!(Host::new().restored(&host.serialized()), OK, "{exponent}");
        }
    }
}

/// A step that is too much work ends early, and the host may go on from there; one that does
/// nothing about it is asked to end.
#[test]
fn a_step_that_is_too_much_work_can_be_gone_on_with() {
    let drive = [("phi_ac", 0.5), ("omega_ac", 1000.0)];
    let host = started(0.0, None, &drive);
    let ends = || {
        let (mut terminated, mut status) = (7, 7);
        unsafe {
            let c = host.component;
            fmi2GetBooleanStatus(c, fmi2StatusKind_fmi2Terminated, &mut terminated);
            fmi2GetStatus(c, fmi2StatusKind_fmi2DoStepStatus, &mut status);
        }
        (terminated == 1, status)
    };
    assert_eq!(host.step(0.0, 1e9), DISCARD);
    assert!(
        host.last_line().contains("use shorter steps"),
        "{}",
        host.last_line()
    );
    assert_eq!(ends(), (false, DISCARD));
    let reached = host.time();
    assert!(reached > 0.0 && reached < 1e9);
    assert_eq!(Host::new().restored(&host.serialized()), OK);
    step(&host, reached, 0.1);
    assert_eq!(ends(), (false, OK));
    assert_eq!(host.set("phi", 0.1), OK);
    step(&host, reached + 0.1, 0.1);

    let host = started(0.0, None, &drive);
    assert_eq!(host.step(0.0, 1e9), DISCARD);
    let reached = host.time();
    assert_eq!(host.step(0.0, 1e9), DISCARD);
    let mut terminated = 0;
    unsafe {
        fmi2GetBooleanStatus(
            host.component,
            fmi2StatusKind_fmi2Terminated,
            &mut terminated,
        );
    }
    assert_eq!((terminated, host.time()), (1, reached));
    assert_eq!(host.step(reached, 0.1), ERROR);
}

/// A communication point that is no number is no time at which a step has ended, with a stop time or without.
#[test]
fn a_communication_point_that_is_not_finite_is_refused() {
    for defined in [0, 1] {
        let host = Host::new();
        let c = host.component;
        unsafe {
            assert_eq!(fmi2SetupExperiment(c, 0, 0.0, 0.0, defined, 9.0), OK);
            assert_eq!(fmi2EnterInitializationMode(c), OK);
            assert_eq!(fmi2ExitInitializationMode(c), OK);
        }
        for steps in 0..2 {
            let before = host.serialized();
            for current in [f64::INFINITY, f64::NEG_INFINITY, f64::NAN] {
                assert_eq!(host.step(current, 0.5), ERROR, "{current}");
                assert!(
                    host.last_line().contains("is not the time"),
                    "{}",
                    host.last_line()
                );
                assert_eq!(host.serialized(), before);
            }
            assert_eq!(host.step(0.5 * f64::from(steps), 0.5), OK);
        }
    }
}
