//! Which call is allowed when (FMI 2.0, sections 3.2.3 and 4.2.4, the state
//! machines of model exchange and co-simulation).

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
    /// After `fmi2Instantiate` or `fmi2Reset`.
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
    /// After `fmi2Terminate`.
    Terminated,
    /// After a fatal error.
    Fatal,
}

/// A kind of call that is not allowed in every phase.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Call {
    /// `fmi2SetDebugLogging`.
    SetDebugLogging,
    /// `fmi2SetupExperiment`.
    SetupExperiment,
    /// `fmi2EnterInitializationMode`.
    EnterInitialization,
    /// `fmi2ExitInitializationMode`.
    ExitInitialization,
    /// `fmi2Terminate`.
    Terminate,
    /// `fmi2Reset`.
    Reset,
    /// `fmi2GetReal` and its like.
    Get,
    /// `fmi2SetReal` and its like; the variability decides further.
    Set,
    /// `fmi2GetFMUstate`, `fmi2SerializeFMUstate` and their like.
    State,
    /// `fmi2FreeFMUstate`.
    FreeState,
    /// `fmi2GetDirectionalDerivative`.
    DirectionalDerivative,
    /// `fmi2SetRealInputDerivatives`.
    SetInputDerivatives,
    /// `fmi2GetRealOutputDerivatives`.
    GetOutputDerivatives,
    /// `fmi2DoStep`.
    DoStep,
    /// `fmi2CancelStep`.
    CancelStep,
    /// `fmi2GetStatus` and its like.
    GetStatus,
    /// `fmi2EnterEventMode`.
    EnterEventMode,
    /// `fmi2NewDiscreteStates` or `fmi2EnterContinuousTimeMode`.
    HandleEvent,
    /// `fmi2CompletedIntegratorStep` or `fmi2SetContinuousStates`.
    Integrate,
    /// `fmi2SetTime`.
    SetTime,
    /// `fmi2GetContinuousStates`, `fmi2GetDerivatives` or `fmi2GetEventIndicators`.
    GetContinuous,
    /// `fmi2GetNominalsOfContinuousStates`.
    GetNominals,
}

impl Call {
    /// Whether an instance of this kind of FMU has such a call.
    #[must_use]
    #[inline]
    pub fn is_part_of(self, interface: Interface) -> bool {
        match self {
            Call::SetInputDerivatives
            | Call::GetOutputDerivatives
            | Call::DoStep
            | Call::CancelStep
            | Call::GetStatus => interface == Interface::CoSimulation,
            Call::EnterEventMode
            | Call::HandleEvent
            | Call::Integrate
            | Call::SetTime
            | Call::GetContinuous
            | Call::GetNominals => interface == Interface::ModelExchange,
            _ => true,
        }
    }
}

impl Phase {
    /// Whether `call` is allowed in this phase.
    #[must_use]
    #[inline]
    pub fn permits(self, call: Call) -> bool {
        use Phase::{
            ContinuousTime, EventMode, Fatal, Initialization, Instantiated, StepComplete,
            StepFailed, Terminated,
        };
        match call {
            Call::FreeState => true,
            Call::SetDebugLogging | Call::Reset | Call::State => self != Fatal,
            Call::SetupExperiment | Call::EnterInitialization => self == Instantiated,
            Call::ExitInitialization => self == Initialization,
            Call::Set => !matches!(self, StepFailed | Terminated | Fatal),
            Call::SetInputDerivatives => {
                matches!(self, Instantiated | Initialization | StepComplete)
            }
            Call::Get | Call::DirectionalDerivative => !matches!(self, Instantiated | Fatal),
            Call::GetOutputDerivatives | Call::GetStatus => {
                matches!(self, StepComplete | StepFailed | Terminated)
            }
            Call::DoStep => self == StepComplete,
            Call::CancelStep => false,
            Call::EnterEventMode | Call::SetTime => matches!(self, EventMode | ContinuousTime),
            Call::HandleEvent => self == EventMode,
            Call::Integrate => self == ContinuousTime,
            Call::GetContinuous => {
                matches!(
                    self,
                    Initialization | EventMode | ContinuousTime | Terminated
                )
            }
            Call::GetNominals => {
                matches!(self, Instantiated | EventMode | ContinuousTime | Terminated)
            }
            Call::Terminate => {
                matches!(self, StepComplete | StepFailed | EventMode | ContinuousTime)
            }
        }
    }

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
