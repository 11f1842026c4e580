//! Many independent scenes, such as a frequency response or a map of pull-in,
//! with their parameters in SIMD lanes.
//!
//! ```
//! use dielectric_elastomer_actuator::scene::Scene;
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

use crate::actuator::Fleet;
use crate::scene::Scene;
use crate::solver::State;
use crate::solver::batch::{self, Arrival, Motion};
use crate::solver::double::Double;
use crate::solver::extremes::Extremes;
use crate::solver::limits::Limit;
use crate::solver::trajectory::{Failure, Progress, Trajectory};

/// What became of a scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Outcome {
    /// The state at the end, or where the actuator collapsed.
    pub state: State,
    /// The extremes of the stretch from the start to there, located exactly.
    pub extremes: Extremes,
    /// Whether and when it collapsed.
    pub collapse: Option<(Limit, f64)>,
}

/// Follows each scene from time 0 to `end`, with the relative `tolerance` of the
/// stretch, and returns the outcomes in their order.
///
/// Scenes with the built-in alternating voltage and otherwise constant inputs
/// share SIMD lanes; all others, and those that collapse, are followed one by one.
///
/// # Errors
/// Each outcome is a [`Failure`] where the integration cannot go on.
#[must_use]
pub fn follow(scenes: &[Scene], end: f64, tolerance: f64) -> Vec<Result<Outcome, Failure>> {
    let abreast: Vec<usize> = (0..scenes.len())
        .filter(|&index| Fleet::takes(&scenes[index].drive))
        .collect();
    let motions: Vec<_> = abreast
        .iter()
        .map(|&index| Motion {
            equation: scenes[index].motion(),
            start: scenes[index].start,
            limits: scenes[index].limits,
        })
        .collect();
    let span = [Double::ZERO, Double::new(end)];
    let level = Level::new();
    let arrivals = batch::follow(level, &mut Fleet::new(), &motions, span, tolerance);

    let mut outcomes = vec![None; scenes.len()];
    for (index, arrival) in abreast.into_iter().zip(arrivals) {
        outcomes[index] = arrival.map(|Arrival { state, extremes }| {
            Ok(Outcome {
                state,
                extremes,
                collapse: None,
            })
        });
    }
    outcomes
        .into_iter()
        .zip(scenes)
        .map(|(outcome, scene)| outcome.unwrap_or_else(|| follow_one(scene, end, tolerance)))
        .collect()
}

/// Follows one scene from time 0 to `end`.
///
/// # Errors
/// [`Failure`] where the integration cannot go on.
pub fn follow_one(scene: &Scene, end: f64, tolerance: f64) -> Result<Outcome, Failure> {
    let trajectory = Trajectory::new(scene.start, Double::ZERO, scene.limits, tolerance);
    let mut trajectory = trajectory.recording_extremes();
    let collapse = match trajectory.advance(scene, end)? {
        Progress::Whole => None,
        Progress::Stopped { limit, after } => Some((limit, after)),
    };
    Ok(Outcome {
        state: trajectory.state(),
        extremes: trajectory
            .extremes()
            .unwrap_or(Extremes::at(scene.start.position)),
        collapse,
    })
}
