//! Many scenes at once against the same scenes one by one.

use crate::largest::largest;
use dielectric_elastomer_actuator::actuator::Ensemble;
use dielectric_elastomer_actuator::arithmetic::double_double::DoubleDouble;
use dielectric_elastomer_actuator::ensemble::{self, InitialValueProblem};
use dielectric_elastomer_actuator::nondimensional::scene::Scene;
use dielectric_elastomer_actuator::solver::limits::Limit;
use dielectric_elastomer_actuator::sweep::{Outcome, follow, follow_one};
use fearless_simd::Level;
use nalgebra::{Matrix2, Vector2};
use proptest::prelude::*;
use proptest::strategy::ValueTree;
use proptest::test_runner::TestRunner;

fn alternating(surface: [f64; 3], amplitude: f64, frequency: f64) -> Scene {
    let mut scene = Scene::at_start();
    scene.parameters.surface_energy = surface[0];
    scene.parameters.surface_tension = surface[1];
    scene.parameters.surface_elasticity = surface[2];
    scene.drive.harmonic.amplitude = amplitude;
    scene.drive.harmonic.frequency = frequency;
    scene
}

fn difference(one: &Outcome, other: &Outcome) -> f64 {
    largest([
        one.state.position - other.state.position,
        one.state.rate - other.state.rate,
        one.extremes.lowest - other.extremes.lowest,
        one.extremes.highest - other.extremes.highest,
    ])
}

/// Amplitudes at ω = 0.1438 over 2000 units of time, `tests/reference/amplitudes.json`,
/// and the same scene among 40 others.
#[test]
fn a_frequency_response_has_the_amplitude_of_the_reference() {
    let mut scenes: Vec<Scene> = (0..40)
        .map(|k| alternating([0.05, 0.05, 0.2], 0.3, 0.13 + 0.001 * f64::from(k)))
        .collect();
    scenes[17] = alternating([0.05, 0.05, 0.2], 0.3, 0.1438);
    let outcome = follow(&scenes, 2000.0, 1e-12)[17].expect("it can be followed");
    let thickness = |stretch: f64| 1.0 / (stretch * stretch);
    let (lowest, highest) = (outcome.extremes.lowest, outcome.extremes.highest);
    let amplitude = 0.5 * (thickness(lowest) - thickness(highest));
    assert!((amplitude - 0.788_423_059_3).abs() < 1e-9, "{amplitude}");
}

/// Those that cannot share lanes: constant inputs, inputs given by derivatives,
/// a fast drive, and a collapse.
#[test]
fn scenes_of_all_kinds_come_out_in_their_order() {
    let usual = alternating([0.05, 0.05, 0.2], 0.3, 0.1438);
    let mut constant = usual;
    constant.drive.harmonic.amplitude = 0.0;
    constant.drive.voltage.set_value(0.6);
    let mut ramp = usual;
    ramp.drive.voltage.set_derivative(1, 1e-3);
    let fast = alternating([0.05, 0.05, 0.2], 0.3, 40.0);
    let mut collapse = alternating([0.0, 0.02, 0.0], 0.3, 0.117);
    collapse.limits.lower = 1e-3;
    collapse.limits.upper = 1e4;
    let scenes = [usual, constant, ramp, fast, collapse];
    let outcomes = follow(&scenes, 1300.0, 1e-12);
    for (scene, outcome) in scenes.iter().zip(&outcomes) {
        let (one, many) = (follow_one(scene, 1300.0, 1e-12), *outcome);
        let (one, many) = (one.expect("followed"), many.expect("followed"));
        // The way to a collapse multiplies every rounding.
        match (one.collapse, many.collapse) {
            (None, None) => {}
            (Some(one), Some(many)) => {
                assert_eq!(one.0, many.0);
                assert!((one.1 - many.1).abs() < 1e-4, "{one:?} {many:?}");
                continue;
            }
            collapse => panic!("{collapse:?}"),
        }
        assert!(difference(&one, &many) < 1e-9 * one.extremes.highest.powi(2));
    }
    let (limit, time) = outcomes[4].expect("followed").collapse.expect("it escapes");
    assert_eq!(limit, Limit::Upper, "{:?}", outcomes[4]);
    // From two integrators; the way there multiplies every rounding.
    assert!((time - 1_251.031_377).abs() < 1e-4, "{time}");
}

