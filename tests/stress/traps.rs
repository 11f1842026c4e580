//! Motions that a long substep could step over without noticing.

use dielectric_elastomer_actuator::solver::State;
use dielectric_elastomer_actuator::solver::limits::{Limit, Limits};
use dielectric_elastomer_actuator::solver::trajectory::{Progress, Trajectory};

use super::independent::{Actuator, Load};
use super::{advance, alternating, assert_at_most, from_rest, motion};
use crate::clocked::Clocked;

/// A voltage that alternates many times within a natural period acts by its
/// mean square; the ripple is below 1e-8 here.
#[test]
fn a_voltage_much_faster_than_the_motion_acts_by_its_mean_square() {
    for (aspect, frequency) in [(1e4, 10.0), (1e6, 10.0), (1e8, 100.0), (1e8, 1000.0)] {
        let actuator = Actuator {
            aspect,
            surface: [0.05, 0.05, 0.2],
        };
        let time = f64::sqrt(aspect);
        let mean = motion(&actuator, &Load::constant(0.3 / 2_f64.sqrt(), 0.0));
        let mut reference = from_rest(1e-14);
        advance(&mut reference, &mean, time);
        for tolerance in [1e-4, 1e-6, 1e-8, 1e-10] {
            let mut trajectory = from_rest(tolerance);
            let fast = motion(&actuator, &alternating(0.3, frequency));
            advance(&mut trajectory, &fast, time);
            let error = (trajectory.position() - reference.position()).abs();
            let what = format!("c = {aspect:e}, ω = {frequency}, tolerance {tolerance:e}");
            assert_at_most(error, 10.0 * tolerance + 1e-8, &what);
        }
    }
}

/// The elastic barrier against contraction is far thinner than a substep of
/// the slow motion before it. With c ≥ 1e6 the motion down to λ = 0.4 is free,
/// but for 2λ⁻⁶/c < 1e-3 of thickness inertia.
#[test]
fn a_fast_contraction_stops_at_the_lower_limit() {
    for (aspect, rate) in [
        (1e6, 1e3),
        (1e6, 1.0),
        (1e6, 10.0),
        (1e8, 0.1),
        (1e8, 1.0),
        (1e12, 1e3),
    ] {
        let actuator = Actuator {
            aspect,
            surface: [0.0; 3],
        };
        let motion = motion(&actuator, &Load::constant(0.0, 0.0));
        for tolerance in [1e-4, 1e-10] {
            for step in [1.0 / rate, 1e3 / rate] {
                let start = State {
                    position: 1.0,
                    rate: -rate,
                };
                let limits = Limits {
                    lower: 0.4,
                    upper: 10.0,
                };
                let mut trajectory = Clocked::from(Trajectory::new(start, limits, tolerance));
                let outcome = trajectory.advance(&motion, step);
                assert!(
                    matches!(outcome, Ok(Progress::Stopped { limit: Limit::Lower, after })
                        if (after * rate - 0.6).abs() < 1e-3),
                    "c = {aspect:e}, rate −{rate}, {tolerance:e}, {step:e}: {outcome:?}"
                );
            }
        }
    }
}

/// Where the limit lies behind the barrier, the actuator bounces, however
/// loose the tolerance.
#[test]
fn a_fast_contraction_bounces_off_the_elastic_barrier() {
    for aspect in [1e8, 1e10, 1e12] {
        let rate = 300.0 / f64::sqrt(aspect);
        let actuator = Actuator {
            aspect,
            surface: [0.05, 0.05, 0.2],
        };
        let motion = motion(&actuator, &Load::constant(0.0, 0.0));
        for tolerance in [1e-2, 1e-4, 1e-8] {
            let start = State {
                position: 1.0,
                rate: -rate,
            };
            let mut trajectory = Clocked::from(Trajectory::new(start, super::WIDE, tolerance));
            advance(&mut trajectory, &motion, 1.5 / rate);
            assert!(trajectory.rate() > 0.0, "c = {aspect:e}, {tolerance:e}");
        }
    }
}
