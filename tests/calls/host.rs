//! A host: an instance and what it told.

use std::ffi::{CStr, CString, c_char, c_void};
use std::marker::PhantomData;
use std::ptr::{null, null_mut};
use std::sync::Mutex;

use DielectricElastomerActuator::*;
use dielectric_elastomer_actuator::fmi2;
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

/// An instance of a model and what it told its host.
pub struct Host<M: Model = Nondimensional> {
    pub component: fmi2Component,
    pub log: Box<Log>,
    model: PhantomData<M>,
}

impl Host {
    pub fn with(name: *const c_char, kind: fmi2Type, guid: *const c_char) -> Host {
        Host::made(name, kind, guid, null())
    }

    pub fn located(name: *const c_char, location: *const c_char, guid: *const c_char) -> Host {
        Host::made(name, fmi2Type_fmi2CoSimulation, guid, location)
    }

    pub fn new() -> Host {
        Host::of(fmi2Type_fmi2CoSimulation)
    }

    pub fn of(kind: fmi2Type) -> Host {
        Host::of_model(kind)
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
}

impl<M: Model> Host<M> {
    pub fn made(
        name: *const c_char,
        kind: fmi2Type,
        guid: *const c_char,
        location: *const c_char,
    ) -> Host<M> {
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
        let component =
            unsafe { fmi2::fmi2Instantiate::<M>(name, kind, guid, location, &callbacks, 0, 1) };
        Host {
            component,
            log,
            model: PhantomData,
        }
    }

    /// An instance of this kind of FMU.
    pub fn of_model(kind: fmi2Type) -> Host<M> {
        let guid = CString::new(M::GUID).expect("no NUL");
        let host = Host::made(c"actuator".as_ptr(), kind, guid.as_ptr(), null());
        assert!(!host.component.is_null());
        host
    }

    pub fn serialized(&self) -> Vec<u8> {
        unsafe {
            let mut state = null_mut();
            assert_eq!(fmi2::fmi2GetFMUstate::<M>(self.component, &mut state), OK);
            let bytes = bytes_of::<M>(self.component, state);
            assert_eq!(fmi2::fmi2FreeFMUstate::<M>(self.component, &mut state), OK);
            assert!(state.is_null());
            bytes
        }
    }

    /// The status of going on from these bytes.
    pub fn restored(&self, bytes: &[u8]) -> fmi2Status {
        unsafe {
            let (mut state, data) = (null_mut(), bytes.as_ptr().cast());
            let read =
                fmi2::fmi2DeSerializeFMUstate::<M>(self.component, data, bytes.len(), &mut state);
            let status = read.max(fmi2::fmi2SetFMUstate::<M>(self.component, state));
            fmi2::fmi2FreeFMUstate::<M>(self.component, &mut state);
            status
        }
    }

    /// The communication point that was reached; 0 before there is one.
    pub fn time(&self) -> f64 {
        let mut time = 0.0;
        let kind = fmi2StatusKind_fmi2LastSuccessfulTime;
        unsafe { fmi2::fmi2GetRealStatus::<M>(self.component, kind, &mut time) };
        time
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

impl<M: Model> Drop for Host<M> {
    fn drop(&mut self) {
        unsafe { fmi2::fmi2FreeInstance::<M>(self.component) };
    }
}

/// A state as bytes; none for no state.
pub fn bytes_of<M: Model>(c: fmi2Component, state: fmi2FMUstate) -> Vec<u8> {
    let mut size = 0;
    unsafe {
        if fmi2::fmi2SerializedFMUstateSize::<M>(c, state, &mut size) != OK {
            return Vec::new();
        }
        let mut bytes = vec![0u8; size];
        fmi2::fmi2SerializeFMUstate::<M>(c, state, bytes.as_mut_ptr().cast(), size);
        bytes
    }
}
