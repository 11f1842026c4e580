//! The balance of energy of random actuators under random inputs, with jumps.

use std::cell::Cell;

use super::scene::{Present, start};
use crate::clocked::Clocked;
use dielectric_elastomer_actuator::actuator::device::{
    Branch, Damping, Device, DeviceMotion, Elasticity, Locking, Permittivity, Port, Source, Spring,
};
use dielectric_elastomer_actuator::actuator::drive::{Harmonic, Polynomial};
use dielectric_elastomer_actuator::actuator::{Drive, Parameters};
use dielectric_elastomer_actuator::arithmetic::double_double::DoubleDouble;
use dielectric_elastomer_actuator::solver::coupled::trajectory::Carried;
use dielectric_elastomer_actuator::solver::coupled::{
    CoupledEquation, MOST_STATES, Progress, Stage,
};
use dielectric_elastomer_actuator::solver::trajectory::Failure;
use proptest::prelude::*;

pub fn off_or(range: std::ops::Range<f64>) -> impl Strategy<Value = f64> {
    prop_oneof![Just(0.0), range]
}

fn elasticity() -> impl Strategy<Value = Elasticity> {
    prop_oneof![
        Just(Elasticity::NeoHookean),
        (5.0..200.0).prop_map(|limit| Elasticity::Gent(Locking::new(limit))),
        (-0.1..0.1, 0.0..0.1).prop_map(|(second, third)| Elasticity::Yeoh { second, third }),
    ]
}

fn branch() -> impl Strategy<Value = Branch> {
    let limit = prop_oneof![Just(f64::INFINITY), 20.0..100.0];
    (off_or(0.1..2.0), -3.0..5.0, limit).prop_map(|(modulus, decades, limit)| Branch {
        modulus,
        relaxation_time: 10_f64.powf(decades),
        limit,
    })
}

prop_compose! {
    fn port()(
        source in prop_oneof![Just(Source::Voltage), Just(Source::Current), Just(Source::Charge)],
        resistance in off_or(-5.0..3.0).prop_map(|decades| {
            if decades == 0.0 { 0.0 } else { 10_f64.powf(decades) }
        }),
        conductance in off_or(0.0..0.01),
        conductivity in off_or(0.0..0.01),
        conduction_field in prop_oneof![Just(f64::INFINITY), 0.3..2.0],
    ) -> Port {
        Port { source, resistance, conductance, conductivity, conduction_field }
    }
}

prop_compose! {
    pub fn device()(
        decades in 0.0..5.0,
        surface in [off_or(0.0..0.1), off_or(0.0..0.1), off_or(0.0..0.3)],
        elasticity in elasticity(),
        spring in (off_or(0.0..0.5), 0.8..1.3),
        terms in [off_or(-0.3..0.1), off_or(-0.05..0.1), off_or(-0.01..0.01)],
        linear in off_or(0.0..5.0),
        viscosity in off_or(-3.0..3.0).prop_map(|decades| {
            if decades == 0.0 { 0.0 } else { 10_f64.powf(decades) }
        }),
        branches in [branch(), branch(), branch()],
        port in port(),
    ) -> Device {
        Device {
            elasticity,
            spring: Spring { stiffness: spring.0, rest: spring.1 },
            permittivity: Permittivity { terms },
            damping: Damping { linear, viscosity },
            branches,
            port,
            ..Device::plain(Parameters {
                aspect: 10_f64.powf(decades),
                surface_energy: surface[0],
                surface_tension: surface[1],
                surface_elasticity: surface[2],
            })
        }
    }
}

/// A thousand cases.
pub fn thousand() -> ProptestConfig {
    ProptestConfig {
        cases: 1000,
        failure_persistence: None,
        ..ProptestConfig::default()
    }
}

/// Whether a motion has ended as one that is pulled in may: at a limit, or far out, where a leakage that grows
/// exponentially with the field can need steps that are too short.
pub fn is_pulled_in(progress: Result<Progress, Failure>, position: f64) -> bool {
    progress != Ok(Progress::Whole) && !(0.35..=3.0).contains(&position)
}

