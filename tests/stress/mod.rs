//! The integrator and the instance where numbers are hardest: at pull-in, far out,
//! in the corners of the parameters, over many and over very long steps.
//!
//! Each test says in its name what holds; every error that is allowed stands
//! with its reason in [`allowed`]. Nothing here may give NaN or hang. What takes
//! minutes runs in short form unless the environment has `STRESS=long`.

mod accuracy;
mod allowed;
mod doubled;
mod escape;
mod fold;
mod independent;
mod inputs;
mod instance;
mod levels;
mod ranges;
mod scenes;
mod steps;
mod traps;
mod varying;

use crate::clocked::Clocked;
use crate::largest::largest;
use crate::processor_time;
use dielectric_elastomer_actuator::actuator::drive::Harmonic;
use dielectric_elastomer_actuator::actuator::{Coefficients, Drive, Motion, Parameters};
use dielectric_elastomer_actuator::solver::State;
use dielectric_elastomer_actuator::solver::limits::Limits;
use dielectric_elastomer_actuator::solver::trajectory::{Progress, Steps, Trajectory};
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
    let mut drive = Drive::constant(load.voltage[0], load.prestress[0]);
    drive.harmonic = Harmonic {
        amplitude,
        frequency,
        frequency_rest: 0.0,
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

/// φ = φ_a sin ωt.
fn alternating(amplitude: f64, frequency: f64) -> Load {
    Load {
        harmonic: [amplitude, frequency, 0.0],
        ..Load::constant(0.0, 0.0)
    }
}

fn from_rest(tolerance: f64) -> Clocked<Steps> {
    Clocked::from(Trajectory::new(REST, WIDE, tolerance))
}

/// Follows the motion for `step`; no limit may be met.
#[track_caller]
fn advance(trajectory: &mut Clocked<Steps>, motion: &Motion, step: f64) {
    assert_eq!(trajectory.advance(motion, step), Ok(Progress::Whole));
}

/// The worse of the differences of position and rate.
fn difference(a: State, [stretch, rate]: [f64; 2]) -> f64 {
    let difference = largest([a.position - stretch, a.rate - rate]);
    assert!(!difference.is_nan());
    difference
}

/// Whether the long form is asked for.
fn long() -> bool {
    std::env::var("STRESS").is_ok_and(|form| form == "long")
}

/// Fails unless `error` is at most `most`; names what was measured.
#[track_caller]
fn assert_at_most(error: f64, most: f64, what: &str) {
    assert!(error <= most, "{what}: {error:e} is more than {most:e}");
    if std::env::var_os("STRESS").is_some() {
        println!("{what}: {error:e}, allowed {most:e}");
    }
}

/// Random numbers that are the same in each run: SplitMix64 (G. L. Steele,
/// D. Lea, C. H. Flood, OOPSLA 2014).
struct Random(u64);

impl Random {
    fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// In [`from`, `to`).
    fn between(&mut self, from: f64, to: f64) -> f64 {
        from + (to - from) * (self.bits() >> 11) as f64 * 2_f64.powi(-53)
    }

    /// An actuator with c of 10 to these powers, γ_s and τ_s below `surface` and
    /// E_s from `elasticity` to 1.
    fn actuator(&mut self, powers: [f64; 2], surface: f64, elasticity: f64) -> Actuator {
        Actuator {
            aspect: 10_f64.powf(self.between(powers[0], powers[1])),
            surface: [
                self.between(0.0, surface),
                self.between(0.0, surface),
                self.between(elasticity, 1.0),
            ],
        }
    }

    /// True once in so many times.
    fn one_in(&mut self, count: u64) -> bool {
        self.bits().is_multiple_of(count)
    }

    /// One of these.
    fn of<T: Copy>(&mut self, these: &[T]) -> T {
        these[(self.bits() % these.len() as u64) as usize]
    }
}
