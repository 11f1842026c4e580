//! What a scene does not need is skipped, and no result changes by it.
//!
//! Beside these: orbits, splitting of steps, saved states and extremes in
//! `solver`, rest and sequences of inputs in `stress`, lanes in `sweep`.

use crate::largest::largest;
use dielectric_elastomer_actuator::instance::Type;
use dielectric_elastomer_actuator::model::variables::Kind;
use dielectric_elastomer_actuator::nondimensional::Instance;
use dielectric_elastomer_actuator::nondimensional::{VARIABLES, value_reference};

const STEP: f64 = 0.37;
const STEPS: u32 = 400;

fn reference(name: &str) -> u32 {
    value_reference(name).expect("a variable")
}

fn started(settings: &[(&str, f64)], tolerance: f64) -> Instance {
    let mut instance = Instance::new();
    for &(name, value) in settings {
        let wanted = match VARIABLES[reference(name) as usize].kind {
            Kind::Boolean => Type::Boolean,
            _ => Type::Real,
        };
        let set = instance.set(wanted, &[reference(name)], |_| value);
        set.expect("it can be set");
    }
    let set_up = instance.setup_experiment(Some(tolerance), 0.0, None);
    set_up.expect("a good tolerance");
    instance.enter_initialization();
    instance.exit_initialization().expect("good start values");
    instance
}

fn read(instance: &Instance, names: &[&str]) -> Vec<f64> {
    let references: Vec<u32> = names.iter().map(|name| reference(name)).collect();
    let mut values = vec![0.0; names.len()];
    let got = instance.get(Type::Real, &references, |place, value| {
        values[place] = value
    });
    got.expect("they can be read");
    values
}

/// λ and dλ/dt at each step; `before` each step the host does something.
fn states(
    settings: &[(&str, f64)],
    tolerance: f64,
    step: f64,
    mut before: impl FnMut(&mut Instance),
) -> Vec<Vec<f64>> {
    let mut instance = started(settings, tolerance);
    let next = |call: u32| {
        before(&mut instance);
        let done = instance.do_step(f64::from(call) * step, step);
        done.expect("the step is possible");
        read(&instance, &["lambda", "lambda_dot"])
    };
    (0..STEPS).map(next).collect()
}

const CONSTANT: &[(&str, f64)] = &[
    ("phi", 0.6),
    ("gamma_s", 0.05),
    ("tau_s", 0.05),
    ("E_s", 0.2),
];
const ALTERNATING: &[(&str, f64)] = &[("phi_ac", 0.3), ("omega_ac", 0.1438), ("E_s", 0.2)];

/// Bit for bit: nothing that is read or set to what it is enters the motion.
#[test]
fn reading_everything_and_setting_nothing_new_leave_the_motion_alone() {
    let reals: Vec<&str> = VARIABLES
        .iter()
        .filter(|variable| matches!(variable.kind, Kind::Real { .. }))
        .map(|variable| variable.name)
        .collect();
    for settings in [CONSTANT, ALTERNATING] {
        let plain = states(settings, 1e-9, STEP, |_| {});
        let all_read = states(settings, 1e-9, STEP, |instance| {
            assert!(read(instance, &reals)[0].is_finite());
        });
        assert_eq!(plain, all_read);
        let set_again = states(settings, 1e-9, STEP, |instance| {
            for &(name, value) in settings {
                let set = instance.set(Type::Real, &[reference(name)], |_| value);
                set.expect("inputs and tunable parameters can be set");
            }
        });
        assert_eq!(plain, set_again);
        let held_again = states(settings, 1e-9, STEP, |instance| {
            let set = instance.set_input_derivatives(&[reference("phi")], &[1], &[0.0]);
            set.expect("inputs have derivatives");
        });
        assert_eq!(plain, held_again);
    }
}

/// Recording extremes looks at each step, so that another substep may answer
/// it: to the tolerance.
#[test]
fn recording_extremes_leaves_the_motion_alone() {
    for settings in [CONSTANT, ALTERNATING] {
        let recording = [settings, &[("record_extremes", 1.0)]].concat();
        for (tolerance, step) in [(1e-6, 7.0), (1e-6, STEP), (1e-12, 7.0), (1e-12, STEP)] {
            let plain = states(settings, tolerance, step, |_| {});
            let recorded = states(&recording, tolerance, step, |_| {});
            let both = plain.iter().flatten().zip(recorded.iter().flatten());
            let difference = largest(both.map(|(one, other)| one - other));
            let what = format!("{settings:?}, tolerance {tolerance:e}, steps of {step}");
            assert!(difference < 10.0 * tolerance, "{what}: {difference:e}");
        }
    }
}
