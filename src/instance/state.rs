//! Saving an instance and going on from there, in this process or another.
//!
//! A saved instance is a row of bytes without pointers: everything that decides
//! how the simulation goes on, down to the history of the integrator.
//!
//! Whatever the bytes, restoring them gives an error, or an instance that answers
//! every call as any other does. Its numbers fit together: settings inside their
//! limits, a phase that goes with how far the simulation is, and a motion whose steps join, with
//! the present in one of them and between the limits of the stretch. That the
//! steps solve the equation of motion is not checked: bytes forged with care move
//! the actuator as they say, until an input or a parameter changes.

use super::{
    Experiment, Fault, Instance, Interface, Phase, Simulation, TOLERANCE_RANGE, check_time,
};
use crate::model::Model;
use crate::model::variables::Access;

/// Grows with each change of what the bytes mean.
pub const LAYOUT: u16 = 13;

impl<M: Model> Instance<M> {
    /// The instance as bytes, in the memory of `buffer`.
    ///
    /// # Errors
    /// Error where the memory does not suffice.
    pub fn save(&self, mut buffer: Vec<u8>) -> Result<Vec<u8>, Fault> {
        buffer.clear();
        postcard::to_extend(self, buffer)
            .map_err(|error| Fault::error(format!("the state cannot be saved: {error}")))
    }

    /// The instance that was saved as these bytes.
    ///
    /// # Errors
    /// Error where the bytes are none of [`Instance::save`], or an instance of
    /// another kind of FMU.
    pub fn saved(&self, bytes: &[u8]) -> Result<Instance<M>, Fault> {
        let damaged =
            |why: &str| Fault::error(format!("the state is damaged ({why}); save it again"));
        let (saved, rest) = postcard::take_from_bytes::<Instance<M>>(bytes)
            .map_err(|error| damaged(&error.to_string()))?;
        if !rest.is_empty() {
            return Err(damaged("it is too long"));
        }
        saved.check_validity().map_err(|why| damaged(&why))?;
        if saved.interface != self.interface {
            return Err(Fault::error(
                "the state is of an instance for another kind of FMU; co-simulation and model \
                 exchange have states of their own"
                    .into(),
            ));
        }
        Ok(saved)
    }

    /// Goes on from where the instance was saved as these bytes.
    ///
    /// # Errors
    /// As [`Instance::saved`]; then nothing changes.
    pub fn restore(&mut self, bytes: &[u8]) -> Result<(), Fault> {
        *self = self.saved(bytes)?;
        Ok(())
    }

    /// Checks that the numbers of an instance read from bytes fit together (see the
    /// head of this file).
    fn check_validity(&self) -> Result<(), String> {
        for variable in M::VARIABLES {
            if let Access::Setting { get, .. } = variable.access {
                variable.check(get(&self.scene))?;
            }
        }
        if !M::inputs_are_finite(&self.scene) {
            return Err("an input is not a finite number".into());
        }
        if !self.experiment.is_valid() {
            return Err("times or tolerance are out of range".into());
        }
        let before = !self.phase.has_begun();
        let matches_phase = match (&self.simulation, self.interface) {
            (Simulation::NotBegun, _) => before,
            (Simulation::Run(_), Interface::CoSimulation) => matches!(
                self.phase,
                Phase::StepComplete | Phase::StepFailed | Phase::Terminated
            ),
            (Simulation::Exchange(_), Interface::ModelExchange) => matches!(
                self.phase,
                Phase::EventMode | Phase::ContinuousTime | Phase::Terminated
            ),
            _ => false,
        };
        if !matches_phase {
            return Err("phase and motion do not belong together".into());
        }
        let valid = match &self.simulation {
            Simulation::NotBegun => true,
            Simulation::Run(run) => run.is_valid(&self.scene, self.experiment.tolerance),
            Simulation::Exchange(exchange) => exchange.is_valid(&self.scene),
        };
        if !valid {
            return Err("its numbers are not those of a motion".into());
        }
        Ok(())
    }
}

impl Experiment {
    fn is_valid(&self) -> bool {
        let [smallest, largest] = TOLERANCE_RANGE;
        let stop = self.stop_time.unwrap_or(self.start_time);
        check_time("start time", self.start_time).is_ok()
            && stop.is_finite()
            && stop >= self.start_time
            && (smallest..=largest).contains(&self.tolerance)
    }
}
