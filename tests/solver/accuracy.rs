//! The error of a motion against the tolerance, invariants, and another integrator.

use dielectric_elastomer_actuator::actuator::motion::{Load, energy};
use dielectric_elastomer_actuator::solver::trajectory::Failure;
use proptest::prelude::*;

use super::*;
use crate::largest::largest;

/// Rows t, λ, dλ/dt of a reference with 30 digits.
fn reference(name: &str) -> Vec<[f64; 3]> {
    let path = format!(
        "{}/tests/reference/case_{name}.csv",
        env!("CARGO_MANIFEST_DIR")
    );
    let text = std::fs::read_to_string(path).expect("the reference is checked in");
    let row = |line: &str| -> [f64; 3] {
        let cells: Vec<f64> = line
            .split(',')
            .map(|c| c.parse().expect("a number"))
            .collect();
        cells.try_into().expect("three columns")
    };
    text.lines().skip(1).map(row).collect()
}

fn worst_error(name: &str, motion: &Motion, tolerance: f64, step: f64) -> f64 {
    let rows = reference(name);
    let mut trajectory = from_rest(tolerance);
    let mut worst = 0.0_f64;
    for pair in rows.windows(2) {
        let [[before, ..], [time, stretch, rate]] = [pair[0], pair[1]];
        follow(&mut trajectory, motion, time - before, step);
        let errors = [trajectory.position() - stretch, trajectory.rate() - rate];
        worst = largest([worst, largest(errors)]);
    }
    worst
}

/// Achieved error against the tolerance asked for, at times that are not ends
/// of substeps (steps of 0.37) and in long steps.
#[test]
fn the_error_stays_within_ten_times_the_tolerance() {
    let cases = [
        ("a", direct(SURFACE, 0.6, 0.0)),
        ("b", direct(SURFACE, 0.6, 0.5)),
        ("d", alternating([0.1, 0.05, 0.2], 0.3, 0.1471)),
    ];
    for (name, motion) in &cases {
        for exponent in 4..=13 {
            let tolerance = 10_f64.powi(-exponent);
            for step in [0.37, 25.0] {
                let error = worst_error(name, motion, tolerance, step);
                assert!(
                    error <= 10.0 * tolerance,
                    "case {name}, steps of {step}, tolerance {tolerance}: error {error}"
                );
            }
        }
    }
}

#[test]
fn energy_stays_over_a_million_units_of_time() {
    let load = Load {
        voltage_squared: 0.36,
        prestress: 0.0,
    };
    for (tolerance, drift) in [(1e-10, 1e-12), (1e-13, 1e-13)] {
        let motion = direct(SURFACE, 0.6, 0.0);
        let mut trajectory = from_rest(tolerance);
        for _ in 0..1000 {
            advance(&mut trajectory, &motion, 1000.37);
            let energy = energy(&motion.coefficients, load, trajectory.state());
            assert!(
                energy.abs() < drift,
                "energy {energy} at tolerance {tolerance}"
            );
        }
    }
}

/// The end of a motion does not depend on how the time is divided into steps: to rounding for a
/// constant drive, to the tolerance for an alternating one.
#[test]
fn splitting_a_step_changes_nothing() {
    let cases = [
        (direct(SURFACE, 0.6, 0.5), 1e-12),
        (alternating(SURFACE, 0.3, 0.1438), 1e-12),
    ];
    for (motion, allowed) in &cases {
        let mut whole = from_rest(1e-12);
        advance(&mut whole, motion, 300.0);
        for step in [0.01, 0.37, 7.0, 100.0] {
            let mut split = from_rest(1e-12);
            follow(&mut split, motion, 300.0, step);
            let difference = (split.position() - whole.position()).abs();
            assert!(difference < *allowed, "steps of {step}: {difference}");
        }
    }
}

#[test]
fn a_motion_run_back_returns_to_its_start() {
    let motion = direct(SURFACE, 0.6, 0.5);
    let mut there = from_rest(1e-12);
    advance(&mut there, &motion, 137.3);
    let State { position, rate } = there.state();
    let start = State {
        position,
        rate: -rate,
    };
    let mut back = Clocked::from(Trajectory::new(start, LIMITS, 1e-12));
    advance(&mut back, &motion, 137.3);
    assert!((back.position() - 1.0).abs() < 1e-12 && back.rate().abs() < 1e-12);
}

