//! The C functions, called as a host would: every function in every phase
//! against the table of the standard, hostile arguments, and random orders.
//!
//! Safety of all calls: components are live, and arrays are as long as their
//! counts say, or null where that is what is tested.
#![allow(unsafe_code, clippy::undocumented_unsafe_blocks)]

use std::ffi::{CStr, CString, c_char, c_void};
use std::ptr::{null, null_mut};
use std::sync::Mutex;

use dielectric_elastomer_actuator::abi::*;
use dielectric_elastomer_actuator::description::GUID;
use dielectric_elastomer_actuator::variables::{Access, Kind, VARIABLES, value_reference};
use fmi::fmi2::binding::*;
use proptest::prelude::*;

const OK: fmi2Status = fmi2Status_fmi2OK;
const WARNING: fmi2Status = fmi2Status_fmi2Warning;
const DISCARD: fmi2Status = fmi2Status_fmi2Discard;
const ERROR: fmi2Status = fmi2Status_fmi2Error;

fn reference(name: &str) -> u32 {
    value_reference(name).unwrap_or_else(|| panic!("no variable {name}"))
}

type Log = Mutex<Vec<String>>;

/// Stands in for the host's variadic logger: on the platforms of these tests a
/// variadic callee may ignore what follows its named arguments.
unsafe extern "C" fn logger(
    environment: *mut c_void,
    _name: *const c_char,
    _status: fmi2Status,
    category: *const c_char,
    message: *const c_char,
) {
    let (log, category, message) = unsafe {
        (
            &*environment.cast::<Log>(),
            CStr::from_ptr(category),
            CStr::from_ptr(message),
        )
    };
    let line = format!(
        "{}: {}",
        category.to_string_lossy(),
        message.to_string_lossy()
    );
    log.lock().expect("one thread").push(line);
}

/// An instance and what it told its host.
struct Host {
    component: fmi2Component,
    log: Box<Log>,
}

impl Host {
    fn with(name: *const c_char, kind: fmi2Type, guid: *const c_char) -> Host {
        let log = Box::new(Log::default());
        let named = logger
            as unsafe extern "C" fn(
                *mut c_void,
                *const c_char,
                fmi2Status,
                *const c_char,
                *const c_char,
            );
        let callbacks = fmi2CallbackFunctions {
            // See `logger`.
            logger: unsafe {
                std::mem::transmute::<*const (), fmi2CallbackLogger>(named as *const ())
            },
            allocateMemory: None,
            freeMemory: None,
            stepFinished: None,
            componentEnvironment: (&raw const *log).cast_mut().cast(),
        };
        let component = unsafe { fmi2Instantiate(name, kind, guid, null(), &callbacks, 0, 1) };
        Host { component, log }
    }

    fn new() -> Host {
        let guid = CString::new(GUID).expect("no NUL");
        let host = Host::with(
            c"actuator".as_ptr(),
            fmi2Type_fmi2CoSimulation,
            guid.as_ptr(),
        );
        assert!(!host.component.is_null());
        host
    }

    fn in_phase(phase: &str) -> Host {
        let host = Host::new();
        let c = host.component;
        unsafe {
            if phase == "instantiated" {
                return host;
            }
            assert_eq!(fmi2SetupExperiment(c, 0, 0.0, 0.0, 0, f64::NAN), OK);
            assert_eq!(fmi2EnterInitializationMode(c), OK);
            if phase == "initialization" {
                return host;
            }
            if phase == "failed" {
                assert_eq!(host.set("phi", 0.7), OK);
                assert_eq!(fmi2SetInteger(c, &reference("on_pull_in"), 1, &2), OK);
            }
            assert_eq!(fmi2ExitInitializationMode(c), OK);
            match phase {
                "failed" => assert_eq!(fmi2DoStep(c, 0.0, 50.0, 1), DISCARD),
                "terminated" => assert_eq!(fmi2Terminate(c), OK),
                _ => assert_eq!(phase, "stepping"),
            }
        }
        host
    }

    fn set(&self, name: &str, value: f64) -> fmi2Status {
        unsafe { fmi2SetReal(self.component, &reference(name), 1, &value) }
    }

