//! Random calls in random order, valid and hostile.

use dielectric_elastomer_actuator::variables::{Access, Kind, VARIABLES};
use proptest::prelude::*;

use super::*;

/// A random call with random arguments, valid and hostile.
#[derive(Clone, Debug)]
enum Random {
    Row(usize),
    SetReal(u32, f64),
    GetReal(u32),
    Step(f64, f64),
}

fn hostile() -> impl Strategy<Value = f64> {
    prop_oneof![
        4 => -2.0..2.0_f64,
        1 => prop::num::f64::ANY,
        1 => prop::sample::select(vec![0.0, -0.0, 1e-310, 1e3, -1e3, 1e6, f64::MAX, f64::NAN]),
    ]
}

fn random_call() -> impl Strategy<Value = Random> {
    let reference = 0..VARIABLES.len() as u32 + 3;
    prop_oneof![
        2 => (0..TABLE.len()).prop_map(Random::Row),
        4 => (reference.clone(), hostile()).prop_map(|(r, v)| Random::SetReal(r, v)),
        2 => reference.prop_map(Random::GetReal),
        4 => (Just(f64::NAN), hostile()).prop_map(|(t, h)| Random::Step(t, h)),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 400, failure_persistence: None, ..ProptestConfig::default() })]

    /// Whatever is called, the answer is a status, and what can be read is a
    /// number; a refused setter leaves the value as it was.
    #[test]
    fn random_calls_are_answered(
        (kind, phases) in prop::sample::select(KINDS.to_vec()),
        phase in 0..5_usize,
        calls in prop::collection::vec(random_call(), 1..30),
    ) {
        let host = Host::in_phase_of(kind, phases[phase]);
        let c = host.component;
        let mut time = 0.0;
        for call in calls {
            match call {
                Random::Row(row) => {
                    let status = (TABLE[row].1)(c);
                    prop_assert!(status <= ERROR, "{} gave {status}", TABLE[row].0);
                    if status == OK && TABLE[row].0 == "fmi2DoStep" {
                        time += 0.1;
                    }
                    if status == OK && TABLE[row].0 == "fmi2Reset" {
                        time = 0.0;
                    }
                }
                Random::SetReal(reference, value) => {
                    let (mut before, mut after) = (0.0, 0.0);
                    let (read, set) = unsafe {(
                        fmi2GetReal(c, &reference, 1, &mut before),
                        fmi2SetReal(c, &reference, 1, &value),
                    )};
                    unsafe { fmi2GetReal(c, &reference, 1, &mut after) };
                    if read == OK {
                        prop_assert_eq!(after, if set == OK { value } else { before });
                    }
                    let row = VARIABLES.get(reference as usize);
                    let settable = row.is_some_and(|row| {
                        matches!(row.kind, Kind::Real { .. })
                            && !matches!(row.access, Access::Result { .. })
                            && row.check(value).is_ok()
                    });
                    prop_assert!(settable || set == ERROR);
                }
                Random::GetReal(reference) => {
                    let mut value = 0.0;
                    let status = unsafe { fmi2GetReal(c, &reference, 1, &mut value) };
                    prop_assert!(status != OK || !value.is_nan(), "{reference} is {value}");
                }
                Random::Step(at, step) => {
                    let at = if at.is_nan() { time } else { at };
                    // A long step of a fast drive is work, not a fault.
                    let step = step.clamp(-1.0, 10.0);
                    let status = host.step(at, step);
                    prop_assert!(status <= ERROR);
                    if status == OK {
                        time += step;
                    }
                }
            }
        }
    }
}
