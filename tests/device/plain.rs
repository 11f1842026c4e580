//! What is off costs nothing and changes nothing: the device is then the paper's actuator.

use super::scene::{LIMITS, follow, start};
use crate::clocked::Clocked;
use dielectric_elastomer_actuator::actuator::device::{Device, DeviceMotion, Spring};
use dielectric_elastomer_actuator::actuator::scales::{Scales, SiDevice};
use dielectric_elastomer_actuator::actuator::{Coefficients, Drive, Motion, Parameters};
use dielectric_elastomer_actuator::arithmetic::double_double::DoubleDouble;
use dielectric_elastomer_actuator::solver::State;
use dielectric_elastomer_actuator::solver::trajectory::Trajectory;

const SHEET: Parameters = Parameters {
    aspect: 100.0,
    surface_energy: 0.05,
    surface_tension: 0.03,
    surface_elasticity: 0.2,
};

/// A plain device folds to the very numbers of the paper's equation.
#[test]
fn a_plain_device_folds_to_the_same_coefficients() {
    let device = Device::plain(SHEET);
    assert!(device.is_plain());
    assert_eq!(device.folded(), Coefficients::fold(&SHEET));
    assert_eq!(device.spring.preload(), 0.0);
    let spring = Spring {
        stiffness: 0.3,
        rest: 1.2,
    };
    let sprung = Device { spring, ..device };
    assert!(sprung.is_plain());
    assert_eq!(sprung.folded().linear, device.folded().linear + 0.3);
    assert_eq!(sprung.spring.preload(), 0.3 * 1.2);
}

/// The integrator of coupled systems follows the paper's motion as the plain one does, with a
/// spring folded in.
#[test]
fn both_integrators_follow_the_same_motion() {
    let mut device = Device::plain(SHEET);
    device.spring = Spring {
        stiffness: 0.3,
        rest: 1.2,
    };
    let drive = Drive::constant(0.5, -0.1);
    let coupled = DeviceMotion {
        device,
        drive,
        records_energy: false,
    };
    let plain = Motion {
        coefficients: device.folded(),
        drive: Drive::constant(0.5, -0.1 + device.spring.preload()),
    };
    let mut ours = start(&coupled, 0.0, 1e-13);
    let rest = State {
        position: 1.0,
        rate: 0.0,
    };
    let mut reference = Clocked::from(Trajectory::new(rest, LIMITS, 1e-13));
    for k in 1..=200 {
        let time = f64::from(k) * 3.7;
        follow(&mut ours, &coupled, DoubleDouble::new(time), f64::INFINITY);
        let step = time - reference.clock.value();
        reference.advance(&plain, step).expect("a motion");
        let error = ours.position() - reference.position();
        assert!(error.abs() < 3e-13, "{time}: {error:e}");
    }
}

/// The scales of the paper's device, and a stack: energies, charges and times that the formulas
/// relate.
#[test]
fn scales_are_consistent() {
    let mut device = SiDevice::sheet(303e3, 1100.0, 2.8, [10e-6, 100e-6]);
    device.layers = 7.0;
    let scales = Scales::of(&device);
    let same = |a: f64, b: f64| assert!((a / b - 1.0).abs() < 1e-14, "{a} {b}");
    same(scales.energy, scales.voltage * scales.charge);
    same(scales.capacitance, scales.charge / scales.voltage);
    same(scales.energy, scales.force * scales.length);
    same(scales.field * 10e-6, scales.voltage);
    same(scales.power(), scales.voltage * scales.current());
    same(scales.resistance(), scales.voltage / scales.current());
    same(device.nondimensional().sheet.aspect, 100.0 / 49.0);
    // A load mass as heavy as 12 times ρT³ adds 144 to c.
    let stack = 7.0 * 10e-6_f64;
    device.load_mass = 12.0 * 1100.0 * stack.powi(3);
    same(device.nondimensional().sheet.aspect, 100.0 / 49.0 + 144.0);
}
