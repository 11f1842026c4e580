//! Around the fold: just under pull-in the motion turns, just over it passes.

use dielectric_elastomer_actuator::pull_in::{self, Threshold};
use dielectric_elastomer_actuator::solver::limits::{Limit, Limits};
use dielectric_elastomer_actuator::solver::trajectory::{Progress, Trajectory};

use super::*;

/// Surface effects and prestress; the last lies close below E*, where the
/// saddle is weakest and the motion lingers longest.
const CASES: [([f64; 3], f64); 6] = [
    ([0.0; 3], 0.0),
    ([0.1, 0.0, 0.0], 0.5),
    ([0.0, 0.0, 0.007], 0.0),
    ([0.05, 0.05, 0.02], 0.1),
    ([0.0, 0.0, 0.029], 0.0),
    ([0.0, 0.0, 0.0295], 0.0),
];

const TOLERANCES: [f64; 9] = [1e-2, 1e-3, 1e-4, 1e-6, 1e-8, 1e-10, 1e-12, 1e-13, 1e-14];

/// Longer than a motion at the distances of these tests lingers at the saddle.
const LONG: f64 = 8000.0;

fn actuator(surface: [f64; 3]) -> Actuator {
    Actuator {
        aspect: 100.0,
        surface,
    }
}

fn threshold(surface: [f64; 3], prestress: f64) -> Threshold {
    let motion = motion(&actuator(surface), &Load::constant(0.0, prestress));
    pull_in::dynamic(&motion.coefficients, prestress).expect("there is a fold")
}

/// Whether the motion from rest passes the stretch of the fold by 0.1 %, before
/// it turns or, if it has turned, in the rest of one long step.
fn passes(mut trajectory: Clocked<Steps>, motion: &Motion, step: f64) -> bool {
    for _ in 0..(LONG / step) as u32 {
        match trajectory.advance(motion, step) {
            Ok(Progress::Whole) => {
                assert!(trajectory.position().is_finite() && trajectory.rate().is_finite());
                if trajectory.rate() < 0.0 {
                    return false;
                }
            }
            Ok(Progress::Stopped {
                limit: Limit::Upper,
                ..
            }) => return true,
            other => panic!("{other:?}"),
        }
    }
    false
}

fn from_rest_to_fold(threshold: Threshold, tolerance: f64) -> Clocked<Steps> {
    let upper = 1.001 / threshold.thickness_stretch.sqrt();
    let limits = Limits { upper, ..WIDE };
    Clocked::from(Trajectory::new(REST, limits, tolerance))
}

/// No false pull-in below, no missed one above, at any tolerance.
#[test]
fn pull_in_is_told_as_near_to_its_voltage_as_the_tolerance_promises() {
    for (surface, prestress) in CASES {
        let threshold = threshold(surface, prestress);
        for tolerance in TOLERANCES {
            for (orbits, share) in [(true, allowed::FOLD), (false, allowed::FOLD_WITHOUT_ORBITS)] {
                let near = share * tolerance + allowed::FOLD_ROUNDING;
                for (sign, expected) in [(-1.0, false), (1.0, true)] {
                    let voltage = threshold.voltage * (1.0 + sign * near);
                    let motion = motion(&actuator(surface), &Load::constant(voltage, prestress));
                    let mut trajectory = from_rest_to_fold(threshold, tolerance);
                    if !orbits {
                        trajectory = trajectory.with(Trajectory::without_orbits);
                    }
                    assert_eq!(
                        passes(trajectory, &motion, if orbits { LONG } else { 1.0 }),
                        expected,
                        "{surface:?}, S = {prestress}, tolerance {tolerance:e}, orbits {orbits}, \
                         {sign} · {near:e} from the threshold"
                    );
                }
            }
        }
    }
}

