//! The integrator on the motion of the actuator, against multiprecision
//! references and against what must hold exactly.

mod clocked;

use clocked::Clocked;
use dielectric_elastomer_actuator::actuator::drive::Harmonic;
use dielectric_elastomer_actuator::actuator::motion::{Load, energy};
use dielectric_elastomer_actuator::actuator::{Coefficients, Drive, Motion, Parameters};
use dielectric_elastomer_actuator::solver::double::Double;
use dielectric_elastomer_actuator::solver::limits::{Limit, Limits};
use dielectric_elastomer_actuator::solver::number::Number;
use dielectric_elastomer_actuator::solver::trajectory::{Failure, Progress, Steps, Trajectory};
use dielectric_elastomer_actuator::solver::{Equation, LocalEquation, Sensitivity, State};
use proptest::prelude::*;

const REST: State = State {
    position: 1.0,
    rate: 0.0,
};
const LIMITS: Limits = Limits {
    lower: 0.05,
    upper: 10.0,
};

fn coefficients(aspect: f64, [gamma, tau, elasticity]: [f64; 3]) -> Coefficients {
    Coefficients::fold(&Parameters {
        aspect,
        surface_energy: gamma,
        surface_tension: tau,
        surface_elasticity: elasticity,
    })
}

fn direct(surface: [f64; 3], voltage: f64, prestress: f64) -> Motion {
    Motion {
        coefficients: coefficients(100.0, surface),
        drive: Drive::constant(voltage, prestress),
    }
}

fn alternating(surface: [f64; 3], amplitude: f64, frequency: f64) -> Motion {
    let mut motion = direct(surface, 0.0, 0.0);
    motion.drive.harmonic = Harmonic {
        amplitude,
        frequency,
        phase: 0.0,
    };
    motion
}

fn from_rest(tolerance: f64) -> Clocked<Steps> {
    Clocked::from(Trajectory::new(REST, LIMITS, tolerance))
}

/// Follows the motion to `time` in steps of `step` and a last shorter one.
fn follow(trajectory: &mut Clocked<Steps>, motion: &Motion, time: f64, step: f64) {
    let whole = (time / step).floor();
    for _ in 0..whole as u64 {
        advance(trajectory, motion, step);
    }
    let rest = time - whole * step;
    if rest > 1e-9 * step {
        advance(trajectory, motion, rest);
    }
}

fn advance(trajectory: &mut Clocked<Steps>, motion: &Motion, step: f64) {
    assert_eq!(trajectory.advance(motion, step), Ok(Progress::Whole));
}

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
        worst = worst
            .max((trajectory.position() - stretch).abs())
            .max((trajectory.rate() - rate).abs());
    }
    worst
}

const SURFACE: [f64; 3] = [0.05, 0.05, 0.2];

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

/// Blow-up of the ideal actuator, from a multiprecision quadrature.
#[test]
fn escape_is_located_where_the_stretch_becomes_infinite() {
    for (voltage, time) in [
        (0.65, 68.055_285_509),
        (0.7, 40.639_961_044),
        (1.0, 21.196_654_486),
    ] {
        let upper = 1e6;
        let limits = Limits { upper, ..LIMITS };
        let mut trajectory = Clocked::from(Trajectory::new(REST, limits, 1e-12));
        let motion = direct([0.0; 3], voltage, 0.0);
        let Ok(Progress::Stopped { limit, after }) = trajectory.advance(&motion, 100.0) else {
            panic!("voltage {voltage} did not escape");
        };
        assert_eq!(limit, Limit::Upper);
        // Far out λ'' = φ²λ³/c, so that λ = √(2c)/(φ (t* − t)).
        let rest = (2.0 * 100.0_f64).sqrt() / (voltage * upper);
        assert!(
            (after + rest - time).abs() < 1e-9,
            "voltage {voltage}: {}",
            after + rest
        );
        assert!((trajectory.position() / upper - 1.0).abs() < 1e-9);
    }
}