/// Endpoint-only steps of 8 nodes against steps of 16, each within ten tolerances of the
/// truth.
#[test]
fn endpoint_only_steps_end_where_steps_with_dense_output_do() {
    for frequency in [0.05, 0.1438, 0.2764, 1.0] {
        let motion = alternating(SURFACE, 0.3, frequency);
        for tolerance in [1e-4, 1e-6, 1e-8, 1e-10] {
            let mut endpoint_only = from_rest(tolerance);
            let mut substeps = from_rest(1e-13).with(Trajectory::without_endpoint_steps);
            for step in [1000.0, 37.0, 11.3, 120.0] {
                advance(&mut endpoint_only, &motion, step);
                advance(&mut substeps, &motion, step);
                let difference = (endpoint_only.position() - substeps.position()).abs();
                assert!(
                    difference < 10.0 * tolerance,
                    "ω = {frequency}, tolerance {tolerance:e}: {difference:e}"
                );
            }
        }
    }
}

#[test]
fn a_step_that_needs_too_much_work_says_so() {
    let motion = alternating(SURFACE, 0.3, 1e3);
    let failure = from_rest(1e-3).advance(&motion, 1e9);
    assert!(
        matches!(failure, Err(Failure::TooManySubsteps { .. })),
        "{failure:?}"
    );
}

/// A fixed-step Runge–Kutta integration (order 4), nothing shared with ours
/// but Eq. 16 as it stands in the paper.
fn runge_kutta(aspect: f64, surface: [f64; 3], voltage: f64, prestress: f64, time: f64) -> f64 {
    let [gamma, tau, elasticity] = surface;
    let f = |x: f64, v: f64| {
        let surface = gamma * x
            + tau * (2.0 * x.powi(3) - x)
            + 0.5 * elasticity * x * (x * x - 1.0) * (3.0 * x * x - 1.0);
        let force =
            6.0 * v * v / x.powi(7) - x + x.powi(-5) + prestress + voltage * voltage * x.powi(3)
                - 2.0 * surface;
        force / (aspect + 2.0 / x.powi(6))
    };
    let steps = 20_000;
    let h = time / f64::from(steps);
    let (mut x, mut v) = (1.0, 0.0);
    for _ in 0..steps {
        let (k1, l1) = (v, f(x, v));
        let (k2, l2) = (v + 0.5 * h * l1, f(x + 0.5 * h * k1, v + 0.5 * h * l1));
        let (k3, l3) = (v + 0.5 * h * l2, f(x + 0.5 * h * k2, v + 0.5 * h * l2));
        let (k4, l4) = (v + h * l3, f(x + h * k3, v + h * l3));
        x += h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4);
        v += h / 6.0 * (l1 + 2.0 * l2 + 2.0 * l3 + l4);
    }
    x
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 64, failure_persistence: None, ..ProptestConfig::default() })]

    /// Bounded motions of all sizes against the independent integrator, whose
    /// own error (20 000 steps in some ten periods) is below the bound.
    #[test]
    fn random_actuators_move_as_an_independent_integrator_says(
        magnitude in -1.0..8.0_f64,
        gamma in 0.0..0.5_f64,
        tau in 0.0..0.5_f64,
        elasticity in 0.0..1.0_f64,
        voltage in 0.0..0.4_f64,
        prestress in -1.0..0.2_f64,
    ) {
        let aspect = 10_f64.powf(magnitude);
        let surface = [gamma, tau, elasticity];
        let time = 20.0 * aspect.max(1.0).sqrt();
        let motion = Motion {
            coefficients: coefficients(aspect, surface),
            drive: Drive::constant(voltage, prestress),
        };
        let mut trajectory = from_rest(1e-11);
        advance(&mut trajectory, &motion, time);
        let independent = runge_kutta(aspect, surface, voltage, prestress, time);
        prop_assert!((trajectory.position() - independent).abs() < 1e-8);
    }

    /// (γ, τ, φ²) moves as (γ − τ, 0, φ² − 4τ).
    #[test]
    fn surface_tension_is_surface_energy_and_voltage(
        tau in 0.0..0.1_f64,
        more in 0.0..0.1_f64,
        voltage_squared in 0.0..0.2_f64,
        time in 1.0..300.0_f64,
    ) {
        let gamma = tau + more;
        let with = direct([gamma, tau, 0.1], (voltage_squared + 4.0 * tau).sqrt(), 0.1);
        let without = direct([more, 0.0, 0.1], voltage_squared.sqrt(), 0.1);
        let (mut a, mut b) = (from_rest(1e-12), from_rest(1e-12));
        advance(&mut a, &with, time);
        advance(&mut b, &without, time);
        prop_assert!((a.position() - b.position()).abs() < 1e-12);
    }
}
