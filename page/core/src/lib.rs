//! One actuator for the live page, stepped as a host of co-simulation steps it: variables by their value
//! references, in nondimensional numbers. Besides, the curves that the page draws.
//!
//! A page has one actuator, which lives here; nothing but numbers crosses the border. A call that is
//! refused changes nothing and answers false; [`actuator_message`] then tells why.
#![expect(unsafe_code, reason = "exported names: no function here is unsafe")]

use std::cell::RefCell;

use dielectric_elastomer_actuator::actuator::Coefficients;
use dielectric_elastomer_actuator::actuator::motion::{Load, acceleration, energy};
use dielectric_elastomer_actuator::instance::{Fault, Instance, Message, Type};
use dielectric_elastomer_actuator::model::variables::{Kind, value_reference};
use dielectric_elastomer_actuator::nondimensional::{Nondimensional, VARIABLES};
use dielectric_elastomer_actuator::solver::State;

/// Next to λ = 1 the stagnation curve is taken at this distance from it, where 0/0 is far enough.
const NEAR_REST: f64 = 1e-5;

struct Page {
    actuator: Instance<Nondimensional>,
    /// What the last call that had something to say said.
    text: String,
}

thread_local! {
    static PAGE: RefCell<Page> = RefCell::new(Page {
        actuator: Instance::new(),
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

    /// The folded parameters and the prestress of the present, the voltage being 0.
    fn unloaded(&self) -> (Coefficients, Load<f64>) {
        let view = self.actuator.view();
        let load = Load {
            voltage_squared: 0.0,
            prestress: view.prestress(),
        };
        (Coefficients::fold(&view.scene.parameters), load)
    }

    /// The same under the present voltage.
    fn loaded(&self) -> (Coefficients, Load<f64>) {
        let (coefficients, load) = self.unloaded();
        let voltage = self.get(reference_of("phi_total"));
        let voltage_squared = voltage * voltage;
        (
            coefficients,
            Load {
                voltage_squared,
                ..load
            },
        )
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

fn at_rest(position: f64) -> State {
    State {
        position,
        rate: 0.0,
    }
}

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

/// An actuator before its initialization, at the start values.
#[unsafe(no_mangle)]
pub extern "C" fn actuator_reset() {
    with(|page| page.actuator.reset());
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
        page.settle(outcome)
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

/// φ² for which the motion from rest at λ = 1 turns at this stretch: the stagnation curve, Eq. 19.
#[unsafe(no_mangle)]
pub extern "C" fn actuator_stagnation(stretch: f64) -> f64 {
    with(|page| {
        let (coefficients, load) = page.unloaded();
        let off = stretch - 1.0;
        let off = if off.abs() < NEAR_REST {
            NEAR_REST
        } else {
            off
        };
        let electric = off * (2.0 + off) * ((1.0 + off) * (1.0 + off) + 1.0);
        energy(&coefficients, load, at_rest(1.0 + off)) / electric
    })
}

/// φ² that holds the actuator at this stretch: the equilibrium curve, Eq. 16 at rest.
#[unsafe(no_mangle)]
pub extern "C" fn actuator_equilibrium(stretch: f64) -> f64 {
    with(|page| {
        let (coefficients, load) = page.unloaded();
        let force = |voltage_squared: f64| {
            let load = Load {
                voltage_squared,
                ..load
            };
            acceleration(&coefficients, load, stretch, 0.0)
        };
        // The force is linear in φ².
        force(0.0) / (force(0.0) - force(1.0))
    })
}

/// The Hamiltonian of the actuator at rest at this stretch, under the present voltage and prestress.
#[unsafe(no_mangle)]
pub extern "C" fn actuator_potential(stretch: f64) -> f64 {
    with(|page| {
        let (coefficients, load) = page.loaded();
        energy(&coefficients, load, at_rest(stretch))
    })
}

/// The stretch rate with which a motion of this Hamiltonian passes a stretch; NaN where it does not get there.
#[unsafe(no_mangle)]
pub extern "C" fn actuator_rate_of_passage(stretch: f64, hamiltonian: f64) -> f64 {
    with(|page| {
        let (coefficients, load) = page.loaded();
        let resting = energy(&coefficients, load, at_rest(stretch));
        let moving = State {
            position: stretch,
            rate: 1.0,
        };
        let per_square = energy(&coefficients, load, moving) - resting;
        ((hamiltonian - resting) / per_square).sqrt()
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn set_named(name: &str, value: f64) {
        assert!(actuator_set(reference_of(name), value), "{name}");
    }

    /// Ideal actuator: λ3 of the dynamic threshold is the root of x³ + 2x² + x − 1, φ = .6469836322448274
    /// (Joglekar's closed form); static 4^(−1/3), √3·2^(−4/3).
    #[test]
    fn the_curves_have_their_maxima_at_the_thresholds() {
        actuator_reset();
        let [dynamic, quasi_static] =
            [0.465_571_231_876_768, 0.25_f64.cbrt()].map(|x: f64| x.powf(-0.5));
        assert!((actuator_stagnation(dynamic).sqrt() - 0.646_983_632_244_827_4).abs() < 1e-14);
        let expected = 3.0_f64.sqrt() * 2.0_f64.powf(-4.0 / 3.0);
        assert!((actuator_equilibrium(quasi_static).sqrt() - expected).abs() < 1e-14);
        // Both are 0 where nothing is loaded.
        assert!(actuator_stagnation(1.0).abs() < 1e-4 && actuator_equilibrium(1.0).abs() < 1e-15);
    }

    #[test]
    fn a_motion_passes_with_the_rate_of_its_energy() {
        actuator_reset();
        set_named("phi", 0.6);
        assert!(actuator_begin(1e-12));
        for _ in 0..40 {
            assert!(actuator_step(1.7));
            let [stretch, rate] =
                ["lambda", "lambda_dot"].map(|name| actuator_get(reference_of(name)));
            let passing =
                actuator_rate_of_passage(stretch, actuator_get(reference_of("hamiltonian")));
            assert!(
                (passing - rate.abs()).abs() < 1e-12,
                "{stretch} {rate} {passing}"
            );
        }
        assert!(actuator_rate_of_passage(0.8, 0.0).is_nan() && actuator_potential(1.0) == 0.0);
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