    fn get(&self, name: &str) -> f64 {
        let mut value = f64::NAN;
        let status = unsafe { fmi2GetReal(self.component, &reference(name), 1, &mut value) };
        assert_eq!(status, OK, "{:?}", self.last_line());
        value
    }

    fn step(&self, time: f64, step: f64) -> fmi2Status {
        unsafe { fmi2DoStep(self.component, time, step, 1) }
    }

    fn last_line(&self) -> String {
        self.log
            .lock()
            .expect("one thread")
            .last()
            .cloned()
            .unwrap_or_default()
    }
}

impl Drop for Host {
    fn drop(&mut self) {
        unsafe { fmi2FreeInstance(self.component) };
    }
}

const PHASES: [&str; 5] = [
    "instantiated",
    "initialization",
    "stepping",
    "failed",
    "terminated",
];

type Function = fn(fmi2Component) -> fmi2Status;

/// The table of FMI 2.0.4, section 4.2.4 (co-simulation): the phases in which
/// each function is allowed; "" for those whose capability is not declared.
const TABLE: [(&str, Function, &str); 16] = [
    // SAFETY, for all rows: a live component, and arrays as long as the counts.
    (
        "fmi2SetDebugLogging",
        |c| unsafe { fmi2SetDebugLogging(c, 1, 0, null()) },
        "instantiated initialization stepping failed terminated",
    ),
    (
        "fmi2SetupExperiment",
        |c| unsafe { fmi2SetupExperiment(c, 0, 0.0, 0.0, 0, 0.0) },
        "instantiated",
    ),
    (
        "fmi2EnterInitializationMode",
        |c| unsafe { fmi2EnterInitializationMode(c) },
        "instantiated",
    ),
    (
        "fmi2ExitInitializationMode",
        |c| unsafe { fmi2ExitInitializationMode(c) },
        "initialization",
    ),
    (
        "fmi2Terminate",
        |c| unsafe { fmi2Terminate(c) },
        "stepping failed",
    ),
    (
        "fmi2Reset",
        |c| unsafe { fmi2Reset(c) },
        "instantiated initialization stepping failed terminated",
    ),
    (
        "fmi2GetReal",
        |c| unsafe { fmi2GetReal(c, &0, 1, &mut 0.0) },
        "initialization stepping failed terminated",
    ),
    (
        "fmi2GetBoolean",
        |c| unsafe { fmi2GetBoolean(c, &reference("pulled_in"), 1, &mut 0) },
        "initialization stepping failed terminated",
    ),
    (
        "fmi2SetReal",
        |c| unsafe { fmi2SetReal(c, &0, 1, &0.1) },
        "instantiated initialization stepping",
    ),
    (
        "fmi2SetInteger",
        |c| unsafe { fmi2SetInteger(c, &reference("on_pull_in"), 1, &1) },
        "instantiated initialization",
    ),
    (
        "fmi2SetRealInputDerivatives",
        |c| unsafe { fmi2SetRealInputDerivatives(c, &0, 1, &1, &0.1) },
        "instantiated initialization stepping",
    ),
    (
        "fmi2DoStep",
        |c| unsafe { fmi2DoStep(c, 0.0, 0.1, 1) },
        "stepping",
    ),
    (
        "fmi2GetRealStatus",
        |c| unsafe { fmi2GetRealStatus(c, fmi2StatusKind_fmi2LastSuccessfulTime, &mut 0.0) },
        "stepping failed terminated",
    ),
    (
        "fmi2GetBooleanStatus",
        |c| unsafe { fmi2GetBooleanStatus(c, fmi2StatusKind_fmi2Terminated, &mut 0) },
        "stepping failed terminated",
    ),
    (
        "fmi2GetFMUstate",
        |c| unsafe { fmi2GetFMUstate(c, &mut null_mut()) },
        "",
    ),
    ("fmi2CancelStep", |c| unsafe { fmi2CancelStep(c) }, ""),
];

