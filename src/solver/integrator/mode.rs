//! The modes of following a motion.

use serde::{Deserialize, Serialize};

use crate::arithmetic::double_double::DoubleDouble;
use crate::solver::orbit::Orbit;

/// How a motion goes on from its start, as far as it is known.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub enum Mode<L> {
    /// By steps, one after another.
    Dense {
        /// The first turning point, where an orbit is looked for.
        first_turn: Option<DoubleDouble>,
        /// The first event, and its time.
        stop: Option<(L, DoubleDouble)>,
    },
    /// There and back between two turning points for ever: no further step is integrated.
    Periodic {
        /// The turning points.
        orbit: Orbit,
        /// −1 on the way back, else 1.
        direction: f64,
    },
    /// Not at all.
    AtRest,
}

impl<L> Mode<L> {
    /// Nothing is known.
    pub const UNKNOWN: Mode<L> = Mode::Dense {
        first_turn: None,
        stop: None,
    };

    /// The sign of the time's direction along the kept steps.
    #[inline(always)]
    pub(super) fn direction(&self) -> f64 {
        match self {
            Mode::Periodic { direction, .. } => *direction,
            Mode::Dense { .. } | Mode::AtRest => 1.0,
        }
    }

    /// Along which it runs there and back.
    pub(super) fn orbit(&self) -> Option<Orbit> {
        match self {
            Mode::Periodic { orbit, .. } => Some(*orbit),
            Mode::Dense { .. } | Mode::AtRest => None,
        }
    }
}
