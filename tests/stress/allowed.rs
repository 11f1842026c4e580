//! Every error that the stress tests allow, with its reason. Tolerances are
//! those given to the trajectory, relative to the position.

use std::time::Duration;

use super::scenes::Kind;

/// How far from φ^C, relative to it and as a share of the tolerance, pull-in is
/// still told rightly: on the way from rest to the fold the energy is off by a
/// hundredth of the tolerance (the share of motions that may be repeated) times
/// some 1e-3. Measured: 1.3e-5.
pub const FOLD: f64 = 1e-4;

/// [`FOLD`] where the motion is not repeated, as under a varying voltage: the
/// tolerance counts in full. Measured: 3.1e-3.
pub const FOLD_WITHOUT_ORBITS: f64 = 1e-2;

/// φ² and the coefficients are rounded, each by half an ulp. Measured: 2 ulps of φ.
pub const FOLD_ROUNDING: f64 = 4.0 * f64::EPSILON;

/// At a turn the stretch changes with the square of the time: within the grid
/// of 0.1, by less than this part.
pub const TOP_OF_GRID: f64 = 1e-3;

/// Share of the tolerance that is divided by the distance from φ^C, as a
/// perturbation at the saddle is: the energy again, as in [`FOLD`]. Measured: 5e-8.
pub const SEPARATRIX: f64 = 1e-6;

/// Rounding that is divided by the distance from φ^C: some ulps of φ. Measured: 1.5e-16.
pub const SEPARATRIX_ROUNDING: f64 = 4e-15;

/// [`SEPARATRIX_ROUNDING`] on the orbit out to λ = 5.3, where the terms of the energy are of
/// size 300 and cancel. Measured: 4e-13.
pub const FAR_ORBIT: f64 = 1e-12;

/// At a tolerance of 1e-9 or less, of times up to 68. Measured: 1.7e-13.
pub const ESCAPE: f64 = 2e-12;

/// Time at which the stretch is 1e4: at the tolerances 1e-13 and 1e-14, from
/// both integrators to 1e-6.
pub const ESCAPE_AT_AC: f64 = 1_251.031_377;

/// A tolerance of 1e-12 over 15 large swings, each of which multiplies what the
/// ones before have lost. Measured: 2e-11.
pub const RESONANCE: f64 = 1e-9;

/// The ten tolerances that are promised, at 1e-12. Measured: 4e-12.
pub const PERIODS: f64 = 1e-11;

/// Where each period is integrated anew, the errors of 13 periods add up.
pub const PERIODS_WITHOUT_ORBITS: f64 = 1e-10;

/// Tolerances, times the growth of an error at the start: what is promised.
pub const RANDOM: f64 = 10.0;

/// Rounding of 30 steps in both integrators, times the growth.
pub const RANDOM_ROUNDING: f64 = 1e-14;

/// One motion from two sets of coefficients that are rounded at different places, over up to 50
/// radians and more; the difference grows with the number of periods. Measured: 7e-15.
pub const REDUNDANCY: f64 = 1e-13;

/// For each unit of τ: 4τ − φ² cancels and loses as many digits as τ is larger
/// than what is left. Measured: 5e-15.
pub const REDUNDANCY_ROUNDING: f64 = 5e-14;

/// The substeps do not depend on the communication steps. What is left is the
/// rounding of the period, counted up to 5e4 times. Measured: 4e-12.
pub const SPLIT: f64 = 1e-11;

/// Ten tolerances there and ten back, with growth of an error up to 10.
/// Measured: 1e-11.
pub const REVERSAL: f64 = 1e-10;

/// For each unit of time: the phase is the same to rounding, but substeps may
/// be cut differently. Measured: 1.6e-17, over 100 units and over 10 000.
pub const LATE: f64 = 2e-16;

/// Tolerances that a communication step under constant inputs adds.
pub const JUMPS: f64 = 10.0;

/// [`JUMPS`] where the inputs make the motion some five times faster: the error of the rate,
/// in the unit of the slow motion, is larger by that factor.
pub const EXTREME_JUMPS: f64 = 50.0;

/// Ten tolerances for each of 300 jumps under an alternating voltage, of
/// which most cancel. Measured: 8 tolerances.
pub const ALTERNATING_JUMPS: f64 = 100.0;

/// Tolerances by which the energy is off after five jumps.
pub const ENERGY: f64 = 10.0;

/// Rounding of an energy whose terms are of size 1.
pub const ENERGY_ROUNDING: f64 = 1e-13;

/// A rounding more or less may decide over one iteration or the length of a
/// substep, that is, over some tolerances of 1e-12, which then grow.
pub const LEVELS: f64 = 1e-10;

/// No step may seem to hang. Processor time; measured: 0.02 s for
/// steps of up to 0.01, 1 s for those that are discarded.
pub const SLOWEST_STEP: Duration = Duration::from_secs(10);

/// Tolerances, times the amplification by the exact motion between communication points:
/// what is promised.
pub const TOLERANCES: f64 = 10.0;

/// [`TOLERANCES`] for random scenes of a kind: some ten times the worst of 1200, which docs/accuracy.md
/// has. At the tightest tolerance, 1e-14, a half of it is twenty roundings, which differ from processor to
/// processor.
pub fn tolerances(kind: Kind) -> f64 {
    match kind {
        Kind::Held | Kind::Jumps | Kind::Short => 0.5,
        Kind::Polynomials => 3.0,
        Kind::ChangedDrive | Kind::Mixed => 7.0,
        Kind::SlowDrive | Kind::FastDrive | Kind::Derivatives | Kind::LookAhead => TOLERANCES,
    }
}

/// Inputs, parameters and states at communication points are rounded.
pub const ROUNDING: f64 = 1e-15;

/// [`ROUNDING`] for each unit T of time: rounded parameters shift a motion in time by so much.
pub const ROUNDING_WITH_TIME: f64 = 4.0 * f64::EPSILON;
