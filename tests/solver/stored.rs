//! Motions that are stored, and stored bytes that are none.

use dielectric_elastomer_actuator::nondimensional::scene::Scene;

use super::{Clocked, Steps, Trajectory, advance};

/// φ = 0.6, S = 0.5.
fn constant() -> Scene {
    let mut scene = Scene::at_start();
    scene.parameters.surface_energy = 0.05;
    scene.parameters.surface_tension = 0.05;
    scene.parameters.surface_elasticity = 0.2;
    scene.drive.voltage.set_value(0.6);
    scene.drive.prestress.set_value(0.5);
    scene
}

/// φ = 0.3 sin(0.1438 t).
fn alternating() -> Scene {
    let mut scene = constant();
    scene.drive.voltage.set_value(0.0);
    scene.drive.prestress.set_value(0.0);
    scene.drive.harmonic.amplitude = 0.3;
    scene.drive.harmonic.frequency = 0.1438;
    scene
}

fn begun(tolerance: f64) -> Clocked<Steps> {
    let Scene { start, limits, .. } = constant();
    Clocked::from(Trajectory::new(start, limits, tolerance))
}

/// A stored motion goes on as if nothing had happened, bit for bit.
#[test]
fn a_stored_motion_goes_on_bit_for_bit() {
    let cases = [constant(), alternating()];
    for motion in &cases {
        for (before, step) in [(0.0, 0.37), (3.3, 0.01), (77.7, 5.0), (1234.5, 0.37)] {
            let mut trajectory = begun(1e-11);
            if before > 0.0 {
                advance(&mut trajectory, motion, before);
            }
            let stored = serde_json::to_string(&*trajectory).expect("it can be stored");
            let again: Trajectory = serde_json::from_str(&stored).expect("it was stored");
            let mut restored = Clocked::at(trajectory.clock, again);
            assert!(restored.is_valid());
            for _ in 0..100 {
                assert_eq!(restored.state(), trajectory.state(), "after {before}");
                advance(&mut trajectory, motion, step);
                advance(&mut restored, motion, step);
            }
        }
    }
}

/// A host that changes its inputs at two successive steps, and then never again: the further steps
/// are those of dense output, which a held step only moves along.
#[test]
fn steps_are_held_again_after_inputs_were_changed() {
    let mut trajectory = begun(1e-9);
    for _ in 0..2 {
        advance(&mut trajectory, &alternating(), 0.01);
        assert!(trajectory.stored_state().is_some());
        trajectory.restart();
    }
    advance(&mut trajectory, &alternating(), 0.01);
    assert!(trajectory.stored_state().is_some());
    advance(&mut trajectory, &alternating(), 0.01);
    assert!(trajectory.stored_state().is_none());
}

/// Numbers that do not fit together as those of one motion are noticed.
#[test]
fn a_forged_motion_is_not_valid() {
    let stored = |mut trajectory: Clocked<Steps>| {
        advance(&mut trajectory, &constant(), 77.7);
        serde_json::to_value(&*trajectory).expect("it can be stored")
    };
    let plain = stored(begun(1e-11));
    let recording = stored(begun(1e-11).with(Trajectory::recording_extremes));
    let valid =
        |stored| serde_json::from_value(stored).is_ok_and(|motion: Trajectory| motion.is_valid());
    assert!(valid(plain.clone()) && valid(recording.clone()));
    let forged = |stored: &serde_json::Value, place: &str, more: f64| {
        let mut forged = stored.clone();
        let number = forged.pointer_mut(place).expect(place);
        *number = match number.as_u64() {
            Some(count) => count.saturating_add_signed(more as i64).into(),
            None => (number.as_f64().expect(place) + more).into(),
        };
        forged
    };
    for (stored, place, more) in [
        (&plain, "/start/state/position", 1e-9),
        (&plain, "/history/1/begin/high", 1e-9),
        (&plain, "/history/1/segment/start/rate", 1e-12),
        (&plain, "/history/1/segment/end/position", 1e-12),
        (&plain, "/history/0/segment/series/even/0", 1e-3),
        (&plain, "/history/0/segment/series/odd/0", 1e-3),
        (&plain, "/cursor/now/high", 1e3),
        (&plain, "/cursor/now/low", 1e3),
        (&plain, "/cursor/step", 1.0),
        (&plain, "/cursor/time_left", 1e-3),
        (&plain, "/mode/Periodic/direction", 0.5),
        (&plain, "/restarts/advances", -1.0),
        (&plain, "/settings/limits/upper", -9.5),
        (&plain, "/mode/Periodic/orbit/period/high", 1e-9),
        (&recording, "/recording/extremes/lowest", 1.0),
        (&recording, "/recording/extremes/highest", 10.0),
    ] {
        let forged = forged(stored, place, more);
        assert!(!valid(forged), "{place} in {stored:#}");
    }
    // Where it does not turn, with the period that goes with it.
    let turn = forged(&plain, "/mode/Periodic/orbit/second_turn/high", -0.1);
    assert!(!valid(forged(
        &turn,
        "/mode/Periodic/orbit/period/high",
        -0.2
    )));
}
