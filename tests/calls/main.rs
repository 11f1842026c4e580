//! The C functions, called as a host would: every function in every phase
//! against the table of the standard, hostile arguments, and random orders.
//!
//! Safety of all calls: components are live, and arrays are as long as their
//! counts say, or null where that is what is tested.
#![allow(unsafe_code, clippy::undocumented_unsafe_blocks)]

mod derivatives;
mod exchange;
mod masters;
mod random;
mod refusals;
mod runs;
mod state;
mod table;

use std::ffi::{CStr, CString, c_char, c_void};
use std::ptr::{null, null_mut};
use std::sync::Mutex;

use dielectric_elastomer_actuator::abi::*;
use dielectric_elastomer_actuator::description::GUID;
use dielectric_elastomer_actuator::variables::{VARIABLES, value_reference};
use fmi::fmi2::binding::*;
use table::{KINDS, TABLE};

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
        Host::made(name, kind, guid, null())
    }

    fn located(name: *const c_char, location: *const c_char, guid: *const c_char) -> Host {
        Host::made(name, fmi2Type_fmi2CoSimulation, guid, location)
    }

    fn made(
        name: *const c_char,
        kind: fmi2Type,
        guid: *const c_char,
        location: *const c_char,
    ) -> Host {
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
        let component = unsafe { fmi2Instantiate(name, kind, guid, location, &callbacks, 0, 1) };
        Host { component, log }
    }

    fn new() -> Host {
        Host::of(fmi2Type_fmi2CoSimulation)
    }

    fn of(kind: fmi2Type) -> Host {
        let guid = CString::new(GUID).expect("no NUL");
        let host = Host::with(c"actuator".as_ptr(), kind, guid.as_ptr());
        assert!(!host.component.is_null());
        host
    }

    /// A co-simulation slave in this phase.
    fn in_phase(phase: &str) -> Host {
        Host::in_phase_of(fmi2Type_fmi2CoSimulation, phase)
    }

    fn in_phase_of(kind: fmi2Type, phase: &str) -> Host {
        let host = Host::of(kind);
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
            if phase == "continuous" {
                assert_eq!(fmi2EnterContinuousTimeMode(c), OK);
            }
            match phase {
                "failed" => assert_eq!(fmi2DoStep(c, 0.0, 50.0, 1), DISCARD),
                "terminated" => assert_eq!(fmi2Terminate(c), OK),
                "stepping" => assert_eq!(kind, fmi2Type_fmi2CoSimulation),
                _ => assert_eq!(kind, fmi2Type_fmi2ModelExchange, "{phase}"),
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