/// Whose iteration never moves by more than rounding: its steps grow all the same.
#[test]
fn a_motion_next_to_rest_is_not_given_back() {
    let scene = alternating([0.0; 3], 1e-160, 0.1438);
    let motion = InitialValueProblem {
        equation: scene.motion(),
        start: scene.start,
        limits: scene.limits,
    };
    let span = [DoubleDouble::ZERO, DoubleDouble::new(5000.0)];
    let arrivals = ensemble::follow(Level::new(), &mut Ensemble::new(), &[motion], span, 1e-9);
    let arrival = arrivals[0].expect("it shares lanes all the way");
    assert_eq!(arrival.state, scene.start);
}

/// At each tolerance, and with steps that change on the way: near resonance the amplitude beats.
#[test]
fn neighbours_do_not_change_a_bit() {
    let scenes: Vec<Scene> = (0..11)
        .map(|k| {
            let mut scene = alternating([0.05, 0.05, 0.2], 0.3, 0.1 + 0.02 * f64::from(k));
            scene.parameters.aspect = 10.0 * f64::from(k + 1);
            scene
        })
        .collect();
    for tolerance in [1e-5, 1e-9, 1e-12] {
        let outcomes = follow(&scenes, 1000.0, tolerance);
        for (scene, among) in scenes.iter().zip(outcomes) {
            let alone = follow(&[*scene], 1000.0, tolerance)[0];
            assert_eq!(alone.expect("followed"), among.expect("followed"));
        }
    }
}

/// Times of a motion between which its amplification is looked at.
const TIMES: u32 = 16;

/// Amplification beyond which a motion is chaotic or escapes.
const MOST_AMPLIFIED: f64 = 1e4;

/// The motion with hardly any error.
fn exact(scene: &Scene, end: f64) -> Outcome {
    follow_one(scene, end, 1e-14).expect("followed")
}

/// By how much the exact motion amplifies an error, from any time to any later one. Rates count in units of 1/`scale`.
///
/// What becomes of an error at the start does not tell. In the scene of c = 14.6 here errors of the start grow 8 times.
/// The motion contracts and expands again on the way: errors that a step makes in between grow 80 times. Judged
/// by the start alone, the test would fail or not by how large the error of that step happens to be.
fn amplification(scene: &Scene, end: f64, scale: f64) -> f64 {
    const NUDGE: f64 = 1e-8;
    let state = |start: [f64; 2], time: f64| {
        let mut scene = *scene;
        scene.start.position += start[0];
        scene.start.rate += start[1] / scale;
        let state = exact(&scene, time).state;
        Vector2::new(state.position, scale * state.rate)
    };
    // What errors of position and rate at the start have become at each time.
    let mut grown = vec![Matrix2::identity()];
    for k in 1..=TIMES {
        let time = end * f64::from(k) / f64::from(TIMES);
        let undisturbed = state([0.0; 2], time);
        let errors = [[NUDGE, 0.0], [0.0, NUDGE]].map(|start| state(start, time) - undisturbed);
        grown.push(Matrix2::from_columns(&errors) / NUDGE);
    }
    let mut most = 1.0_f64;
    for (k, earlier) in grown.iter().enumerate() {
        let back = earlier.try_inverse().expect("a motion can be reversed");
        for later in &grown[k + 1..] {
            most = largest([&[most], (later * back).as_slice()].concat());
        }
    }
    most
}

