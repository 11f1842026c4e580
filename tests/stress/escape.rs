//! Motions that go far: to infinity in finite time, and onto far orbits.

use dielectric_elastomer_actuator::instance::Type;
use dielectric_elastomer_actuator::nondimensional::Instance;
use dielectric_elastomer_actuator::nondimensional::value_reference;
use dielectric_elastomer_actuator::pull_in;
use dielectric_elastomer_actuator::solver::limits::{Limit, Limits};
use dielectric_elastomer_actuator::solver::trajectory::{Progress, Trajectory};

use super::*;

/// Voltage, aspect and time of the escapes of `tests/reference`.
fn references() -> Vec<[f64; 3]> {
    let text = include_str!("../reference/amplitudes.json");
    let all: serde_json::Value = serde_json::from_str(text).expect("JSON");
    let number = |value: &serde_json::Value| match value.as_str() {
        Some(digits) => digits.parse().expect("a number"),
        None => value.as_f64().expect("a number"),
    };
    let row = |row: &serde_json::Value| [&row["phi"], &row["c"], &row["t"]].map(number);
    let rows = all["escape"].as_array().expect("rows");
    assert_eq!(rows.len(), 3);
    rows.iter().map(row).collect()
}

/// Time from a far stretch to infinity: 2c λ'² = φ²λ⁴ − 2λ² + … there by the energy; the next
/// term of the series is of order λ⁻⁵.
fn rest(voltage: f64, aspect: f64, stretch: f64) -> f64 {
    let next = 1.0 / (3.0 * (voltage * stretch).powi(2));
    (2.0 * aspect).sqrt() / (voltage * stretch) * (1.0 + next)
}

/// In one step and in steps of 0.1, up to stretches of 1e6.
#[test]
fn the_stretch_becomes_infinite_when_it_should() {
    for [voltage, aspect, time] in references() {
        let actuator = Actuator {
            aspect,
            surface: [0.0; 3],
        };
        let motion = motion(&actuator, &Load::constant(voltage, 0.0));
        for upper in [1e4, 1e5, 1e6] {
            for tolerance in [1e-9, 1e-10, 1e-12, 1e-14] {
                for step in [100.0, 0.1] {
                    let limits = Limits { upper, ..WIDE };
                    let mut trajectory = Clocked::from(Trajectory::new(REST, limits, tolerance));
                    let mut steps = 0.0;
                    let after = loop {
                        match trajectory.advance(&motion, step) {
                            Ok(Progress::Whole) => steps += 1.0,
                            Ok(Progress::Stopped {
                                limit: Limit::Upper,
                                after,
                            }) => break steps * step + after,
                            other => panic!("{other:?}"),
                        }
                    };
                    let error = (after + rest(voltage, aspect, upper) - time).abs();
                    let what = format!("escape, φ = {voltage}, to {upper:e}, {tolerance:e}");
                    assert_at_most(error, allowed::ESCAPE, &what);
                    assert_at_most((trajectory.position() / upper - 1.0).abs(), 1e-9, &what);
                }
            }
        }
    }
}

#[test]
fn the_instance_tells_the_time_of_an_escape() {
    for [voltage, aspect, time] in references() {
        let mut instance = Instance::new();
        let reference = |name| value_reference(name).expect("a variable");
        for (name, value) in [("phi", voltage), ("c", aspect), ("lambda_max", 1e6)] {
            instance
                .set(Type::Real, &[reference(name)], |_| value)
                .expect("a legal value");
        }
        instance
            .setup_experiment(Some(1e-12), 0.0, None)
            .expect("legal");
        instance.enter_initialization();
        instance.exit_initialization().expect("legal");
        for step in 0..700 {
            instance
                .do_step(0.1 * f64::from(step), 0.1)
                .expect("it holds");
        }
        let mut at = f64::NAN;
        instance
            .get(Type::Real, &[reference("pull_in_time")], |_, t| at = t)
            .expect("a variable");
        let error = (at + rest(voltage, aspect, 1e6) - time).abs();
        assert_at_most(error, allowed::ESCAPE, "pull_in_time");
    }
}

