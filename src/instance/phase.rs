//! The phases in the life of an instance. The room of a standard says which of its calls they permit.

use serde::{Deserialize, Serialize};

/// The kinds of FMU that an instance can be.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Interface {
    /// The actuator integrates its motion itself.
    CoSimulation,
    /// The host integrates it.
    ModelExchange,
}

/// The states of an instance. Calls return when they are done, so "step in
/// progress" and "step canceled" do not occur.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Phase {
    /// As it was made, or after a reset.
    Instantiated,
    /// Between entering and exiting initialization mode.
    Initialization,
    /// Co-simulation: at a communication point.
    StepComplete,
    /// Co-simulation: after a step that was discarded.
    StepFailed,
    /// Model exchange: at an event.
    EventMode,
    /// Model exchange: between events.
    ContinuousTime,
    /// After the end.
    Terminated,
    /// After a fatal error.
    Fatal,
}

impl Phase {
    /// Whether initialization has ended.
    #[must_use]
    #[inline]
    pub fn has_begun(self) -> bool {
        !matches!(self, Phase::Instantiated | Phase::Initialization)
    }

    /// The phase in words, for messages.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Phase::Instantiated => "instantiated",
            Phase::Initialization => "initialization mode",
            Phase::StepComplete => "step complete",
            Phase::StepFailed => "step failed",
            Phase::EventMode => "event mode",
            Phase::ContinuousTime => "continuous-time mode",
            Phase::Terminated => "terminated",
            Phase::Fatal => "fatal error",
        }
    }
}
