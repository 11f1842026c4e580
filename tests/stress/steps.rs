//! Communication steps of all sizes and numbers, late times, time reversal.

use dielectric_elastomer_actuator::arithmetic::double_double::DoubleDouble;

use super::*;

/// Communication steps as powers of two, so that their sums are exact.
fn binary(exponents: impl IntoIterator<Item = i32>) -> Vec<f64> {
    exponents.into_iter().map(|e| 2_f64.powi(e)).collect()
}

fn reference_actuator() -> Actuator {
    Actuator {
        aspect: 100.0,
        surface: [0.05, 0.05, 0.2],
    }
}

/// The state after these steps, and after one step as long as all of them.
fn split_and_whole(motion: &Motion, steps: &[f64], tolerance: f64) -> [State; 2] {
    let mut split = from_rest(tolerance);
    for &step in steps {
        advance(&mut split, motion, step);
    }
    let mut whole = from_rest(tolerance);
    advance(&mut whole, motion, steps.iter().sum());
    [split.state(), whole.state()]
}

/// 2⁻³⁰ (about 1e-9) to 2²⁰ (about 1e6) up, down and shuffled.
#[test]
fn steps_from_1e_9_to_1e6_in_any_order_end_where_one_step_ends() {
    let mut random = Random(3);
    for (load, largest, tolerance) in [
        (Load::constant(0.6, 0.5), 20, 1e-12),
        (Load::constant(0.3, -1.0), 20, 1e-12),
        // By t = 8192 this motion has multiplied every error some hundredfold.
        (alternating(0.3, 0.1438), 12, 1e-13),
    ] {
        let motion = motion(&reference_actuator(), &load);
        let up = binary(-30..=largest);
        let down: Vec<f64> = up.iter().rev().copied().collect();
        let mut shuffled = up.clone();
        for i in (1..shuffled.len()).rev() {
            shuffled.swap(i, (random.bits() % (i as u64 + 1)) as usize);
        }
        let mut mixed = binary((-30..=largest).flat_map(|e| [e, -30, -8]));
        mixed.extend(binary([-1; 64]));
        for steps in [up, down, shuffled, mixed] {
            let [split, whole] = split_and_whole(&motion, &steps, tolerance);
            let error = difference(split, [whole.position, whole.rate]);
            assert_at_most(error, allowed::SPLIT, "geometric steps");
        }
    }
}

#[test]
fn random_splits_end_where_one_step_ends() {
    let mut random = Random(4);
    for _ in 0..200 {
        let load = if random.bits().is_multiple_of(2) {
            Load::constant(random.between(0.0, 0.7), random.between(-1.0, 0.5))
        } else {
            alternating(random.between(0.1, 0.4), random.between(0.05, 0.4))
        };
        let motion = motion(&reference_actuator(), &load);
        let longest = 10_f64.powf(random.between(-3.0, 2.0));
        let grain = 2_f64.powi(-20);
        let steps: Vec<f64> = (0..100)
            .map(|_| grain * (random.between(0.0, longest) / grain).ceil().max(1.0))
            .collect();
        let [split, whole] = split_and_whole(&motion, &steps, 1e-12);
        let error = difference(split, [whole.position, whole.rate]);
        assert!(
            error <= allowed::SPLIT,
            "{error:e}: {load:?}, steps below {longest}"
        );
    }
}

/// Steps of 1e-3: 1e5 of them, in the long form 1e7.
#[test]
fn many_small_steps_end_where_one_step_ends() {
    let count = if long() { 10_000_000 } else { 100_000 };
    let step = 2_f64.powi(-10);
    for load in [Load::constant(0.6, 0.0), alternating(0.3, 0.1438)] {
        let motion = motion(&reference_actuator(), &load);
        let [split, whole] = split_and_whole(&motion, &vec![step; count], 1e-12);
        let error = difference(split, [whole.position, whole.rate]);
        assert_at_most(error, allowed::SPLIT, "small steps");
    }
}

/// Forward, the rate reversed, and as long again.
#[test]
fn a_motion_run_back_returns_to_its_start() {
    let mut random = Random(5);
    for _ in 0..50 {
        let actuator = random.actuator([-2.0, 6.0], 0.2, 0.05);
        let time = random.between(1.0, 100.0) * (actuator.aspect + 2.0).sqrt();
        let load = Load::constant(random.between(0.0, 0.6), random.between(-1.0, 0.5));
        let motion = motion(&actuator, &load);
        for orbits in [true, false] {
            returns(
                orbits,
                [&motion; 2],
                time,
                &format!("{actuator:?}, {load:?}"),
            );
        }
    }
}

/// A driven motion, whose voltage is run back too: with x = ωt + ϑ at the turn,
/// sin(x − ωs) = sin(ωs + π − x). The frequency is a multiple of 1/2048 and the
/// time a whole number, so that x is exact.
#[test]
fn a_driven_motion_run_back_with_its_drive_returns_to_its_start() {
    let mut random = Random(6);
    for _ in 0..50 {
        let frequency = (random.between(100.0, 800.0)).round() / 2048.0;
        let time = random.between(10.0, 1000.0).round();
        let (sine, cosine) = (frequency * time).sin_cos();
        let mut back = alternating(0.3, frequency);
        back.harmonic[2] = sine.atan2(-cosine);
        let motions =
            [alternating(0.3, frequency), back].map(|load| motion(&reference_actuator(), &load));
        let what = format!("ω = {frequency}, t = {time}");
        returns(true, [&motions[0], &motions[1]], time, &what);
    }
}

/// Follows `forth` for `time` and `back` from there with the rate reversed.
fn returns(orbits: bool, [forth, back]: [&Motion; 2], time: f64, what: &str) {
    let follow = |start: State, motion: &Motion| {
        let mut trajectory = Clocked::from(Trajectory::new(start, WIDE, 1e-12));
        if !orbits {
            trajectory = trajectory.with(Trajectory::without_orbits);
        }
        advance(&mut trajectory, motion, time);
        let State { position, rate } = trajectory.state();
        State {
            position,
            rate: -rate,
        }
    };
    let State { position, rate } = follow(follow(REST, forth), back);
    let unit = (forth.coefficients.inertia + 2.0).sqrt();
    let error = largest([position - 1.0, rate * unit]);
    assert_at_most(error, allowed::REVERSAL, what);
}

/// At t = 1e9 an alternating voltage has the phase it should have: the run
/// from 1e9 and the run from 0 with that phase go together. ω = 1/8, so that
/// ωt is a whole number, whose sine the standard library reduces exactly.
#[test]
fn at_a_time_of_1e9_steps_of_1e_3_go_as_they_do_at_0() {
    let count = if long() { 10_000_000 } else { 100_000 };
    let actuator = reference_actuator();
    for step in [1e-3, 2_f64.powi(-10)] {
        let (sine, cosine) = 1.25e8_f64.sin_cos();
        let (late, mut early) = (alternating(0.3, 0.125), alternating(0.3, 0.125));
        early.harmonic[2] = sine.atan2(cosine);
        let [late_motion, early_motion] = [late, early].map(|load| motion(&actuator, &load));
        let mut late = Clocked::at(DoubleDouble::new(1e9), Trajectory::new(REST, WIDE, 1e-12));
        let mut early = from_rest(1e-12);
        let mut worst = 0.0_f64;
        for _ in 0..count {
            advance(&mut late, &late_motion, step);
            advance(&mut early, &early_motion, step);
            let State { position, rate } = early.state();
            worst = worst.max(difference(late.state(), [position, rate]));
        }
        let most = allowed::LATE * f64::from(count) * step;
        assert_at_most(worst, most, "late and early");
    }
}
