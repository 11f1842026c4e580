//! What others have published, and closed forms.

use super::scene::{Present, follow, start};
use dielectric_elastomer_actuator::actuator::Drive;
use dielectric_elastomer_actuator::actuator::Parameters;
use dielectric_elastomer_actuator::actuator::device::equation::Load;
use dielectric_elastomer_actuator::actuator::device::{
    Branch, Device, DeviceMotion, Elasticity, Locking, Port, Source,
};
use dielectric_elastomer_actuator::actuator::scales::{Scales, SiDevice, SiElasticity};
use dielectric_elastomer_actuator::arithmetic::double_double::DoubleDouble;
use dielectric_elastomer_actuator::pull_in::device::{dynamic, quasi_static};
use dielectric_elastomer_actuator::solver::coupled::{CoupledEquation, Stage, Trajectory};

fn sheet(aspect: f64) -> Device {
    Device::plain(Parameters {
        aspect,
        surface_energy: 0.0,
        surface_tension: 0.0,
        surface_elasticity: 0.0,
    })
}

fn motion(device: Device, source: f64, prestress: f64) -> DeviceMotion {
    DeviceMotion {
        device,
        drive: Drive::constant(source, prestress),
        records_energy: false,
    }
}

fn close(found: f64, exact: f64, error: f64) {
    assert!((found - exact).abs() < error, "{found} for {exact}");
}

/// The stretch at which a damped device comes to rest.
fn equilibrium(mut device: Device, source: f64, prestress: f64) -> f64 {
    let period = ((device.sheet.aspect + 2.0) / 6.0).sqrt();
    device.damping.viscosity = period;
    let motion = motion(device, source, prestress);
    let mut trajectory = start(&motion, 0.0, 1e-12);
    follow(
        &mut trajectory,
        &motion,
        DoubleDouble::new(1000.0 * period),
        f64::INFINITY,
    );
    trajectory.position()
}

fn stage(position: f64) -> Stage {
    Stage {
        position,
        rate: 0.0,
        internal: [1.0; 4],
    }
}

/// X. Zhao, Z. Suo, Appl. Phys. Lett. 91 (2007) 061921: λ = 1.26 and .69 √(µ/ε), exactly 2^(1/3)
/// and √3 2^(−4/3). M. Joglekar, J. Appl. Mech. 81 (2014): .6470 for a step.
#[test]
fn ideal_pull_in() {
    let fold = quasi_static(&sheet(100.0), 0.0).expect("a fold");
    close(
        fold.voltage,
        3.0_f64.sqrt() * 2.0_f64.powf(-4.0 / 3.0),
        1e-15,
    );
    close(fold.stretch, 2.0_f64.cbrt(), 1e-7);
    let fold = dynamic(&sheet(100.0), 0.0).expect("a fold");
    close(fold.voltage, 0.646_983_632_244_827_4, 1e-15);
    close(fold.stretch.powi(-2), 0.465_571_231_876_768, 1e-7);
}

/// C. Keplinger, M. Kaltenbrunner, N. Arnold, S. Bauer, PNAS 107 (2010) 4505: no pull-in at held
/// charge; λ⁶ = 1 + q².
#[test]
fn held_charge_is_stable_everywhere() {
    let mut device = sheet(4e4);
    device.port.source = Source::Charge;
    for charge in [0.3_f64, 1.002_244_772_747_494, 3.0, 30.0] {
        let exact = (1.0 + charge * charge).powf(1.0 / 6.0);
        close(equilibrium(device, charge, 0.0), exact, 1e-11);
    }
}

/// J. Sheng, H. Chen, L. Liu, J. Zhang, Y. Wang, S. Jia, J. Appl. Phys. 115 (2014), Eq. 20:
/// equilibrium 1.149 at J = 100, S = .5, φ² = .1, and the frequency around it.
#[test]
fn gent_equilibrium_and_frequency_of_sheng() {
    let mut device = sheet(1e12);
    device.elasticity = Elasticity::Gent(Locking::new(100.0));
    let voltage = 0.1_f64.sqrt();
    let light = Device {
        sheet: sheet(100.0).sheet,
        ..device
    };
    let found = equilibrium(light, voltage, 0.5);
    close(found, 1.149_228_951_976_537, 1e-11);
    let motion = motion(device, voltage, 0.5);
    let local = motion.at(&DoubleDouble::ZERO, &DoubleDouble::ZERO);
    let load = Load {
        source: voltage,
        prestress: 0.5,
    };
    let frequency = local.small_signal_frequency(&load, &stage(found));
    // In units of √(12µ/ρ)/L that is √c times ours.
    close(frequency * 1e6, 1.672_707_923_249_469, 1e-9);
}

