//! Every set of processor instructions gives the same motion, in any floating-point environment
//! of the host.

use fearless_simd::Level;

use super::*;

/// The levels of this processor, each with whether it multiplies and adds with
/// one rounding.
fn levels() -> Vec<(&'static str, bool, Level)> {
    let mut levels = vec![("baseline", false, Level::baseline())];
    #[cfg(target_arch = "x86_64")]
    {
        let best = Level::new();
        let found = [
            ("SSE2", false, best.as_sse2().map(Level::Sse2)),
            ("AVX2", true, best.as_avx2().map(Level::Avx2)),
            ("AVX-512", true, best.as_avx512().map(Level::Avx512)),
        ];
        let here =
            |(name, fused, level): (_, _, Option<_>)| level.map(|level| (name, fused, level));
        levels.extend(found.into_iter().filter_map(here));
    }
    levels
}

/// The states at 200 points.
fn states(level: Level, motion: &Motion, step: f64) -> Vec<State> {
    let mut trajectory = from_rest(1e-12).with(|motion| motion.with_level(level));
    let next = |_| {
        advance(&mut trajectory, motion, step);
        trajectory.state()
    };
    (0..200).map(next).collect()
}

/// Levels that round a multiplication with addition equally often give the
/// same bits; the others differ by what a rounding more does.
#[test]
fn all_levels_give_the_same_motion() {
    let mut random = Random(8);
    for case in 0..20 {
        let actuator = random.actuator([-1.0, 6.0], 0.2, 0.05);
        let unit = (actuator.aspect + 2.0).sqrt();
        let mut load = Load::constant(random.between(0.0, 0.6), random.between(-0.3, 0.3));
        if case % 2 == 1 {
            load.harmonic = [0.3, random.between(0.1, 5.0) / unit, 0.5];
        }
        let motion = motion(&actuator, &load);
        let step = unit * random.between(0.02, 0.3);
        let runs: Vec<_> = levels()
            .into_iter()
            .map(|(name, fused, level)| (name, fused, states(level, &motion, step)))
            .collect();
        for (name, fused, run) in &runs {
            for (other, other_fused, other_run) in &runs {
                let what = format!("{name} and {other}, case {case}");
                if fused == other_fused {
                    assert_eq!(run, other_run, "{what}");
                }
                let errors =
                    |(a, b): (&State, &State)| [a.position - b.position, (a.rate - b.rate) * unit];
                let worst = largest(run.iter().zip(other_run).flat_map(errors));
                assert_at_most(worst, allowed::LEVELS, &what);
            }
        }
    }
}

/// A motion from rest under a load that changes on the way, up to a limit if it comes to one.
fn changing(level: Level, motions: &[Motion], step: f64) -> Vec<State> {
    let mut trajectory = from_rest(1e-10).with(|motion| motion.with_level(level));
    let mut states = Vec::new();
    for motion in motions {
        trajectory.restart();
        for _ in 0..10 {
            match trajectory.advance(motion, step) {
                Ok(Progress::Whole) => states.push(trajectory.state()),
                _ => return states,
            }
        }
    }
    states
}

/// A host that has every exception trap, one that rounds up, and one that flushes subnormal
/// numbers to zero: what is computed inside the guard is what is always computed, no trap is
/// sprung, and the flags are as they were.
#[cfg(target_arch = "x86_64")]
#[test]
fn no_level_follows_the_floating_point_environment_of_the_host() {
    use dielectric_elastomer_actuator::fmi2::float_environment::in_default;

    const DEFAULT: u32 = 0x1f80;
    #[expect(unsafe_code, reason = "sets the environment as a host does")]
    fn within<T>(environment: u32, call: impl FnOnce() -> T) -> T {
        let (mut before, mut after) = (0_u32, 0_u32);
        // SAFETY: reads and writes MXCSR; nothing is computed in the host's environment.
        unsafe {
            std::arch::asm!("stmxcsr [{}]", in(reg) &mut before);
            std::arch::asm!("ldmxcsr [{}]", in(reg) &environment);
        }
        let result = in_default(call);
        // SAFETY: reads MXCSR and puts back what was there before.
        unsafe {
            std::arch::asm!("stmxcsr [{}]", in(reg) &mut after);
            std::arch::asm!("ldmxcsr [{}]", in(reg) &before);
        }
        assert_eq!(after, environment, "{after:x} and not {environment:x}");
        result
    }

    let mut random = Random(12);
    for case in 0..30 {
        let actuator = random.actuator([-1.0, 6.0], 0.2, 0.05);
        let unit = (actuator.aspect + 2.0).sqrt();
        let motions: Vec<Motion> = (0..6)
            .map(|k| {
                // The first voltage step, weak ones, and some that no actuator survives.
                let voltage = random.of(&[0.0, 1e-160, 0.1, 0.4, 0.6, 1.5]);
                let mut load = Load::constant(voltage, random.between(-0.3, 0.3));
                if k % 3 == 2 {
                    load.harmonic = [0.3, random.between(0.1, 500.0) / unit, 0.5];
                }
                let mut motion = motion(&actuator, &load);
                let slope = random.of(&[0.0, 1e-310, 1e-3]) / unit;
                motion.drive.voltage.set_derivative(1, slope);
                motion
            })
            .collect();
        let step = unit * random.of(&[1e-6, 0.02, 0.3, 4.0]);
        for (name, _, level) in levels() {
            let usual = changing(level, &motions, step);
            for environment in [
                DEFAULT & !0x1f80,
                DEFAULT & !0x680,
                DEFAULT | 0x4000,
                DEFAULT | 0x8040,
                DEFAULT | 0x3f,
            ] {
                let there = within(environment, || changing(level, &motions, step));
                assert_eq!(there, usual, "{name}, case {case}, {environment:x}");
            }
        }
    }
}
