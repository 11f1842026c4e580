//! What the motion meets on its way: limits at which it stops, turning points between which it
//! repeats, extremes that are recorded.

use super::{Integrator, Method, Mode, Recording};
use crate::arithmetic::double_double::DoubleDouble;
use crate::arithmetic::roots::crossing;
use crate::solver::extremes::Extremes;
use crate::solver::limits::{Limit, Limits};
use crate::solver::orbit::Orbit;
use crate::solver::position_origin::PositionOrigin;

impl<M: Method> Integrator<M> {
    /// Moves the present to `target`, which lies in one of the steps.
    pub(in crate::solver) fn arrive(&mut self, target: DoubleDouble) {
        self.cursor.now = target;
        if self.history.is_empty() {
            // Not even the first step could be solved.
            return;
        }
        self.cursor.step = self.history.find(target, self.cursor.step);
        if self.recording.is_some() {
            self.record(target);
        }
        let step = &mut self.history.steps_mut()[self.cursor.step];
        let offset = target.since(step.begin);
        let ahead = step.segment.length() - offset;
        self.cursor.time_left = 0.0;
        // Where extremes are recorded every step is looked at.
        if ahead == 0.0 || self.recording.is_some() {
            return;
        }
        step.segment.expand();
        let room = match &self.mode {
            Mode::Dense { stop: None, .. } => ahead,
            Mode::Dense {
                stop: Some((_, at)),
                ..
            } => ahead.min(at.since(target)),
            Mode::Periodic { orbit, direction } => {
                let room = if *direction > 0.0 { ahead } else { offset };
                let to_turn = orbit.time_to_turn(target, *direction);
                if to_turn < room { to_turn } else { room }
            }
            Mode::AtRest => 0.0,
        };
        // Less than all of it, since it is counted down with rounding.
        self.cursor.time_left = room * (1.0 - 1e-9);
    }

    /// Moves the present along an orbit by the time `step`.
    pub(super) fn run_orbit(&mut self, orbit: Orbit, direction: f64, step: f64) {
        let (now, next_direction) = orbit.run(self.cursor.now, direction, step);
        if self.recording.is_some() {
            for turn in orbit.turns_within(self.cursor.now, direction, step) {
                self.arrive(turn);
            }
        }
        if let Mode::Periodic { direction, .. } = &mut self.mode {
            *direction = next_direction;
        }
        self.arrive(now);
    }

    /// Records the extremes of the motion up to `target`. Not inlined: seldom called, and from several places.
    #[inline(never)]
    fn record(&mut self, target: DoubleDouble) {
        self.history.steps_mut()[self.cursor.step].segment.expand();
        let position = self.position();
        let Some(Recording { extremes, until }) = &mut self.recording else {
            return;
        };
        // Along an orbit the motion turns where the orbit does only.
        let along_orbit = |orbit: Orbit| orbit.second_turn().since(*until) <= 0.0;
        if !self.mode.orbit().is_some_and(along_orbit) {
            let first = self.history.find(*until, 0);
            // Not before the first one, whatever a forged state says.
            let last = self.history.find(target, first).max(first);
            for step in &mut self.history.steps_mut()[first..=last] {
                step.segment.expand();
                let from = until.since(step.begin).max(0.0);
                let to = target.since(step.begin).min(step.segment.length());
                let known =
                    step.origin.relative(extremes.lowest)..=step.origin.relative(extremes.highest);
                for turn in step.segment.turns_outside(known, from, to) {
                    extremes.include(step.origin.absolute(turn));
                }
            }
            *until = target;
        }
        extremes.include(position);
    }

    /// Records the extremes of the motion from now on.
    #[must_use]
    pub fn recording_extremes(mut self) -> Self {
        self.record_extremes_anew(true);
        self
    }

    /// Forgets the extremes so far: they are recorded from the present on, or not any more.
    pub fn record_extremes_anew(&mut self, recording: bool) {
        // Along an orbit the motion turns where the orbit does only.
        let orbit = self.mode.orbit();
        let until = orbit.map_or(self.cursor.now, |orbit| orbit.second_turn());
        self.recording = recording.then(|| Recording {
            extremes: Extremes::at(self.position()),
            until,
        });
        self.cursor.time_left = 0.0;
    }

    /// The extremes up to the present, where they are recorded.
    pub fn extremes(&self) -> Option<Extremes> {
        self.recording.map(|recording| recording.extremes)
    }

    /// Notes a turning point of the last step, if nothing stops there; the second one closes an
    /// orbit.
    pub(in crate::solver) fn look_for_turn(&mut self) {
        let (
            Mode::Dense {
                first_turn,
                stop: None,
            },
            Some(step),
        ) = (&mut self.mode, self.history.steps_mut().last_mut())
        else {
            return;
        };
        let segment = &mut step.segment;
        if segment.start().rate * segment.end().rate >= 0.0 {
            return;
        }
        segment.expand();
        let offset = crossing(0.0, segment.length(), |offset| segment.rate(offset));
        let turn = step.begin.plus(offset);
        match *first_turn {
            None => *first_turn = Some(turn),
            Some(first) if turn.since(first) > 0.0 => {
                self.mode = Mode::Periodic {
                    orbit: Orbit::between(first, turn),
                    direction: 1.0,
                };
            }
            Some(_) => {}
        }
    }

    /// The limit that the motion first meets in the last step, and the offset at which it does.
    /// `lowest` and `highest` hold the motion there.
    pub(in crate::solver) fn first_contact(
        &mut self,
        lowest: f64,
        highest: f64,
    ) -> Option<(Limit, f64)> {
        let limits = self.settings.limits;
        let step = self.history.steps_mut().last_mut()?;
        let limits = Limits {
            lower: step.origin.relative(limits.lower),
            upper: step.origin.relative(limits.upper),
        };
        limits.first_contact(&mut step.segment, lowest..=highest)
    }

    /// Notes that the motion stops at this offset after the begin of the last step.
    pub(in crate::solver) fn stop_in_last_step(&mut self, event: Option<(M::Event, f64)>) {
        let begin = self.history.steps().last().map(|step| step.begin);
        if let (Mode::Dense { stop, .. }, Some(begin)) = (&mut self.mode, begin) {
            *stop = event.map(|(event, offset)| (event, begin.plus(offset)));
        }
    }
}
