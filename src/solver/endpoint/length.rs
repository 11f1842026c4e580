//! How long the next equal steps may be.

use serde::{Deserialize, Serialize};

use super::plan::NODES;
use crate::solver::step_control::{StepControl, factor};

/// Order of the error at the end of a step.
pub const ORDER: f64 = 2.0 * NODES as f64;

/// Contraction above which shorter steps are cheaper.
const SLOW: f64 = 0.25;

/// Steps after which their length is looked at, and by which part it must be too long or too short
/// to be changed: a new plan costs as much as a step.
const CALM: u32 = 12;
const TOO_LONG: f64 = 0.8;
const TOO_SHORT: f64 = 2.0;

/// The first step in units of the motion's time scale at a tolerance of 1e-12.
const FIRST_AT_TIGHT_TOLERANCE: f64 = 1.5;

/// By how much steps may grow at once.
const MOST_GROWTH: f64 = 3.0;

/// How long a step may be of which only the time scale of the motion is known, and the tolerance.
pub fn first(time_scale: f64, control: StepControl) -> f64 {
    time_scale * FIRST_AT_TIGHT_TOLERANCE * factor(1e-12 / control.tolerance, ORDER)
}

/// The worst of the steps since the length was looked at: its error as a part of what is allowed,
/// and its contraction.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub struct Seen {
    pub steps: u32,
    pub error: f64,
    pub contraction: f64,
    /// Steps after which their length is looked at.
    due: u32,
}

impl Seen {
    pub const NOTHING: Seen = Seen {
        steps: 0,
        error: 0.0,
        contraction: 0.0,
        due: CALM,
    };

    /// Nothing, of steps whose length is still to be found: each is looked at.
    pub const BEGIN: Seen = Seen {
        due: 1,
        ..Seen::NOTHING
    };

    /// Whether the numbers can be those of steps.
    pub fn is_valid(&self) -> bool {
        self.error >= 0.0 && self.contraction >= 0.0 && self.steps <= self.due && self.due <= CALM
    }

    /// By which factor steps may be longer.
    #[inline(always)]
    fn factor(&self) -> f64 {
        factor(self.error, ORDER).min((SLOW / self.contraction.max(1e-6)).sqrt())
    }

    /// After enough steps of this `length`, how long they should be from now on if that is another
    /// length than is `wanted`, which they have when the way allows it. The first ones grow at once, and one that is
    /// `alone` between two communication points: longer ways may then need fewer steps, and this one keeps its plan.
    #[inline(always)]
    pub fn another_length(&mut self, length: f64, wanted: f64, alone: bool) -> Option<f64> {
        if self.steps < self.due {
            return None;
        }
        let next = (self.factor() * length).min(MOST_GROWTH * length);
        let due = self.due;
        *self = Seen::NOTHING;
        if next > TOO_SHORT * wanted {
            self.due = due;
            Some(next)
        } else if next < TOO_LONG * length || (due < CALM || alone) && next > wanted {
            Some(next)
        } else {
            None
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The first ones threefold at most, after each step; once they fit, after enough of them.
    #[test]
    fn the_first_steps_grow_at_once_and_later_ones_seldom() {
        let step = |seen: &mut Seen, error: f64, length: f64| {
            seen.error = seen.error.max(error);
            seen.steps += 1;
            seen.another_length(length, length, false)
        };
        let mut seen = Seen::BEGIN;
        assert_eq!(step(&mut seen, 1e-20, 1.0), Some(3.0));
        let grown = step(&mut seen, 1e-7, 3.0).expect("a longer one");
        assert!(3.0 * TOO_SHORT < grown && grown < 7.5, "{grown}");
        // A fifth of what is allowed fits.
        assert_eq!(step(&mut seen, 0.2, grown), None);
        for _ in 1..CALM {
            assert_eq!(step(&mut seen, 1e-20, grown), None);
        }
        assert_eq!(step(&mut seen, 1e-20, grown), Some(3.0 * grown));
    }

    /// Where ways of another length come between.
    #[test]
    fn a_step_that_is_alone_grows_by_less_than_twice() {
        for alone in [false, true] {
            let mut seen = Seen {
                steps: CALM,
                ..Seen::NOTHING
            };
            let grown = alone.then_some(3.0);
            assert_eq!(seen.another_length(1.0, 2.0, alone), grown);
        }
    }
}