#[test]
fn each_function_is_allowed_in_the_phases_of_the_standard_only() {
    for (name, function, allowed) in TABLE {
        for phase in PHASES {
            let host = Host::in_phase(phase);
            let expected = if allowed.split(' ').any(|p| p == phase) {
                OK
            } else {
                ERROR
            };
            let status = function(host.component);
            assert_eq!(status, expected, "{name} in {phase}: {}", host.last_line());
            if status == ERROR {
                assert!(host.last_line().contains(name), "{}", host.last_line());
            }
        }
    }
}

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
            "pulled_in (value reference 16) is not of type Real",
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
    assert!(
        host.last_line()
            .contains("no variable with value reference 99; the largest is 28")
    );
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
        for (_, function, _) in TABLE {
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
    let guid = CString::new(GUID).expect("no NUL");
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
        (
            c"a".as_ptr(),
            fmi2Type_fmi2ModelExchange,
            guid.as_ptr(),
            "only co-simulation",
        ),
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
        host.last_line().contains("0.00000000000001 is used"),
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
    assert_eq!(only(c"logNothing"), ERROR);
    assert!(
        host.last_line()
            .contains("logEvents, logStatusWarning, logStatusError")
    );
}

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

/// A random call with random arguments, valid and hostile.
#[derive(Clone, Debug)]
enum Random {
    Row(usize),
    SetReal(u32, f64),
    GetReal(u32),
    Step(f64, f64),
}

fn hostile() -> impl Strategy<Value = f64> {
    prop_oneof![
        4 => -2.0..2.0_f64,
        1 => prop::num::f64::ANY,
        1 => prop::sample::select(vec![0.0, -0.0, 1e-310, 1e3, -1e3, 1e6, f64::MAX, f64::NAN]),
    ]
}

fn random_call() -> impl Strategy<Value = Random> {
    let reference = 0..VARIABLES.len() as u32 + 3;
    prop_oneof![
        2 => (0..TABLE.len()).prop_map(Random::Row),
        4 => (reference.clone(), hostile()).prop_map(|(r, v)| Random::SetReal(r, v)),
        2 => reference.prop_map(Random::GetReal),
        4 => (Just(f64::NAN), hostile()).prop_map(|(t, h)| Random::Step(t, h)),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 400, failure_persistence: None, ..ProptestConfig::default() })]

    /// Whatever is called, the answer is a status, and what can be read is a
    /// number; a refused setter leaves the value as it was.
    #[test]
    fn random_calls_are_answered(
        phase in prop::sample::select(PHASES.to_vec()),
        calls in prop::collection::vec(random_call(), 1..30),
    ) {
        let host = Host::in_phase(phase);
        let c = host.component;
        let mut time = 0.0;
        for call in calls {
            match call {
                Random::Row(row) => {
                    let status = (TABLE[row].1)(c);
                    prop_assert!(status <= ERROR, "{} gave {status}", TABLE[row].0);
                    if status == OK && TABLE[row].0 == "fmi2DoStep" {
                        time += 0.1;
                    }
                    if status == OK && TABLE[row].0 == "fmi2Reset" {
                        time = 0.0;
                    }
                }
                Random::SetReal(reference, value) => {
                    let (mut before, mut after) = (0.0, 0.0);
                    let (read, set) = unsafe {(
                        fmi2GetReal(c, &reference, 1, &mut before),
                        fmi2SetReal(c, &reference, 1, &value),
                    )};
                    unsafe { fmi2GetReal(c, &reference, 1, &mut after) };
                    if read == OK {
                        prop_assert_eq!(after, if set == OK { value } else { before });
                    }
                    let row = VARIABLES.get(reference as usize);
                    let settable = row.is_some_and(|row| {
                        matches!(row.kind, Kind::Real { .. })
                            && !matches!(row.access, Access::Result { .. })
                            && row.check(value).is_ok()
                    });
                    prop_assert!(settable || set == ERROR);
                }
                Random::GetReal(reference) => {
                    let mut value = 0.0;
                    let status = unsafe { fmi2GetReal(c, &reference, 1, &mut value) };
                    prop_assert!(status != OK || !value.is_nan(), "{reference} is {value}");
                }
                Random::Step(at, step) => {
                    let at = if at.is_nan() { time } else { at };
                    // A long step of a fast drive is work, not a fault.
                    let step = step.clamp(-1.0, 10.0);
                    let status = host.step(at, step);
                    prop_assert!(status <= ERROR);
                    if status == OK {
                        time += step;
                    }
                }
            }
        }
    }
}
