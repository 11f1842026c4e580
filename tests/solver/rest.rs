//! Motions at rest, next to it, and damped.

use dielectric_elastomer_actuator::arithmetic::double_double::DoubleDouble;
use dielectric_elastomer_actuator::arithmetic::number::Number;
use dielectric_elastomer_actuator::solver::{LocalEquation, Sensitivity};

use super::*;

#[test]
fn rest_at_an_equilibrium_stays_and_wakes() {
    let mut trajectory = from_rest(1e-10);
    advance(&mut trajectory, &direct([0.0; 3], 0.0, 0.0), 1e6);
    assert_eq!(trajectory.state(), REST);
    trajectory.restart();
    advance(&mut trajectory, &direct([0.0; 3], 0.3, 0.0), 10.0);
    assert!(trajectory.position() > 1.0);
}

/// Within rounding of an equilibrium nothing changes in the iterations, which
/// must not be taken for an iteration that converges slowly.
#[test]
fn a_motion_next_to_rest_goes_on() {
    let coefficients = coefficients(100.0, [0.05, 0.05, 0.0]);
    let start = State {
        position: 1.060_000_000_000_000_3,
        rate: 1.267_592_835_769_656_6e-17,
    };
    for ulps in 0..200 {
        let voltage = f64::from_bits(0.510_955_419_527_634_8_f64.to_bits() + ulps);
        let motion = Motion {
            coefficients,
            drive: Drive::constant(voltage, 0.240_000_000_000_000_4),
        };
        for tolerance in [1e-6, 1e-10, 1e-14] {
            let mut trajectory = Clocked::from(Trajectory::new(start, LIMITS, tolerance));
            advance(&mut trajectory, &motion, 30.0);
            assert!((trajectory.position() - start.position).abs() < 1e-9);
        }
    }
}

/// x'' = 1 − x − x'/5: autonomous, but not reversible.
struct Damped;

impl Equation for Damped {
    type Local<'a> = Damped;

    fn at(&self, _time: &DoubleDouble) -> Damped {
        Damped
    }

    fn is_autonomous(&self) -> bool {
        true
    }
}

impl LocalEquation for Damped {
    type Load<N: Number> = N;

    fn load<N: Number>(&self, offset: N) -> N {
        offset
    }

    fn acceleration<N: Number>(&self, _time: N, x: N, rate: N) -> N {
        x.same(1.0) - x - rate * rate.same(0.2)
    }

    fn load_frequency(&self) -> f64 {
        0.0
    }

    fn eighth_degree(&self, _half: f64, _factor: f64) -> Option<[f64; 2]> {
        None
    }

    fn parts<N: Number>(time: N) -> [N; 2] {
        [time, time.same(0.0)]
    }

    fn sensitivity(&self, _state: State) -> Sensitivity {
        Sensitivity {
            position: 1.0,
            load: [0.0; 2],
            rate: 0.2,
        }
    }
}

#[test]
fn a_damped_motion_is_not_run_there_and_back() {
    let start = State {
        position: 1.5,
        rate: 0.0,
    };
    let decay = 0.1_f64;
    let frequency = (1.0 - decay * decay).sqrt();
    for step in [0.3, 7.0] {
        let mut trajectory = Clocked::from(Trajectory::new(start, LIMITS, 1e-10));
        for k in 1..=40 {
            assert_eq!(trajectory.advance(&Damped, step), Ok(Progress::Whole));
            let time = step * f64::from(k);
            let (sine, cosine) = (frequency * time).sin_cos();
            let exact = 1.0 + 0.5 * (-decay * time).exp() * (cosine + decay / frequency * sine);
            let error = (trajectory.position() - exact).abs();
            assert!(error < 1e-9, "{error} after {time} in steps of {step}");
        }
    }
}

#[test]
fn a_damped_motion_rests_where_all_derivatives_vanish_only() {
    let turn = |rate| State {
        position: 1.0,
        rate,
    };
    let mut resting = Clocked::from(Trajectory::new(turn(0.0), LIMITS, 1e-10));
    assert_eq!(resting.advance(&Damped, 1e3), Ok(Progress::Whole));
    assert_eq!(resting.state(), turn(0.0));
    // x'' vanishes here too, but x' does not.
    let mut passing = Clocked::from(Trajectory::new(
        State {
            position: 0.98,
            ..turn(0.1)
        },
        LIMITS,
        1e-10,
    ));
    assert_eq!(passing.advance(&Damped, 0.5), Ok(Progress::Whole));
    assert!(passing.position() > 1.0);
}
