//! Saving an instance and going on from there, in this process or another.
//!
//! A saved instance is a row of bytes without pointers: everything that decides
//! how the simulation goes on, down to the history of the integrator.
//!
//! Whatever the bytes, reading them gives an error, or an instance that answers
//! every call as any other does. Its numbers fit together: settings inside their
//! limits, a phase that goes with how far the simulation is, and a motion whose steps join, with
//! the present in one of them and between the limits of the stretch. That the
//! steps solve the equation of motion is not checked: bytes that are forged with care give a wrong motion
//! until an input or a parameter changes.

use super::{
    Experiment, Fault, Instance, Interface, Phase, Simulation, TOLERANCE_RANGE, check_time,
};
use crate::model::Model;
use crate::model::variables::Access;

/// Grows with each change of what the bytes mean.
pub const LAYOUT: u16 = 22;

/// Bytes that are allocated for a first save. They are enlarged where they do not suffice.
const LEAST_ROOM: usize = 1024;

/// A saved instance, whose numbers fit together: it was saved by this process, or its bytes were
/// checked.
#[derive(Debug, Default, PartialEq)]
pub struct Saved {
    bytes: Vec<u8>,
}

impl Saved {
    /// The instance as bytes.
    #[must_use]
    pub fn bytes(&self) -> &[u8] {
        &self.bytes
    }
}

impl<M: Model> Instance<M> {
    /// Saves the present instance, in the memory of one that was saved before.
    ///
    /// # Errors
    /// Error where the memory does not suffice.
    pub fn save(&self, before: Saved) -> Result<Saved, Fault> {
        let mut bytes = before.bytes;
        bytes.resize(bytes.capacity().max(LEAST_ROOM), 0);
        loop {
            match postcard::to_slice(self, &mut bytes).map(|used| used.len()) {
                Ok(length) => {
                    bytes.truncate(length);
                    return Ok(Saved { bytes });
                }
                Err(postcard::Error::SerializeBufferFull) => bytes.resize(2 * bytes.len(), 0),
                Err(error) => {
                    return Err(Fault::error(format!("the state cannot be saved: {error}")));
                }
            }
        }
    }

    /// The instance that was saved as these bytes, which may come from anywhere.
    ///
    /// # Errors
    /// Error where the bytes are none of [`Instance::save`], or an instance of
    /// another kind of FMU.
    pub fn saved(&self, bytes: &[u8]) -> Result<Saved, Fault> {
        let saved = self.read(bytes)?;
        saved.check_validity().map_err(|why| damaged(&why))?;
        let bytes = bytes.to_vec();
        Ok(Saved { bytes })
    }

    /// Goes on from where an instance was saved.
    ///
    /// # Errors
    /// Error where it is of another kind of FMU; then nothing changes.
    pub fn restore(&mut self, saved: &Saved) -> Result<(), Fault> {
        *self = self.read(&saved.bytes)?;
        Ok(())
    }

    /// The instance of these bytes.
    fn read(&self, bytes: &[u8]) -> Result<Instance<M>, Fault> {
        let (saved, rest) = postcard::take_from_bytes::<Instance<M>>(bytes)
            .map_err(|error| damaged(&error.to_string()))?;
        if !rest.is_empty() {
            return Err(damaged("it is too long"));
        }
        if saved.interface != self.interface {
            return Err(Fault::error(
                "the state is of an instance for another kind of FMU; co-simulation and model \
                 exchange have states of their own"
                    .into(),
            ));
        }
        Ok(saved)
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

/// The bytes are not those of an instance.
#[cold]
fn damaged(why: &str) -> Fault {
    Fault::error(format!("the state is damaged ({why}); save it again"))
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
