//! One actuator for the live page, stepped as a host of co-simulation steps it: variables by their value
//! references, in nondimensional numbers. The [`curves`] that the page draws are beside.
//!
//! A page has one actuator, which lives here; nothing but numbers crosses the border. A call that is
//! refused changes nothing and answers false; [`actuator_message`] then tells why.
#![expect(unsafe_code, reason = "exported names: no function here is unsafe")]

pub mod curves;
mod equilibrium;

use std::cell::RefCell;
use std::f64::consts::TAU;
use std::mem;

use dielectric_elastomer_actuator::actuator::motion::Load;
use dielectric_elastomer_actuator::actuator::scales::{Scales, SiDevice};
use dielectric_elastomer_actuator::actuator::{Coefficients, Parameters};
use dielectric_elastomer_actuator::instance::{Fault, Instance, Message, Type};
use dielectric_elastomer_actuator::model::variables::{Kind, value_reference};
use dielectric_elastomer_actuator::nondimensional::{Nondimensional, VARIABLES};

struct Page {
    actuator: Instance<Nondimensional>,
    /// The actuator before the last reset, until the next motion has begun.
    before: Option<Instance<Nondimensional>>,
    /// What the last device was folded to.
    folded: [f64; 8],
    /// What the last call that had something to say said.
    text: String,
}

thread_local! {
    static PAGE: RefCell<Page> = RefCell::new(Page {
        actuator: Instance::new(),
        before: None,
        folded: [f64::NAN; 8],
        text: String::new(),
    });
}

fn with<T>(act: impl FnOnce(&mut Page) -> T) -> T {
    PAGE.with_borrow_mut(act)
}

impl Page {
    /// Whether a call went through; what it had to say is kept.
    fn settle(&mut self, outcome: Result<Option<Message>, Fault>) -> bool {
        let (went_through, text) = match outcome {
            Ok(message) => (true, message.map_or(String::new(), |message| message.text)),
            Err(fault) => (false, fault.text),
        };
        self.text = text;
        went_through
    }

    fn get(&self, reference: u32) -> f64 {
        let mut value = f64::NAN;
        if let Some(kind) = type_of(reference) {
            let read = self
                .actuator
                .get(kind, &[reference], |_, number| value = number);
            if read.is_err() {
                return f64::NAN;
            }
        }
        value
    }
}

/// The FMI type of a variable.
fn type_of(reference: u32) -> Option<Type> {
    let variable = VARIABLES.get(reference as usize)?;
    Some(match variable.kind {
        Kind::Real { .. } => Type::Real,
        Kind::Boolean => Type::Boolean,
        Kind::Enumeration(_) => Type::Integer,
    })
}

/// The value reference of a variable of the table.
fn reference_of(name: &str) -> u32 {
    value_reference::<Nondimensional>(name).unwrap_or(u32::MAX)
}

/// Smallest and largest value of a variable of the table; NaN where it has none.
fn limits_of(reference: u32) -> [f64; 2] {
    let variable = VARIABLES.get(reference as usize);
    match variable.map(|variable| variable.kind) {
        Some(Kind::Real { min, max, .. }) => [min, max],
        _ => [f64::NAN; 2],
    }
}

const UNLOADED: Load<f64> = Load {
    voltage_squared: 0.0,
    prestress: 0.0,
};

/// Puts the names of all variables, a line each in the order of their value references, into the message.
#[unsafe(no_mangle)]
pub extern "C" fn actuator_variables() {
    let names: Vec<&str> = VARIABLES.iter().map(|variable| variable.name).collect();
    with(|page| page.text = names.join("\n"));
}

/// Address of the message, UTF-8.
#[unsafe(no_mangle)]
pub extern "C" fn actuator_message() -> *const u8 {
    with(|page| page.text.as_ptr())
}

/// Length of the message in bytes.
#[unsafe(no_mangle)]
pub extern "C" fn actuator_message_length() -> usize {
    with(|page| page.text.len())
}

/// Smallest value of the variable of a value reference.
#[unsafe(no_mangle)]
pub extern "C" fn actuator_least(reference: u32) -> f64 {
    limits_of(reference)[0]
}

/// Largest value of the variable of a value reference.
#[unsafe(no_mangle)]
pub extern "C" fn actuator_most(reference: u32) -> f64 {
    limits_of(reference)[1]
}

