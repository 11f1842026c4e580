//! Bytes for a saved state: read as they are, and as contents of an envelope with the right
//! length and checksum; an instance that takes them is saved as bytes that are taken in their
//! turn, and goes on without harm.
#![no_main]
#![allow(dead_code, unsafe_code, clippy::undocumented_unsafe_blocks)]

#[path = "../../tests/calls/host.rs"]
mod host;
#[path = "../../tests/calls/script.rs"]
mod script;

use std::ptr::null_mut;

use DielectricElastomerActuator::*;
use dielectric_elastomer_actuator::nondimensional::VARIABLES;
use fmi::fmi2::binding::*;
use host::{ERROR, Host, OK};

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    for kind in [fmi2Type_fmi2CoSimulation, fmi2Type_fmi2ModelExchange] {
        let host = Host::of(kind);
        go_on(&host, kind, bytes);
        let mut sealed = host.serialized();
        sealed.truncate(script::CONTENTS);
        sealed.extend(bytes);
        script::seal(&mut sealed);
        go_on(&host, kind, &sealed);
    }
});

fn go_on(host: &Host, kind: fmi2Type, bytes: &[u8]) {
    let (c, mut state) = (host.component, null_mut());
    let before = host.serialized();
    unsafe {
        let read = fmi2DeSerializeFMUstate(c, bytes.as_ptr().cast(), bytes.len(), &mut state);
        if read != OK {
            assert_eq!((read, host.serialized()), (ERROR, before));
            return;
        }
        assert_eq!(fmi2SetFMUstate(c, state), OK);
        assert_eq!(fmi2FreeFMUstate(c, &mut state), OK);
    }
    let saved = host.serialized();
    let other = Host::of(kind);
    let d = other.component;
    unsafe {
        let read = fmi2DeSerializeFMUstate(d, saved.as_ptr().cast(), saved.len(), &mut state);
        assert_eq!(read, OK, "what was saved is refused: {}", other.last_line());
        assert_eq!(fmi2SetFMUstate(other.component, state), OK);
        assert_eq!(fmi2FreeFMUstate(other.component, &mut state), OK);
    }
    assert_eq!(other.serialized(), saved);
    unsafe {
        for reference in 0..VARIABLES.len() as u32 {
            fmi2GetReal(c, &reference, 1, &mut 0.0);
        }
        for step in [0.01, 1.0] {
            assert!(fmi2DoStep(c, host.time(), step, 1) <= ERROR);
        }
        assert!(fmi2GetDerivatives(c, [0.0; 2].as_mut_ptr(), 2) <= ERROR);
    }
}
