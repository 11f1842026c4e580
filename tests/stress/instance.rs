//! Extreme but legal values through the instance, as a host would set them: never
//! NaN, never a hang; a step is done or says why not.

use std::time::Duration;

use dielectric_elastomer_actuator::instance::{Instance, Severity, Type};
use dielectric_elastomer_actuator::model::Model;
use dielectric_elastomer_actuator::model::variables::{
    self, Access, Causality, Kind, Variability, Variable,
};
use dielectric_elastomer_actuator::nondimensional::{Nondimensional, value_reference};
use dielectric_elastomer_actuator::si::Si;

use super::*;

/// The time in which the motion turns some times.
fn time_unit<M: Model>() -> f64 {
    10.0 * M::EXPERIMENT.step_size
}

fn type_of<M: Model>(variable: &Variable<M>) -> Type {
    match variable.kind {
        Kind::Real { .. } => Type::Real,
        Kind::Boolean => Type::Boolean,
        Kind::Enumeration(_) => Type::Integer,
    }
}

/// A legal value: a limit, the start, a denormal, next to nothing, or any size.
fn value<M: Model>(random: &mut Random, variable: &Variable<M>) -> f64 {
    let (min, max) = match variable.kind {
        Kind::Real { min, max, .. } => (min, max),
        Kind::Boolean => return random.of(&[0.0, 1.0]),
        Kind::Enumeration(of) => return 1.0 + (random.bits() % of.items.len() as u64) as f64,
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
    let chosen = chosen.clamp(min, max);
    if variable.check(chosen).is_ok() {
        chosen
    } else {
        start
    }
}

/// Why a legal value may be refused on the way.
const REASONS: [&str; 5] = [
    "cannot be set: there is no motion",
    "chooses the Gent law and",
    "is added to the supply voltage only",
    "make the permittivity",
    "is out of proportion to electric_field",
];

fn set_some<M: Model>(
    instance: &mut Instance<M>,
    random: &mut Random,
    share: u64,
    stepping: bool,
) -> Vec<String> {
    let mut set = Vec::new();
    for (reference, variable) in M::VARIABLES.iter().enumerate() {
        let fixed = stepping && variable.variability == Variability::Fixed;
        let result = matches!(variable.access, Access::Result { .. });
        if result || fixed || !random.bits().is_multiple_of(share) {
            continue;
        }
        let value = value(random, variable);
        let said = format!("{} = {value:e}", variable.name);
        if let Err(fault) = instance.set(type_of(variable), &[reference as u32], |_| value) {
            // On the way a value may not go with the present state or with others, which the message says.
            let reason = |part: &&str| fault.text.contains(part);
            let known = fault.text.contains("cannot be set: ") && REASONS.iter().any(reason);
            assert!(stepping && known, "{said}: {fault:?}");
            continue;
        }
        set.push(said);
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

/// Reads everything: numbers, and states that are finite. Returns how many results are refused
/// because they are no numbers.
fn read<M: Model>(instance: &Instance<M>, history: &[String]) -> usize {
    let mut refused = 0;
    for (reference, variable) in M::VARIABLES.iter().enumerate() {
        let mut value = f64::NAN;
        let outcome = instance.get(type_of(variable), &[reference as u32], |_, number| {
            value = number;
        });
        let name = variable.name;
        let state = ["lambda", "lambda3", "lambda_dot", "lambda3_dot"].contains(&name);
        match outcome {
            Ok(()) => assert!(!value.is_nan(), "{name} is NaN after {history:?}"),
            Err(fault) => {
                assert_eq!(
                    fault.severity,
                    Severity::Discard,
                    "{name} after {history:?}"
                );
                refused += 1;
            }
        }
        assert!(!state || value.is_finite(), "{name} after {history:?}");
    }
    refused
}

#[test]
fn legal_values_however_extreme_give_a_step_or_a_reason() {
    let refused =
        extremes_give_a_step_or_a_reason::<Nondimensional>(if long() { 50_000 } else { 500 });
    assert_eq!(refused, 0, "results that are no numbers");
}

/// Where a parameter is changed on the way, a state may be one in which a result is no number, such as
/// an energy beyond locking: it is refused.
#[test]
fn legal_values_of_the_real_actuator_however_extreme_give_a_step_or_a_reason() {
    extremes_give_a_step_or_a_reason::<Si>(if long() { 10_000 } else { 200 });
}

/// Returns how many results were refused.
fn extremes_give_a_step_or_a_reason<M: Model>(count: u64) -> usize {
    let unit = time_unit::<M>();
    let mut slowest = (Duration::ZERO, Vec::new());
    let (mut done, mut discarded, mut refused) = (0, 0, 0);
    for seed in 0..count {
        let mut random = Random(seed);
        let mut instance = Instance::<M>::new();
        let start_time = unit * random.of(&[0.0, -1e9, 1e9, 5e-324]);
        let tolerance = random.of(&[1e-14, 1e-10, 1e-6, 1e-2]);
        instance
            .setup_experiment(Some(tolerance), start_time, None)
            .expect("legal");
        instance.enter_initialization();
        let mut history = vec![format!("seed {seed}, tolerance {tolerance:e}")];
        let share = random.of(&[1, 2, 4, 8]);
        history.extend(set_some(&mut instance, &mut random, share, false));
        refused += read(&instance, &history);
        if instance.exit_initialization().is_err() {
            continue;
        }
        for _ in 0..8 {
            let step = unit * random.of(&[1e-9, 1e-6, 1e-3, 1e-2]);
            let current = instance.last_successful_time();
            history.push(format!("step {step:e}"));
            let begin = processor_time::of_this_thread();
            let outcome = instance.do_step(current, step);
            let taken = processor_time::of_this_thread() - begin;
            if taken > slowest.0 {
                slowest = (taken, history.clone());
            }
            refused += read(&instance, &history);
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
    println!("{done} steps done, {discarded} discarded, {refused} results refused; {slowest:?}");
    assert!(slowest.0 < allowed::SLOWEST_STEP, "{slowest:?}");
    refused
}

/// Steps of 1e6 under the fastest legal drives: bounded work, then a reason.
#[test]
fn a_step_that_is_too_long_for_its_drive_is_discarded_with_a_reason() {
    for (frequency, aspect, is_too_long) in [
        (1e3, 1e-3, true),
        (1e3, 1e12, true),
        (1.0, 1e-3, true),
        (1e-3, 1e-3, false),
    ] {
        let mut instance = Instance::<Nondimensional>::new();
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
        assert_eq!(outcome.is_err(), is_too_long, "{what}");
        if let Err(fault) = outcome {
            assert_eq!(fault.severity, Severity::Discard, "{what}");
            assert!(fault.text.contains("use shorter steps"), "{what}");
            assert!(instance.last_successful_time() > 0.0, "{what}");
        }
        assert_eq!(read(&instance, std::slice::from_ref(&what)), 0);
        assert!(taken < allowed::SLOWEST_STEP, "{what}");
    }
}

/// A host that adds up its steps, in a run as long as one takes; its time is what it says.
#[test]
fn sums_of_many_steps_run_through() {
    sums_run_through::<Nondimensional>("phi", 0.5);
}

#[test]
fn sums_of_many_steps_of_the_real_actuator_run_through() {
    sums_run_through::<Si>("voltage", 500.0);
}

fn sums_run_through<M: Model>(input: &str, value: f64) {
    let step = 1e-4 * time_unit::<M>();
    let count = if long() { 100_000_000 } else { 1_000_000 };
    for start in [0.0, -30.0 * time_unit::<M>()] {
        let mut instance = Instance::<M>::new();
        let stop = start + f64::from(count) * step;
        instance
            .setup_experiment(None, start, Some(stop))
            .expect("legal");
        instance.enter_initialization();
        let reference = variables::value_reference::<M>(input).expect("an input");
        instance
            .set(Type::Real, &[reference], |_| value)
            .expect("legal");
        instance.exit_initialization().expect("legal");
        let mut time = start;
        for _ in 0..count {
            instance.do_step(time, step).expect("a step");
            time += step;
        }
        let deviation = (instance.last_successful_time() - time).abs();
        let rounding = 2e-14 * time.abs() + 1e-12 * time_unit::<M>();
        assert_at_most(deviation, rounding, "deviation of the clock");
        assert!(
            instance.do_step(time, step).is_err(),
            "beyond the stop time"
        );
    }
}
