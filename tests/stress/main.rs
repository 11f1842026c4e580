//! The integrator and the slave where numbers are hardest: at pull-in, far out,
//! in the corners of the parameters, over many and over very long steps.
//!
//! Each test says in its name what holds; every error that is allowed stands
//! with its reason in [`allowed`]. Nothing here may give NaN or hang. What takes
//! minutes runs in short form unless the environment has `STRESS=long`.

mod independent;

use dielectric_elastomer_actuator::actuator::drive::Harmonic;
use dielectric_elastomer_actuator::actuator::{Coefficients, Drive, Motion, Parameters};
use dielectric_elastomer_actuator::solver::State;
use dielectric_elastomer_actuator::solver::double::Double;
use dielectric_elastomer_actuator::solver::limits::Limits;
use dielectric_elastomer_actuator::solver::trajectory::{Progress, Trajectory};
use independent::{Actuator, Load, Taylor};

const REST: State = State {
    position: 1.0,
    rate: 0.0,
};

/// The widest limits that a host can set.
const WIDE: Limits = Limits {
    lower: 1e-3,
    upper: 1e6,
};

/// An actuator under a load, as the library and as the independent integrator see it.
fn motion(actuator: &Actuator, load: &Load) -> Motion {
    let [surface_energy, surface_tension, surface_elasticity] = actuator.surface;
    let [amplitude, frequency, phase] = load.harmonic;
    let mut drive = Drive::constant(load.voltage, load.prestress);
    drive.harmonic = Harmonic {
        amplitude,
        frequency,
        phase,
    };
    Motion {
        coefficients: Coefficients::fold(&Parameters {
            aspect: actuator.aspect,
            surface_energy,
            surface_tension,
            surface_elasticity,
        }),
        drive,
    }
}

fn from_rest(tolerance: f64) -> Trajectory {
    Trajectory::new(REST, Double::ZERO, WIDE, tolerance)
}

/// Follows the motion for `step`; no limit may be met.
#[track_caller]
fn advance(trajectory: &mut Trajectory, motion: &Motion, step: f64) {
    assert_eq!(trajectory.advance(motion, step), Ok(Progress::Whole));
}

/// The worse of the differences of position and rate.
fn difference(a: State, [stretch, rate]: [f64; 2]) -> f64 {
    let difference = (a.position - stretch).abs().max((a.rate - rate).abs());
    assert!(!difference.is_nan());
    difference
}
