//! A damped actuator is followed by the integrator of the paper's equation.

use super::scene::{LIMITS, Scene, follow, number, read, start};
use crate::clocked::Clocked;
use crate::largest::largest;
use dielectric_elastomer_actuator::actuator::Drive;
use dielectric_elastomer_actuator::actuator::device::{Damping, Device, DeviceMotion};
use dielectric_elastomer_actuator::actuator::drive::Harmonic;
use dielectric_elastomer_actuator::actuator::parameters::Parameters;
use dielectric_elastomer_actuator::arithmetic::double_double::DoubleDouble;
use dielectric_elastomer_actuator::solver::State;
use dielectric_elastomer_actuator::solver::trajectory::{Steps, Trajectory};

fn from_rest(tolerance: f64) -> Clocked<Steps> {
    let rest = State {
        position: 1.0,
        rate: 0.0,
    };
    Clocked::from(Trajectory::new(rest, LIMITS, tolerance))
}

/// A device with surface effects and this inertia and damping, under a constant and an alternating voltage.
fn motion(inertia: f64, damping: Damping, voltage: f64, alternating: f64) -> DeviceMotion {
    let sheet = Parameters {
        aspect: inertia,
        surface_energy: 0.05,
        surface_tension: 0.03,
        surface_elasticity: 0.2,
    };
    let mut drive = Drive::constant(voltage, 0.1);
    drive.harmonic = Harmonic {
        amplitude: alternating,
        frequency: 1.7 / (inertia + 2.0).sqrt(),
        frequency_rest: 0.0,
        phase: 0.4,
    };
    DeviceMotion {
        device: Device {
            damping,
            ..Device::plain(sheet)
        },
        drive,
        records_energy: false,
    }
}

/// Motions with little and with much damping of both kinds.
fn motions() -> impl Iterator<Item = DeviceMotion> {
    [1.0, 100.0, 1e5].into_iter().flat_map(|inertia: f64| {
        let strong = 3.9 * (inertia + 2.0).sqrt();
        let of = move |linear: f64, viscosity: f64| Damping {
            linear: linear * strong,
            viscosity: viscosity * strong / 6.0,
        };
        let dampings = [of(0.01, 0.0), of(0.0, 0.1), of(0.3, 0.7)];
        dampings.into_iter().flat_map(move |damping| {
            [(0.5, 0.0), (0.0, 0.4), (0.2, 0.3)]
                .map(|(voltage, alternating)| motion(inertia, damping, voltage, alternating))
        })
    })
}

#[test]
fn both_integrators_follow_the_same_damped_motion() {
    for motion in motions() {
        assert!(motion.is_plain());
        let scale = (motion.device.sheet.aspect + 2.0).sqrt();
        for part in [0.013, 0.6, 7.9] {
            let step = part * scale;
            let mut plain = from_rest(1e-12);
            let mut reference = start(&motion, 0.0, 1e-13);
            for k in 1..=40 {
                plain.advance(&motion.damped(), step).expect("a motion");
                let time = DoubleDouble::new(step).scale(f64::from(k));
                // With dense output.
                follow(&mut reference, &motion, time, 0.1 * scale);
                let position = plain.position() - reference.position();
                let rate = (plain.rate() - reference.rate()) * scale;
                let error = largest([position, rate]);
                assert!(error < 1e-11, "{motion:?}, step {step}, {k}: {error:e}");
            }
        }
    }
}

/// The voltage is set at each step, as a controller does: single short steps and endpoint-only ones.
#[test]
fn both_integrators_follow_a_damped_motion_whose_voltage_changes() {
    for base in motions() {
        let scale = (base.device.sheet.aspect + 2.0).sqrt();
        for part in [0.004, 0.3] {
            let step = part * scale;
            let mut plain = from_rest(1e-11);
            let mut reference = start(&base, 0.0, 1e-13);
            for k in 0..60 {
                let mut motion = base;
                motion
                    .drive
                    .voltage
                    .set_value(0.3 + 0.1 * (0.2 * f64::from(k)).sin());
                plain.restart();
                reference.restart();
                plain.advance(&motion.damped(), step).expect("a motion");
                reference.advance(&motion, step).expect("a motion");
                let error = (plain.position() - reference.position()).abs();
                assert!(error < 1e-10, "{base:?}, step {step}, {k}: {error:e}");
            }
        }
    }
}

/// Against multiprecision.
#[test]
fn damped_scenes_are_met() {
    for name in ["D_kv_step", "H_ac_damped", "own_linear_damping"] {
        let file = read(name);
        let scene = Scene::of(&file);
        let motion = scene.motion(false);
        assert!(motion.is_plain(), "{name}");
        for tolerance in [1e-6, 1e-9, 1e-12] {
            let mut plain = from_rest(tolerance);
            for row in file["rows"].as_array().expect("rows") {
                let time = DoubleDouble::new(number(&row["t_s"]) / scene.scales().time);
                let rest = time.since(plain.clock);
                if rest > 0.0 {
                    plain.advance(&motion.damped(), rest).expect("a motion");
                    let error = (plain.position() - number(&row["lambda"])).abs();
                    assert!(error < 10.0 * tolerance, "{name}, {tolerance:e}: {error:e}");
                }
            }
        }
    }
}

/// Steps of the paper's integrator would be as short as what is damped relaxes.
#[test]
fn strong_damping_is_left_to_the_integrator_of_coupled_systems() {
    let strong = Damping {
        linear: 0.0,
        viscosity: 10.0,
    };
    assert!(!motion(100.0, strong, 0.5, 0.0).is_plain());
}
