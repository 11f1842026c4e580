//! What a host does with a motion: saves it, changes its inputs, awaits events.

use super::scene::{LIMITS, Scene, follow, number, read, start, start_between};
use crate::clocked::Clocked;
use dielectric_elastomer_actuator::actuator::device::{Breakdown, DeviceMotion};
use dielectric_elastomer_actuator::arithmetic::double_double::DoubleDouble;
use dielectric_elastomer_actuator::solver::coupled::trajectory::Carried;
use dielectric_elastomer_actuator::solver::coupled::{Event, Progress, Trajectory};
use dielectric_elastomer_actuator::solver::limits::{Limit, Limits};

const SCENES: [&str; 6] = [
    "A_si_dc_step",
    "B_rc_step",
    "F_sls_creep_vhb",
    "G_gent_snap",
    "own_stiff_rc",
    "own_everything",
];

fn all(trajectory: &Trajectory) -> Vec<u64> {
    let state = trajectory.state();
    let numbers = [state.position, state.rate].into_iter();
    let numbers = numbers
        .chain(trajectory.internal())
        .chain(trajectory.integrals());
    numbers.map(f64::to_bits).collect()
}

/// A motion that was saved goes on bit for bit, whether it stands inside a step or on an orbit.
#[test]
fn a_saved_motion_goes_on_bit_for_bit() {
    for name in SCENES {
        let scene = Scene::of(&read(name));
        for records in [false, true] {
            let motion = scene.motion(records);
            let mut trajectory =
                start(&motion, scene.charge, 1e-9).with(Trajectory::recording_extremes);
            for k in 0..40 {
                if k % 7 == 3 {
                    trajectory.restart();
                }
                let step = 3.1 + f64::from(k) * 11.3;
                let bytes = postcard::to_allocvec(&*trajectory).expect("bytes");
                let again: Trajectory = postcard::from_bytes(&bytes).expect("a motion");
                let mut restored = Clocked::at(trajectory.clock, again);
                assert!(restored.is_valid(), "{name} {k}");
                assert!(restored.keeps_to(LIMITS, 1e-9));
                assert_eq!(all(&restored), all(&trajectory), "{name} {k}");
                let ends = [
                    trajectory.advance(&motion, step),
                    restored.advance(&motion, step),
                ];
                assert_eq!(ends, [Ok(Progress::Whole); 2], "{name} {k}");
                assert_eq!(all(&restored), all(&trajectory), "{name} {k}");
                assert_eq!(restored.extremes(), trajectory.extremes(), "{name} {k}");
            }
        }
    }
}

/// Bytes that were changed are refused, or give a motion whose numbers fit together.
#[test]
fn damaged_bytes_never_give_a_motion_that_is_none() {
    for name in SCENES {
        let scene = Scene::of(&read(name));
        let motion = scene.motion(true);
        let mut trajectory = start(&motion, scene.charge, 1e-9);
        follow(
            &mut trajectory,
            &motion,
            DoubleDouble::new(33.3),
            f64::INFINITY,
        );
        let bytes = postcard::to_allocvec(&*trajectory).expect("bytes");
        for place in (0..bytes.len()).step_by(3) {
            for change in [0x01, 0x80, 0xff] {
                let mut damaged = bytes.clone();
                damaged[place] ^= change;
                let Ok(restored) = postcard::from_bytes::<Trajectory>(&damaged) else {
                    continue;
                };
                if restored.is_valid() {
                    let mut restored = Clocked::at(DoubleDouble::new(33.3), restored);
                    let _ = restored.advance(&motion, 1.0);
                    assert!(restored.position().is_finite(), "{name}, byte {place}");
                }
            }
        }
    }
}

/// Restarts at every communication point, as with inputs that change there, keep the tolerance.
#[test]
fn restarts_at_every_step_keep_the_tolerance() {
    for name in [
        "A_si_dc_step",
        "B_rc_step",
        "D_kv_step",
        "own_stiff_rc",
        "own_everything",
    ] {
        let file = read(name);
        let scene = Scene::of(&file);
        let (scales, motion) = (scene.scales(), scene.motion(false));
        let mut trajectory = start(&motion, scene.charge, 1e-10);
        let rows = file["rows"].as_array().expect("rows");
        let step = 0.01
            * scales
                .time(DoubleDouble::new(number(&rows[15]["t_s"])))
                .value();
        for row in &rows[..16] {
            let target = scales.time(DoubleDouble::new(number(&row["t_s"])));
            loop {
                trajectory.restart();
                let rest = target.since(trajectory.clock);
                if rest <= 0.0 {
                    break;
                }
                let progress = trajectory.advance(&motion, rest.min(step));
                assert_eq!(progress, Ok(Progress::Whole));
            }
            let error = trajectory.position() - number(&row["lambda"]);
            assert!(error.abs() < 1e-9, "{name}: {error:e}");
        }
    }
}