/// More than so many of the thousand must be followed to their end. Of 60 000, four were not.
pub const MOST_OF_THEM: u32 = 990;

/// The time scale of a random device, and the unit of its source: a current fills the capacitance of 1 in about a period.
pub fn scales(device: &Device) -> (f64, f64) {
    let period = ((device.sheet.aspect + 2.0) / 6.0).sqrt();
    match device.port.source {
        Source::Current => (period, 0.3 / period),
        _ => (period, 1.0),
    }
}

/// A drive from now on, in these units: a source that rises, a prestress, and what alternates.
pub fn drive(
    (period, unit): (f64, f64),
    [source, slope, prestress, amplitude, frequency]: [f64; 5],
) -> Drive {
    let mut voltage = Polynomial::constant(unit * source);
    voltage.set_derivative(1, unit * slope / period);
    Drive {
        since: DoubleDouble::ZERO,
        lead: 0.0,
        voltage,
        prestress: Polynomial::constant(prestress),
        harmonic: Harmonic {
            amplitude: unit * amplitude,
            frequency: frequency / period,
            frequency_rest: 0.0,
            phase: 0.3,
        },
    }
}

/// Steps an ideal source with the bookkeeping that a host has to do.
fn set(motion: &mut DeviceMotion, trajectory: &mut Clocked<Carried>, drive: Drive) {
    let time = trajectory.clock;
    let before = motion.drive.at(&time).voltage(0.0);
    motion.drive = drive;
    motion.drive.since = time;
    trajectory.restart();
    let (origin, position) = trajectory.position_from_origin();
    let stage = Stage {
        position,
        rate: trajectory.rate(),
        internal: trajectory.internal(),
    };
    let exchanged = motion.at(&time, &origin).exchanged_by_step(before, &stage);
    trajectory.jump(&[0.0; MOST_STATES], &exchanged.all());
}

/// What is stored has grown by what was supplied less what was lost, to 1e-10 of what was stored, lost or supplied at
/// most, whatever the parameters and inputs.
#[test]
fn energy_is_balanced() {
    let inputs = prop::collection::vec(
        (
            -0.4..0.4,
            -0.1..0.1,
            -0.2..0.2,
            0.01..2.0,
            off_or(0.05..0.3),
            0.1..3.0,
        ),
        1..6,
    );
    let followed = Cell::new(0);
    proptest!(thousand(), |(device in device(), inputs in inputs)| {
        let units = scales(&device);
        let (period, _) = units;
        let mut motion = DeviceMotion {
            device,
            drive: Drive::constant(0.0, 0.0),
            records_energy: true,
        };
        let mut trajectory = start(&motion, 0.0, 3e-12);
        let at_start = Present::of(&motion, &trajectory).stored.total();
        let mut largest = 0.0_f64;
        for (source, slope, prestress, periods, amplitude, frequency) in inputs {
            let drive = drive(units, [source, slope, prestress, amplitude, frequency]);
            set(&mut motion, &mut trajectory, drive);
            for _ in 0..4 {
                let progress = trajectory.advance(&motion, periods * period);
                if is_pulled_in(progress, trajectory.position()) {
                    return Ok(());
                }
                prop_assert_eq!(progress, Ok(Progress::Whole));
                let present = Present::of(&motion, &trajectory);
                let stored = present.stored.total();
                largest = present
                    .exchanged
                    .all()
                    .into_iter()
                    .fold(largest.max(stored), |a, b| a.max(b.abs()));
                let residual = stored - at_start - present.exchanged.gain();
                prop_assert!(
                    residual.abs() < 1e-10 * largest.max(1e-4),
                    "{residual:e} of {largest:e}"
                );
            }
        }
        followed.set(followed.get() + 1);
    });
    assert!(followed.get() > MOST_OF_THEM, "{}", followed.get());
}
