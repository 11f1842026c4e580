//! The state at the present time.

use super::{Piece, Trajectory};
use crate::solver::State;
use crate::solver::coupled::{FullState, MOST_INTEGRALS, MOST_STATES};
use crate::solver::double::Double;
use crate::solver::extremes::Extremes;
use crate::solver::orbit::Orbit;

/// Where the present lies.
enum Present<'a> {
    Start,
    Inside(&'a Piece, f64),
    End(&'a Piece),
}

impl Trajectory {
    fn present(&self) -> Present<'_> {
        if self.pieces.is_empty() || self.now == Double::ZERO {
            return Present::Start;
        }
        let piece = &self.pieces[self.index];
        let offset = self.now.since(piece.begin);
        if offset == piece.segment.length() {
            Present::End(piece)
        } else {
            Present::Inside(piece, offset)
        }
    }

    /// The present position, counted from 0.
    #[must_use]
    pub fn position(&self) -> f64 {
        let (origin, position) = match self.present() {
            Present::Start => (self.origin, self.start.motion.position),
            Present::Inside(piece, offset) => (piece.origin, piece.segment.position(offset)),
            Present::End(piece) => (piece.origin, piece.segment.end().position),
        };
        origin.plus(position).value()
    }

    /// The present position, counted from the origin that is returned with it.
    #[must_use]
    pub fn position_from_origin(&self) -> (Double, f64) {
        match self.present() {
            Present::Start => (self.origin, self.start.motion.position),
            Present::Inside(piece, offset) => (piece.origin, piece.segment.position(offset)),
            Present::End(piece) => (piece.origin, piece.segment.end().position),
        }
    }

    /// The present rate.
    #[must_use]
    pub fn rate(&self) -> f64 {
        self.direction
            * match self.present() {
                Present::Start => self.start.motion.rate,
                Present::Inside(piece, offset) => piece.segment.rate(offset),
                Present::End(piece) => piece.segment.end().rate,
            }
    }

    /// The present first-order states.
    #[must_use]
    pub fn internal(&self) -> [f64; MOST_STATES] {
        match (self.present(), &self.rest) {
            (Present::Inside(_, offset), Some(rest)) => rest.internal(offset),
            (Present::End(_), Some(rest)) => rest.end.internal,
            _ => self.start.internal,
        }
    }

    /// The present derivatives of the first-order states, from the polynomials: where a state
    /// relaxes fast, its equation would lose their digits. Nothing before the first step.
    #[must_use]
    pub fn slopes(&self) -> Option<[f64; MOST_STATES]> {
        let rest = self.rest.as_ref()?;
        match self.present() {
            Present::Start => Some(rest.slopes(0.0)),
            Present::Inside(_, offset) => Some(rest.slopes(offset)),
            Present::End(_) => Some(rest.slopes(2.0 * rest.half)),
        }
    }

    /// The present integrals.
    #[must_use]
    pub fn integrals(&self) -> [f64; MOST_INTEGRALS] {
        match (self.present(), &self.rest) {
            (Present::Inside(_, offset), Some(rest)) => rest.integrals(offset),
            (Present::End(_), Some(rest)) => rest.end.integrals,
            _ => self.start.integrals,
        }
    }

    /// All of the present state, its position counted from the origin of its piece.
    pub(super) fn full_state(&self) -> FullState {
        FullState {
            motion: State {
                position: self.position_from_origin().1,
                rate: self.rate(),
            },
            internal: self.internal(),
            integrals: self.integrals(),
        }
    }

    /// x'' and z' at present, from the polynomials.
    pub(super) fn slopes_at_present(&self) -> (f64, [f64; MOST_STATES]) {
        let piece = &self.pieces[self.index];
        let series = piece.segment.series();
        let u = self.now.since(piece.begin) / series.half - 1.0;
        let all: [f64; 16] = std::array::from_fn(|k| {
            let half = if k % 2 == 0 {
                &series.even
            } else {
                &series.odd
            };
            half[k / 2]
        });
        let acceleration =
            crate::solver::coupled::piece::sum(&all, u) / (series.half * series.half);
        (acceleration, self.slopes().unwrap_or_default())
    }

    /// The piece of `time`, looked for from the piece `near` on.
    pub(in crate::solver::coupled) fn find(&self, time: Double, near: usize) -> usize {
        let mut index = near;
        while index + 1 < self.pieces.len() && time.since(self.pieces[index + 1].begin) > 0.0 {
            index += 1;
        }
        while index > 0 && time.since(self.pieces[index].begin) < 0.0 {
            index -= 1;
        }
        index
    }

    /// Moves the present to `target`, which lies in one of the pieces.
    pub(super) fn arrive(&mut self, target: Double) {
        self.now = target;
        if self.pieces.is_empty() {
            // Not even the first step could be solved.
            return;
        }
        self.index = self.find(target, self.index);
        let piece = &mut self.pieces[self.index];
        if target.since(piece.begin) != piece.segment.length() {
            piece.segment.expand();
        }
        if self.extremes.is_some() {
            self.record(target);
        }
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
        let Some(mut extremes) = self.extremes else {
            return;
        };
        // Along an orbit the motion turns where the orbit does only.
        let along_orbit = |orbit: &Orbit| orbit.second_turn().since(self.recorded) <= 0.0;
        if !self.orbit.as_ref().is_some_and(along_orbit) {
            let first = self.find(self.recorded, 0);
            let last = self.find(target, first);
            for piece in &mut self.pieces[first..=last] {
                piece.segment.expand();
                let from = self.recorded.since(piece.begin).max(0.0);
                let to = target.since(piece.begin).min(piece.segment.length());
                include(piece, [from, to], &mut extremes);
            }
            self.recorded = target;
        }
        extremes.include(self.position());
        self.extremes = Some(extremes);
    }
}

fn include(piece: &Piece, [from, to]: [f64; 2], extremes: &mut Extremes) {
    for turn in piece.segment.turns(from, to) {
        extremes.include(piece.origin.plus(turn).value());
    }
}
