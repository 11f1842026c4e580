//! Whether numbers fit together as those of a motion that has been followed.

use super::{Integrator, Method, Mode};
use crate::arithmetic::double_double::DoubleDouble;
use crate::solver::dense_output::VALIDATION_TOLERANCE;
use crate::solver::extremes::Extremes;
use crate::solver::limits::Limits;
use crate::solver::orbit::Orbit;
use crate::solver::position_origin::PositionOrigin;

impl<M: Method> Integrator<M> {
    /// Whether the numbers fit together: to be checked where they do not come from this process.
    /// The steps join, the present lies in its step and between the limits, an orbit turns where it
    /// says. Whether the steps solve an equation is not looked at.
    pub fn is_valid(&self) -> bool {
        let end = self.history.end();
        let inside = |time: &DoubleDouble| {
            time.is_finite() && time.since(DoubleDouble::ZERO) >= 0.0 && time.since(end) <= 0.0
        };
        let in_step = |time: &DoubleDouble| {
            inside(time) && self.history.find(*time, self.cursor.step) == self.cursor.step
        };
        let first = self.history.steps().first();
        let latest = self.latest_unseen();
        self.history.is_valid()
            && self.settings.control.is_valid()
            && self.settings.limits.are_valid()
            && self.start.time.is_finite()
            && self.start.origin.is_finite()
            && self.start.state.position.is_finite()
            && self.start.state.rate.is_finite()
            && first.is_none_or(|step| {
                step.segment.begins_in(self.start.state) && step.origin == self.start.origin
            })
            // No step outlives a restart: a short step, which may come first then, looks at none.
            && (first.is_none() || self.restarts.advances > 0)
            && self.cursor.step < self.history.steps().len().max(1)
            && (0.0..=end.value()).contains(&self.cursor.time_left)
            && [self.cursor.now, latest].iter().all(in_step)
            && (self.recording.iter()).all(|recording| inside(&recording.until))
            && match &self.mode {
                Mode::Dense { first_turn, stop } => {
                    first_turn.iter().all(inside)
                        && stop.is_none_or(|(_, at)| inside(&at) && at.since(latest) >= 0.0)
                }
                Mode::Periodic { orbit, direction } => {
                    direction.abs() == 1.0 && self.follows(orbit)
                }
                Mode::AtRest => first.is_none() && self.start.state.rate == 0.0,
            }
            && (self.next_length.iter()).all(|length| *length > 0.0 && length.is_finite())
            && self.is_between_limits()
            && self.method.is_valid(self)
    }

    /// Whether it is followed between these limits, with this tolerance.
    pub fn keeps_to(&self, limits: Limits, tolerance: f64) -> bool {
        self.settings.limits == limits && self.settings.control.tolerance == tolerance
    }

    /// Where the present comes to at the latest before it is looked where it is, but for rounding:
    /// the time left is counted down step by step.
    fn latest_unseen(&self) -> DoubleDouble {
        let left =
            (self.cursor.time_left - VALIDATION_TOLERANCE * self.history.end().value()).max(0.0);
        self.cursor.now.plus(self.mode.direction() * left)
    }

    /// Whether the motion turns at the ends of the orbit, and is on it.
    fn follows(&self, orbit: &Orbit) -> bool {
        let turns_at = |time: &DoubleDouble| {
            let steps = self.history.steps();
            let step = steps.get(self.history.find(*time, 0));
            step.is_some_and(|step| step.segment.turns_at(time.since(step.begin)))
        };
        let turns = orbit.turns();
        turns[0].since(DoubleDouble::ZERO) >= 0.0
            && turns[1].since(self.history.end()) <= 0.0
            && orbit.is_valid()
            && [self.cursor.now, self.latest_unseen()]
                .iter()
                .all(|time| orbit.holds(*time))
            && turns.iter().all(turns_at)
    }

    /// Whether the present, and what is recorded, lie between the limits.
    fn is_between_limits(&self) -> bool {
        let Limits { lower, upper } = self.settings.limits;
        let range =
            lower - VALIDATION_TOLERANCE * lower.abs()..=upper + VALIDATION_TOLERANCE * upper.abs();
        let recorded = self.extremes().is_none_or(|Extremes { lowest, highest }| {
            lowest <= highest && range.contains(&lowest) && range.contains(&highest)
        });
        recorded && range.contains(&self.position()) && self.rate().is_finite()
    }
}
