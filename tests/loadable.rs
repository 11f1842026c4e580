//! A plain build gives, for each FMU, a library that a host can load.
#![cfg(unix)]
#![allow(unsafe_code)]

use std::env::consts::{DLL_PREFIX, DLL_SUFFIX};
use std::ffi::{CStr, CString, c_char, c_void};

use dielectric_elastomer_actuator::fmi2::EXPORTED_NAMES;
use dielectric_elastomer_actuator::model::Model;
use dielectric_elastomer_actuator::nondimensional::Nondimensional;
use dielectric_elastomer_actuator::si::Si;

#[test]
fn each_library_is_loaded_with_every_function_of_the_standard() {
    for name in [Nondimensional::IDENTIFIER, Si::IDENTIFIER] {
        let library = loaded(name);
        for function in EXPORTED_NAMES {
            assert!(!symbol(library, function).is_null(), "{name}: {function}");
        }
        let version = symbol(library, "fmi2GetVersion");
        // SAFETY: the standard gives the function this type.
        let version: unsafe extern "C" fn() -> *const c_char =
            unsafe { std::mem::transmute(version) };
        // SAFETY: the function takes nothing and returns a text that lives as long as the library.
        assert_eq!(unsafe { CStr::from_ptr(version()) }, c"2.0");
    }
}

/// The library of an FMU, which cargo has put beside this test.
fn loaded(name: &str) -> *mut c_void {
    let test = std::env::current_exe().expect("the test is a file");
    let file = test.with_file_name(format!("{DLL_PREFIX}{name}{DLL_SUFFIX}"));
    let path = CString::new(file.as_os_str().as_encoded_bytes()).expect("no NUL in a path");
    // SAFETY: a path that ends with NUL; the library has no code that runs when it is loaded.
    let library = unsafe { libc::dlopen(path.as_ptr(), libc::RTLD_NOW | libc::RTLD_LOCAL) };
    assert!(!library.is_null(), "{} cannot be loaded", file.display());
    library
}

fn symbol(library: *mut c_void, name: &str) -> *mut c_void {
    let name = CString::new(name).expect("no NUL in a name");
    // SAFETY: a library that is loaded, and a name that ends with NUL.
    unsafe { libc::dlsym(library, name.as_ptr()) }
}
