//! Which call is allowed when (FMI 2.0, sections 3.2.3 and 4.2.4: the state machines of model
//! exchange and co-simulation).

use crate::instance::{Fault, Instance, Interface, Phase, Severity};
use crate::model::Model;

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
    #[inline]
    fn is_part_of(self, interface: Interface) -> bool {
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

    /// Whether this phase permits it.
    #[inline]
    fn is_permitted_in(self, phase: Phase) -> bool {
        use Phase::{
            ContinuousTime, EventMode, Fatal, Initialization, Instantiated, StepComplete,
            StepFailed, Terminated,
        };
        match self {
            Call::FreeState => true,
            Call::SetDebugLogging | Call::Reset | Call::State => phase != Fatal,
            Call::SetupExperiment | Call::EnterInitialization => phase == Instantiated,
            Call::ExitInitialization => phase == Initialization,
            Call::Set => !matches!(phase, StepFailed | Terminated | Fatal),
            Call::SetInputDerivatives => {
                matches!(phase, Instantiated | Initialization | StepComplete)
            }
            Call::Get | Call::DirectionalDerivative => !matches!(phase, Instantiated | Fatal),
            Call::GetOutputDerivatives | Call::GetStatus => {
                matches!(phase, StepComplete | StepFailed | Terminated)
            }
            Call::DoStep => phase == StepComplete,
            Call::CancelStep => false,
            Call::EnterEventMode | Call::SetTime => matches!(phase, EventMode | ContinuousTime),
            Call::HandleEvent => phase == EventMode,
            Call::Integrate => phase == ContinuousTime,
            Call::GetContinuous => {
                matches!(
                    phase,
                    Initialization | EventMode | ContinuousTime | Terminated
                )
            }
            Call::GetNominals => {
                matches!(
                    phase,
                    Instantiated | EventMode | ContinuousTime | Terminated
                )
            }
            Call::Terminate => {
                matches!(
                    phase,
                    StepComplete | StepFailed | EventMode | ContinuousTime
                )
            }
        }
    }

    /// Whether the standard allows the call on this instance at present.
    #[inline]
    pub fn is_permitted<M: Model>(self, instance: &Instance<M>) -> bool {
        self.is_permitted_in(instance.phase()) && self.is_part_of(instance.interface())
    }

    /// Whether the standard allows the call on this instance at present, and why not.
    ///
    /// # Errors
    /// Error where it does not, Fatal after a fatal error.
    pub fn check<M: Model>(self, instance: &Instance<M>) -> Result<(), Fault> {
        if self.is_permitted(instance) {
            Ok(())
        } else {
            Err(self.refusal(instance.phase(), instance.interface()))
        }
    }

    /// Why the call is not allowed at present.
    #[cold]
    fn refusal(self, phase: Phase, interface: Interface) -> Fault {
        let severity = if phase == Phase::Fatal {
            Severity::Fatal
        } else {
            Severity::Error
        };
        let kind = match interface {
            Interface::CoSimulation => "co-simulation",
            Interface::ModelExchange => "model exchange",
        };
        let text = match self {
            Call::CancelStep => "no step is in progress: fmi2DoStep returns when it is done".into(),
            _ => format!("not allowed in the phase \"{}\" of {kind}", phase.name()),
        };
        Fault { severity, text }
    }
}
