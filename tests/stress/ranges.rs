//! The corners of the parameters, and random ones.

use super::*;

/// The time in which small motions turn by a radian: c + 2 at λ = 1 is moved
/// by a stiffness of 6 + 4E and a little more.
fn unit(actuator: &Actuator) -> f64 {
    let [_, _, elasticity] = actuator.surface;
    ((actuator.aspect + 2.0) / (6.0 + 4.0 * elasticity)).sqrt()
}

/// The worst difference from the independent integrator at `points` points, in
/// the stretch or in the rate times [`unit`].
fn worst(
    mut trajectory: Clocked<Steps>,
    actuator: &Actuator,
    load: &Load,
    step: f64,
    points: u32,
) -> f64 {
    let unit = unit(actuator);
    let motion = motion(actuator, load);
    let mut reference = Taylor::new(1.0, 0.0);
    let mut worst = 0.0_f64;
    for _ in 0..points {
        advance(&mut trajectory, &motion, step);
        reference.advance(actuator, load, step);
        let State { position, rate } = trajectory.state();
        let [stretch, stretch_rate] = reference.state();
        worst = largest([worst, position - stretch, (rate - stretch_rate) * unit]);
    }
    worst
}

/// By how much a small error at the start has grown at most, at these points:
/// linearly under a constant voltage, perhaps exponentially under another.
fn growth(actuator: &Actuator, load: &Load, step: f64, points: u32) -> f64 {
    let unit = unit(actuator);
    let mut motion = Taylor::new(1.0, 0.0).varied();
    let mut growth = 1.0_f64;
    for _ in 0..points {
        motion.advance(actuator, load, step);
        for (start, start_unit) in [1.0, unit].into_iter().enumerate() {
            let stretch = motion.stretch.along[start].abs();
            let rate = motion.rate.along[start].abs() * unit;
            growth = growth.max(stretch.max(rate) / start_unit);
        }
    }
    growth
}

/// Thirteen periods for c from 1e-2 to 1e10 and E_s up to 100, stretched and
/// contracted (λ down to .54).
#[test]
fn actuators_of_all_aspects_and_elasticities_move_as_they_should() {
    for (elasticity, load) in [
        (0.2, Load::constant(0.6, 0.0)),
        (0.2, Load::constant(0.0, -5.0)),
        (10.0, Load::constant(0.6, 0.5)),
        (100.0, Load::constant(5.0, 0.5)),
    ] {
        for exponent in -2..=10 {
            let actuator = Actuator {
                aspect: 10_f64.powi(exponent),
                surface: [0.05, 0.05, elasticity],
            };
            let step = 2.0 * unit(&actuator);
            for (trajectory, most) in [
                (from_rest(1e-12), allowed::PERIODS),
                (
                    from_rest(1e-12).with(Trajectory::without_orbits),
                    allowed::PERIODS_WITHOUT_ORBITS,
                ),
            ] {
                let error = worst(trajectory, &actuator, &load, step, 40);
                let what = format!(
                    "E = {elasticity}, S = {}, c = 1e{exponent}",
                    load.prestress[0]
                );
                assert_at_most(error, most, &what);
            }
        }
    }
}

/// Under constant and alternating voltage, at three tolerances.
#[test]
fn random_actuators_move_as_the_independent_integrator_says() {
    let mut random = Random(1);
    let count = if long() { 20_000 } else { 400 };
    for case in 0..count {
        let actuator = random.actuator([-1.0, 8.0], 0.5, 0.05);
        let unit = unit(&actuator);
        let mut load = Load::constant(random.between(0.0, 0.6), random.between(-2.0, 0.5));
        if case % 2 == 1 {
            load.harmonic = [
                random.between(0.0, 0.4),
                random.between(0.05, 2.0) / unit,
                random.between(-3.0, 3.0),
            ];
        }
        let tolerance = random.of(&[1e-6, 1e-9, 1e-12]);
        let step = unit * random.between(0.25, 2.5);
        let error = worst(from_rest(tolerance), &actuator, &load, step, 30);
        let growth = growth(&actuator, &load, step, 30);
        let most = (allowed::RANDOM * tolerance + allowed::RANDOM_ROUNDING) * growth;
        let what = format!("{tolerance:e}: {actuator:?}, {load:?}, steps of {step}");
        assert_at_most(error, most, &what);
    }
}

/// (γ, τ, φ²) moves as (γ − τ, 0, φ² − 4τ), with constant voltage: τ up to 100,
/// of which the second actuator knows nothing.
#[test]
fn surface_tension_of_any_size_is_surface_energy_and_voltage() {
    let mut random = Random(2);
    for _ in 0..400 {
        let tau = 10_f64.powf(random.between(-3.0, 2.0));
        let more = random.between(0.0, 0.5);
        let elasticity = random.between(0.05, 1.0);
        let squared = random.between(0.0, 0.4);
        let prestress = random.between(-1.0, 0.5);
        let aspect = 10_f64.powf(random.between(-2.0, 10.0));
        let step = random.between(0.1, 50.0) * (aspect + 2.0).sqrt();
        let run = |surface: [f64; 3], voltage: f64| {
            let actuator = Actuator { aspect, surface };
            let motion = motion(&actuator, &Load::constant(voltage, prestress));
            let mut trajectory = from_rest(1e-12);
            advance(&mut trajectory, &motion, step);
            trajectory.position()
        };
        let with = run([tau + more, tau, elasticity], (squared + 4.0 * tau).sqrt());
        let without = run([more, 0.0, elasticity], squared.sqrt());
        let most = allowed::REDUNDANCY + allowed::REDUNDANCY_ROUNDING * tau;
        let what = format!("τ = {tau}, c = {aspect:e}, step {step:e}");
        assert_at_most((with - without).abs(), most, &what);
    }
}
