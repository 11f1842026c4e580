//! Many scenes: an ensemble in SIMD lanes, and one by one.

use std::hint::black_box;
use std::time::Duration;

use dielectric_elastomer_actuator::nondimensional::scene::Scene;
use dielectric_elastomer_actuator::sweep::{self, Outcome};

use crate::case::{Case, larger};
use crate::row::Row;
use crate::timing::seconds_per_call;

/// Frequencies of the drive, 0.05 to 0.3; heyoka's side has the same.
pub const SCENES: usize = 64;

/// How long each is followed.
const TIME: f64 = 2000.0;

const TOLERANCES: [f64; 3] = [1e-6, 1e-9, 1e-12];

/// Tolerances that an error may have; heyoka's side has the same.
const ALLOWED: f64 = 100.0;

/// Times both ways at each tolerance; nanoseconds for each scene. The error is that of the state at
/// the end and of the extremes, against a run alone at a tolerance of 1e-14.
pub fn run(case: &Case, least: Duration) {
    let scenes = scenes(case);
    let one = |tolerance: f64| -> Vec<Outcome> {
        let follow = |scene| sweep::follow_one(scene, TIME, tolerance).expect("a bounded motion");
        scenes.iter().map(follow).collect()
    };
    let many = |tolerance: f64| -> Vec<Outcome> {
        let outcomes = sweep::follow(&scenes, TIME, tolerance).into_iter();
        outcomes.map(|o| o.expect("a bounded motion")).collect()
    };
    let exact = one(1e-14);
    for tolerance in TOLERANCES {
        type Follow<'a> = &'a dyn Fn(f64) -> Vec<Outcome>;
        let ways: [(&str, Follow); 2] = [("ours, ensemble", &many), ("ours, one by one", &one)];
        for (method, follow) in ways {
            let error = error(&follow(tolerance), &exact);
            assert!(
                error <= ALLOWED * tolerance,
                "{method} at {tolerance:e}: error {error:e}"
            );
            let seconds = seconds_per_call(least, || {
                black_box(follow(tolerance));
            });
            Row {
                method,
                tolerance,
                step: None,
                inputs: "extremes recorded",
                nanoseconds: Some(1e9 * seconds / SCENES as f64),
                error: Some(error),
                hold_error: None,
                note: String::new(),
            }
            .print();
        }
    }
}

fn scenes(case: &Case) -> [Scene; SCENES] {
    let [gamma, tau, elasticity] = case.surface;
    let mut scenes = [Scene::at_start(); SCENES];
    for (k, scene) in scenes.iter_mut().enumerate() {
        scene.parameters.surface_energy = gamma;
        scene.parameters.surface_tension = tau;
        scene.parameters.surface_elasticity = elasticity;
        scene.drive.harmonic.amplitude = case.amplitude;
        scene.drive.harmonic.frequency = 0.05 + 0.25 * k as f64 / (SCENES - 1) as f64;
    }
    scenes
}

fn error(outcomes: &[Outcome], exact: &[Outcome]) -> f64 {
    let numbers = |outcome: &Outcome| {
        [
            outcome.state.position,
            outcome.state.rate,
            outcome.extremes.lowest,
            outcome.extremes.highest,
        ]
    };
    let pairs = outcomes.iter().zip(exact);
    pairs
        .flat_map(|(one, other)| numbers(one).into_iter().zip(numbers(other)))
        .map(|(one, other)| (one - other).abs())
        .fold(0.0, larger)
}
