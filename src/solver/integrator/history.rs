//! Dense output: the polynomials of the steps that are kept, one after another without a gap.

use serde::{Deserialize, Serialize};

use super::PositionOrigin;
use crate::solver::double::Double;
use crate::solver::segment::Segment;

/// Steps kept to find an orbit; an orbit near a saddle takes about 20.
pub const CAPACITY: usize = 64;

/// The motion over one step.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub struct KeptStep<O> {
    /// Time at which it begins, counted from the origin of time.
    pub begin: Double,
    /// Where its positions are counted from.
    pub origin: O,
    /// The motion from there on.
    pub segment: Segment,
}

impl<O> KeptStep<O> {
    /// Time at which it ends.
    pub fn end(&self) -> Double {
        self.begin.plus(self.segment.length())
    }
}

/// The steps that are kept.
#[derive(Debug, Serialize, Deserialize)]
#[serde(into = "Vec<KeptStep<O>>", try_from = "Vec<KeptStep<O>>")]
#[serde(bound = "O: PositionOrigin")]
pub struct History<O> {
    /// With room for as many as are kept, so that none is ever allocated later.
    steps: Vec<KeptStep<O>>,
}

impl<O: Copy> Clone for History<O> {
    fn clone(&self) -> History<O> {
        let mut history = History::empty();
        history.steps.extend_from_slice(&self.steps);
        history
    }
}

impl<O> History<O> {
    /// No step.
    pub fn empty() -> History<O> {
        History {
            steps: Vec::with_capacity(CAPACITY),
        }
    }

    /// An empty history in the memory of this one, which must not be used any more.
    pub fn take(&mut self) -> History<O> {
        self.clear();
        History {
            steps: std::mem::take(&mut self.steps),
        }
    }

    /// Whether no step is kept.
    #[inline]
    pub fn is_empty(&self) -> bool {
        self.steps.is_empty()
    }

    /// Whether no further step can be kept.
    pub fn is_full(&self) -> bool {
        self.steps.len() >= CAPACITY
    }

    /// Forgets all steps.
    pub fn clear(&mut self) {
        self.steps.clear();
    }

    /// The steps, the first one first.
    #[inline]
    pub fn steps(&self) -> &[KeptStep<O>] {
        &self.steps
    }

    /// The steps, to be expanded.
    pub fn steps_mut(&mut self) -> &mut [KeptStep<O>] {
        &mut self.steps
    }

    /// Adds a step, if there is room for it.
    pub fn push(&mut self, step: KeptStep<O>) {
        if !self.is_full() {
            self.steps.push(step);
        }
    }

    /// The end of the last step.
    #[inline]
    pub fn end(&self) -> Double {
        self.steps.last().map_or(Double::ZERO, KeptStep::end)
    }

    /// The step that holds `time`, looked for from the step `near` on. Of two that meet at `time`,
    /// the earlier one if `near` is not after it.
    pub fn find(&self, time: Double, near: usize) -> usize {
        let steps = self.steps();
        let mut index = near;
        while index + 1 < steps.len() && time.since(steps[index + 1].begin) > 0.0 {
            index += 1;
        }
        while index > 0 && time.since(steps[index].begin) < 0.0 {
            index -= 1;
        }
        index
    }
}

impl<O> From<History<O>> for Vec<KeptStep<O>> {
    fn from(history: History<O>) -> Vec<KeptStep<O>> {
        history.steps
    }
}

impl<O: PositionOrigin> TryFrom<Vec<KeptStep<O>>> for History<O> {
    type Error = &'static str;

    fn try_from(mut steps: Vec<KeptStep<O>>) -> Result<History<O>, &'static str> {
        if steps.len() > CAPACITY {
            return Err("more steps than a trajectory keeps");
        }
        let mut before: Option<KeptStep<O>> = None;
        for step in &mut steps {
            let follows = match before {
                // Where the position is counted from may change in between.
                Some(last) => {
                    step.begin == last.end()
                        && (step.origin != last.origin
                            || step.segment.begins_in(last.segment.end()))
                }
                None => step.begin == Double::ZERO,
            };
            if !(step.segment.is_valid() && step.origin.is_finite() && follows) {
                return Err("a step of the trajectory is damaged");
            }
            step.segment.expand();
            before = Some(*step);
        }
        steps.reserve_exact(CAPACITY - steps.len());
        Ok(History { steps })
    }
}
