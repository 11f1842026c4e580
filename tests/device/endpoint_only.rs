//! Steps of which only the end is asked for, with first-order states.

use std::cell::Cell;

use super::balance::{MOST_OF_THEM, device, drive, is_pulled_in, off_or, scales, thousand};
use super::scene::{Scene, follow, number, read, start};
use crate::largest::largest;
use dielectric_elastomer_actuator::actuator::Drive;
use dielectric_elastomer_actuator::actuator::device::DeviceMotion;
use dielectric_elastomer_actuator::arithmetic::double_double::DoubleDouble;
use dielectric_elastomer_actuator::solver::coupled::Progress;
use proptest::prelude::*;

/// Long communication steps keep no polynomial, short ones and stiff systems do.
#[test]
fn long_steps_of_what_is_not_stiff_keep_no_dense_output() {
    for (name, step, dense) in [
        ("B_rc_step", f64::INFINITY, false),
        ("B_rc_step", 7.3, true),
        ("F_sls_creep_vhb", f64::INFINITY, false),
        ("own_current", f64::INFINITY, false),
        ("own_stiff_rc", f64::INFINITY, true),
        ("own_everything", f64::INFINITY, true),
    ] {
        let file = read(name);
        let scene = Scene::of(&file);
        let motion = scene.motion(false);
        let mut trajectory = start(&motion, scene.charge, 1e-9);
        let row = &file["rows"].as_array().expect("rows")[2];
        let time = scene.scales().time(DoubleDouble::new(number(&row["t_s"])));
        follow(&mut trajectory, &motion, time, step);
        assert_eq!(trajectory.slopes().is_some(), dense, "{name}, {step}");
    }
}

/// Where energies are summed up, steps have dense output: the motion is the same.
#[test]
fn a_random_motion_does_not_depend_on_what_is_asked_for() {
    // 1 is for a host that changes its inputs at each step.
    let advances = 1..5;
    let inputs = prop::collection::vec(
        (
            -0.3..0.3,
            -0.1..0.1,
            -0.2..0.2,
            0.05..3.0,
            off_or(0.05..0.2),
            0.1..2.0,
        ),
        1..8,
    );
    let compared = Cell::new(0);
    proptest!(thousand(), |(device in device(), advances in advances, inputs in inputs)| {
        let units = scales(&device);
        let (period, _) = units;
        let motion = |records_energy: bool| DeviceMotion {
            device,
            drive: Drive::constant(0.0, 0.0),
            records_energy,
        };
        let mut both = [motion(false), motion(true)].map(|motion| {
            let trajectory = start(&motion, 0.0, 1e-11);
            (motion, trajectory)
        });
        for (source, slope, prestress, periods, amplitude, frequency) in inputs {
            let drive = drive(units, [source, slope, prestress, amplitude, frequency]);
            for (motion, trajectory) in &mut both {
                motion.drive = Drive { since: trajectory.clock, ..drive };
                trajectory.restart();
            }
            for _ in 0..advances {
                let [ends, dense] = &mut both;
                let step = periods * period;
                let progress = [ends, dense].map(|(motion, trajectory)| {
                    let progress = trajectory.advance(motion, step);
                    (progress, is_pulled_in(progress, trajectory.position()))
                });
                if progress.iter().all(|(_, pulled_in)| *pulled_in) {
                    return Ok(());
                }
                prop_assert_eq!(progress, [(Ok(Progress::Whole), false); 2]);
                let [(_, ends), (_, dense)] = &both;
                let position = (ends.position() - dense.position()) / dense.position();
                let rate = (ends.rate() - dense.rate()) * period / dense.position();
                prop_assert!(largest([position, rate]) < 1e-8, "{position:e}, {rate:e}");
                for (one, other) in ends.internal().iter().zip(dense.internal()) {
                    prop_assert!((one - other).abs() < 1e-8 * other.abs().max(1.0), "{one}, {other}");
                }
            }
        }
        compared.set(compared.get() + 1);
    });
    assert!(compared.get() > MOST_OF_THEM, "{}", compared.get());
}
