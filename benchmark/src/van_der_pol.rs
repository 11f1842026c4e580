//! The van der Pol oscillator of the Reference FMUs (Modelica Association), as a
//! host loads it: forward Euler with an internal step of 0.01.
#![expect(unsafe_code, reason = "this module speaks C with an FMU")]

use fmi::fmi2::binding::{fmi2CallbackFunctions, fmi2Component, fmi2Status_fmi2OK};

use crate::fmu::Fmu;
use crate::host::callbacks;

/// GUID and value reference of the displacement in its `modelDescription.xml`.
const GUID: &std::ffi::CStr = c"{BD403596-3166-4232-ABC2-132BDF73E644}";
const DISPLACEMENT: u32 = 1;

/// An instance in step mode.
pub struct Oscillator<'a> {
    fmu: &'a Fmu,
    component: fmi2Component,
    _callbacks: Box<fmi2CallbackFunctions>,
}

impl Oscillator<'_> {
    pub fn start(fmu: &Fmu) -> Oscillator<'_> {
        let callbacks = Box::new(callbacks());
        let component = fmu.instance(GUID, &callbacks);
        // SAFETY: a live component.
        let statuses = unsafe {
            [
                (fmu.setup)(component, 0, 0.0, 0.0, 0, 0.0),
                (fmu.enter_initialization)(component),
                (fmu.exit_initialization)(component),
            ]
        };
        assert_eq!(statuses, [fmi2Status_fmi2OK; 3]);
        Oscillator {
            fmu,
            component,
            _callbacks: callbacks,
        }
    }

    #[inline]
    pub fn step(&self, time: f64, step: f64) {
        // SAFETY: a live component.
        let status = unsafe { (self.fmu.do_step)(self.component, time, step, 1) };
        assert!(status == fmi2Status_fmi2OK);
    }

    #[inline]
    pub fn displacement(&self) -> f64 {
        let mut value = 0.0;
        // SAFETY: a live component and one value.
        unsafe { (self.fmu.get_real)(self.component, &DISPLACEMENT, 1, &mut value) };
        value
    }
}

impl Drop for Oscillator<'_> {
    fn drop(&mut self) {
        // SAFETY: freed once.
        unsafe { (self.fmu.free)(self.component) };
    }
}
