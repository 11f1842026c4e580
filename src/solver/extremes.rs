//! How far a motion has swung to both sides.

use serde::{Deserialize, Serialize};

/// The smallest and the largest position that a motion has taken.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Extremes {
    /// The smallest position.
    pub lowest: f64,
    /// The largest position.
    pub highest: f64,
}

impl Extremes {
    /// The extremes of a motion that has only been at this position.
    pub fn at(position: f64) -> Extremes {
        Extremes {
            lowest: position,
            highest: position,
        }
    }

    /// Takes a further position into account.
    pub fn include(&mut self, position: f64) {
        self.lowest = self.lowest.min(position);
        self.highest = self.highest.max(position);
    }

    /// Takes another motion, or another part of this one, into account.
    pub fn include_all(&mut self, other: Extremes) {
        self.include(other.lowest);
        self.include(other.highest);
    }

    /// Whether the numbers can be those of a motion.
    pub fn is_valid(&self) -> bool {
        self.lowest <= self.highest && self.lowest.is_finite() && self.highest.is_finite()
    }
}
