//! Both models give one trajectory after scaling, to rounding.

use super::host::Host;
use dielectric_elastomer_actuator::actuator::scales::{Scales, SiDevice};
use dielectric_elastomer_actuator::instance::Type;
use dielectric_elastomer_actuator::nondimensional;
use proptest::prelude::*;

/// So tight that where the two choose other steps, by a rounding of time, is not seen.
const TOLERANCE: f64 = 1e-13;

/// A sheet under alternating voltage and force, at first in motion.
#[derive(Clone, Copy, Debug)]
struct Sheet {
    /// µ in Pa, ρ in kg/m³, ε_r.
    material: [f64; 3],
    /// H in m, L/H, and how many layers.
    geometry: [f64; 3],
    /// γ, τ and E, nondimensional.
    surface: [f64; 3],
    /// φ, φ_ac, ω, S and the rate at the start, nondimensional.
    load: [f64; 5],
    /// Load mass in units of ρT³/12.
    mass: f64,
    /// The communication step, nondimensional.
    step: f64,
}

fn sheets() -> impl Strategy<Value = Sheet> {
    let material = [1e4..2e6_f64, 800.0..1500.0, 2.0..8.0];
    let geometry = ((1e-6..1e-4_f64), 5.0..60.0_f64, 1..40_u32);
    let surface = [0.0..0.05_f64, 0.0..0.05, 0.0..0.1];
    let load = [0.0..0.35_f64, 0.0..0.1, 0.0..0.5, -0.1..0.1, -0.01..0.01];
    (
        material,
        geometry,
        surface,
        load,
        0.0..30.0_f64,
        0.05..20.0_f64,
    )
        .prop_map(
            |(material, (height, ratio, layers), surface, load, mass, step)| Sheet {
                material,
                geometry: [height, ratio, f64::from(layers)],
                surface,
                load,
                mass,
                step,
            },
        )
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    /// Stretch and rate at 60 communication points; a load mass adds to c.
    #[test]
    fn si_units_and_nondimensional_numbers_give_the_same_motion(sheet in sheets()) {
        let [mu, rho, permittivity] = sheet.material;
        let [height, ratio, layers] = sheet.geometry;
        let side = ratio * height * layers;
        let mut device = SiDevice::sheet(mu, rho, permittivity, [height, side]);
        device.layers = layers;
        let scales = Scales::of(&device);
        let stack = layers * height;
        let [gamma, tau, elasticity] = sheet.surface;
        let [phi, phi_ac, omega, prestress, rate] = sheet.load;
        let mass = sheet.mass * rho * stack.powi(3) / 12.0;
        let newtons_per_metre = mu * stack;
        let mut si = Host::begun_with(TOLERANCE, &[
            ("mu", mu),
            ("rho", rho),
            ("eps_r", permittivity),
            ("H", height),
            ("L", side),
            ("n_layers", layers),
            ("gamma_s", (gamma * newtons_per_metre).min(15.0)),
            ("tau_s", (tau * newtons_per_metre).min(15.0)),
            ("E_s", (elasticity * newtons_per_metre).min(100.0)),
            ("m_load", mass),
            ("voltage", phi * scales.voltage),
            ("V_ac", phi_ac * scales.voltage),
            ("f_ac", omega / (std::f64::consts::TAU * scales.time)),
            ("force", prestress * scales.force),
            ("lambda_dot_start", rate / scales.time),
        ]);
        let surface = |name: &str| si.get(name) / newtons_per_metre;
        let values = [
            ("phi", phi),
            ("phi_ac", phi_ac),
            ("omega_ac", omega),
            ("S", prestress),
            ("lambda_dot_start", rate),
            ("c", ratio * ratio + 12.0 * mass / (rho * stack.powi(3))),
            ("gamma_s", surface("gamma_s")),
            ("tau_s", surface("tau_s")),
            ("E_s", surface("E_s")),
        ];
        let mut plain = nondimensional::Instance::new();
        plain.setup_experiment(Some(TOLERANCE), 0.0, None).expect("an experiment");
        plain.enter_initialization();
        let reference = |name: &str| nondimensional::value_reference(name).expect(name);
        for (name, value) in values {
            plain.set(Type::Real, &[reference(name)], |_| value).expect(name);
        }
        plain.exit_initialization().expect("a start");
        for k in 0..60 {
            plain.do_step(sheet.step * f64::from(k), sheet.step).expect("a step");
            si.step(sheet.step * scales.time);
            let mut theirs = [0.0; 2];
            let references = ["lambda", "lambda_dot"].map(reference);
            plain
                .get(Type::Real, &references, |place, value| theirs[place] = value)
                .expect("values");
            let ours = [si.get("lambda"), si.get("lambda_dot") * scales.time];
            // The phase of the motion has the rounding of its time.
            let allowed = 5e-13 * (1.0 + 1e-3 * sheet.step * f64::from(k));
            for (ours, theirs) in ours.into_iter().zip(theirs) {
                prop_assert!((ours - theirs).abs() < allowed, "step {}: {} {}", k, ours, theirs);
            }
        }
    }
}
