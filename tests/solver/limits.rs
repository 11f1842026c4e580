//! Where the motion meets a limit, and where it only starts next to one.

use dielectric_elastomer_actuator::solver::limits::Limit;

use super::*;

const NARROW: Limits = Limits {
    lower: 0.5,
    upper: 1.5,
};

/// Where the motion from `position` stops within the time 3, under this prestress.
fn stop(position: f64, rate: f64, prestress: f64) -> Option<(Limit, f64)> {
    let motion = direct([0.0, 0.0, 0.2], 0.0, prestress);
    let mut trajectory = Clocked::from(Trajectory::new(State { position, rate }, NARROW, 1e-10));
    for _ in 0..3 {
        match trajectory.advance(&motion, 1.0) {
            Ok(Progress::Whole) => (),
            Ok(Progress::Stopped { limit, .. }) => {
                return Some((limit, trajectory.clock.value()));
            }
            Err(failure) => panic!("{failure:?}"),
        }
    }
    None
}

#[test]
fn a_start_next_to_a_limit_meets_it_only_on_the_way_out() {
    let top = 1.5_f64.next_down();
    let bottom = 0.5_f64.next_up();
    // The actuator draws back to λ = 1 by itself.
    assert_eq!(stop(top, 0.0, 0.0), None);
    assert_eq!(stop(top, -0.1, 0.0), None);
    assert_eq!(stop(top, -1e-20, 0.0), None);
    assert_eq!(stop(bottom, 0.0, 0.0), None);
    assert_eq!(stop(bottom, 0.1, 0.0), None);
    let at_once = |met: Option<(Limit, f64)>, which| {
        assert!(
            matches!(met, Some((limit, time)) if limit == which && time < 1e-6),
            "{met:?}"
        );
    };
    at_once(stop(top, 0.1, 0.0), Limit::Upper);
    at_once(stop(top, 0.0, 10.0), Limit::Upper);
    at_once(stop(bottom, -0.1, 0.0), Limit::Lower);
    at_once(stop(bottom, 0.0, -100.0), Limit::Lower);
}

/// Inward first, and back within a part of a step: rate −1e-6 against an outward force.
#[test]
fn a_limit_is_met_after_a_turn_next_to_it() {
    let acceleration = (10.0 - 1.5 + 1.5_f64.powi(-5) - 0.2 * 1.5 * 1.25 * 5.75)
        / (100.0 + 2.0 * 1.5_f64.powi(-6));
    let met = stop(1.5_f64.next_down(), -1e-6, 10.0);
    let expected = 2e-6 / acceleration;
    assert!(
        matches!(met, Some((Limit::Upper, time)) if (time / expected - 1.0).abs() < 1e-3),
        "{met:?}, {expected:e}"
    );
}

/// Blow-up of the ideal actuator, from a multiprecision quadrature.
#[test]
fn escape_is_located_where_the_stretch_becomes_infinite() {
    for (voltage, time) in [
        (0.65, 68.055_285_509),
        (0.7, 40.639_961_044),
        (1.0, 21.196_654_486),
    ] {
        let upper = 1e6;
        let limits = Limits { upper, ..LIMITS };
        let mut trajectory = Clocked::from(Trajectory::new(REST, limits, 1e-12));
        let motion = direct([0.0; 3], voltage, 0.0);
        let Ok(Progress::Stopped { limit, after }) = trajectory.advance(&motion, 100.0) else {
            panic!("voltage {voltage} did not escape");
        };
        assert_eq!(limit, Limit::Upper);
        // Far out λ'' = φ²λ³/c, so that λ = √(2c)/(φ (t* − t)).
        let rest = (2.0 * 100.0_f64).sqrt() / (voltage * upper);
        assert!(
            (after + rest - time).abs() < 1e-9,
            "voltage {voltage}: {}",
            after + rest
        );
        assert!((trajectory.position() / upper - 1.0).abs() < 1e-9);
    }
}

#[test]
fn the_lower_limit_stops_a_contraction() {
    let limits = Limits {
        lower: 0.5,
        upper: 10.0,
    };
    let mut trajectory = Clocked::from(Trajectory::new(REST, limits, 1e-10));
    let motion = direct([0.0; 3], 0.0, -30.0);
    let stopped = trajectory.advance(&motion, 100.0);
    assert!(
        matches!(
            stopped,
            Ok(Progress::Stopped {
                limit: Limit::Lower,
                ..
            })
        ),
        "{stopped:?}"
    );
    assert!((trajectory.position() - 0.5).abs() < 1e-12);
}
