//! The extremes of a motion that the host integrates, in steps of its own.

use serde::{Deserialize, Serialize};

use crate::arithmetic::double_double::DoubleDouble;
use crate::solver::State;
use crate::solver::extremes::Extremes;
use crate::solver::limits::Limits;

/// The extremes up to a completed step of the host's integrator.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Recording {
    /// The extremes, where they are recorded.
    pub extremes: Option<Extremes>,
    time: DoubleDouble,
    state: State,
}

impl Recording {
    /// Records from this state on, between these limits, or nothing where there are none.
    #[must_use]
    pub fn begin(limits: Option<Limits>, time: DoubleDouble, state: State) -> Recording {
        Recording {
            extremes: limits.map(|limits| Extremes::at(limits.nearest(state.position))),
            time,
            state,
        }
    }

    /// Records the host's step that has come to this state. Inside the step the motion is that on
    /// the cubic through both ends.
    pub fn include_step(&mut self, limits: Limits, time: DoubleDouble, state: State) {
        if let Some(turn) = turn_between(self.state, state, time.since(self.time)) {
            self.include_position(limits, turn);
        }
        self.include(limits, time, state);
    }

    /// Records this state alone: it may have jumped.
    pub fn include(&mut self, limits: Limits, time: DoubleDouble, state: State) {
        self.include_position(limits, state.position);
        (self.time, self.state) = (time, state);
    }

    /// Whether the numbers fit together as those of a recording, or of none.
    #[must_use]
    pub fn is_valid(&self, recorded: bool) -> bool {
        let State { position, rate } = self.state;
        let extremes = self.extremes.is_none_or(|extremes| extremes.is_valid());
        position.is_finite()
            && rate.is_finite()
            && self.time.is_finite()
            && extremes
            && self.extremes.is_some() == recorded
    }

    /// A host may step beyond the limits before it handles the event there.
    fn include_position(&mut self, limits: Limits, position: f64) {
        if let Some(extremes) = &mut self.extremes {
            extremes.include(limits.nearest(position));
        }
    }
}

/// The position at which a motion turns on its way between two states that lie
/// `time` apart, on the cubic through both with their rates.
fn turn_between(from: State, to: State, time: f64) -> Option<f64> {
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
