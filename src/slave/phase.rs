//! Which call is allowed when (FMI 2.0, section 4.2.4, state machine of
//! co-simulation).

/// The states of a co-simulation slave. Calls return when they are done, so
/// "step in progress" and "step canceled" do not occur.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Phase {
    /// After `fmi2Instantiate` or `fmi2Reset`.
    Instantiated,
    /// Between entering and exiting initialization mode.
    Initialization,
    /// At a communication point.
    StepComplete,
    /// After a step that was discarded.
    StepFailed,
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
    /// `fmi2SetRealInputDerivatives`.
    SetInputDerivatives,
    /// `fmi2GetRealOutputDerivatives`.
    GetOutputDerivatives,
    /// `fmi2DoStep`.
    DoStep,
    /// `fmi2GetStatus` and its like.
    GetStatus,
    /// A function that this unit does not offer.
    NotOffered,
}

impl Phase {
    /// Whether `call` is allowed in this phase.
    #[must_use]
    pub fn permits(self, call: Call) -> bool {
        use Phase::{Fatal, Initialization, Instantiated, StepComplete, StepFailed, Terminated};
        match call {
            Call::SetDebugLogging | Call::Reset | Call::NotOffered => self != Fatal,
            Call::SetupExperiment | Call::EnterInitialization => self == Instantiated,
            Call::ExitInitialization => self == Initialization,
            Call::Set | Call::SetInputDerivatives => {
                matches!(self, Instantiated | Initialization | StepComplete)
            }
            Call::Get => matches!(
                self,
                Initialization | StepComplete | StepFailed | Terminated
            ),
            Call::GetOutputDerivatives | Call::GetStatus => {
                matches!(self, StepComplete | StepFailed | Terminated)
            }
            Call::DoStep => self == StepComplete,
            Call::Terminate => matches!(self, StepComplete | StepFailed),
        }
    }

    /// The phase in words, for messages.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Phase::Instantiated => "instantiated",
            Phase::Initialization => "initialization mode",
            Phase::StepComplete => "step complete",
            Phase::StepFailed => "step failed",
            Phase::Terminated => "terminated",
            Phase::Fatal => "fatal error",
        }
    }
}
