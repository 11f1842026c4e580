//! Where a motion comes to the end of the range in which it is followed.

use std::ops::RangeInclusive;

use serde::{Deserialize, Serialize};

use super::State;
use super::dense_output::{PARTS, Segment};
use crate::arithmetic::roots::crossing;

/// The range of positions inside which the motion is followed.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Limits {
    /// The motion stops where it comes down to this position.
    pub lower: f64,
    /// The motion stops where it comes up to this position.
    pub upper: f64,
}

/// Which limit has been reached.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum Limit {
    /// The lower one.
    Lower,
    /// The upper one.
    Upper,
}

impl Limits {
    /// Whether there is room between the limits.
    pub fn are_valid(&self) -> bool {
        self.lower < self.upper && self.lower.is_finite() && self.upper.is_finite()
    }

    /// The position between the limits that is the nearest to this one. `f64::clamp` would bring along what
    /// prints its numbers in a panic.
    pub fn nearest(&self, position: f64) -> f64 {
        if position < self.lower {
            self.lower
        } else if position > self.upper {
            self.upper
        } else {
            position
        }
    }

    /// The limit that lies less than `tolerance`, relative to it, before a state that moves towards
    /// it, or behind the state.
    pub fn reached(&self, state: &State, tolerance: f64) -> Option<Limit> {
        let &State { position, rate } = state;
        let margin = |toward: f64| if toward > 0.0 { tolerance } else { 0.0 };
        if position >= self.upper * (1.0 - margin(rate)) {
            Some(Limit::Upper)
        } else if position <= self.lower * (1.0 + margin(-rate)) {
            Some(Limit::Lower)
        } else {
            None
        }
    }

    /// The limit that the motion first meets in the segment, and the offset
    /// at which it does, to rounding. `reach` is the range that holds the motion.
    pub fn first_contact(
        &self,
        segment: &mut Segment,
        reach: RangeInclusive<f64>,
    ) -> Option<(Limit, f64)> {
        let upper = *reach.end() >= self.upper;
        let lower = *reach.start() <= self.lower;
        if !upper && !lower {
            return None;
        }
        segment.expand();
        let upper = upper.then(|| contact(segment, self.upper, 1.0)).flatten();
        let lower = lower.then(|| contact(segment, self.lower, -1.0)).flatten();
        match (upper, lower) {
            (Some(up), Some(down)) if down < up => Some((Limit::Lower, down)),
            (Some(up), _) => Some((Limit::Upper, up)),
            (None, Some(down)) => Some((Limit::Lower, down)),
            (None, None) => None,
        }
    }

    /// Whether these positions are so far out that a substep with them says
    /// nothing about where it crossed a limit, nor perhaps about the motion:
    /// an equation may be singular out there.
    pub fn are_left_behind_by(&self, nodes: RangeInclusive<f64>) -> bool {
        let margin = 0.5 * (self.upper - self.lower);
        *nodes.end() > self.upper + margin || *nodes.start() < 0.5 * self.lower
    }
}

/// The offset at which the motion first goes through `level` from below (`sign` 1)
/// or from above (`sign` −1).
fn contact(segment: &Segment, level: f64, sign: f64) -> Option<f64> {
    let over = |s: &Segment, t: f64| sign * (s.position(t) - level);
    let toward = |s: &Segment, t: f64| sign * s.rate(t);
    let part = segment.length() / PARTS as f64;
    // The polynomial rounds a start next to the level onto it.
    let State { position, rate } = segment.start();
    if sign * (position - level) >= 0.0 && sign * rate > 0.0 {
        return Some(0.0);
    }
    for i in 0..PARTS {
        let (begin, end) = (i as f64 * part, (i + 1) as f64 * part);
        let [first, last] = [begin, end].map(|t| toward(segment, t));
        let turn = || crossing(begin, end, |t| toward(segment, t));
        // Nothing is gone through on the way back.
        let farthest = match first > 0.0 && last < 0.0 {
            true => turn(),
            false if last >= 0.0 && first.max(last) > 0.0 => end,
            false => continue,
        };
        if over(segment, farthest) >= 0.0 {
            let nearest = if first < 0.0 { turn() } else { begin };
            return Some(crossing(nearest, farthest, |t| over(segment, t)));
        }
    }
    None
}
