//! What is refused, with which words, and that nothing changes by it.

use super::*;

#[test]
fn bad_values_are_refused_by_name_and_limit_and_change_nothing() {
    let host = Host::in_phase("stepping");
    let cases = [
        ("phi", f64::NAN, "phi = NaN is not a finite number"),
        ("S", f64::INFINITY, "S = inf is not a finite number"),
        ("c", 0.0, "c = 0 is below its minimum 0.001"),
        ("E_s", 101.0, "E_s = 101 is above its maximum 100"),
        ("lambda", 1.0, "lambda is a result of the model"),
        (
            "lambda_start",
            1.1,
            "lambda_start is fixed after initialization",
        ),
        (
            "pulled_in",
            1.0,
            "pulled_in (value reference 16) is not a real number",
        ),
    ];
    for (name, value, message) in cases {
        // The good value before the bad one must not be set either.
        let (references, values) = ([reference("gamma_s"), reference(name)], [0.05, value]);
        let status =
            unsafe { fmi2SetReal(host.component, references.as_ptr(), 2, values.as_ptr()) };
        assert_eq!(status, ERROR, "{name} = {value}");
        assert!(host.last_line().contains(message), "{}", host.last_line());
        assert_eq!(host.get("gamma_s"), 0.0);
    }
    let status = unsafe { fmi2SetReal(host.component, &99, 1, &1.0) };
    assert_eq!(status, ERROR);
    let largest = VARIABLES.len() - 1;
    let message = format!("no variable with value reference 99; the largest is {largest}");
    assert!(host.last_line().contains(&message), "{}", host.last_line());
}

#[test]
fn impossible_steps_are_refused_and_the_run_goes_on() {
    let host = Host::new();
    let c = host.component;
    unsafe {
        assert_eq!(fmi2SetupExperiment(c, 1, 1e-10, 5.0, 1, 7.0), OK);
        assert_eq!(fmi2EnterInitializationMode(c), OK);
        assert_eq!(fmi2ExitInitializationMode(c), OK);
    }
    assert_eq!(host.set("phi", 0.6), OK);
    for (time, step) in [
        (5.0, 0.0),
        (5.0, -1.0),
        (5.0, f64::NAN),
        (5.0, f64::INFINITY),
        (f64::NAN, 0.1),
        (0.0, 0.1),
        (5.1, 0.1),
        (5.0, 3.0),
    ] {
        assert_eq!(host.step(time, step), ERROR, "step {step} from {time}");
    }
    assert_eq!(host.step(5.0, 1.0), OK);
    assert_eq!(host.step(6.0, 1.0), OK);
    assert_eq!(host.step(7.0, 0.1), ERROR, "beyond the stop time");
    assert!(host.get("lambda") > 1.0);
}

#[test]
fn null_pointers_are_refused_everywhere() {
    let host = Host::in_phase("stepping");
    let c = host.component;
    unsafe {
        for (_, function, ..) in TABLE {
            assert_eq!(function(null_mut()), ERROR);
        }
        fmi2FreeInstance(null_mut());
        assert_eq!(fmi2GetReal(c, null(), 1, &mut 0.0), ERROR);
        assert_eq!(fmi2GetReal(c, &0, 1, null_mut()), ERROR);
        assert_eq!(fmi2GetReal(c, null(), 0, null_mut()), OK);
        assert_eq!(fmi2SetReal(c, null(), 1, &0.0), ERROR);
        assert_eq!(fmi2SetReal(c, &0, 1, null()), ERROR);
        assert_eq!(fmi2SetReal(c, null(), 0, null()), OK);
        assert_eq!(fmi2SetDebugLogging(c, 1, 1, null()), ERROR);
        assert_eq!(fmi2SetDebugLogging(c, 1, 1, &null()), ERROR);
        assert_eq!(
            fmi2GetRealStatus(c, fmi2StatusKind_fmi2LastSuccessfulTime, null_mut()),
            ERROR
        );
    }
}

