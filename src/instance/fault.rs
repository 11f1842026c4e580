//! What a call answers when it cannot do as asked.

/// How a call ends that did not do what was asked, as a status of FMI.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Severity {
    /// The step ended early; the host should terminate.
    Discard,
    /// The call was refused and changed nothing.
    Error,
    /// The instance can no longer be used.
    Fatal,
}

/// Why a call did not do what was asked, in words for the host's log: the
/// value, the limit, and what to do.
#[derive(Clone, Debug, PartialEq)]
pub struct Fault {
    /// How the call ends.
    pub severity: Severity,
    /// What to tell the user.
    pub text: String,
}

impl Fault {
    /// A call that was refused.
    #[must_use]
    pub fn error(text: String) -> Fault {
        Fault {
            severity: Severity::Error,
            text,
        }
    }

    /// A step that ended early.
    #[must_use]
    pub fn discard(text: String) -> Fault {
        Fault {
            severity: Severity::Discard,
            text,
        }
    }
}

/// A line for the host's log from a call that succeeded.
#[derive(Clone, Debug, PartialEq)]
pub struct Message {
    /// Whether it is a warning; else it is an event of the simulation.
    pub warning: bool,
    /// What to tell the user.
    pub text: String,
}
