//! The host of an instance: its logger, and the statuses that calls return.

use std::ffi::{CStr, CString};

use fmi::fmi2::binding::{
    fmi2CallbackFunctions, fmi2Status, fmi2Status_fmi2Discard, fmi2Status_fmi2Error,
    fmi2Status_fmi2Fatal, fmi2Status_fmi2OK, fmi2Status_fmi2Warning,
};

use crate::description::LOG_CATEGORIES;
use crate::instance::{Fault, Message, Severity};

/// Log categories by their place in [`LOG_CATEGORIES`].
const EVENTS: usize = 0;
const WARNINGS: usize = 1;
const ERRORS: usize = 2;

/// The logger of a host and the categories that are switched on.
pub struct Host {
    /// Copied by value: hosts may free or reuse the structure that they passed.
    callbacks: fmi2CallbackFunctions,
    name: CString,
    enabled: [bool; LOG_CATEGORIES.len()],
}

impl Host {
    pub fn new(callbacks: fmi2CallbackFunctions, name: &CStr, logging_on: bool) -> Host {
        let mut enabled = [true; LOG_CATEGORIES.len()];
        enabled[EVENTS] = logging_on;
        Host {
            callbacks,
            name: name.to_owned(),
            enabled,
        }
    }

    /// Switches the listed categories on and the others off, or all of them where none is listed. Where logging is
    /// switched off, the list does not matter (FMI 2.0, section 2.1.5).
    pub fn set_logging(&mut self, on: bool, categories: &[&CStr]) -> Result<(), Fault> {
        let mut enabled = [on && categories.is_empty(); LOG_CATEGORIES.len()];
        for wanted in categories {
            let known = LOG_CATEGORIES
                .iter()
                .position(|(name, _)| name.as_bytes() == wanted.to_bytes());
            let Some(place) = known else {
                let names = LOG_CATEGORIES.map(|(name, _)| name).join(", ");
                return Err(Fault::error(format!(
                    "there is no log category of that name; there are {names}"
                )));
            };
            enabled[place] = on;
        }
        self.enabled = enabled;
        Ok(())
    }

    fn log(&self, status: fmi2Status, category: usize, text: &str) {
        let Some(logger) = self.callbacks.logger else {
            return;
        };
        if !self.enabled[category] {
            return;
        }
        // The host takes the text for a printf format.
        let text: String = text.chars().filter(|&c| c != '%' && c != '\0').collect();
        let (Ok(category), Ok(text)) =
            (CString::new(LOG_CATEGORIES[category].0), CString::new(text))
        else {
            return;
        };
        // SAFETY: the logger is a function of the host with this signature
        // (FMI 2.0, section 2.1.5), all texts end with NUL and outlive the
        // call, and the format has no conversion that would ask for arguments.
        unsafe {
            logger(
                self.callbacks.componentEnvironment,
                self.name.as_ptr(),
                status,
                category.as_ptr(),
                text.as_ptr(),
            );
        }
    }

    /// Logs why a call was not done, and gives its status.
    #[cold]
    pub fn refuse(&self, function: &str, fault: Fault) -> fmi2Status {
        let status = match fault.severity {
            Severity::Discard => fmi2Status_fmi2Discard,
            Severity::Error => fmi2Status_fmi2Error,
            Severity::Fatal => fmi2Status_fmi2Fatal,
        };
        self.log(status, ERRORS, &format!("{function}: {}", fault.text));
        status
    }

    /// Logs a message of a call that succeeded, and gives its status.
    #[cold]
    pub fn announce(&self, function: &str, message: Message) -> fmi2Status {
        let (status, category) = if message.warning {
            (fmi2Status_fmi2Warning, WARNINGS)
        } else {
            (fmi2Status_fmi2OK, EVENTS)
        };
        self.log(status, category, &format!("{function}: {}", message.text));
        status
    }
}