/// E = .007 just past pull-in: λ3 falls to .036 in each period of 293.
#[test]
fn the_far_orbit_past_pull_in_is_followed() {
    let actuator = Actuator {
        aspect: 100.0,
        surface: [0.0, 0.0, 0.007],
    };
    let coefficients = motion(&actuator, &Load::constant(0.0, 0.0)).coefficients;
    let fold = pull_in::dynamic(&coefficients, 0.0).expect("there is a fold");
    for distance in [1e-4, 1e-6] {
        let load = Load::constant(fold.voltage * (1.0 + distance), 0.0);
        let motion = motion(&actuator, &load);
        for step in [0.1, 1.7, 50.0] {
            let (mut trajectory, mut reference) = (from_rest(1e-12), Taylor::new(1.0, 0.0));
            let (mut worst, mut thinnest) = (0.0_f64, 1.0_f64);
            for _ in 0..(1000.0 / step) as u32 {
                advance(&mut trajectory, &motion, step);
                reference.advance(&actuator, &load, step);
                worst = worst.max(difference(trajectory.state(), reference.state()));
                thinnest = thinnest.min(trajectory.position().powi(-2));
            }
            let most = allowed::FAR_ORBIT / distance;
            assert_at_most(
                worst,
                most,
                &format!("far orbit, {distance:e} past, {step}"),
            );
            assert!(
                step > 1.0 || (0.0359..0.0361).contains(&thinnest),
                "{thinnest}"
            );
        }
    }
}

/// E = 0 near resonance: λ3 goes up to 6.7 and the motion survives.
#[test]
fn an_alternating_voltage_contracts_the_actuator_to_a_thickness_stretch_of_six() {
    for ([gamma, tau], frequency, expected) in [
        ([0.1, 0.05], 0.137, 6.72),
        ([0.05, 0.05], 0.133, 6.25),
        ([0.0, 0.05], 0.129, 6.02),
    ] {
        let actuator = Actuator {
            aspect: 100.0,
            surface: [gamma, tau, 0.0],
        };
        let load = alternating(0.3, frequency);
        let motion = motion(&actuator, &load);
        let (mut trajectory, mut reference) = (from_rest(1e-12), Taylor::new(1.0, 0.0));
        let (mut worst, mut thickest) = (0.0_f64, 1.0_f64);
        for _ in 0..4000 {
            advance(&mut trajectory, &motion, 0.5);
            reference.advance(&actuator, &load, 0.5);
            worst = worst.max(difference(trajectory.state(), reference.state()));
            thickest = thickest.max(trajectory.position().powi(-2));
        }
        assert!((thickest - expected).abs() < 0.01, "{thickest}");
        assert_at_most(worst, allowed::RESONANCE, &format!("ω = {frequency}"));
    }
}

/// γ = 0, τ = .02, E = S = 0: 40 swings, then λ → ∞. What is lost in a swing
/// grows with each one, so that the tolerance counts.
#[test]
fn an_alternating_voltage_drives_the_actuator_to_infinity() {
    let actuator = Actuator {
        aspect: 100.0,
        surface: [0.0, 0.02, 0.0],
    };
    let load = alternating(0.3, 0.117);
    let motion = motion(&actuator, &load);
    let mut reference = Taylor::new(1.0, 0.0);
    reference.advance(&actuator, &load, 1251.0);
    let [stretch, rate] = reference.state();
    for (tolerance, most) in [(1e-10, 1e-2), (1e-12, 2e-4), (1e-14, 1e-5)] {
        let limits = Limits {
            upper: stretch,
            ..WIDE
        };
        let mut trajectory = Clocked::from(Trajectory::new(REST, limits, tolerance));
        let stopped = trajectory.advance(&motion, 2000.0);
        let Ok(Progress::Stopped { after, .. }) = stopped else {
            panic!("{stopped:?}")
        };
        let what = format!("at stretch {stretch} and rate {rate}, tolerance {tolerance:e}");
        assert_at_most((after - 1251.0).abs(), most, &what);

        let limits = Limits { upper: 1e4, ..WIDE };
        let mut trajectory = Clocked::from(Trajectory::new(REST, limits, tolerance));
        let stopped = trajectory.advance(&motion, 2000.0);
        let Ok(Progress::Stopped { after, .. }) = stopped else {
            panic!("{stopped:?}")
        };
        assert_at_most(
            (after - allowed::ESCAPE_AT_AC).abs(),
            most,
            "at stretch 1e4",
        );
    }
}
