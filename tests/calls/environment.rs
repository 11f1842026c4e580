//! Hosts with a floating-point environment of their own: traps, another rounding, subnormal
//! numbers flushed to zero. A call leaves it as it was, flags included, and computes what it
//! always computes.
#![cfg(target_arch = "x86_64")]

use std::arch::asm;

use dielectric_elastomer_actuator::model::variables::{Access, Kind};

use super::*;

/// Of MXCSR: everything masked, no flag.
const DEFAULT: u32 = 0x1f80;

const ENVIRONMENTS: [(&str, u32); 7] = [
    ("the default one", DEFAULT),
    (
        "traps for invalid, zero divide and overflow",
        DEFAULT & !0x680,
    ),
    ("every trap", DEFAULT & !0x1f80),
    ("every flag", DEFAULT | 0x3f),
    ("rounding up", DEFAULT | 0x4000),
    ("rounding to zero", DEFAULT | 0x6000),
    (
        "subnormal numbers flushed and taken for zero",
        DEFAULT | 0x8040,
    ),
];

/// What `call` gives in this environment, which it must leave as it is.
#[track_caller]
fn within<T>(environment: u32, call: impl FnOnce() -> T) -> T {
    let (mut before, mut after) = (0_u32, 0_u32);
    let result;
    unsafe {
        asm!("stmxcsr [{}]", in(reg) &mut before);
        asm!("ldmxcsr [{}]", in(reg) &environment);
        result = call();
        asm!("stmxcsr [{}]", in(reg) &mut after);
        asm!("ldmxcsr [{}]", in(reg) &before);
    }
    assert_eq!(after, environment, "{after:x} and not {environment:x}");
    result
}

#[test]
fn every_function_in_every_phase_leaves_the_environment_as_it_was() {
    for (what, environment) in ENVIRONMENTS {
        for (kind, phases) in KINDS {
            for phase in phases {
                for (name, function, ..) in TABLE {
                    let [usual, host] = [0, 1].map(|_| Host::in_phase_of(kind, phase));
                    let wanted = function(usual.component);
                    let status = within(environment, || function(host.component));
                    assert_eq!(status, wanted, "{name} in {phase} with {what}");
                }
            }
        }
    }
}

/// Everything that takes part in a run, each call of it in this environment: the first voltage
/// step, an alternating voltage, derivatives, all variables, states, and a collapse.
fn co_simulation(environment: u32) -> Vec<u64> {
    let host = within(environment, Host::new);
    let c = host.component;
    let mut results = Vec::new();
    let call = |function: &dyn Fn() -> fmi2Status| {
        assert_eq!(within(environment, function), OK, "{}", host.last_line());
    };
    call(&|| unsafe { fmi2SetupExperiment(c, 1, 1e-10, -1.0, 1, f64::INFINITY) });
    call(&|| host.set("E_s", 0.1));
    call(&|| unsafe { fmi2EnterInitializationMode(c) });
    call(&|| unsafe { fmi2ExitInitializationMode(c) });
    let scenes = [
        ("phi", 0.4),
        ("S", 0.1),
        ("S", 1e-310),
        ("phi_ac", 0.2),
        ("omega_ac", 0.7),
        ("gamma_s", 0.05),
        ("phi", 0.1),
        ("phi_ac", 0.0),
        ("E_s", 0.0),
        ("phi", 1.5),
    ];
    let mut time = -1.0;
    // A state that lies stored, behind inputs that change at each step.
    let states = ["lambda", "lambda_dot"].map(reference);
    for k in 0..20 {
        let voltage = 0.3 + 0.01 * f64::from(k % 7);
        call(&|| host.set("phi", voltage));
        call(&|| host.step(time, 0.01));
        time += 0.01;
        for state in &states {
            let mut value = 0.0;
            let get = || unsafe { fmi2GetReal(c, state, 1, &mut value) };
            assert_eq!(within(environment, get), OK);
            results.push(value.to_bits());
        }
    }
    for (name, value) in scenes {
        call(&|| host.set(name, value));
        if name == "S" {
            let (orders, slopes) = ([1, 2], [1e-3, -1e-4]);
            let references = [reference("S"); 2];
            let (from, order, slope) = (references.as_ptr(), orders.as_ptr(), slopes.as_ptr());
            call(&|| unsafe { fmi2SetRealInputDerivatives(c, from, 2, order, slope) });
        }
        for h in [1e-9, 0.1, 0.1, 0.1, 7.3, 40.0] {
            call(&|| host.step(time, h));
            time += h;
            for (reference, variable) in (0..).zip(&VARIABLES) {
                if matches!(variable.kind, Kind::Real { .. }) {
                    let mut value = 0.0;
                    within(environment, || unsafe {
                        fmi2GetReal(c, &reference, 1, &mut value)
                    });
                    results.push(value.to_bits());
                }
                if matches!(variable.access, Access::Result { .. }) {
                    let mut slope = 0.0;
                    within(environment, || unsafe {
                        fmi2GetRealOutputDerivatives(c, &reference, 1, &1, &mut slope)
                    });
                    results.push(slope.to_bits());
                    within(environment, || unsafe {
                        fmi2GetDirectionalDerivative(c, &reference, 1, &0, 1, &1.0, &mut slope)
                    });
                    results.push(slope.to_bits());
                }
            }
            let bytes = within(environment, || host.serialized());
            assert_eq!(within(environment, || host.restored(&bytes)), OK);
        }
    }
    within(environment, || drop(host));
    results
}

/// A host's integrator on the way to a collapse, in this environment.
fn model_exchange(environment: u32) -> Vec<u64> {
    let host = Host::in_phase_of(fmi2Type_fmi2ModelExchange, "continuous");
    let c = host.component;
    let mut results = Vec::new();
    assert_eq!(within(environment, || host.set("phi", 0.8)), OK);
    let mut states = [1.0, 0.0];
    for k in 0..4000 {
        let (time, mut slopes, mut indicators) = (f64::from(k) * 0.01, [0.0; 2], [0.0; 2]);
        within(environment, || unsafe {
            assert_eq!(fmi2SetTime(c, time), OK);
            assert_eq!(fmi2SetContinuousStates(c, states.as_ptr(), 2), OK);
            assert_eq!(fmi2GetDerivatives(c, slopes.as_mut_ptr(), 2), OK);
            assert_eq!(fmi2GetEventIndicators(c, indicators.as_mut_ptr(), 2), OK);
            fmi2CompletedIntegratorStep(c, 1, &mut 0, &mut 0);
        });
        results.extend([slopes, indicators].concat().iter().map(|x| x.to_bits()));
        if indicators[1] < 0.0 {
            break;
        }
        for (state, slope) in states.iter_mut().zip(slopes) {
            *state += 0.01 * slope;
        }
    }
    // A state that an integrator tried far out.
    within(environment, || unsafe {
        fmi2SetContinuousStates(c, [0.0, 1e300].as_ptr(), 2);
        fmi2GetDerivatives(c, states.as_mut_ptr(), 2);
        fmi2GetReal(c, &reference("lambda_ddot"), 1, &mut states[0]);
    });
    results
}

#[test]
fn results_do_not_depend_on_the_environment() {
    let (instance, exchange) = (co_simulation(DEFAULT), model_exchange(DEFAULT));
    for (what, environment) in ENVIRONMENTS {
        assert_eq!(co_simulation(environment), instance, "{what}");
        assert_eq!(model_exchange(environment), exchange, "{what}");
    }
}
