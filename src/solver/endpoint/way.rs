//! A way to go, and how far it was gone.

use crate::arithmetic::double_double::DoubleDouble;
use crate::solver::coupled::Stage;
use crate::solver::step_control::StepControl;

/// A way to go.
#[derive(Clone, Copy, Debug)]
pub struct Way<const K: usize> {
    /// Time of the model at its begin.
    pub begin: DoubleDouble,
    /// The present, counted from there.
    pub now: DoubleDouble,
    /// Present state.
    pub state: Stage<f64, K>,
    /// The time to be reached, counted from there.
    pub target: DoubleDouble,
    /// Positions between which steps may go.
    pub bounds: (f64, f64),
    /// What a step may miss.
    pub control: StepControl,
    /// How many steps may still be solved.
    pub budget: u32,
}

impl<const K: usize> Way<K> {
    /// Present time of the model.
    #[inline]
    pub fn time(&self) -> DoubleDouble {
        self.begin.add(self.now)
    }

    /// How long it still is.
    #[inline]
    pub fn rest(&self) -> f64 {
        self.target.since(self.now)
    }
}

/// How steps ended.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum End {
    /// At the time to be reached.
    Reached,
    /// Where the next one would not stay between the bounds, or would be too short.
    Blocked,
    /// Where the budget is spent.
    TooMany,
}
