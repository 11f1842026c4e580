//! Whether numbers fit together as those of a motion that has been followed.

use serde::{Deserialize, Deserializer};

use super::piece::Rest;
use super::trajectory::{CAPACITY, Piece, Trajectory};
use crate::solver::double::Double;
use crate::solver::limits::Limits;
use crate::solver::segment::ROUNDING;

impl Trajectory {
    /// Whether the numbers fit together: to be checked where they do not come from this process.
    /// Whether the pieces solve an equation is not looked at.
    #[must_use]
    pub fn is_sound(&self) -> bool {
        let inside = |time: &Double| {
            time.is_finite() && time.since(Double::ZERO) >= 0.0 && time.since(self.end()) <= 0.0
        };
        let first = self.pieces.first();
        let length = self.next_length.unwrap_or(1.0);
        self.control.is_sound()
            && self.limits.are_sound()
            && [self.time, self.since, self.origin]
                .iter()
                .all(Double::is_finite)
            && self.start.is_finite()
            && first.is_none_or(|piece| {
                piece.segment.begins_in(self.start.motion) && piece.origin == self.origin
            })
            && self.index < self.pieces.len().max(1)
            && inside(&self.now)
            && self.find(self.now, self.index) == self.index
            && self.recorded.is_finite()
            && (self.extremes.is_none() || inside(&self.recorded))
            && self.first_turn.iter().all(inside)
            && self
                .stop
                .is_none_or(|(_, at)| inside(&at) && at.since(self.now) >= 0.0)
            && match self.orbit {
                Some(orbit) => self.stop.is_none() && self.follows(orbit),
                None => self.direction == 1.0,
            }
            && (!self.at_rest || first.is_none() && self.start.motion.rate == 0.0)
            && length > 0.0
            && length.is_finite()
            && self.rest.as_ref().is_none_or(|rest| self.has(rest))
            && self.slopes_before.is_none_or(|(acceleration, slopes)| {
                acceleration.is_finite() && slopes.iter().all(|slope| slope.is_finite())
            })
            && self.is_between_limits()
    }

    /// Whether it is followed between these limits, with this tolerance.
    #[must_use]
    pub fn keeps_to(&self, limits: Limits, tolerance: f64) -> bool {
        self.limits == limits && self.control.tolerance == tolerance
    }

    /// Whether the first-order states belong to the only piece, and lead to their ends.
    fn has(&self, rest: &Rest) -> bool {
        let [piece] = self.pieces.as_slice() else {
            return false;
        };
        let leads = |start: f64, end: f64, slopes: &[f64]| {
            let gain = 2.0 * rest.half * slopes[0];
            let size: f64 = slopes.iter().map(|slope| slope.abs()).sum();
            let size = start.abs() + rest.half * size;
            size.is_finite() && (end - start - gain).abs() <= ROUNDING * size
        };
        let (start, end) = (&rest.start, &rest.end);
        let states = rest
            .slopes
            .iter()
            .zip(start.internal.iter().zip(&end.internal));
        let sums = rest
            .powers
            .iter()
            .zip(start.integrals.iter().zip(&end.integrals));
        2.0 * rest.half == piece.segment.length()
            && *start == self.start
            && end.motion == piece.segment.end()
            && { states }.all(|(slopes, (start, end))| leads(*start, *end, slopes))
            && { sums }.all(|(powers, (start, end))| leads(*start, *end, powers))
    }

    /// Whether the motion turns at the ends of the orbit, and is on it.
    fn follows(&self, orbit: crate::solver::orbit::Orbit) -> bool {
        let turns_at = |time: &Double| {
            let piece = self.pieces.get(self.find(*time, 0));
            piece.is_some_and(|piece| piece.segment.turns_at(time.since(piece.begin)))
        };
        let [first, second] = orbit.turns();
        self.direction.abs() == 1.0
            && self.first_turn == Some(first)
            && second.since(self.end()) <= 0.0
            && orbit.is_sound()
            && orbit.holds(self.now)
            && [first, second].iter().all(turns_at)
    }

    /// Whether the present, and what is recorded, lie between the limits.
    fn is_between_limits(&self) -> bool {
        let Limits { lower, upper } = self.limits;
        let range = lower - ROUNDING * lower.abs()..=upper + ROUNDING * upper.abs();
        let recorded = self.extremes.is_none_or(|extremes| {
            extremes.lowest <= extremes.highest
                && range.contains(&extremes.lowest)
                && range.contains(&extremes.highest)
        });
        recorded
            && range.contains(&self.position())
            && self.rate().is_finite()
            && self.internal().iter().all(|state| state.is_finite())
            && self.integrals().iter().all(|sum| sum.is_finite())
    }
}

/// Pieces that join, with room for as many as are kept.
pub(super) fn pieces<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Vec<Piece>, D::Error> {
    use serde::de::Error;
    let mut list = Vec::<Piece>::deserialize(deserializer)?;
    if list.len() > CAPACITY {
        return Err(D::Error::custom("more pieces than a trajectory keeps"));
    }
    let mut before: Option<Piece> = None;
    for piece in &mut list {
        let follows = match before {
            // Where the position is counted from may change in between.
            Some(last) => {
                let end = last.segment.end();
                piece.begin == last.end()
                    && (piece.origin != last.origin || piece.segment.begins_in(end))
            }
            None => piece.begin == Double::ZERO,
        };
        if !(piece.segment.is_sound() && piece.origin.is_finite() && follows) {
            return Err(D::Error::custom("a piece of the trajectory is damaged"));
        }
        piece.segment.expand();
        before = Some(*piece);
    }
    list.reserve_exact(CAPACITY - list.len());
    Ok(list)
}
