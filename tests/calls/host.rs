//! A host: an instance and what it told.

use std::ffi::{CStr, CString, c_char, c_void};
use std::ptr::null;
use std::sync::Mutex;

use DielectricElastomerActuator::*;
use dielectric_elastomer_actuator::model::Model;
use dielectric_elastomer_actuator::nondimensional::Nondimensional;
use dielectric_elastomer_actuator::nondimensional::value_reference;
use fmi::fmi2::binding::*;

pub const OK: fmi2Status = fmi2Status_fmi2OK;
pub const ERROR: fmi2Status = fmi2Status_fmi2Error;

pub fn reference(name: &str) -> u32 {
    value_reference(name).unwrap_or_else(|| panic!("no variable {name}"))
}

pub type Log = Mutex<Vec<String>>;

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
pub struct Host {
    pub component: fmi2Component,
    pub log: Box<Log>,
}

impl Host {
    pub fn with(name: *const c_char, kind: fmi2Type, guid: *const c_char) -> Host {
        Host::made(name, kind, guid, null())
    }

    pub fn located(name: *const c_char, location: *const c_char, guid: *const c_char) -> Host {
        Host::made(name, fmi2Type_fmi2CoSimulation, guid, location)
    }

    pub fn made(
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

    pub fn new() -> Host {
        Host::of(fmi2Type_fmi2CoSimulation)
    }

    pub fn of(kind: fmi2Type) -> Host {
        let guid = CString::new(Nondimensional::GUID).expect("no NUL");
        let host = Host::with(c"actuator".as_ptr(), kind, guid.as_ptr());
        assert!(!host.component.is_null());
        host
    }

    pub fn set(&self, name: &str, value: f64) -> fmi2Status {
        unsafe { fmi2SetReal(self.component, &reference(name), 1, &value) }
    }

    pub fn get(&self, name: &str) -> f64 {
        let mut value = f64::NAN;
        let status = unsafe { fmi2GetReal(self.component, &reference(name), 1, &mut value) };
        assert_eq!(status, OK, "{:?}", self.last_line());
        value
    }

    pub fn step(&self, time: f64, step: f64) -> fmi2Status {
        unsafe { fmi2DoStep(self.component, time, step, 1) }
    }

    pub fn last_line(&self) -> String {
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
