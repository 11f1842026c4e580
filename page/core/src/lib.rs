//! One actuator for the live page, stepped as a host of co-simulation steps it: variables by their value
//! references, in nondimensional numbers. Besides, the curves that the page draws.
//!
//! A page has one actuator, which lives here; nothing but numbers crosses the border. A call that is
//! refused changes nothing and answers false; [`actuator_message`] then tells why.
#![expect(unsafe_code, reason = "exported names: no function here is unsafe")]

mod equilibrium;

use std::cell::RefCell;
use std::f64::consts::TAU;
use std::mem;

use dielectric_elastomer_actuator::actuator::motion::{Load, acceleration, energy};
use dielectric_elastomer_actuator::actuator::scales::{Scales, SiDevice};
use dielectric_elastomer_actuator::actuator::{Coefficients, Parameters};
use dielectric_elastomer_actuator::instance::{Fault, Instance, Message, Type};
use dielectric_elastomer_actuator::model::variables::{Kind, value_reference};
use dielectric_elastomer_actuator::nondimensional::{Nondimensional, VARIABLES};
use dielectric_elastomer_actuator::solver::State;

/// Next to λ = 1 the stagnation curve is taken at this distance from it, where 0/0 is far enough.
const NEAR_REST: f64 = 1e-5;

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

/// The angular frequency of small oscillations about the equilibrium under the present prestress and voltage, the
/// alternating one left out; NaN where there is no equilibrium.
#[unsafe(no_mangle)]
pub extern "C" fn actuator_frequency() -> f64 {
    with(|page| {
        let (coefficients, load) = page.unloaded();
        let view = page.actuator.view();
        let load = Load {
            voltage_squared: view.voltage() * view.voltage(),
            ..load
        };
        let limits = view.scene.limits;
        equilibrium::frequency(&coefficients, load, [limits.lower, limits.upper])
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

    /// A period of a motion of small amplitude, timed between two passages, under surface effects and a load.
    #[test]
    fn a_small_motion_has_the_frequency() {
        let [surface, start] = [0.3, 1e-4];
        actuator_reset();
        for (name, value) in [
            ("c", 100.0),
            ("tau_s", surface),
            ("E_s", 1.0),
            ("phi", 0.4),
            // What holds λ = 1: S + φ² = 2(γ + τ).
            ("S", 2.0 * surface - 0.16),
            ("lambda_start", 1.0 + start),
        ] {
            set_named(name, value);
        }
        assert!(actuator_begin(1e-12));
        let frequency = actuator_frequency();
        // A quarter of a period after the start the motion passes the equilibrium.
        assert!(actuator_step(0.25 * TAU / frequency));
        let off = actuator_get(reference_of("lambda")) - 1.0;
        assert!(off.abs() < 1e-3 * start, "{frequency}: off by {off}");
    }

    /// Without load and surface effects ω² = 6/(c + 2); beyond pull-in nothing holds the actuator.
    #[test]
    fn the_frequency_ends_where_the_equilibrium_does() {
        actuator_reset();
        set_named("c", 100.0);
        assert!((actuator_frequency().powi(2) - 6.0 / 102.0).abs() < 1e-12);
        set_named("phi", 0.69);
        assert!(actuator_frequency().is_nan());
        // The static threshold is 0.6873.
        set_named("phi", 0.687);
        assert!(actuator_frequency() < 0.5 * (6.0_f64 / 102.0).sqrt());
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