#[test]
fn the_lower_limit_stops_a_contraction() {
    let limits = Limits {
        lower: 0.5,
        upper: 10.0,
    };
    let mut trajectory = Clocked::from(Trajectory::new(REST, limits, 1e-10));
    let motion = direct([0.0; 3], 0.0, -30.0);
    let stopped = trajectory.advance(&motion, 100.0);
    assert!(
        matches!(
            stopped,
            Ok(Progress::Stopped {
                limit: Limit::Lower,
                ..
            })
        ),
        "{stopped:?}"
    );
    assert!((trajectory.position() - 0.5).abs() < 1e-12);
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

#[test]
fn rest_at_an_equilibrium_stays_and_wakes() {
    let mut trajectory = from_rest(1e-10);
    advance(&mut trajectory, &direct([0.0; 3], 0.0, 0.0), 1e6);
    assert_eq!(trajectory.state(), REST);
    trajectory.restart();
    advance(&mut trajectory, &direct([0.0; 3], 0.3, 0.0), 10.0);
    assert!(trajectory.position() > 1.0);
}

/// x'' = 1 − x − x'/5: autonomous, but not reversible.
struct Damped;

impl Equation for Damped {
    type Local<'a> = Damped;

    fn at(&self, _time: &Double) -> Damped {
        Damped
    }

    fn is_autonomous(&self) -> bool {
        true
    }
}

impl LocalEquation for Damped {
    type Load<N: Number> = N;

    fn load<N: Number>(&self, offset: N) -> N {
        offset
    }

    fn acceleration<N: Number>(&self, _time: N, x: N, rate: N) -> N {
        x.same(1.0) - x - rate * rate.same(0.2)
    }

    fn load_frequency(&self) -> f64 {
        0.0
    }

    fn load_series(&self, _half: f64) -> Option<[[f64; 5]; 2]> {
        None
    }

    fn parts<N: Number>(time: N) -> [N; 2] {
        [time, time.same(0.0)]
    }

    fn sensitivity(&self, _state: State) -> Sensitivity {
        Sensitivity {
            load: [0.0; 2],
            rate: 0.2,
        }
    }

    fn natural_frequency(&self, _state: State) -> f64 {
        1.0
    }
}

#[test]
fn a_damped_motion_is_not_run_there_and_back() {
    let start = State {
        position: 1.5,
        rate: 0.0,
    };
    let decay = 0.1_f64;
    let frequency = (1.0 - decay * decay).sqrt();
    for step in [0.3, 7.0] {
        let mut trajectory = Clocked::from(Trajectory::new(start, LIMITS, 1e-10));
        for k in 1..=40 {
            assert_eq!(trajectory.advance(&Damped, step), Ok(Progress::Whole));
            let time = step * f64::from(k);
            let (sine, cosine) = (frequency * time).sin_cos();
            let exact = 1.0 + 0.5 * (-decay * time).exp() * (cosine + decay / frequency * sine);
            let error = (trajectory.position() - exact).abs();
            assert!(error < 1e-9, "{error} after {time} in steps of {step}");
        }
    }
}

#[test]
fn a_damped_motion_rests_where_all_derivatives_vanish_only() {
    let turn = |rate| State {
        position: 1.0,
        rate,
    };
    let mut resting = Clocked::from(Trajectory::new(turn(0.0), LIMITS, 1e-10));
    assert_eq!(resting.advance(&Damped, 1e3), Ok(Progress::Whole));
    assert_eq!(resting.state(), turn(0.0));
    // x'' vanishes here too, but x' does not.
    let mut passing = Clocked::from(Trajectory::new(
        State {
            position: 0.98,
            ..turn(0.1)
        },
        LIMITS,
        1e-10,
    ));
    assert_eq!(passing.advance(&Damped, 0.5), Ok(Progress::Whole));
    assert!(passing.position() > 1.0);
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

/// Extremes against those of a motion looked at in small steps, and against
/// the turn of the exact orbit: λ3 of case a.
#[test]
fn extremes_are_recorded_exactly_and_whatever_the_steps() {
    let cases = [
        direct(SURFACE, 0.6, 0.0),
        direct(SURFACE, 0.6, 0.5),
        alternating(SURFACE, 0.3, 0.1438),
    ];
    for motion in &cases {
        let mut fine = from_rest(1e-12);
        let (mut lowest, mut highest) = (1.0_f64, 1.0_f64);
        for _ in 0..200_000 {
            advance(&mut fine, motion, 0.0015);
            lowest = lowest.min(fine.position());
            highest = highest.max(fine.position());
        }
        let mut before: Option<[f64; 2]> = None;
        for step in [0.3, 7.1, 300.0] {
            let mut recording = from_rest(1e-12).with(Trajectory::recording_extremes);
            follow(&mut recording, motion, 300.0, step);
            let found = recording.extremes().expect("they are recorded");
            // Samples 0.0015 apart miss a turn by up to x''·0.00075²/2.
            for (exact, sampled) in [(found.highest, highest), (-found.lowest, -lowest)] {
                assert!(
                    exact >= sampled - 1e-13 && exact <= sampled + 1e-7,
                    "steps of {step}: {exact} beside {sampled}"
                );
            }
            let found = [found.lowest, found.highest];
            for (now, before) in found.iter().zip(before.unwrap_or(found)) {
                assert!(
                    (now - before).abs() < 1e-12,
                    "steps of {step}: {now}, {before}"
                );
            }
            before = Some(found);
        }
    }
}

/// Strides of 8 nodes against substeps of 16, each within ten tolerances of the
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

/// Within rounding of an equilibrium nothing changes in the sweeps, which must
/// not be taken for an iteration that converges slowly.
#[test]
fn a_motion_next_to_rest_goes_on() {
    let coefficients = coefficients(100.0, [0.05, 0.05, 0.0]);
    let start = State {
        position: 1.060_000_000_000_000_3,
        rate: 1.267_592_835_769_656_6e-17,
    };
    for ulps in 0..200 {
        let voltage = f64::from_bits(0.510_955_419_527_634_8_f64.to_bits() + ulps);
        let motion = Motion {
            coefficients,
            drive: Drive::constant(voltage, 0.240_000_000_000_000_4),
        };
        for tolerance in [1e-6, 1e-10, 1e-14] {
            let mut trajectory = Clocked::from(Trajectory::new(start, LIMITS, tolerance));
            advance(&mut trajectory, &motion, 30.0);
            assert!((trajectory.position() - start.position).abs() < 1e-9);
        }
    }
}
