//! How long the next equal steps may be.

use serde::{Deserialize, Serialize};

use super::plan::NODES;
use crate::solver::step_control::factor;

/// Order of the error at the end of a step.
pub const ORDER: f64 = 2.0 * NODES as f64;

/// Contraction above which shorter steps are cheaper.
const SLOW: f64 = 0.25;

/// Steps after which their length is looked at, and by which part it must be too long or too short
/// to be changed: a new plan costs as much as a step.
const CALM: u32 = 8;
const TOO_LONG: f64 = 0.96;
const TOO_SHORT: f64 = 1.25;

/// The worst of the steps since the length was looked at: its error as a part of what is allowed,
/// and its contraction.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub struct Seen {
    pub steps: u32,
    pub error: f64,
    pub contraction: f64,
}

impl Seen {
    pub const NOTHING: Seen = Seen {
        steps: 0,
        error: 0.0,
        contraction: 0.0,
    };

    /// Whether the numbers can be those of steps.
    pub fn is_valid(&self) -> bool {
        self.error >= 0.0 && self.contraction >= 0.0 && self.steps <= CALM
    }

    /// By which factor steps may be longer.
    #[inline(always)]
    fn factor(&self) -> f64 {
        factor(self.error, ORDER).min((SLOW / self.contraction.max(1e-6)).sqrt())
    }

    /// After enough steps of this `length`, how long they should be from now on if that is another
    /// length than is `wanted`, which they have when the way allows it.
    #[inline(always)]
    pub fn another_length(&mut self, length: f64, wanted: f64) -> Option<f64> {
        if self.steps < CALM {
            return None;
        }
        let next = self.factor() * length;
        *self = Seen::NOTHING;
        if next < TOO_LONG * length {
            Some(next)
        } else if next > TOO_SHORT * wanted {
            Some(next.min(2.0 * length).max(wanted))
        } else {
            None
        }
    }
}
