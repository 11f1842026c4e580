//! Inputs that jump at each communication step. No energy is kept then, so the
//! independent integrator says what is right.

use super::*;

/// Follows random jumps for `count` steps and returns the worst error that a
/// step adds: the independent integrator takes each step from the state in
/// which the library begins it, since a motion kicked at random is chaotic. In
/// units of the stretch; the rate counts in units of 1/√(c+2).
fn jumps(seed: u64, count: u32, tolerance: f64, choose: impl Fn(&mut Random) -> Load) -> f64 {
    let mut random = Random(seed);
    let actuator = random.actuator([-1.0, 6.0], 0.2, 0.1);
    let unit = (actuator.aspect + 2.0).sqrt();
    let mut trajectory = from_rest(tolerance);
    let mut worst = 0.0_f64;
    for _ in 0..count {
        let load = choose(&mut random);
        let step = unit * 10_f64.powf(random.between(-3.0, 0.5));
        let State { position, rate } = trajectory.state();
        let mut reference = Taylor::new(position, rate);
        reference.advance(&actuator, &load, step);
        trajectory.restart();
        advance(&mut trajectory, &motion(&actuator, &load), step);
        let State { position, rate } = trajectory.state();
        let [stretch, stretch_rate] = reference.state();
        worst = largest([worst, position - stretch, (rate - stretch_rate) * unit]);
    }
    worst
}

#[test]
fn inputs_that_jump_at_each_step_move_the_actuator_as_they_should() {
    let count = if long() { 500 } else { 6 };
    for seed in 0..count {
        for tolerance in [1e-8, 1e-12] {
            let error = jumps(seed, 300, tolerance, |random| {
                Load::constant(random.between(-0.7, 0.7), random.between(-1.0, 0.5))
            });
            let what = format!("jumps {seed}, tolerance {tolerance:e}");
            assert_at_most(error, allowed::JUMPS * tolerance, &what);
        }
    }
}

/// From nothing to everything that the actuator bears and back, a step each.
#[test]
fn inputs_that_jump_between_extremes_move_the_actuator_as_they_should() {
    let count = if long() { 500 } else { 6 };
    for seed in 0..count {
        for tolerance in [1e-8, 1e-12] {
            let error = jumps(seed, 100, tolerance, |random| {
                Load::constant(random.of(&[-2.0, 0.0, 2.0]), random.of(&[-10.0, 0.0, 5.0]))
            });
            let what = format!("extremes {seed}, tolerance {tolerance:e}");
            assert_at_most(error, allowed::EXTREME_JUMPS * tolerance, &what);
        }
    }
}

/// Inputs that a controller changes a little at each of many short steps: what the
/// steps leave does not add up.
#[test]
fn many_short_steps_under_changing_inputs_keep_the_tolerance() {
    let most: f64 = if long() { 200_000.0 } else { 10_000.0 };
    for (aspect, step) in [
        (0.01, 0.001),
        (1.0, 0.001),
        (1.0, 0.02),
        (100.0, 0.01),
        (100.0, 0.1),
    ] {
        let actuator = Actuator {
            aspect,
            surface: [0.1, 0.05, 0.2],
        };
        for tolerance in [1e-10, 1e-13] {
            let mut random = Random(11);
            let mut load = Load::constant(0.4, 0.0);
            let (mut trajectory, mut reference) = (from_rest(tolerance), Taylor::new(1.0, 0.0));
            let mut worst = 0.0_f64;
            for _ in 0..most.min(2000.0 / step) as u32 {
                let change = random.between(-0.05, 0.05) * step;
                load.voltage[0] = (load.voltage[0] + change).clamp(0.1, 0.6);
                trajectory.restart();
                advance(&mut trajectory, &motion(&actuator, &load), step);
                reference.advance(&actuator, &load, step);
                worst = largest([worst, trajectory.position() - reference.state()[0]]);
            }
            let what = format!("c = {aspect}, steps of {step}, tolerance {tolerance:e}");
            assert_at_most(worst, 10.0 * tolerance, &what);
        }
    }
}

/// A voltage of the host that jumps on top of the built-in alternating one.
#[test]
fn jumps_leave_the_phase_of_the_alternating_voltage_alone() {
    for seed in 0..20 {
        let mut random = Random(seed);
        let actuator = Actuator {
            aspect: 100.0,
            surface: [0.05, 0.05, 0.2],
        };
        let mut load = alternating(0.3, random.between(0.05, 1.0));
        let mut trajectory = from_rest(1e-12);
        let mut reference = Taylor::new(1.0, 0.0);
        let mut worst = 0.0_f64;
        for _ in 0..300 {
            load.voltage[0] = random.between(-0.3, 0.3);
            let step = random.between(0.01, 3.0);
            trajectory.restart();
            advance(&mut trajectory, &motion(&actuator, &load), step);
            reference.advance(&actuator, &load, step);
            worst = worst.max(difference(trajectory.state(), reference.state()));
        }
        assert_at_most(
            worst,
            allowed::ALTERNATING_JUMPS * 1e-12,
            "jumps and alternation",
        );
    }
}

/// Piecewise constant inputs that come back to nothing: the actuator then has
/// the energy that the independent integrator gave it, for 1e6 units of time.
#[test]
fn energy_given_by_a_sequence_of_inputs_stays_over_a_million_units_of_time() {
    use dielectric_elastomer_actuator::actuator::motion::{Load as Present, energy};
    let actuator = Actuator {
        aspect: 100.0,
        surface: [0.05, 0.05, 0.2],
    };
    let nothing = Present {
        voltage_squared: 0.0,
        prestress: 0.0,
    };
    for (tolerance, orbits, drift) in [
        (1e-10, true, 1e-12),
        (1e-13, true, 1e-13),
        (1e-14, true, 1e-13),
        (1e-14, false, 1e-12),
    ] {
        let mut random = Random(7);
        let (mut trajectory, mut reference) = (from_rest(tolerance), Taylor::new(1.0, 0.0));
        if !orbits {
            trajectory = trajectory.with(Trajectory::without_orbits);
        }
        for last in [false, false, false, false, true] {
            let mut load = Load::constant(random.between(0.2, 0.6), random.between(-0.5, 0.5));
            if last {
                load = Load::constant(0.0, 0.0);
            }
            let step = random.between(5.0, 20.0);
            trajectory.restart();
            advance(&mut trajectory, &motion(&actuator, &load), step);
            reference.advance(&actuator, &load, step);
        }
        let motion = motion(&actuator, &Load::constant(0.0, 0.0));
        let [position, rate] = reference.state();
        let given = energy(&motion.coefficients, nothing, State { position, rate });
        let now = |t: &Trajectory| energy(&motion.coefficients, nothing, t.state());
        let first = now(&trajectory);
        let mut worst = 0.0_f64;
        for _ in 0..1000 {
            advance(&mut trajectory, &motion, 1000.37);
            worst = largest([worst, now(&trajectory) - first]);
        }
        let what = format!("energy, tolerance {tolerance:e}, orbits {orbits}");
        assert_at_most(worst, drift, &what);
        let most = allowed::ENERGY * tolerance + allowed::ENERGY_ROUNDING;
        assert_at_most((first - given).abs(), most, &what);
    }
}