/// Appendix A of the paper, after Joglekar: H 2 mm, L 10 mm, µ 67.1 kPa, ρ 1200, ε 6.198e-11.
#[test]
fn appendix_a_in_si_units() {
    let relative = 6.198e-11 / 8.854_187_818_8e-12;
    let device = SiDevice::sheet(67.1e3, 1200.0, relative, [2e-3, 10e-3]);
    let scales = Scales::of(&device);
    close(scales.time * 1e6, 77.209_143_648_218_29, 1e-13);
    close(0.5 * scales.voltage, 32_902.998_232, 1e-5);
    let motion = motion(device.nondimensional(), 0.5, 0.0);
    let mut trajectory = start(&motion, 0.0, 1e-12).with(Trajectory::recording_extremes);
    // 16.7211477513329 units of time.
    let period = scales.time(DoubleDouble::new(1.291_025_498_695_744_5e-3));
    follow(&mut trajectory, &motion, period, f64::INFINITY);
    close(trajectory.position(), 1.0, 1e-11);
    let highest = trajectory.extremes().expect("recorded").highest;
    close(highest.powi(-2), 0.798_867_594_059, 1e-11);
}

/// The prestress of Elastosil at two stretches, σ0 = 2(λ² − λ⁻⁴) dW/dI by its Yeoh constants: the
/// force that holds the sheet there, over its deformed section.
#[test]
fn yeoh_prestress_of_elastosil() {
    let mut device = SiDevice::sheet(361.4e3, 1080.0, 2.8, [100e-6, 20e-3]);
    device.elasticity = SiElasticity::Yeoh {
        second: -16.7 / 180.7,
        third: 6.6 / 180.7,
    };
    let motion = motion(device.nondimensional(), 0.0, 0.0);
    let local = motion.at(&DoubleDouble::ZERO, &DoubleDouble::ZERO);
    for (stretch, stress) in [(1.15, 261_846.480_913_707), (1.38, 546_469.550_958_688)] {
        let load = Load {
            source: 0.0,
            prestress: 0.0,
        };
        let [force, ..] = local.forces(&load, &stage(stretch));
        // µTL(−force) on the section LT/λ.
        close(-force * 361.4e3 * stretch, stress, 1e-8);
    }
}

/// A blocked membrane is charged like 1 − exp(−t/RC).
#[test]
fn a_blocked_membrane_is_charged_exponentially() {
    let mut device = sheet(1e18);
    device.port.resistance = 3.0;
    let motion = motion(device, 0.4, 0.0);
    let mut trajectory = start(&motion, 0.0, 1e-12);
    for time in [0.1, 1.0, 2.7, 10.0, 60.0] {
        follow(
            &mut trajectory,
            &motion,
            DoubleDouble::new(time),
            f64::INFINITY,
        );
        let exact = -0.4 * (-time / 3.0_f64).exp_m1();
        close(Present::of(&motion, &trajectory).charge, exact, 1e-10);
    }
}

/// The creep of a standard linear solid after a small step: λ − 1 = (φ²/6)[1 − m/(1+m)
/// exp(−t/((1+m)τ))], to the order of φ⁴, where damping has stilled the ringing.
#[test]
fn a_small_step_creeps_as_the_standard_linear_solid() {
    let mut device = sheet(100.0);
    let (modulus, relaxation_time) = (1.5, 1e5);
    device.branches[0] = Branch {
        modulus,
        relaxation_time,
        limit: f64::INFINITY,
    };
    device.damping.viscosity = 5.0;
    let voltage = 1e-3_f64;
    let motion = motion(device, voltage, 0.0);
    let mut trajectory = start(&motion, 0.0, 1e-13);
    for part in [0.1, 0.5, 1.0, 3.0, 10.0] {
        let time = part * relaxation_time;
        follow(
            &mut trajectory,
            &motion,
            DoubleDouble::new(time),
            f64::INFINITY,
        );
        let left = modulus / (1.0 + modulus) * (-time / ((1.0 + modulus) * relaxation_time)).exp();
        let exact = voltage * voltage / 6.0 * (1.0 - left);
        // The dashpot's 6η delays by some 10 units of time.
        close(trajectory.position() - 1.0, exact, 3e-4 * exact);
    }
}

/// Small oscillations at rest: f = √(6/(c+2))/2π, and stiffer by 8φ²λ² at held charge.
#[test]
fn small_oscillations() {
    let device = sheet(100.0);
    let load = Load {
        source: 0.3,
        prestress: 0.0,
    };
    let none = Load {
        source: 0.0,
        prestress: 0.0,
    };
    let voltage = motion(device, 0.3, 0.0);
    let local = voltage.at(&DoubleDouble::ZERO, &DoubleDouble::ZERO);
    close(
        local.small_signal_frequency(&none, &stage(1.0)),
        (6.0_f64 / 102.0).sqrt(),
        1e-15,
    );
    let held_voltage = local.small_signal_frequency(&load, &stage(1.1));
    let port = Port {
        source: Source::Charge,
        ..device.port
    };
    let charge = 0.3 * 1.1_f64.powi(4);
    let by_charge = motion(Device { port, ..device }, charge, 0.0);
    let load = Load {
        source: charge,
        prestress: 0.0,
    };
    let local = by_charge.at(&DoubleDouble::ZERO, &DoubleDouble::ZERO);
    let held_charge = local.small_signal_frequency(&load, &stage(1.1));
    let inertia = 100.0 + 2.0 * 1.1_f64.powi(-6);
    let stiffer = inertia * (held_charge.powi(2) - held_voltage.powi(2));
    close(stiffer, 8.0 * 0.09 * 1.21, 1e-12);
}
