//! Extremes between communication points.

use super::*;

/// Extremes against those of a motion looked at in small steps, and against
/// the turn of the exact orbit: λ3 of case a.
#[test]
fn extremes_are_recorded_exactly_and_whatever_the_steps() {
    let cases = [
        direct(SURFACE, 0.6, 0.0),
        direct(SURFACE, 0.6, 0.5),
        alternating(SURFACE, 0.3, 0.1438),
    ];
    for motion in &cases {
        let mut fine = from_rest(1e-12);
        let (mut lowest, mut highest) = (1.0_f64, 1.0_f64);
        for _ in 0..200_000 {
            advance(&mut fine, motion, 0.0015);
            lowest = lowest.min(fine.position());
            highest = highest.max(fine.position());
        }
        let mut before: Option<[f64; 2]> = None;
        for step in [0.3, 7.1, 300.0] {
            let mut recording = from_rest(1e-12).with(Trajectory::recording_extremes);
            follow(&mut recording, motion, 300.0, step);
            let found = recording.extremes().expect("they are recorded");
            // Samples 0.0015 apart miss a turn by up to x''·0.00075²/2.
            for (exact, sampled) in [(found.highest, highest), (-found.lowest, -lowest)] {
                assert!(
                    exact >= sampled - 1e-13 && exact <= sampled + 1e-7,
                    "steps of {step}: {exact} beside {sampled}"
                );
            }
            let found = [found.lowest, found.highest];
            for (now, before) in found.iter().zip(before.unwrap_or(found)) {
                assert!(
                    (now - before).abs() < 1e-12,
                    "steps of {step}: {now}, {before}"
                );
            }
            before = Some(found);
        }
    }
}
