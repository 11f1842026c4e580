//! Where a motion comes to the end of the range in which it is followed.

use std::ops::RangeInclusive;

use super::segment::Segment;

/// The range of positions inside which the motion is followed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits {
    /// The motion stops where it comes down to this position.
    pub lower: f64,
    /// The motion stops where it comes up to this position.
    pub upper: f64,
}

/// Which limit has been reached.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Limit {
    /// The lower one.
    Lower,
    /// The upper one.
    Upper,
}

/// Parts of a segment in each of which the motion turns at most once.
const PARTS: usize = 32;

impl Limits {
    /// The limit that the motion first meets in the segment, and the offset
    /// at which it does, to rounding. `nodes` is the range of positions at the
    /// nodes of the segment.
    #[must_use]
    pub fn first_contact(
        &self,
        segment: &mut Segment,
        nodes: RangeInclusive<f64>,
    ) -> Option<(Limit, f64)> {
        // Between two nodes the motion may go a little beyond both.
        let beyond = 0.25 * (nodes.end() - nodes.start());
        let (limit, level, sign) = if nodes.end() + beyond >= self.upper {
            (Limit::Upper, self.upper, 1.0)
        } else if nodes.start() - beyond <= self.lower {
            (Limit::Lower, self.lower, -1.0)
        } else {
            return None;
        };
        segment.expand();
        let over = |s: &Segment, t: f64| sign * (s.position(t) - level);
        let toward = |s: &Segment, t: f64| sign * s.rate(t);
        let part = segment.length() / PARTS as f64;
        for i in 0..PARTS {
            let (from, to) = (i as f64 * part, (i + 1) as f64 * part);
            if over(segment, from) >= 0.0 {
                return Some((limit, from));
            }
            let turns = toward(segment, from) > 0.0 && toward(segment, to) < 0.0;
            let farthest = if turns && over(segment, to) < 0.0 {
                segment.crossing(from, to, toward)
            } else {
                to
            };
            if over(segment, farthest) >= 0.0 {
                return Some((limit, segment.crossing(from, farthest, over)));
            }
        }
        None
    }
}