/// One to four units in the last place of φ^C from it the rounding of φ² may
/// decide, but the motion keeps to one of the two answers.
#[test]
fn to_one_ulp_of_pull_in_the_motion_turns_or_passes_and_nothing_else() {
    for (surface, prestress) in CASES {
        let threshold = threshold(surface, prestress);
        for ulps in -6..=6_i64 {
            let voltage = f64::from_bits(threshold.voltage.to_bits().wrapping_add_signed(ulps));
            let motion = motion(&actuator(surface), &Load::constant(voltage, prestress));
            for (tolerance, step) in [(1e-14, 1.0), (1e-12, 0.37), (1e-4, LONG)] {
                let passed = passes(from_rest_to_fold(threshold, tolerance), &motion, step);
                if ulps.abs() > 4 && tolerance < 1e-10 {
                    assert_eq!(
                        passed,
                        ulps > 0,
                        "{surface:?}, S = {prestress}, {ulps} ulps"
                    );
                }
            }
        }
    }
}

/// With surface elasticity the motion past the fold turns on the larger orbit,
/// also at the loosest tolerances, and never goes beyond it.
#[test]
fn past_the_fold_surface_elasticity_turns_the_motion_back() {
    for (surface, prestress) in CASES.into_iter().filter(|(surface, _)| surface[2] > 0.0) {
        let threshold = threshold(surface, prestress);
        let fold = 1.0 / threshold.thickness_stretch.sqrt();
        let load = Load::constant(threshold.voltage * (1.0 + 1e-6), prestress);
        let mut reference = Taylor::new(1.0, 0.0);
        let mut farthest = 0.0_f64;
        for _ in 0..10_000 {
            reference.advance(&actuator(surface), &load, 0.1);
            farthest = farthest.max(reference.state()[0]);
        }
        assert!(farthest > 1.001 * fold);
        let motion = motion(&actuator(surface), &load);
        for tolerance in [1e-2, 1e-3, 1e-4, 1e-8, 1e-12] {
            let mut trajectory = from_rest(tolerance);
            let mut top = 0.0_f64;
            for _ in 0..10_000 {
                advance(&mut trajectory, &motion, 0.1);
                top = top.max(trajectory.position());
            }
            // Two grids of 0.1 meet the top at different places.
            let error = (top / farthest - 1.0).abs();
            let what = format!("turning stretch, {surface:?}, tolerance {tolerance:e}");
            assert_at_most(error, allowed::TOP_OF_GRID + tolerance, &what);
        }
    }
}

/// Periods up to 30 times that of the small motion, point by point over two of
/// them, against the independent integrator. At the relative distance d from
/// the threshold, the time at the saddle grows like −ln d, and a relative
/// perturbation like 1/d.
#[test]
fn near_the_separatrix_the_motion_lingers_as_long_as_it_should() {
    for (surface, periods) in [
        ([0.0; 3], [58.6, 100.5, 142.7, 184.9, 227.1]),
        ([0.0, 0.0, 0.007], [59.5, 103.4, 147.7, 192.0, 236.2]),
        ([0.0, 0.0, 0.0295], [67.7, 161.6, 332.6, 552.2, 777.9]),
    ] {
        let threshold = threshold(surface, 0.0);
        for (period, distance) in periods.into_iter().zip([1e-2, 1e-4, 1e-6, 1e-8, 1e-10]) {
            let load = Load::constant(threshold.voltage * (1.0 - distance), 0.0);
            let motion = motion(&actuator(surface), &load);
            for tolerance in [1e-6, 1e-9, 1e-12] {
                let mut reference = Taylor::new(1.0, 0.0);
                let mut trajectory = from_rest(tolerance);
                let mut worst = 0.0_f64;
                for _ in 0..100 {
                    reference.advance(&actuator(surface), &load, period / 50.0);
                    advance(&mut trajectory, &motion, period / 50.0);
                    worst = worst.max(difference(trajectory.state(), reference.state()));
                }
                let most =
                    (allowed::SEPARATRIX * tolerance + allowed::SEPARATRIX_ROUNDING) / distance;
                let what = format!("{surface:?}, {distance:e} below, tolerance {tolerance:e}");
                assert_at_most(worst, most, &what);
                // Back at the start, to the digits of `period`.
                assert!((trajectory.position() - 1.0).abs() < 0.01, "{what}");
            }
        }
    }
}
