//! Inputs that vary much within a step that is short for the motion. Each value is exact:
//! from two multiprecision integrations, to the digits written.

use super::accuracy::play;
use super::scenes::{Scene, Step};
use super::*;

const DEFAULT: Actuator = Actuator {
    aspect: 100.0,
    surface: [0.0; 3],
};

fn scene(actuator: Actuator, load: Load, steps: Vec<Step>) -> Scene {
    Scene {
        actuator,
        start: [1.0, 0.0],
        start_time: 0.0,
        tolerance: None,
        load,
        steps,
    }
}

fn changed(load: Load, length: f64) -> Step {
    Step {
        change: Some(load),
        length,
    }
}

fn unchanged(length: f64) -> Step {
    Step {
        change: None,
        length,
    }
}

/// A voltage with these derivatives.
fn voltage(voltage: [f64; 5]) -> Load {
    Load {
        voltage,
        ..Load::constant(0.0, 0.0)
    }
}

/// Plays the scene at the default tolerance and at tight and loose ones.
fn holds(mut scene: Scene, exact: [Option<f64>; 2]) {
    let unit = scene.actuator.time_scale();
    for tolerance in [None, Some(1e-12), Some(1e-6), Some(1e-14), Some(1e-2)] {
        scene.tolerance = tolerance;
        let played = play(&scene);
        assert_eq!(played.compared, scene.steps.len(), "{tolerance:?}");
        let most = allowed::TOLERANCES * tolerance.unwrap_or(1e-10) + 4.0 * f64::EPSILON;
        for (place, unit) in [1.0, unit].into_iter().enumerate() {
            if let Some(exact) = exact[place] {
                let error = (played.end[place] - exact).abs() * unit;
                assert!(error <= most, "{tolerance:?}: {error:e}");
            }
        }
        let ratio = played.worst.ratio;
        assert!(ratio <= allowed::TOLERANCES, "{tolerance:?}: {ratio}");
    }
}

/// φ = T₄(2s/h − 1) over one step h: φ² is of degree 8, the first that 4 nodes integrate
/// wrongly.
#[test]
fn a_polynomial_voltage_of_order_4_moves_a_short_step_as_it_should() {
    let h = 2_f64.powi(-8);
    let [one, two, three, four] = [1, 2, 3, 4].map(|k| h.powi(k));
    let swing = voltage([
        1.0,
        -32.0 / one,
        320.0 / two,
        -1536.0 / three,
        3072.0 / four,
    ]);
    let rest = Load::constant(0.2, 0.0);
    let steps = vec![unchanged(h), changed(swing, h)];
    holds(
        scene(DEFAULT, rest, steps),
        [None, Some(2.037_620_273_357_558_6e-5)],
    );
}

/// A sine passed with its exact derivatives of orders 1 to 4 at each step, ωh = 1.5.
#[test]
fn a_sine_passed_by_its_derivatives_moves_short_steps_as_it_should() {
    let frequency = 2.0_f64;
    let steps = (0..1000).map(|k| {
        let (sine, cosine) = (1.5 * f64::from(k)).sin_cos();
        let turn = [sine, cosine, -sine, -cosine, sine];
        let derivatives = std::array::from_fn(|n| 0.5 * turn[n] * frequency.powi(n as i32));
        changed(voltage(derivatives), 1.5 / frequency)
    });
    let actuator = Actuator {
        aspect: 1e6,
        ..DEFAULT
    };
    let steps = steps.collect();
    holds(scene(actuator, Load::constant(0.0, 0.0), steps), [None; 2]);
}

/// The built-in drive turns φ² by up to half a turn in each step.
#[test]
fn short_steps_under_a_fast_drive_with_a_changed_voltage_move_as_they_should() {
    let load = |k: u32| Load {
        harmonic: [0.5, 2.0, 0.8],
        ..Load::constant(0.1 + 1e-4 * f64::from(k % 3), 0.0)
    };
    let one = 49.0 / 64.0;
    let lengths = [one, std::f64::consts::FRAC_PI_2 - one];
    let steps = (0..1000).map(|k| changed(load(k), lengths[k as usize % 2]));
    let actuator = Actuator {
        aspect: 1e6,
        ..DEFAULT
    };
    let scene = scene(actuator, load(0), steps.collect());
    holds(scene, [Some(1.031_356_207_976_927_2), None]);
}

/// A piece that looks beyond the step is much shorter than the time scale: its rate is off
/// by as much more than its position.
#[test]
fn a_piece_that_looks_ahead_has_the_right_rate() {
    let h = 2_f64.powi(-16);
    let mut rising = Load::constant(0.0, 0.0);
    rising.prestress[1] = 1e-3;
    let derivatives = [
        0.2,
        0.3 / h,
        -0.1 / (h * h),
        0.2 / h.powi(3),
        0.3 / h.powi(4),
    ];
    for (order, exact) in [(1, None), (2, Some(2.933_887_932_869_213_4e-4)), (4, None)] {
        let swing = std::array::from_fn(|k| if k <= order { derivatives[k] } else { 0.0 });
        let steps = vec![
            changed(rising, 16.0),
            changed(Load::constant(0.0, 0.0), h),
            unchanged(h),
            changed(voltage(swing), h),
        ];
        let scene = scene(DEFAULT, Load::constant(0.0, 0.0), steps);
        holds(scene, [None, exact]);
    }
}
