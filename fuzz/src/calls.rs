//! Calls in any order with any arguments (`tests/calls/script.rs`).
#![no_main]
#![allow(dead_code, unsafe_code, clippy::undocumented_unsafe_blocks)]

#[path = "../../tests/calls/host.rs"]
mod host;
#[path = "../../tests/calls/script.rs"]
mod script;

use dielectric_elastomer_actuator::nondimensional::Nondimensional;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    if let Err(fault) = script::play::<Nondimensional>(&script::from_fuzzed(bytes)) {
        panic!("{fault}");
    }
});
