//! Extreme but legal values through the instance, as a host would set them: never
//! NaN, never a hang; a step is done or says why not.

use std::time::Duration;

use dielectric_elastomer_actuator::instance::{Severity, Type};
use dielectric_elastomer_actuator::model::variables::{
    Access, Causality, Kind, Variability, Variable,
};
use dielectric_elastomer_actuator::nondimensional::{
    Instance, Nondimensional, VARIABLES, value_reference,
};

use super::*;

fn type_of(variable: &Variable<Nondimensional>) -> Type {
    match variable.kind {
        Kind::Real { .. } => Type::Real,
        Kind::Boolean => Type::Boolean,
        Kind::Enumeration(_) => Type::Integer,
    }
}

/// A legal value: a limit, the start, a denormal, next to nothing, or any size.
fn value(random: &mut Random, variable: &Variable<Nondimensional>) -> f64 {
    let Kind::Real { min, max, .. } = variable.kind else {
        return random.of(&[1.0, 2.0]);
    };
    let start = variable.start.expect("it can be set");
    let sign = if min < 0.0 {
        random.of(&[-1.0, 1.0])
    } else {
        1.0
    };
    let any = sign * 10_f64.powf(random.between(-12.0, max.log10()));
    let tiny = random.of(&[
        5e-324,
        -5e-324,
        1e-310,
        f64::MIN_POSITIVE,
        1e-200,
        0.0,
        -0.0,
    ]);
    let next = |value: f64, up: bool| {
        if up {
            value.next_up()
        } else {
            value.next_down()
        }
    };
    let chosen = match random.bits() % 8 {
        0 => min,
        1 => max,
        2 => next(min, true),
        3 => next(max, false),
        4 => tiny,
        5 => any,
        6 => random.between(min, max),
        _ => start,
    };
    chosen.clamp(min, max)
}

fn set_some(
    instance: &mut Instance,
    random: &mut Random,
    share: u64,
    stepping: bool,
) -> Vec<String> {
    let mut set = Vec::new();
    for (reference, variable) in VARIABLES.iter().enumerate() {
        let fixed = stepping && variable.variability == Variability::Fixed;
        let result = matches!(variable.access, Access::Result { .. });
        if result || fixed || !random.bits().is_multiple_of(share) {
            continue;
        }
        let value = value(random, variable);
        set.push(format!("{} = {value:e}", variable.name));
        instance
            .set(type_of(variable), &[reference as u32], |_| value)
            .expect("a legal value");
        if variable.causality == Causality::Input && random.bits().is_multiple_of(4) {
            let order = 1 + (random.bits() % 4) as i32;
            let slope = random.of(&[5e-324, -1e-3, 1.0, -1e3, 1e3]);
            set.push(format!("derivative {order} = {slope:e}"));
            instance
                .set_input_derivatives(&[reference as u32], &[order], &[slope])
                .expect("a legal derivative");
        }
    }
    set
}

/// Reads everything; no NaN, and a stretch between the limits.
fn read(instance: &Instance, history: &[String]) {
    for (reference, variable) in VARIABLES.iter().enumerate() {
        instance
            .get(type_of(variable), &[reference as u32], |_, value| {
                assert!(
                    !value.is_nan(),
                    "{} is NaN after {history:?}",
                    variable.name
                );
                let state = ["lambda", "lambda3", "lambda_dot", "lambda3_dot"];
                if state.contains(&variable.name) {
                    assert!(value.is_finite(), "{} after {history:?}", variable.name);
                }
            })
            .expect("a variable");
    }
}

