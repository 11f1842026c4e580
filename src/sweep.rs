//! Many independent scenes, such as a frequency response or a map of pull-in,
//! with their parameters in SIMD lanes.
//!
//! ```
//! use dielectric_elastomer_actuator::nondimensional::scene::Scene;
//! use dielectric_elastomer_actuator::sweep;
//!
//! let mut scenes = [Scene::at_start(); 100];
//! for (scene, k) in scenes.iter_mut().zip(0..) {
//!     scene.drive.harmonic.amplitude = 0.3;
//!     scene.drive.harmonic.frequency = 0.1 + 0.001 * f64::from(k);
//! }
//! let outcomes = sweep::follow(&scenes, 500.0, 1e-8);
//! let highest = outcomes.iter().flatten().map(|outcome| outcome.extremes.highest);
//! assert!(highest.fold(1.0, f64::max) > 1.05);
//! ```

use fearless_simd::Level;

use crate::actuator::Ensemble;
use crate::arithmetic::double_double::DoubleDouble;
use crate::ensemble::{self, Arrival, InitialValueProblem};
use crate::nondimensional::scene::Scene;
use crate::solver::State;
use crate::solver::extremes::Extremes;
use crate::solver::limits::Limit;
use crate::solver::trajectory::{Failure, Progress, Trajectory};

/// What became of a scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Outcome {
    /// The state at the end, or where the actuator collapsed.
    pub state: State,
    /// The extremes of the stretch from the start to there, located between the steps.
    pub extremes: Extremes,
    /// Whether and when it collapsed.
    pub collapse: Option<(Limit, f64)>,
}

/// Follows each scene from time 0 to `end`, with the relative `tolerance` of the
/// stretch, and returns the outcomes in their order.
///
/// Scenes with the built-in alternating voltage and otherwise constant inputs share SIMD lanes.
/// All others are followed one by one, and so is the last part of those that collapse.
///
/// # Errors
/// Each outcome is a [`Failure`] where the integration cannot go on.
#[must_use]
pub fn follow(scenes: &[Scene], end: f64, tolerance: f64) -> Vec<Result<Outcome, Failure>> {
    let motions: Vec<_> = scenes
        .iter()
        .map(|scene| InitialValueProblem {
            equation: scene.motion(),
            start: scene.start,
            limits: scene.limits,
        })
        .collect();
    let span = [DoubleDouble::ZERO, DoubleDouble::new(end)];
    let arrivals = ensemble::follow(
        Level::new(),
        &mut Ensemble::new(),
        &motions,
        span,
        tolerance,
    );
    let outcome = |arrival: Arrival| Outcome {
        state: arrival.state,
        extremes: arrival.extremes,
        collapse: collapse(arrival.progress),
    };
    arrivals
        .into_iter()
        .map(|arrival| arrival.map(outcome))
        .collect()
}

/// Follows one scene from time 0 to `end`.
///
/// # Errors
/// [`Failure`] where the integration cannot go on.
pub fn follow_one(scene: &Scene, end: f64, tolerance: f64) -> Result<Outcome, Failure> {
    let trajectory = Trajectory::new(scene.start, scene.limits, tolerance);
    let mut trajectory = trajectory.recording_extremes();
    let mut clock = DoubleDouble::ZERO;
    let progress = trajectory.advance(scene, &mut clock, end)?;
    Ok(Outcome {
        state: trajectory.state(),
        extremes: trajectory
            .extremes()
            .unwrap_or(Extremes::at(scene.start.position)),
        collapse: collapse(progress),
    })
}

fn collapse(progress: Progress) -> Option<(Limit, f64)> {
    match progress {
        Progress::Whole => None,
        Progress::Stopped { limit, after } => Some((limit, after)),
    }
}
