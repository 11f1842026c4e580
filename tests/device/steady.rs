//! The periodic state of a damped actuator under an alternating voltage.

use super::scene::{Scene, follow, number, read, start};
use dielectric_elastomer_actuator::arithmetic::double_double::DoubleDouble;
use std::f64::consts::TAU;

/// Samples of one period of the voltage.
const SAMPLES: usize = 64;

/// Mean, amplitude and phase at twice the frequency, and the extremes, after the transient.
#[test]
fn the_steady_state_has_the_exact_amplitude_and_phase() {
    let scene_file = read("H_ac_damped");
    let file = read("ac_steady_state");
    for row in file["rows"].as_array().expect("rows") {
        let mut scene = Scene::of(&scene_file);
        let get = |key: &str| number(&row[key]);
        let frequency = get("omega");
        scene.drive.harmonic.frequency = frequency;
        let motion = scene.motion(false);
        let mut trajectory = start(&motion, scene.charge, 1e-11);
        let period = TAU / frequency;
        // The transient falls like exp(−ζω_n t): e⁻³⁰ after 90 natural periods.
        let natural = TAU / (6.0 / (motion.device.sheet.aspect + 2.0)).sqrt();
        let whole = (90.0 * natural / period).ceil();
        follow(
            &mut trajectory,
            &motion,
            DoubleDouble::new(whole * period),
            period,
        );
        trajectory.record_extremes_anew(true);
        let (mut mean, mut cosine, mut sine) = (0.0, 0.0, 0.0);
        for k in 1..=SAMPLES {
            let part = k as f64 / SAMPLES as f64;
            follow(
                &mut trajectory,
                &motion,
                DoubleDouble::new((whole + part) * period),
                f64::INFINITY,
            );
            let (stretch, angle) = (trajectory.position(), 2.0 * TAU * part);
            mean += stretch / SAMPLES as f64;
            cosine += 2.0 * stretch * angle.cos() / SAMPLES as f64;
            sine += 2.0 * stretch * angle.sin() / SAMPLES as f64;
        }
        let extremes = trajectory.extremes().expect("recorded");
        for (found, key) in [
            (mean, "lambda_mean"),
            (cosine.hypot(sine), "lambda_amplitude_2f"),
            ((-sine).atan2(-cosine), "phase_lag_2f_rad"),
            (extremes.highest, "lambda_max"),
            (extremes.lowest, "lambda_min"),
        ] {
            let error = (found - get(key)).abs();
            let allowed = if key.starts_with("phase") { 1e-8 } else { 1e-9 };
            assert!(error < allowed, "{key} at {} Hz: {error:e}", row["f"]);
        }
    }
}
