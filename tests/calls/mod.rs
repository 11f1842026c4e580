//! The C functions, called as a host would: every function in every phase
//! against the table of the standard, hostile arguments, and random orders.
//!
//! Safety of all calls: components are live, and arrays are as long as their
//! counts say, or null where that is what is tested.
#![allow(unsafe_code, clippy::undocumented_unsafe_blocks)]

mod clock;
mod continuous_states;
mod derivatives;
mod environment;
mod exchange;
mod extremes;
mod host;
mod masters;
mod random;
mod refusals;
mod runs;
mod script;
mod state;
mod table;

use std::ffi::{CStr, CString};
use std::ptr::{null, null_mut};

use crate::processor_time;
use DielectricElastomerActuator::*;
use dielectric_elastomer_actuator::model::Model;
use dielectric_elastomer_actuator::nondimensional::Nondimensional;
use dielectric_elastomer_actuator::nondimensional::VARIABLES;
use fmi::fmi2::binding::*;
use host::{ERROR, Host, OK, reference};
use table::{KINDS, TABLE};

const WARNING: fmi2Status = fmi2Status_fmi2Warning;
const DISCARD: fmi2Status = fmi2Status_fmi2Discard;

impl Host {
    /// A co-simulation instance in this phase.
    fn in_phase(phase: &str) -> Host {
        Host::in_phase_of(fmi2Type_fmi2CoSimulation, phase)
    }

    fn in_phase_of(kind: fmi2Type, phase: &str) -> Host {
        let host = Host::of(kind);
        let c = host.component;
        unsafe {
            if phase == "instantiated" {
                return host;
            }
            assert_eq!(fmi2SetupExperiment(c, 0, 0.0, 0.0, 0, f64::NAN), OK);
            assert_eq!(fmi2EnterInitializationMode(c), OK);
            if phase == "initialization" {
                return host;
            }
            if phase == "failed" {
                assert_eq!(host.set("phi", 0.7), OK);
                assert_eq!(fmi2SetInteger(c, &reference("on_pull_in"), 1, &2), OK);
            }
            assert_eq!(fmi2ExitInitializationMode(c), OK);
            if phase == "continuous" {
                assert_eq!(fmi2EnterContinuousTimeMode(c), OK);
            }
            match phase {
                "failed" => assert_eq!(fmi2DoStep(c, 0.0, 50.0, 1), DISCARD),
                "terminated" => assert_eq!(fmi2Terminate(c), OK),
                "stepping" => assert_eq!(kind, fmi2Type_fmi2CoSimulation),
                _ => assert_eq!(kind, fmi2Type_fmi2ModelExchange, "{phase}"),
            }
        }
        host
    }
}
