//! Every set of processor instructions gives the same motion.

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
            ("SSE4.2", false, best.as_sse4_2().map(Level::Sse4_2)),
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
    let mut trajectory = from_rest(1e-12).with_level(level);
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
                let error = |(a, b): (&State, &State)| {
                    let rate = (a.rate - b.rate).abs() * unit;
                    (a.position - b.position).abs().max(rate)
                };
                let worst = run.iter().zip(other_run).map(error).fold(0.0, f64::max);
                assert_at_most(worst, allowed::LEVELS, &what);
            }
        }
    }
}