/// Folds a device in SI units. Address of eight numbers: the units of time, voltage and stress in SI units, the
/// period of small oscillations about λ = 1 without load and surface effects, c, `gamma_s`, `tau_s`, `E_s`.
#[unsafe(no_mangle)]
pub extern "C" fn actuator_fold(
    shear_modulus: f64,
    density: f64,
    relative_permittivity: f64,
    thickness: f64,
    side: f64,
    surface_energy: f64,
    surface_tension: f64,
    surface_elasticity: f64,
) -> *const f64 {
    let sizes = [thickness, side];
    let device = SiDevice {
        surface_energy,
        surface_tension,
        surface_elasticity,
        ..SiDevice::sheet(shear_modulus, density, relative_permittivity, sizes)
    };
    let scales = Scales::of(&device);
    let Parameters {
        aspect,
        surface_energy,
        surface_tension,
        surface_elasticity,
    } = device.nondimensional().sheet;
    let bare = Coefficients::fold(&Parameters {
        aspect,
        surface_energy: 0.0,
        surface_tension: 0.0,
        surface_elasticity: 0.0,
    });
    with(|page| {
        page.folded = [
            scales.time,
            scales.voltage,
            shear_modulus,
            TAU / equilibrium::small_frequency(&bare, UNLOADED, 1.0),
            aspect,
            surface_energy,
            surface_tension,
            surface_elasticity,
        ];
        page.folded.as_ptr()
    })
}

/// An actuator before its initialization, at the start values.
#[unsafe(no_mangle)]
pub extern "C" fn actuator_reset() {
    with(|page| page.before = Some(mem::take(&mut page.actuator)));
}

/// Takes the last reset back, where no motion has begun since.
#[unsafe(no_mangle)]
pub extern "C" fn actuator_restore() {
    with(|page| {
        if let Some(before) = page.before.take() {
            page.actuator = before;
        }
    });
}

/// Ends the initialization; the motion begins at time 0, followed with this relative tolerance.
#[unsafe(no_mangle)]
pub extern "C" fn actuator_begin(tolerance: f64) -> bool {
    with(|page| {
        let actuator = &mut page.actuator;
        let outcome = actuator.setup_experiment(Some(tolerance), 0.0, None);
        let outcome = outcome.and_then(|message| {
            actuator.enter_initialization();
            actuator.exit_initialization().map(|()| message)
        });
        let has_begun = page.settle(outcome);
        if has_begun {
            page.before = None;
        }
        has_begun
    })
}

/// Sets the variable of a value reference.
#[unsafe(no_mangle)]
pub extern "C" fn actuator_set(reference: u32, value: f64) -> bool {
    with(|page| {
        // An unknown reference is refused with its message as a Real one.
        let kind = type_of(reference).unwrap_or(Type::Real);
        let outcome = page.actuator.set(kind, &[reference], |_| value);
        page.settle(outcome.map(|()| None))
    })
}

/// Reads the variable of a value reference; NaN where there is none.
#[unsafe(no_mangle)]
pub extern "C" fn actuator_get(reference: u32) -> f64 {
    with(|page| page.get(reference))
}

/// Moves the actuator by one communication step.
#[unsafe(no_mangle)]
pub extern "C" fn actuator_step(length: f64) -> bool {
    with(|page| {
        let time = page.actuator.last_successful_time();
        let outcome = page.actuator.do_step(time, length);
        page.settle(outcome)
    })
}

/// The present time.
#[unsafe(no_mangle)]
pub extern "C" fn actuator_time() -> f64 {
    with(|page| page.actuator.last_successful_time())
}

#[cfg(test)]
mod tests {
    use super::*;

    pub fn set_named(name: &str, value: f64) {
        assert!(actuator_set(reference_of(name), value), "{name}");
    }

    #[test]
    fn a_start_that_is_refused_is_taken_back() {
        actuator_reset();
        set_named("phi", 0.6);
        assert!(actuator_begin(1e-10) && actuator_step(3.0));
        let stretch = actuator_get(reference_of("lambda"));
        actuator_reset();
        assert!(!actuator_set(reference_of("c"), 1e13));
        actuator_restore();
        assert_eq!(actuator_get(reference_of("lambda")), stretch);
        assert_eq!(actuator_time(), 3.0);
        assert!(actuator_step(1.0));
        // What has begun is kept.
        actuator_reset();
        assert!(actuator_begin(1e-10));
        actuator_restore();
        assert_eq!(actuator_time(), 0.0);
    }

    #[test]
    fn the_limits_are_those_of_the_table() {
        let phi = reference_of("phi");
        assert!(!actuator_set(phi, 1.001 * actuator_most(phi)));
        assert!(actuator_set(phi, actuator_most(phi)) && actuator_set(phi, actuator_least(phi)));
        assert!(actuator_most(reference_of("pulled_in")).is_nan() && actuator_least(9999).is_nan());
    }

    #[test]
    fn what_is_refused_says_why() {
        actuator_reset();
        assert!(!actuator_set(reference_of("phi"), 1e9));
        assert!(with(|page| page.text.contains("phi")), "the value is named");
        assert!(!actuator_set(9999, 1.0) && actuator_get(9999).is_nan());
        assert!(!actuator_step(1.0));
    }
}
