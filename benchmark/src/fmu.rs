//! An FMU for co-simulation, as a host loads it.
#![expect(unsafe_code, reason = "this module loads libraries")]

use std::ffi::{CStr, c_char};
use std::ptr::null;

use fmi::fmi2::binding::{
    fmi2CallbackFunctions, fmi2Component, fmi2Real, fmi2Status, fmi2Type,
    fmi2Type_fmi2CoSimulation, fmi2ValueReference,
};
use libloading::Library;

/// Defines [`Fmu`] with these functions of FMI 2.0.
macro_rules! functions {
    ($($name:ident: $symbol:literal, ($($argument:ty),*) $(-> $answer:ty)?;)*) => {
        /// The functions of a shared library, called through pointers.
        #[derive(Debug)]
        pub struct Fmu {
            $(pub $name: unsafe extern "C" fn($($argument),*) $(-> $answer)?,)*
            /// Loaded as long as its functions are called.
            _library: Library,
        }

        impl Fmu {
            /// Loads a shared library.
            pub fn load(path: &str) -> Fmu {
                // SAFETY: FMUs have no code that runs when they are loaded.
                let library = unsafe { Library::new(path) }
                    .unwrap_or_else(|error| panic!("{path}: {error}"));
                Fmu {
                    // SAFETY: the functions of FMI 2.0 have these types.
                    $($name: *unsafe { library.get($symbol) }
                        .unwrap_or_else(|error| panic!("{path}: {error}")),)*
                    _library: library,
                }
            }
        }
    };
}

functions! {
    instantiate: b"fmi2Instantiate", (
        *const c_char, fmi2Type, *const c_char, *const c_char, *const fmi2CallbackFunctions, i32, i32
    ) -> fmi2Component;
    free: b"fmi2FreeInstance", (fmi2Component);
    set_debug_logging: b"fmi2SetDebugLogging",
        (fmi2Component, i32, usize, *const *const c_char) -> fmi2Status;
    setup: b"fmi2SetupExperiment",
        (fmi2Component, i32, fmi2Real, fmi2Real, i32, fmi2Real) -> fmi2Status;
    enter_initialization: b"fmi2EnterInitializationMode", (fmi2Component) -> fmi2Status;
    exit_initialization: b"fmi2ExitInitializationMode", (fmi2Component) -> fmi2Status;
    do_step: b"fmi2DoStep", (fmi2Component, fmi2Real, fmi2Real, i32) -> fmi2Status;
    get_real: b"fmi2GetReal",
        (fmi2Component, *const fmi2ValueReference, usize, *mut fmi2Real) -> fmi2Status;
    set_real: b"fmi2SetReal",
        (fmi2Component, *const fmi2ValueReference, usize, *const fmi2Real) -> fmi2Status;
    set_derivatives: b"fmi2SetRealInputDerivatives",
        (fmi2Component, *const fmi2ValueReference, usize, *const i32, *const fmi2Real) -> fmi2Status;
}

impl Fmu {
    /// An instance of the FMU with this GUID.
    pub fn instance(&self, guid: &CStr, callbacks: &fmi2CallbackFunctions) -> fmi2Component {
        // SAFETY: all pointers live during the call, the callbacks as long as the caller says.
        let component = unsafe {
            (self.instantiate)(
                c"benchmark".as_ptr(),
                fmi2Type_fmi2CoSimulation,
                guid.as_ptr(),
                null(),
                callbacks,
                0,
                0,
            )
        };
        assert!(!component.is_null(), "fmi2Instantiate");
        component
    }
}
