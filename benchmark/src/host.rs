//! A host of the FMI functions: what a simulation tool does, without the tool.
#![expect(unsafe_code, reason = "this module speaks C with FMUs")]

use std::ffi::{CString, c_char, c_void};
use std::ptr::{null, null_mut};

use dielectric_elastomer_actuator::model::Model;
use dielectric_elastomer_actuator::nondimensional::Nondimensional;
use dielectric_elastomer_actuator::nondimensional::value_reference;
use fmi::fmi2::binding::{fmi2CallbackFunctions, fmi2Component, fmi2Status, fmi2Status_fmi2OK};

use crate::case::Case;
use crate::fmu::Fmu;

unsafe extern "C" fn silent(
    _environment: *mut c_void,
    _name: *const c_char,
    _status: fmi2Status,
    _category: *const c_char,
    _message: *const c_char,
) {
}

/// Callbacks of a host that is not interested.
pub fn callbacks() -> fmi2CallbackFunctions {
    type Logger = unsafe extern "C" fn(
        *mut c_void,
        *const c_char,
        fmi2Status,
        *const c_char,
        *const c_char,
        ...
    );
    unsafe extern "C" fn allocate(count: usize, size: usize) -> *mut c_void {
        // SAFETY: plain C.
        unsafe { libc::calloc(count, size) }
    }
    unsafe extern "C" fn free(memory: *mut c_void) {
        // SAFETY: memory of `allocate`.
        unsafe { libc::free(memory) };
    }
    let named = silent
        as unsafe extern "C" fn(
            *mut c_void,
            *const c_char,
            fmi2Status,
            *const c_char,
            *const c_char,
        );
    fmi2CallbackFunctions {
        // SAFETY: a callee on these platforms may ignore variadic arguments.
        logger: Some(unsafe { std::mem::transmute::<*const (), Logger>(named as *const ()) }),
        allocateMemory: Some(allocate),
        freeMemory: Some(free),
        stepFinished: None,
        componentEnvironment: null_mut(),
    }
}

/// An instance of the packed FMU in step mode.
pub struct Host {
    fmu: &'static Fmu,
    component: fmi2Component,
    /// Callbacks must live as long as the instance.
    _callbacks: Box<fmi2CallbackFunctions>,
    phi: u32,
    outputs: [u32; 2],
}

fn reference(name: &str) -> u32 {
    value_reference(name).unwrap_or_else(|| panic!("no variable {name}"))
}

impl Host {
    /// An initialized instance. Without `built_in` the alternating voltage is
    /// left to the caller.
    pub fn new(case: &Case, tolerance: f64, built_in: bool) -> Host {
        let fmu = case.fmu;
        let guid = CString::new(Nondimensional::GUID).expect("no NUL");
        let callbacks = Box::new(callbacks());
        let component = fmu.instance(&guid, &callbacks);
        let host = Host {
            fmu,
            component,
            _callbacks: callbacks,
            phi: reference("phi"),
            outputs: [reference("lambda"), reference("lambda_dot")],
        };
        let [gamma, tau, elasticity] = case.surface;
        for (name, value) in [
            ("c", case.aspect),
            ("gamma_s", gamma),
            ("tau_s", tau),
            ("E_s", elasticity),
            ("S", case.prestress),
            ("phi", case.voltage),
            ("phi_ac", if built_in { case.amplitude } else { 0.0 }),
            ("omega_ac", case.frequency),
        ] {
            // SAFETY: a live component and one value.
            let status = unsafe { (fmu.set_real)(component, &reference(name), 1, &value) };
            assert_eq!(status, fmi2Status_fmi2OK, "{name}");
        }
        // SAFETY: a live component.
        let statuses = unsafe {
            [
                (fmu.setup)(component, 1, tolerance, 0.0, 0, 0.0),
                (fmu.enter_initialization)(component),
                (fmu.exit_initialization)(component),
            ]
        };
        assert_eq!(statuses, [fmi2Status_fmi2OK; 3]);
        host
    }

    #[inline]
    pub fn step(&self, time: f64, step: f64) {
        // SAFETY: a live component.
        let status = unsafe { (self.fmu.do_step)(self.component, time, step, 1) };
        assert!(status == fmi2Status_fmi2OK);
    }

    /// λ, one round trip.
    #[inline]
    pub fn stretch(&self) -> f64 {
        let mut value = 0.0;
        // SAFETY: a live component and one value.
        unsafe { (self.fmu.get_real)(self.component, &self.outputs[0], 1, &mut value) };
        value
    }

    /// Any Real variables.
    #[inline]
    pub fn read(&self, references: &[u32], values: &mut [f64]) {
        assert!(references.len() <= values.len());
        // SAFETY: a live component, and room for the values.
        unsafe {
            (self.fmu.get_real)(
                self.component,
                references.as_ptr(),
                references.len(),
                values.as_mut_ptr(),
            )
        };
    }

    /// Switches the log on.
    pub fn log(&self) {
        // SAFETY: a live component.
        let status = unsafe { (self.fmu.set_debug_logging)(self.component, 1, 0, null()) };
        assert!(status == fmi2Status_fmi2OK);
    }

    /// λ and dλ/dt.
    pub fn state(&self) -> [f64; 2] {
        let mut values = [0.0; 2];
        // SAFETY: a live component and two values.
        unsafe {
            (self.fmu.get_real)(
                self.component,
                self.outputs.as_ptr(),
                2,
                values.as_mut_ptr(),
            )
        };
        values
    }

    /// Sets the voltage and its derivatives up to `order`.
    #[inline]
    pub fn set(&self, derivatives: &[f64; 4], order: usize) {
        // SAFETY: a live component and one value; then `order` of each.
        unsafe {
            (self.fmu.set_real)(self.component, &self.phi, 1, &derivatives[0]);
            if order > 0 {
                let references = [self.phi; 3];
                (self.fmu.set_derivatives)(
                    self.component,
                    references.as_ptr(),
                    order,
                    [1, 2, 3].as_ptr(),
                    derivatives[1..].as_ptr(),
                );
            }
        }
    }
}

impl Drop for Host {
    fn drop(&mut self) {
        // SAFETY: freed once.
        unsafe { (self.fmu.free)(self.component) };
    }
}