#[test]
fn legal_values_however_extreme_give_a_step_or_a_reason() {
    let count = if long() { 50_000 } else { 500 };
    let mut slowest = (Duration::ZERO, Vec::new());
    let (mut done, mut discarded) = (0, 0);
    for seed in 0..count {
        let mut random = Random(seed);
        let mut instance = Instance::new();
        let start_time = random.of(&[0.0, -1e9, 1e9, 5e-324]);
        let tolerance = random.of(&[1e-14, 1e-10, 1e-6, 1e-2]);
        instance
            .setup_experiment(Some(tolerance), start_time, None)
            .expect("legal");
        instance.enter_initialization();
        let mut history = vec![format!("seed {seed}, tolerance {tolerance:e}")];
        let share = random.of(&[1, 2, 4, 8]);
        history.extend(set_some(&mut instance, &mut random, share, false));
        read(&instance, &history);
        if instance.exit_initialization().is_err() {
            continue;
        }
        for _ in 0..8 {
            let step = random.of(&[1e-9, 1e-6, 1e-3, 1e-2]);
            let current = instance.last_successful_time();
            history.push(format!("step {step:e}"));
            let begin = processor_time::of_this_thread();
            let outcome = instance.do_step(current, step);
            let taken = processor_time::of_this_thread() - begin;
            if taken > slowest.0 {
                slowest = (taken, history.clone());
            }
            read(&instance, &history);
            match outcome {
                Ok(_) => done += 1,
                Err(fault) => {
                    assert_eq!(fault.severity, Severity::Discard, "{history:?}");
                    assert!(!fault.text.is_empty() && !fault.text.contains("NaN"));
                    discarded += 1;
                    let reached = instance.last_successful_time();
                    assert!(
                        reached >= current && reached <= current + step * (1.0 + 1e-9),
                        "{reached:e} from {current:e}: {} {history:?}",
                        fault.text
                    );
                    break;
                }
            }
            let share = random.of(&[1, 4, 1000]);
            history.extend(set_some(&mut instance, &mut random, share, true));
        }
    }
    assert!(
        done > count && discarded > 0,
        "{done} done, {discarded} discarded"
    );
    assert!(slowest.0 < allowed::SLOWEST_STEP, "{slowest:?}");
}

/// Steps of 1e6 under the fastest legal drives: bounded work, then a reason.
#[test]
fn a_step_that_is_too_long_for_its_drive_is_discarded_with_a_reason() {
    for (frequency, aspect) in [(1e3, 1e-3), (1e3, 1e12), (1.0, 1e-3), (1e-3, 1e-3)] {
        let mut instance = Instance::new();
        for (name, value) in [("c", aspect), ("phi_ac", 0.3), ("omega_ac", frequency)] {
            let reference = value_reference(name).expect("a variable");
            instance
                .set(Type::Real, &[reference], |_| value)
                .expect("a legal value");
        }
        instance.setup_experiment(None, 0.0, None).expect("legal");
        instance.enter_initialization();
        instance.exit_initialization().expect("legal");
        let begin = processor_time::of_this_thread();
        let outcome = instance.do_step(0.0, 1e6);
        let taken = processor_time::of_this_thread() - begin;
        let what = format!("ω = {frequency}, c = {aspect}: {outcome:?} in {taken:?}");
        if let Err(fault) = outcome {
            assert_eq!(fault.severity, Severity::Discard, "{what}");
            assert!(fault.text.contains("use shorter steps"), "{what}");
            assert!(instance.last_successful_time() > 0.0, "{what}");
        }
        read(&instance, std::slice::from_ref(&what));
        assert!(taken < allowed::SLOWEST_STEP, "{what}");
    }
}

/// A host that adds up its steps, in a run as long as one takes; its time is what it says.
#[test]
fn sums_of_many_steps_run_through() {
    let step = 1e-4;
    let count = if long() { 100_000_000 } else { 1_000_000 };
    for start in [0.0, -30.0] {
        let mut instance = Instance::new();
        let stop = start + f64::from(count) * step;
        instance
            .setup_experiment(None, start, Some(stop))
            .expect("legal");
        instance.enter_initialization();
        instance.set(Type::Real, &[0], |_| 0.5).expect("legal");
        instance.exit_initialization().expect("legal");
        let mut time = start;
        for _ in 0..count {
            instance.do_step(time, step).expect("a step");
            time += step;
        }
        let deviation = (instance.last_successful_time() - time).abs();
        assert_at_most(
            deviation,
            2e-14 * time.abs() + 1e-12,
            "deviation of the clock",
        );
        assert!(
            instance.do_step(time, step).is_err(),
            "beyond the stop time"
        );
    }
}
