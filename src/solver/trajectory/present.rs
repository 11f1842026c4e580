//! Where in its pieces the motion stands, and what its state is there.

use super::Trajectory;
use crate::solver::State;
use crate::solver::double::Double;
use crate::solver::orbit::Orbit;
use crate::solver::pieces::Piece;
use crate::solver::segment::Segment;

/// Where the present lies: at a state that is known, or inside a segment.
enum Present<'a> {
    At(State),
    Inside(&'a Segment, f64),
}

impl Trajectory {
    /// The present position.
    #[must_use]
    pub fn position(&self) -> f64 {
        match self.present() {
            Present::At(state) => state.position,
            Present::Inside(segment, offset) => segment.position(offset),
        }
    }

    /// The present rate.
    #[must_use]
    pub fn rate(&self) -> f64 {
        self.direction
            * match self.present() {
                Present::At(state) => state.rate,
                Present::Inside(segment, offset) => segment.rate(offset),
            }
    }

    /// The present position and rate.
    #[must_use]
    pub fn state(&self) -> State {
        State {
            position: self.position(),
            rate: self.rate(),
        }
    }

    fn present(&self) -> Present<'_> {
        if self.pieces.count() == 0 || self.now == Double::ZERO {
            return Present::At(self.start);
        }
        let Piece { begin, segment } = &self.pieces.list()[self.index];
        let offset = self.now.since(*begin);
        if offset == segment.length() {
            Present::At(segment.end())
        } else {
            Present::Inside(segment, offset)
        }
    }

    /// Moves the present to `target`, which lies in one of the pieces.
    pub(super) fn arrive(&mut self, target: Double) {
        self.now = target;
        if self.pieces.count() == 0 {
            // Not even the first substep could be solved.
            return;
        }
        self.index = self.pieces.find(target, self.index);
        if self.extremes.is_some() {
            self.record(target);
        }
        let Piece { begin, segment } = self.pieces.piece(self.index);
        let offset = target.since(*begin);
        let ahead = segment.length() - offset;
        self.slack = 0.0;
        if ahead == 0.0 {
            return;
        }
        if self.extremes.is_some() {
            // Every step is looked at.
            return;
        }
        segment.expand();
        let mut room = if self.direction > 0.0 { ahead } else { offset };
        if let Some(orbit) = &self.orbit {
            room = room.min(orbit.time_to_turn(target, self.direction));
        }
        if let Some((_, at)) = self.stop {
            room = room.min(at.since(target));
        }
        // Less than all of it, since it is counted down with rounding.
        self.slack = room * (1.0 - 1e-9);
    }

    /// Moves the present along the orbit by the time `step`.
    pub(super) fn run_orbit(&mut self, orbit: Orbit, step: f64) {
        let (now, direction) = orbit.run(self.now, self.direction, step);
        if self.extremes.is_some() {
            for turn in orbit.turns_within(self.now, self.direction, step) {
                self.arrive(turn);
            }
        }
        self.direction = direction;
        self.arrive(now);
    }

    /// Records the extremes of the motion up to `target`.
    fn record(&mut self, target: Double) {
        self.pieces.piece(self.index).segment.expand();
        let Some(mut extremes) = self.extremes else {
            return;
        };
        // Along an orbit the motion turns where the orbit does only.
        let along_orbit = |orbit: &Orbit| orbit.second_turn().since(self.recorded) <= 0.0;
        if !self.orbit.as_ref().is_some_and(along_orbit) {
            let first = self.pieces.find(self.recorded, 0);
            let last = self.pieces.find(target, first);
            for index in first..=last {
                let Piece { begin, segment } = self.pieces.piece(index);
                segment.expand();
                let from = self.recorded.since(*begin).max(0.0);
                let to = target.since(*begin).min(segment.length());
                segment
                    .turns(from, to)
                    .for_each(|turn| extremes.include(turn));
            }
            self.recorded = target;
        }
        extremes.include(self.position());
        self.extremes = Some(extremes);
    }
}