/// A step of no length to speak of, as rounding leaves them of communication steps, says nothing about the next one.
#[test]
fn a_step_that_rounding_has_left_leads_nowhere() {
    for name in ["B_rc_step", "D_kv_step", "own_stiff_rc", "own_everything"] {
        let scene = Scene::of(&read(name));
        let motion = scene.motion(false);
        let mut undisturbed = start(&motion, scene.charge, 1e-9);
        let mut trajectory = start(&motion, scene.charge, 1e-9);
        for k in 0..200 {
            for step in [2.0, 3e-17, 5.0] {
                trajectory.restart();
                for _ in 0..2 {
                    let progress = trajectory.advance(&motion, step);
                    assert_eq!(progress, Ok(Progress::Whole));
                    undisturbed.advance(&motion, step).expect("a step");
                }
            }
            let error = trajectory.position() - undisturbed.position();
            assert!(error.abs() < 1e-8, "{name} {k}: {error:e}");
        }
    }
}

/// The true field φλ² of an ideal source reaches breakdown at a stretch that is known, once.
#[test]
fn breakdown_is_located() {
    let scene = Scene::of(&read("A_si_dc_step"));
    let mut motion = scene.motion(false);
    let voltage = motion.drive.voltage.value();
    motion.device.breakdown = Some(Breakdown {
        field: 1.15 * voltage,
        exponent: 0.3,
    });
    let mut trajectory = start(&motion, 0.0, 1e-12);
    let end = trajectory.advance(&motion, 30.0);
    let Ok(Progress::Stopped {
        limit: Event::Margin,
        after,
    }) = end
    else {
        panic!("{end:?}");
    };
    assert!(after > 0.0 && after < 16.0);
    // φλ² = 1.15 φ λ^0.3.
    let exact = 1.15_f64.powf(1.0 / 1.7);
    assert!(
        (trajectory.position() - exact).abs() < 1e-11,
        "{}",
        trajectory.position()
    );
    assert!(trajectory.rate() > 0.0);
    trajectory.pass_margin();
    assert_eq!(trajectory.advance(&motion, 100.0), Ok(Progress::Whole));
}

/// A peak of the field between two looks is not missed: the field touches breakdown for a
/// thousandth of a period.
#[test]
fn a_short_breakdown_is_located() {
    let scene = Scene::of(&read("H_ac_damped"));
    let mut motion = scene.motion(false);
    let field = |motion: &DeviceMotion, trajectory: &Clocked<Carried>| {
        let voltage = motion.drive.at(&trajectory.clock).voltage(0.0);
        voltage.abs() * trajectory.position().powi(2)
    };
    let mut trajectory = start(&motion, 0.0, 1e-12);
    let mut highest = (0.0_f64, 0.0);
    for k in 1..=40_000 {
        follow(
            &mut trajectory,
            &motion,
            DoubleDouble::new(f64::from(k) * 0.05),
            f64::INFINITY,
        );
        let here = field(&motion, &trajectory);
        if here > highest.0 {
            highest = (here, f64::from(k) * 0.05);
        }
    }
    motion.device.breakdown = Some(Breakdown {
        field: highest.0 * (1.0 - 1e-7),
        exponent: 0.0,
    });
    let mut trajectory = start(&motion, 0.0, 1e-12);
    let end = trajectory.advance(&motion, 2000.0);
    let Ok(Progress::Stopped {
        limit: Event::Margin,
        after,
    }) = end
    else {
        panic!("{end:?}");
    };
    assert!(
        after < highest.1 && after > highest.1 - 2.0,
        "{after} {highest:?}"
    );
    let error = field(&motion, &trajectory) / (highest.0 * (1.0 - 1e-7)) - 1.0;
    assert!(error.abs() < 1e-11, "{error:e}");
}

/// A limit of the stretch is met where it lies, with losses as without.
#[test]
fn limits_are_located() {
    for name in ["B_rc_step", "own_everything", "G_gent_snap"] {
        let scene = Scene::of(&read(name));
        let motion = scene.motion(true);
        let limits = Limits {
            lower: 0.5,
            upper: 1.01,
        };
        let mut trajectory = start_between(&motion, scene.charge, 1e-11, limits);
        let end = trajectory.advance(&motion, 1e5);
        let Ok(Progress::Stopped { limit, .. }) = end else {
            panic!("{name}: {end:?}");
        };
        assert_eq!(limit, Event::Limit(Limit::Upper));
        assert!((trajectory.position() - 1.01).abs() < 1e-14, "{name}");
        assert!(trajectory.rate() > 0.0);
    }
}
