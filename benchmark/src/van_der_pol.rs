//! The van der Pol oscillator of the Reference FMUs (Modelica Association), as a
//! host loads it: forward Euler with an internal step of 0.01.

use std::hint::black_box;
use std::ptr::null;

use fmi::fmi2::binding::{
    fmi2CallbackFunctions, fmi2Component, fmi2Real, fmi2Status, fmi2Status_fmi2OK,
    fmi2Type_fmi2CoSimulation,
};
use libloading::{Library, Symbol};

use crate::host::{DoStep, GetReal, callbacks};

/// GUID and value reference of the displacement in its `modelDescription.xml`.
const GUID: &std::ffi::CStr = c"{BD403596-3166-4232-ABC2-132BDF73E644}";
const DISPLACEMENT: u32 = 1;

type Instantiate = unsafe extern "C" fn(
    *const i8,
    u32,
    *const i8,
    *const i8,
    *const fmi2CallbackFunctions,
    i32,
    i32,
) -> fmi2Component;
type Setup =
    unsafe extern "C" fn(fmi2Component, i32, fmi2Real, fmi2Real, i32, fmi2Real) -> fmi2Status;
type Mode = unsafe extern "C" fn(fmi2Component) -> fmi2Status;
type Free = unsafe extern "C" fn(fmi2Component);

/// Its shared library.
pub struct VanDerPol(Library);

impl VanDerPol {
    pub fn load(path: &str) -> VanDerPol {
        // SAFETY: it has no code that runs when it is loaded.
        VanDerPol(unsafe { Library::new(path) }.unwrap_or_else(|error| panic!("{path}: {error}")))
    }

    fn function<T>(&self, name: &str) -> Symbol<'_, T> {
        // SAFETY: the functions of FMI 2.0 have the types above.
        unsafe { self.0.get(name.as_bytes()) }.unwrap_or_else(|error| panic!("{name}: {error}"))
    }

    /// An instance in step mode.
    pub fn start(&self) -> Oscillator<'_> {
        let callbacks = Box::new(callbacks());
        // SAFETY: all pointers live during the call, the callbacks longer.
        let component = unsafe {
            self.function::<Instantiate>("fmi2Instantiate")(
                c"oscillator".as_ptr().cast(),
                fmi2Type_fmi2CoSimulation,
                GUID.as_ptr().cast(),
                null(),
                &*callbacks,
                0,
                0,
            )
        };
        assert!(
            !component.is_null(),
            "fmi2Instantiate of the van der Pol FMU"
        );
        // SAFETY: a live component.
        let statuses = unsafe {
            [
                self.function::<Setup>("fmi2SetupExperiment")(component, 0, 0.0, 0.0, 0, 0.0),
                self.function::<Mode>("fmi2EnterInitializationMode")(component),
                self.function::<Mode>("fmi2ExitInitializationMode")(component),
            ]
        };
        assert_eq!(statuses, [fmi2Status_fmi2OK; 3]);
        Oscillator {
            component,
            do_step: *self.function("fmi2DoStep"),
            get_real: *self.function("fmi2GetReal"),
            free: *self.function("fmi2FreeInstance"),
            _callbacks: callbacks,
            _library: self,
        }
    }
}

/// An instance.
pub struct Oscillator<'a> {
    component: fmi2Component,
    do_step: DoStep,
    get_real: GetReal,
    free: Free,
    _callbacks: Box<fmi2CallbackFunctions>,
    _library: &'a VanDerPol,
}

impl Oscillator<'_> {
    #[inline]
    pub fn step(&self, time: f64, step: f64) {
        // SAFETY: a live component.
        let status = unsafe { black_box(self.do_step)(self.component, time, step, 1) };
        assert!(status == fmi2Status_fmi2OK);
    }

    #[inline]
    pub fn displacement(&self) -> f64 {
        let mut value = 0.0;
        // SAFETY: a live component and one value.
        unsafe { black_box(self.get_real)(self.component, &DISPLACEMENT, 1, &mut value) };
        value
    }
}

impl Drop for Oscillator<'_> {
    fn drop(&mut self) {
        // SAFETY: freed once.
        unsafe { (self.free)(self.component) };
    }
}
