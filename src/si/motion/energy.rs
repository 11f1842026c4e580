//! The energies of a motion in SI units that integrals and jumps of the source give.

use super::SiMotion;
use crate::actuator::device::{DeviceMotion, Exchanged};
use crate::arithmetic::double_double::DoubleDouble;
use crate::si::SiScene;
use crate::solver::coupled::{CoupledEquation, LocalCoupledEquation};

impl SiMotion {
    /// Energies lost and supplied since the start in J; 0 where they are not recorded. Where an ideal source has
    /// jumped since the last advance, the energy of the jump is included.
    #[must_use]
    pub fn exchanged(&self, scene: &SiScene, time: &DoubleDouble) -> Exchanged {
        let mut sums = self.trajectory.integrals();
        if !(self.stale && self.motion.records_energy) {
            return Exchanged::from_integrals(&sums.map(|sum| sum * self.scales.energy));
        }
        let jump = if self.follows(scene) {
            let motion = DeviceMotion {
                drive: scene.drive(&self.scales),
                ..self.motion
            };
            let jump = self.at_present(time, |local, stage| {
                let (origin, _) = self.stretch_from_origin();
                let now = motion.at(&self.reached(time), &origin);
                now.exchanged_by_step(local.load(0.0).source, stage).all()
            });
            jump.map(|energy| energy * self.scales.energy)
        } else {
            let state = self.carried_over(time);
            scene.exchanged_at_once(time, &state, state.charge)
        };
        for (sum, jump) in sums.iter_mut().zip(jump) {
            *sum = *sum * self.scales.energy + jump;
        }
        Exchanged::from_integrals(&sums)
    }

    /// Adds the energy that an ideal source exchanges at once when it meets this charge, in C, on the electrodes.
    pub(super) fn book_charging(&mut self, scene: &SiScene, time: &DoubleDouble, charge: f64) {
        let capacitance = self.at_present(time, |local, stage| {
            local.capacitance(local.stretch(stage.position))
        });
        let before = scene.source_before(&self.scales, charge, capacitance);
        self.book_step(time, before);
    }

    /// Adds the energy that an ideal source exchanges at once when it jumps from this nondimensional value.
    pub(super) fn book_step(&mut self, time: &DoubleDouble, before: f64) {
        if !self.motion.records_energy {
            return;
        }
        let exchanged =
            self.at_present(time, |local, stage| local.exchanged_by_step(before, stage));
        self.trajectory.book(&exchanged.all());
    }
}
