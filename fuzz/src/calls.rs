//! Calls in any order with any arguments (`tests/calls/script.rs`).
#![no_main]
#![allow(dead_code)]

#[path = "../../tests/calls/host.rs"]
mod host;
#[path = "../../tests/calls/script.rs"]
mod script;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    if let Err(fault) = script::play(&script::from_fuzzed(bytes)) {
        panic!("{fault}");
    }
});
