//! The curves that the page draws, of the actuator with its present parameters and load.
#![expect(unsafe_code, reason = "exported names: no function here is unsafe")]

use dielectric_elastomer_actuator::actuator::Coefficients;
use dielectric_elastomer_actuator::actuator::motion::{Load, acceleration, energy};
use dielectric_elastomer_actuator::solver::State;

use crate::{Page, equilibrium, reference_of, with};

/// Next to λ = 1 the stagnation curve is taken at this distance from it, where 0/0 is far enough.
const NEAR_REST: f64 = 1e-5;

impl Page {
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
}

fn at_rest(position: f64) -> State {
    State {
        position,
        rate: 0.0,
    }
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
    use std::f64::consts::TAU;

    use super::*;
    use crate::tests::set_named;
    use crate::{actuator_begin, actuator_get, actuator_reset, actuator_step};

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
}
