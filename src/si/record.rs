//! What is recorded where the host integrates, in steps of its own.

use serde::{Deserialize, Serialize};

use super::{Si, SiScene, SiState};
use crate::model::Record;
use crate::nondimensional::recording::turn_between;
use crate::solver::State;
use crate::solver::double::Double;
use crate::solver::extremes::Extremes;

/// The extremes of the stretch, and the host's last step.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct SiRecord {
    /// The extremes, where they are recorded.
    pub extremes: Option<Extremes>,
    time: Double,
    motion: State,
}

impl Default for SiRecord {
    fn default() -> SiRecord {
        SiRecord {
            extremes: None,
            time: Double::ZERO,
            motion: State {
                position: 1.0,
                rate: 0.0,
            },
        }
    }
}

impl Record<Si> for SiRecord {
    fn begin(scene: &SiScene, time: Double, state: SiState) -> SiRecord {
        let motion = state.motion;
        SiRecord {
            extremes: scene
                .records_extremes()
                .then(|| Extremes::at(motion.position)),
            time,
            motion,
        }
    }

    /// Inside the step the motion is that on the cubic through both ends.
    fn include_step(&mut self, scene: &SiScene, time: Double, state: SiState) {
        if let Some(turn) = turn_between(self.motion, state.motion, time.since(self.time)) {
            self.include_position(scene, turn);
        }
        self.include(scene, time, state);
    }

    fn include(&mut self, scene: &SiScene, time: Double, state: SiState) {
        self.include_position(scene, state.motion.position);
        (self.time, self.motion) = (time, state.motion);
    }

    fn is_valid(&self, scene: &SiScene) -> bool {
        let State { position, rate } = self.motion;
        let extremes = self.extremes.is_none_or(|Extremes { lowest, highest }| {
            lowest <= highest && lowest.is_finite() && highest.is_finite()
        });
        position.is_finite()
            && rate.is_finite()
            && self.time.is_finite()
            && extremes
            && self.extremes.is_some() == scene.records_extremes()
    }
}

impl SiRecord {
    /// A host may step beyond the limits before it handles the event there.
    fn include_position(&mut self, scene: &SiScene, position: f64) {
        if let Some(extremes) = &mut self.extremes {
            extremes.include(position.clamp(scene.limits.lower, scene.limits.upper));
        }
    }
}
