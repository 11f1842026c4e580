//! Thresholds against the motion itself, by an integrator of its own.

use super::assert_rounded;
use super::case::{Case, stretch};

/// Whether the motion from rest at λ = 1 reaches `stretch` before it turns
/// back: the classical Runge-Kutta method on Eq. 16. The step is below 1/1000
/// of the fastest period here, so the energy is kept to about 1e-11, well below
/// the distance of 1e-8 from the threshold at which this is used.
fn passes(case: Case, voltage: f64, stretch: f64) -> bool {
    const STEP: f64 = 0.01;
    const STEPS: usize = 1_000_000;
    let rate = |[x, v]: [f64; 2]| {
        let force = voltage * voltage * x.powi(3) - case.restoring_force(x);
        let inertia = Case::INERTIA + 2.0 * x.powi(-6);
        [v, (6.0 * x.powi(-7) * v * v + force) / inertia]
    };
    let along = |[x, v]: [f64; 2], [dx, dv]: [f64; 2], h: f64| [x + h * dx, v + h * dv];
    let mut state = [1.0, 0.0];
    for _ in 0..STEPS {
        let k1 = rate(state);
        let k2 = rate(along(state, k1, STEP / 2.0));
        let k3 = rate(along(state, k2, STEP / 2.0));
        let k4 = rate(along(state, k3, STEP));
        let mean = [0, 1].map(|i| (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]) / 6.0);
        state = along(state, mean, STEP);
        if state[0] >= stretch {
            return true;
        }
        if state[1] <= 0.0 {
            return false;
        }
    }
    panic!("the motion neither passes {stretch} nor turns back");
}

#[test]
fn both_sides_of_the_dynamic_threshold() {
    let ideal = Case::IDEAL;
    for case in [
        ideal,
        Case {
            prestress: 0.5,
            ..ideal
        },
        Case {
            prestress: -0.4,
            ..ideal
        },
        Case {
            gamma: 0.1,
            tau: 0.05,
            ..ideal
        },
        Case {
            tau: 0.3,
            prestress: 1.0,
            ..ideal
        },
        Case {
            elasticity: 0.007,
            ..ideal
        },
        Case {
            elasticity: 0.029,
            ..ideal
        },
        Case {
            gamma: 1.4,
            elasticity: 0.1,
            ..ideal
        },
    ] {
        let fold = case.dynamic().expect("these have a fold");
        assert!(stretch(fold) > 1.0);
        assert!(
            passes(case, fold.voltage * (1.0 + 1e-8), 1.05 * stretch(fold)),
            "{case:?}"
        );
        assert!(
            !passes(case, fold.voltage * (1.0 - 1e-8), stretch(fold)),
            "{case:?}"
        );
    }
}

/// With a strong surface energy or compression the stagnation curve falls from
/// λ = 1 on: the motion contracts, or runs away from rest.
#[test]
fn both_sides_of_a_threshold_at_rest() {
    let ideal = Case::IDEAL;
    for case in [
        Case {
            gamma: 3.0,
            tau: 0.5,
            ..ideal
        },
        Case {
            prestress: -2.5,
            ..ideal
        },
        Case {
            gamma: 1.5625,
            ..ideal
        },
        Case {
            gamma: 5.0,
            elasticity: 0.1,
            ..ideal
        },
    ] {
        let fold = case.dynamic().expect("the curve falls from λ = 1 on");
        assert_eq!(fold.thickness_stretch, 1.0);
        let square = 2.0 * (case.gamma + case.tau) - case.prestress;
        assert_rounded(fold.voltage, square.sqrt(), "φ");
        assert!(passes(case, fold.voltage * (1.0 + 1e-8), 2.0), "{case:?}");
        assert!(
            !passes(case, fold.voltage * (1.0 - 1e-8), 1.0 + 1e-6),
            "{case:?}"
        );
    }
}

#[test]
fn without_a_fold_the_turning_stretch_grows_steadily() {
    let case = Case {
        elasticity: 0.03,
        ..Case::IDEAL
    };
    assert_eq!(case.dynamic(), None);
    for turn in [1.5_f64, 1.6, 1.7, 1.75, 1.8, 1.9, 2.0, 2.5] {
        let voltage = case.stagnation(turn).sqrt();
        assert!(passes(case, voltage, turn * (1.0 - 1e-6)), "{turn}");
        assert!(!passes(case, voltage, turn * (1.0 + 1e-6)), "{turn}");
    }
}

#[test]
fn both_sides_of_the_escape_voltage() {
    // No fold: the turning stretch grows to infinity as φ² nears 4τ.
    let case = Case {
        tau: 0.8,
        ..Case::IDEAL
    };
    assert_eq!(case.dynamic(), None);
    let escape = case.escape_voltage().expect("E = 0");
    assert!(passes(case, escape * (1.0 + 1e-3), 50.0));
    assert!(!passes(case, escape * (1.0 - 1e-3), 50.0));

    // A fold below 4τ: between the two the actuator pulls in, but is bounded.
    let case = Case {
        tau: 5.0,
        prestress: -8.5,
        ..Case::IDEAL
    };
    let fold = case.dynamic().expect("compression makes a fold");
    let escape = case.escape_voltage().expect("E = 0");
    let between = 0.5 * (fold.voltage + escape);
    assert!(!passes(case, fold.voltage * (1.0 - 1e-8), stretch(fold)));
    assert!(passes(case, between, 1.05 * stretch(fold)));
    assert!(!passes(case, between, 50.0));
    assert!(passes(case, escape * (1.0 + 1e-3), 50.0));
}