/// Motions under a voltage near the one at which they escape, of actuators without surface elasticity: at most two
/// tolerances times the amplification of an error on the way. At 68 tolerances from 1e-4 to 1e-12, and all scenes, the
/// largest error was one.
#[test]
fn near_escape_errors_are_two_tolerances_times_the_amplification() {
    let mut runner = TestRunner::deterministic();
    let mut draw = |range: std::ops::Range<f64>| {
        let tree = range.new_tree(&mut runner).expect("a number");
        tree.current()
    };
    let mut compared = 0;
    for _ in 0..200 {
        let scale = 10_f64.powf(draw(0.0..3.0));
        let surface = [draw(0.0..0.02), draw(0.0..0.02), 0.0];
        let frequency = 10_f64.powf(draw(-0.7..-0.3)) / scale;
        let mut scene = alternating(surface, draw(0.34..0.42), frequency);
        scene.parameters.aspect = 6.0 * scale * scale - 2.0;
        scene.drive.prestress.set_value(draw(0.0..0.02));
        scene.drive.voltage.set_value(draw(0.24..0.28));
        let end = 200.0 * scale;
        let one = exact(&scene, end);
        if one.collapse.is_some() {
            continue;
        }
        let amplification = amplification(&scene, end, scale);
        if amplification > MOST_AMPLIFIED {
            continue;
        }
        compared += 1;
        for tolerance in [1e-4, 1e-6, 1e-9, 1e-12] {
            let mut many = follow(&[scene], end, tolerance)[0].expect("followed");
            let rate = scale * (one.state.rate - many.state.rate);
            many.state.rate = one.state.rate;
            let error = largest([difference(&one, &many), rate]) / amplification;
            // Rounding of both.
            assert!(
                error <= 2.0 * tolerance + 1e-13,
                "{scene:?} {tolerance}: {error}"
            );
        }
    }
    assert!(compared > 100, "{compared}");
}

#[test]
fn no_scene_has_no_outcome() {
    assert!(follow(&[], 100.0, 1e-9).is_empty());
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 24, failure_persistence: None, ..ProptestConfig::default() })]

    /// Bounded random scenes, more than there are lanes.
    #[test]
    fn random_scenes_move_as_they_do_alone(
        numbers in prop::collection::vec((0.0..0.1_f64, 0.0..0.1_f64, 0.05..0.4_f64, 0.05..0.3_f64, 0.05..0.4_f64, -0.3..0.2_f64, 0.7..4.0_f64), 1..30),
        digits in 4..12_i32,
    ) {
        let scenes: Vec<Scene> = numbers
            .iter()
            .map(|&(gamma, tau, elasticity, amplitude, frequency, prestress, decades)| {
                let mut scene = alternating([gamma, tau, elasticity], amplitude, frequency);
                scene.parameters.aspect = 10_f64.powf(decades);
                scene.drive.prestress.set_value(prestress);
                scene
            })
            .collect();
        let tolerance = 10_f64.powi(-digits);
        for (scene, outcome) in scenes.iter().zip(follow(&scenes, 200.0, tolerance)) {
            let one = follow_one(scene, 200.0, 1e-13).expect("followed");
            let many = outcome.expect("followed");
            // The ten tolerances that are promised, for the rate and the extremes too.
            prop_assert!(difference(&one, &many) < 10.0 * tolerance, "{one:?} {many:?}");
        }
    }
}

/// A drive many times faster than the motion: steps must not fall together with its periods.
#[test]
fn fast_drives_are_seen_as_they_are() {
    let scenes: Vec<Scene> = (0..400)
        .map(|k| {
            let mut scene = alternating([0.0, 0.0, 0.2], 0.4, 8.0 + 0.1 * f64::from(k));
            scene.parameters.aspect = 100.0;
            scene.drive.voltage.set_value(0.2);
            scene.drive.harmonic.phase = 0.7;
            scene
        })
        .collect();
    for tolerance in [1e-4, 1e-6] {
        let found = follow(&scenes, 100.0, tolerance);
        for (scene, found) in scenes.iter().zip(found) {
            let error = difference(&found.expect("a motion"), &exact(scene, 100.0));
            let frequency = scene.drive.harmonic.frequency;
            assert!(error < 100.0 * tolerance, "{frequency}: {error:e}");
        }
    }
}
