//! Exact periods and turning points of undamped scenes under constant inputs.

use super::scene::{Scene, follow, number, read, start};
use dielectric_elastomer_actuator::arithmetic::double_double::DoubleDouble;

/// After whole periods the actuator stands at λ = 1 again, after half a period at the turn.
#[test]
fn periods_and_turning_points_are_exact() {
    let file = read("periods");
    for row in file["rows"].as_array().expect("rows") {
        let name = row["scene"].as_str().expect("a name");
        let scene = Scene::of(&read(name));
        let motion = scene.motion(false);
        let (period, turn) = (number(&row["period_nd"]), number(&row["lambda_turn"]));
        let mut trajectory = start(&motion, scene.charge, 1e-12);
        follow(
            &mut trajectory,
            &motion,
            DoubleDouble::new(0.5 * period),
            f64::INFINITY,
        );
        let error = trajectory.position() - turn;
        assert!(error.abs() < 1e-11, "{name}: turns at {error:e} off");
        follow(
            &mut trajectory,
            &motion,
            DoubleDouble::new(1e3 * period),
            period * 0.377,
        );
        let error = trajectory.position() - 1.0;
        assert!(error.abs() < 1e-11, "{name}: begins anew at {error:e} off");
        // The rate back at the start, over what the period was off by.
        let [lowest, highest] = [1.0, turn];
        let scale = (highest - lowest) / period;
        assert!(
            trajectory.rate().abs() < 1e-7 * scale,
            "{name}: {}",
            trajectory.rate()
        );
    }
}
