//! The integrator on the motion of the actuator, against multiprecision references and against
//! what must hold exactly.

mod accuracy;
mod extremes;
mod limits;
mod rest;
mod stored;

use crate::clocked::Clocked;
use dielectric_elastomer_actuator::actuator::drive::Harmonic;
use dielectric_elastomer_actuator::actuator::{Coefficients, Drive, Motion, Parameters};
use dielectric_elastomer_actuator::solver::limits::Limits;
use dielectric_elastomer_actuator::solver::trajectory::{Progress, Steps, Trajectory};
use dielectric_elastomer_actuator::solver::{Equation, State};

const REST: State = State {
    position: 1.0,
    rate: 0.0,
};
const LIMITS: Limits = Limits {
    lower: 0.05,
    upper: 10.0,
};

fn coefficients(aspect: f64, [gamma, tau, elasticity]: [f64; 3]) -> Coefficients {
    Coefficients::fold(&Parameters {
        aspect,
        surface_energy: gamma,
        surface_tension: tau,
        surface_elasticity: elasticity,
    })
}

fn direct(surface: [f64; 3], voltage: f64, prestress: f64) -> Motion {
    Motion {
        coefficients: coefficients(100.0, surface),
        drive: Drive::constant(voltage, prestress),
    }
}

fn alternating(surface: [f64; 3], amplitude: f64, frequency: f64) -> Motion {
    let mut motion = direct(surface, 0.0, 0.0);
    motion.drive.harmonic = Harmonic {
        amplitude,
        frequency,
        frequency_rest: 0.0,
        phase: 0.0,
    };
    motion
}

fn from_rest(tolerance: f64) -> Clocked<Steps> {
    Clocked::from(Trajectory::new(REST, LIMITS, tolerance))
}

/// Follows the motion to `time` in steps of `step` and a last shorter one.
fn follow<E: Equation>(trajectory: &mut Clocked<Steps>, motion: &E, time: f64, step: f64) {
    let whole = (time / step).floor();
    for _ in 0..whole as u64 {
        advance(trajectory, motion, step);
    }
    let rest = time - whole * step;
    if rest > 1e-9 * step {
        advance(trajectory, motion, rest);
    }
}

fn advance<E: Equation>(trajectory: &mut Clocked<Steps>, motion: &E, step: f64) {
    assert_eq!(trajectory.advance(motion, step), Ok(Progress::Whole));
}

const SURFACE: [f64; 3] = [0.05, 0.05, 0.2];
