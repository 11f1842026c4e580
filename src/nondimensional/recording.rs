//! The extremes of a motion that the host integrates.

use serde::{Deserialize, Serialize};

use super::Nondimensional;
use crate::model::Record;
use crate::nondimensional::scene::Scene;
use crate::solver::State;
use crate::solver::double::Double;
use crate::solver::extremes::Extremes;

/// The extremes up to a completed step of the host's integrator.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Recording {
    /// The extremes, where they are recorded.
    pub extremes: Option<Extremes>,
    time: Double,
    state: State,
}

impl Record<Nondimensional> for Recording {
    fn begin(scene: &Scene, time: Double, state: State) -> Recording {
        Recording {
            extremes: scene
                .records_extremes()
                .then(|| Extremes::at(state.position)),
            time,
            state,
        }
    }

    /// Inside the step the motion is that on the cubic through both ends.
    fn include_step(&mut self, scene: &Scene, time: Double, state: State) {
        if let Some(turn) = turn_between(self.state, state, time.since(self.time)) {
            self.include_position(scene, turn);
        }
        self.include(scene, time, state);
    }

    fn include(&mut self, scene: &Scene, time: Double, state: State) {
        self.include_position(scene, state.position);
        (self.time, self.state) = (time, state);
    }

    fn is_valid(&self, scene: &Scene) -> bool {
        let State { position, rate } = self.state;
        let extremes = self.extremes.is_none_or(|Extremes { lowest, highest }| {
            lowest <= highest && lowest.is_finite() && highest.is_finite()
        });
        position.is_finite()
            && rate.is_finite()
            && self.time.is_finite()
            && extremes
            && self.extremes.is_some() == scene.records_extremes()
    }
}

impl Recording {
    /// A host may step beyond the limits before it handles the event there.
    fn include_position(&mut self, scene: &Scene, position: f64) {
        if let Some(extremes) = &mut self.extremes {
            extremes.include(position.clamp(scene.limits.lower, scene.limits.upper));
        }
    }
}

/// The position at which a motion turns on its way between two states that lie
/// `time` apart, on the cubic through both with their rates.
pub(crate) fn turn_between(from: State, to: State, time: f64) -> Option<f64> {
    let [first, last] = [from.rate, to.rate].map(|rate| rate * time);
    if first * last >= 0.0 {
        return None;
    }
    let rise = to.position - from.position;
    // p(s) = position + first s + square s² + cube s³, 0 ≤ s ≤ 1.
    let (square, cube) = (3.0 * rise - 2.0 * first - last, first + last - 2.0 * rise);
    // p' has one zero inside, since it changes sign; written without cancellation.
    let root = (square * square - 3.0 * cube * first).sqrt();
    let s = -first / (square - root.copysign(first));
    let turn = from.position + s * (first + s * (square + s * cube));
    ((0.0..=1.0).contains(&s) && turn.is_finite()).then_some(turn)
}
