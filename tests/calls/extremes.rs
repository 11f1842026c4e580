//! The extremes of the stretch, and the window over which they are recorded.

use super::*;

/// An instance under an alternating voltage, whose extremes are recorded where the window
/// is not 0 or the Boolean is true.
fn driven(boolean: bool, window: f64) -> Host {
    let host = Host::in_phase("initialization");
    for (name, value) in [
        ("phi", 0.2),
        ("phi_ac", 0.4),
        ("omega_ac", 0.37),
        ("E_s", 0.2),
        ("extremes_window", window),
    ] {
        assert_eq!(host.set(name, value), OK);
    }
    let record = i32::from(boolean);
    unsafe {
        let c = host.component;
        assert_eq!(
            fmi2SetBoolean(c, &reference("record_extremes"), 1, &record),
            OK
        );
        assert_eq!(fmi2ExitInitializationMode(c), OK);
    }
    host
}

fn extremes(host: &Host) -> [f64; 2] {
    ["lambda_lowest", "lambda_highest"].map(|name| host.get(name))
}

/// The extremes of a fine sample of the motion from `begin` to `end`.
fn sampled(begin: f64, end: f64) -> [f64; 2] {
    let (host, count) = (driven(false, 0.0), 40_000);
    assert_eq!(host.step(0.0, begin), OK);
    let mut found = [host.get("lambda"); 2];
    let step = (end - begin) / f64::from(count);
    for k in 0..count {
        assert_eq!(host.step(begin + f64::from(k) * step, step), OK);
        let stretch = host.get("lambda");
        found = [found[0].min(stretch), found[1].max(stretch)];
    }
    found
}

#[test]
fn a_new_window_begins_at_the_present() {
    for (boolean, first) in [(true, 0.0), (false, 1.0)] {
        let host = driven(boolean, first);
        assert_eq!(host.step(0.0, 31.0), OK);
        let whole = extremes(&host);
        assert!(whole[1] - whole[0] > 0.01);
        // The same value again begins nothing.
        assert_eq!(host.set("extremes_window", first), OK);
        assert_eq!(extremes(&host), whole);
        assert_eq!(host.set("extremes_window", 2.0), OK);
        assert_eq!(extremes(&host), [host.get("lambda"); 2]);
        assert_eq!(host.step(31.0, 9.5), OK);
        for (found, expected) in extremes(&host).into_iter().zip(sampled(31.0, 40.5)) {
            assert!((found - expected).abs() < 1e-8, "{found} and {expected}");
        }
    }
}

#[test]
fn a_window_can_begin_where_nothing_was_recorded_and_end_again() {
    let host = driven(false, 0.0);
    assert_eq!(host.step(0.0, 31.0), OK);
    assert_eq!(extremes(&host), [0.0; 2]);
    assert_eq!(host.set("extremes_window", 1.0), OK);
    assert_eq!(host.step(31.0, 9.5), OK);
    for (found, expected) in extremes(&host).into_iter().zip(sampled(31.0, 40.5)) {
        assert!((found - expected).abs() < 1e-8, "{found} and {expected}");
    }
    assert_eq!(host.set("extremes_window", 0.0), OK);
    assert_eq!(extremes(&host), [0.0; 2]);
    assert_eq!(host.step(40.5, 1.0), OK);
}

/// On an orbit, where nothing is integrated any more, and from there on.
#[test]
fn a_window_of_a_motion_that_repeats_has_its_turning_points() {
    let host = Host::in_phase("initialization");
    assert_eq!(host.set("phi", 0.5), OK);
    assert_eq!(host.set("extremes_window", 1.0), OK);
    assert_eq!(unsafe { fmi2ExitInitializationMode(host.component) }, OK);
    assert_eq!(host.step(0.0, 1000.0), OK);
    let whole = extremes(&host);
    for k in 0..40 {
        let time = 1000.0 + 50.0 * f64::from(k) + 0.25 * f64::from(k * k);
        let span = 50.0 + 0.25 * f64::from(2 * k + 1);
        assert_eq!(host.set("extremes_window", f64::from(k + 2)), OK);
        assert_eq!(host.step(time, 0.001), OK);
        let [lowest, highest] = extremes(&host);
        assert!(highest - lowest < 1e-3, "{lowest} {highest}");
        assert_eq!(host.step(time + 0.001, span - 0.001), OK);
        for (found, expected) in extremes(&host).into_iter().zip(whole) {
            assert!((found - expected).abs() < 1e-9, "{found} and {expected}");
        }
    }
}

#[test]
fn a_saved_window_goes_on_bit_for_bit() {
    let host = driven(false, 3.0);
    assert_eq!(host.step(0.0, 12.0), OK);
    assert_eq!(host.set("extremes_window", 4.0), OK);
    let (mut state, c) = (null_mut(), host.component);
    assert_eq!(unsafe { fmi2GetFMUstate(c, &mut state) }, OK);
    let go_on = || {
        assert_eq!(host.step(12.0, 3.0), OK);
        assert_eq!(host.set("extremes_window", 5.0), OK);
        assert_eq!(host.step(15.0, 20.0), OK);
        extremes(&host).map(f64::to_bits)
    };
    let first = go_on();
    assert_eq!(unsafe { fmi2SetFMUstate(c, state) }, OK);
    assert_eq!(go_on(), first);
    assert_eq!(unsafe { fmi2FreeFMUstate(c, &mut state) }, OK);
}

/// A host that sets numbers only asks to terminate.
#[test]
fn terminating_can_be_asked_for_by_a_number() {
    let host = Host::in_phase("initialization");
    assert_eq!(host.set("phi", 0.7), OK);
    assert_eq!(host.set("terminate_on_pull_in", 1.0), OK);
    assert_eq!(unsafe { fmi2ExitInitializationMode(host.component) }, OK);
    assert_eq!(host.step(0.0, 10.0), OK);
    assert_eq!(host.get("collapsed"), 0.0);
    assert_eq!(host.step(10.0, 60.0), DISCARD);
    assert!(
        host.last_line().contains("on_pull_in = terminate"),
        "{}",
        host.last_line()
    );
    assert_eq!(host.get("collapsed"), 1.0);
    assert_eq!(host.set("terminate_on_pull_in", 0.0), ERROR);
}

/// A host steps beyond the limit before it handles the event there: what is recorded ends at the limit, whether the
/// window begins before the event is handled or after it.
#[test]
fn a_window_that_begins_beyond_a_limit_begins_at_the_limit() {
    for window_first in [true, false] {
        let host = Host::in_phase_of(fmi2Type_fmi2ModelExchange, "continuous");
        host.put(1e-7, [10.5, 1.0]);
        let handle = || unsafe {
            assert_eq!(
                fmi2NewDiscreteStates(host.component, &mut exchange::no_info()),
                OK
            );
        };
        unsafe { assert_eq!(fmi2EnterEventMode(host.component), OK) };
        if !window_first {
            handle();
        }
        assert_eq!(host.set("extremes_window", 1.0), OK);
        if window_first {
            handle();
        }
        assert_eq!(host.get("lambda_highest"), 10.0);
    }
}
