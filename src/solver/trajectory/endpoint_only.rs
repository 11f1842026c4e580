//! When a motion takes endpoint-only steps, and how it follows them.

use super::{FEW, Trajectory};
use crate::arithmetic::double_double::DoubleDouble;
use crate::solver::Equation;
use crate::solver::coupled::Stage;
use crate::solver::endpoint::{End, Way};
use crate::solver::integrator::Mode;

/// A step with dense output takes as much time as so many that have an end only, without a restart.
const TIME_OF_DENSE: f64 = 3.0;

/// So many endpoint-only steps take no longer than one with dense output.
const PER_DENSE_STEP: f64 = 2.0;

/// More endpoint-only steps are not made at once, since all are lost where a limit is met.
const MOST_AT_ONCE: u32 = 8;

impl Trajectory {
    /// Whether endpoint-only steps may go the way from the start at once, which takes fewer instructions than the loop
    /// over steps: those of a way on which they meet something are lost.
    #[inline]
    pub(super) fn may_go_straight(&self, step: f64) -> bool {
        let few = || {
            let most = f64::from(MOST_AT_ONCE);
            !self.records_extremes() && self.method.endpoint.surely_reach(step, most)
        };
        let nothing_ahead = matches!(self.mode, Mode::Dense { stop: None, .. });
        nothing_ahead && self.history.is_empty() && (self.restarts.at_every_step() || few())
    }

    /// Whether the next steps need no dense output, where the motion is asked for after the time `rest`:
    /// they are shorter, for where nothing but its end is.
    #[inline(never)]
    pub(super) fn takes_endpoint_steps<E: Equation>(&self, equation: &E, rest: f64) -> bool {
        let steps = &self.method;
        if !steps.takes_endpoint_steps {
            return false;
        }
        let many = || {
            let faster = steps
                .endpoint
                .are_faster(rest, self.next_length, TIME_OF_DENSE);
            faster && !self.may_repeat(equation)
        };
        if !self.restarts.at_every_step() {
            many()
        } else if self.settings.control.repeated().is_loose() {
            // A few take no longer than to look for an orbit.
            steps.endpoint.reach(rest, FEW) || many()
        } else {
            steps.endpoint.reach(rest, PER_DENSE_STEP)
        }
    }

    /// Follows the motion from its start for the time `step`, which a few endpoint-only steps take, and
    /// moves the start there. Where they do not reach it, they have not been made.
    #[inline(never)]
    pub(super) fn go_straight_to_end<E: Equation>(
        &mut self,
        equation: &E,
        clock: &DoubleDouble,
        step: f64,
    ) -> End {
        let mut way = Way {
            begin: *clock,
            now: DoubleDouble::ZERO,
            state: Stage::of(self.start.state, []),
            target: DoubleDouble::new(step),
            bounds: self.bounds(),
            control: self.step_control(false),
            budget: MOST_AT_ONCE,
        };
        let level = self.settings.level;
        let end = self.method.endpoint.go(level, equation, &mut way);
        if end == End::Reached {
            self.start.state = way.state.motion();
        } else {
            self.method.endpoint.restart();
        }
        end
    }

    /// Follows the motion from the end of the last step toward `target` (see [`crate::solver::integrator::Integrator`]).
    pub(super) fn go_to_end_by_steps<E: Equation>(
        &mut self,
        equation: &E,
        target: DoubleDouble,
        budget: &mut u32,
    ) -> (DoubleDouble, bool) {
        let (level, control) = (self.settings.level, self.step_control(false));
        self.go_to_end(target, &mut [], control, budget, |steps, way| {
            steps.endpoint.go(level, equation, way)
        })
    }
}
