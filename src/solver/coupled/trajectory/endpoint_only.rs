//! When a coupled motion takes endpoint-only steps, and how it follows them.

use super::Trajectory;
use crate::arithmetic::double_double::DoubleDouble;
use crate::solver::coupled::CoupledEquation;
use crate::solver::endpoint::Coupled;

/// The work of such a step, in iterations of one with dense output.
const WORK: u32 = 2;

/// A step with dense output takes as much time as so many that have an end only: one with first-order states needs more
/// iterations, and its matrices are larger. With 3 the reference scenes take up to 1.5 times as long, with 8 no less.
const TIME_OF_DENSE: f64 = 6.0;

/// So many of them take no longer than one with dense output, where the equation changes at each.
const PER_DENSE_STEP: f64 = 2.0;

impl Trajectory {
    /// Whether the next steps need no dense output, where the motion is asked for after the time `rest`: they are
    /// shorter, for where nothing but its end is.
    pub(super) fn takes_endpoint_steps<E: CoupledEquation>(&self, equation: &E, rest: f64) -> bool {
        let steps = &self.method.endpoint;
        let awaits = self.method.awaits_margin && equation.awaits_event();
        let origin = (self.history.steps().last()).map_or(self.start.origin, |step| step.origin);
        equation.is_regular()
            && origin == DoubleDouble::ZERO
            && !awaits
            && !equation.repeats()
            && equation.integrals() == 0
            && if self.restarts.at_every_step() {
                steps.reach(rest, PER_DENSE_STEP)
            } else {
                steps.are_faster(rest, self.next_length, TIME_OF_DENSE)
            }
    }

    /// Follows the motion from the end of the last step toward `target`, and adds to the work done, in iterations, of
    /// which there may be so many as the `budget` says.
    pub(super) fn go_to_end_by_steps<E: CoupledEquation>(
        &mut self,
        equation: &E,
        target: DoubleDouble,
        budget: u32,
        work: &mut u32,
    ) -> (DoubleDouble, bool) {
        let (level, control) = (self.settings.level, self.step_control(false));
        let mut internal = match &self.method.polynomials {
            Some(polynomials) => polynomials.end.internal,
            None => self.method.internal,
        };
        let most = budget.div_ceil(WORK);
        let mut steps = most;
        let gone = self.go_to_end(
            target,
            &mut internal,
            control,
            &mut steps,
            |carried, way| carried.endpoint.go(level, &Coupled(equation), way),
        );
        *work += (most - steps) * WORK;
        if gone.0 == DoubleDouble::ZERO {
            return gone;
        }
        self.method.internal = internal;
        self.method.polynomials = None;
        if let Some(derivatives) = self.method.endpoint.derivatives() {
            self.method.slopes_before = Some(derivatives);
        }
        gone
    }
}