#[test]
fn instances_are_refused_with_a_reason() {
    let guid = CString::new(Nondimensional::GUID).expect("no NUL");
    let co_simulation = fmi2Type_fmi2CoSimulation;
    let cases = [
        (
            c"a".as_ptr(),
            co_simulation,
            c"{wrong}".as_ptr(),
            "do not belong together",
        ),
        (
            c"a".as_ptr(),
            co_simulation,
            null(),
            "the GUID is a null pointer",
        ),
        (
            c"".as_ptr(),
            co_simulation,
            guid.as_ptr(),
            "the instance name is empty",
        ),
        (
            null(),
            co_simulation,
            guid.as_ptr(),
            "the instance name is a null pointer",
        ),
        (c"a".as_ptr(), 7, guid.as_ptr(), "there is no FMU type 7"),
    ];
    for (name, kind, guid, message) in cases {
        let host = Host::with(name, kind, guid);
        assert!(host.component.is_null());
        assert!(host.last_line().contains(message), "{}", host.last_line());
    }
    let none = unsafe { fmi2Instantiate(c"a".as_ptr(), 1, guid.as_ptr(), null(), null(), 0, 0) };
    assert!(none.is_null());
}

#[test]
fn start_values_must_lie_between_the_limits() {
    let host = Host::in_phase("initialization");
    assert_eq!(host.set("lambda_start", 20.0), OK);
    assert_eq!(host.get("lambda"), 20.0);
    unsafe {
        assert_eq!(fmi2ExitInitializationMode(host.component), ERROR);
        assert!(
            host.last_line().contains("lambda_max = 10"),
            "{}",
            host.last_line()
        );
        assert_eq!(host.set("lambda_start", 1.2), OK);
        assert_eq!(fmi2ExitInitializationMode(host.component), OK);
    }
    assert_eq!(host.get("lambda"), 1.2);
}

#[test]
fn a_tolerance_out_of_range_is_moved_with_a_warning() {
    let host = Host::new();
    let setup =
        |tolerance| unsafe { fmi2SetupExperiment(host.component, 1, tolerance, 0.0, 0, 0.0) };
    assert_eq!(setup(1e-30), WARNING);
    assert!(
        host.last_line()
            .contains("1e-30 is outside 1e-14 to 0.01; 1e-14 is used"),
        "{}",
        host.last_line()
    );
    assert_eq!(setup(-1.0), ERROR);
    assert_eq!(setup(f64::NAN), ERROR);
    assert_eq!(setup(1e-6), OK);
}

#[test]
fn log_categories_are_obeyed() {
    let host = Host::in_phase("stepping");
    let lines = || host.log.lock().expect("one thread").len();
    let before = lines();
    let only =
        |category: &CStr| unsafe { fmi2SetDebugLogging(host.component, 1, 1, &category.as_ptr()) };
    assert_eq!(only(c"logEvents"), OK);
    assert_eq!(host.set("phi", f64::NAN), ERROR);
    assert_eq!(lines(), before, "errors are switched off");
    assert_eq!(only(c"logStatusError"), OK);
    assert_eq!(host.set("phi", f64::NAN), ERROR);
    assert_eq!(lines(), before + 1);
    // A discarded call is among the errors, as the description of the category says.
    for (name, value) in [("phi_ac", 0.1), ("omega_ac", 1000.0)] {
        assert_eq!(host.set(name, value), OK);
    }
    assert_eq!(host.step(0.0, 1e9), DISCARD);
    assert_eq!(lines(), before + 2);
    // Where logging is switched off, the list does not matter.
    let warnings = c"logStatusWarning".as_ptr();
    assert_eq!(
        unsafe { fmi2SetDebugLogging(host.component, 0, 1, &warnings) },
        OK
    );
    assert_eq!(host.set("phi", f64::NAN), ERROR);
    assert_eq!(lines(), before + 2);
    assert_eq!(only(c"logStatusError"), OK);
    assert_eq!(only(c"logNothing"), ERROR);
    assert!(
        host.last_line()
            .contains("logEvents, logStatusWarning, logStatusError")
    );
}
