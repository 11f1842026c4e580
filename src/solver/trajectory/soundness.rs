//! Whether numbers fit together as those of a motion that has been followed.

use super::Trajectory;
use crate::solver::double::Double;
use crate::solver::extremes::Extremes;
use crate::solver::limits::Limits;
use crate::solver::orbit::Orbit;
use crate::solver::pieces::Piece;
use crate::solver::segment::ROUNDING;

impl Trajectory {
    /// Whether the numbers fit together: to be checked where they do not come from
    /// this process. The pieces join, the present lies in its piece and between the
    /// limits, an orbit turns where it says. Whether the pieces solve an equation is
    /// not looked at.
    #[must_use]
    pub fn is_sound(&self) -> bool {
        let inside = |time: &Double| {
            time.is_finite() && time.since(Double::ZERO) >= 0.0 && time.since(self.end()) <= 0.0
        };
        let in_piece =
            |time: &Double| inside(time) && self.pieces.find(*time, self.index) == self.index;
        let first = self.pieces.list().first();
        let length = self.next_length.unwrap_or(1.0);
        let last = self.last_unseen();
        self.control.is_sound()
            && self.limits.are_sound()
            && self.time.is_finite()
            && self.origin.is_finite()
            && self.recorded.is_finite()
            && first.is_none_or(|piece| piece.segment.begins_in(self.start))
            // No piece outlives a restart: a short step, which may come first then, looks at none.
            && (first.is_none() || self.advances > 0)
            && self.index < self.pieces.count().max(1)
            && (0.0..=self.end().value()).contains(&self.slack)
            && [self.now, last].iter().all(in_piece)
            && self.first_turn.iter().all(inside)
            && self.stop.is_none_or(|(_, at)| inside(&at) && at.since(last) >= 0.0)
            && match self.orbit {
                Some(orbit) => self.stop.is_none() && self.follows(orbit),
                None => self.direction == 1.0,
            }
            && (!self.at_rest || first.is_none() && self.start.rate == 0.0)
            && length > 0.0
            && length.is_finite()
            && self.steps.are_sound()
            && self.strides.are_sound()
            && self.is_between_limits()
    }

    /// Whether it is followed between these limits, with this tolerance.
    #[must_use]
    pub fn keeps_to(&self, limits: Limits, tolerance: f64) -> bool {
        self.limits == limits && self.control.tolerance == tolerance
    }

    /// Where the present comes to at the latest before it is looked where it is, but
    /// for rounding: the slack is counted down step by step.
    fn last_unseen(&self) -> Double {
        let slack = (self.slack - ROUNDING * self.end().value()).max(0.0);
        self.now.plus(self.direction * slack)
    }

    /// Whether the motion turns at the ends of the orbit, and is on it.
    fn follows(&self, orbit: Orbit) -> bool {
        let turns_at = |time: &Double| {
            let piece = self.pieces.list().get(self.pieces.find(*time, 0));
            piece.is_some_and(|Piece { begin, segment }| segment.turns_at(time.since(*begin)))
        };
        let [first, second] = orbit.turns();
        self.direction.abs() == 1.0
            && self.first_turn == Some(first)
            && second.since(self.end()) <= 0.0
            && orbit.is_sound()
            && [self.now, self.last_unseen()]
                .iter()
                .all(|time| orbit.holds(*time))
            && [first, second].iter().all(turns_at)
    }

    /// Whether the present, and what is recorded, lie between the limits.
    fn is_between_limits(&self) -> bool {
        let Limits { lower, upper } = self.limits;
        let range = lower - ROUNDING * lower.abs()..=upper + ROUNDING * upper.abs();
        let recorded = self.extremes.is_none_or(|Extremes { lowest, highest }| {
            lowest <= highest && range.contains(&lowest) && range.contains(&highest)
        });
        recorded && range.contains(&self.position()) && self.rate().is_finite()
    }
}
