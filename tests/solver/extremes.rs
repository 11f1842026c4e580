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

/// Driven motions slow and fast, weak and strong: extremes that long steps find are those of a motion of
/// which every turn is looked at.
#[test]
fn long_steps_pass_over_no_extreme() {
    for frequency in [0.03, 0.11, 0.1438, 0.29, 0.7, 1.9, 6.0] {
        for [amplitude, offset] in [[0.05, 0.0], [0.2, 0.0], [0.3, 0.1], [0.02, 0.55]] {
            let mut motion = direct(SURFACE, offset, 0.0);
            motion.drive.harmonic = alternating(SURFACE, amplitude, frequency).drive.harmonic;
            for tolerance in [1e-4, 1e-6, 1e-9] {
                let mut long = from_rest(tolerance).with(Trajectory::recording_extremes);
                let mut dense = from_rest(tolerance)
                    .with(Trajectory::recording_extremes)
                    .with(Trajectory::without_endpoint_steps);
                follow(&mut long, &motion, 400.0, 400.0);
                follow(&mut dense, &motion, 400.0, 0.5);
                let [long, dense] = [long, dense].map(|t| t.extremes().expect("recorded"));
                for [found, known] in [[long.highest, dense.highest], [long.lowest, dense.lowest]] {
                    let scene = format!("{frequency}, {amplitude}, {offset} at {tolerance:e}");
                    assert!(
                        (found - known).abs() < 20.0 * tolerance,
                        "{scene}: {found}, {known}"
                    );
                }
            }
        }
    }
}
