//! Cases that can be solved by hand.

use super::case::Case;
use super::{ROUNDING_ERROR, assert_rounded, assert_within};

#[test]
fn ideal_actuator() {
    let fold = Case::IDEAL.dynamic().expect("the ideal actuator pulls in");
    assert_rounded(fold.voltage, 0.646_983_632_244_827_4, "dynamic φ");
    let x = fold.thickness_stretch;
    let cubic = ((x + 2.0) * x + 1.0) * x - 1.0;
    assert_within(cubic, 0.0, ROUNDING_ERROR, "x³ + 2x² + x − 1 at λ3");

    let fold = Case::IDEAL
        .quasi_static()
        .expect("the ideal actuator pulls in");
    let voltage = 3.0_f64.sqrt() * 2.0_f64.powf(-4.0 / 3.0);
    assert_rounded(fold.voltage, voltage, "static φ");
    assert_rounded(
        fold.thickness_stretch,
        4.0_f64.powf(-1.0 / 3.0),
        "static λ3",
    );
}

/// E = S = 0: with x = λ3 and a = 1 + 2γ − 2τ, Eq. 20 is x(1+x)² = a, and the
/// equilibrium curve has its top at x = ∛(a/4) with φ² = 4τ + (3/4) a x.
#[test]
fn without_elasticity_and_prestress() {
    for (gamma, tau) in [
        (0.25, 0.0),
        (1.25, 0.0),
        (0.0, 0.375),
        (100.0, 99.75),
        (0.0, 0.499),
    ] {
        let case = Case {
            gamma,
            tau,
            ..Case::IDEAL
        };
        let a = 1.0 + 2.0 * gamma - 2.0 * tau;

        let fold = case.dynamic().expect("a > 0");
        let x = fold.thickness_stretch;
        assert_rounded(x * (1.0 + x) * (1.0 + x), a, "dynamic λ3");
        let square = 4.0 * tau - x * x + 2.0 * a * x / (1.0 + x);
        assert_rounded(fold.voltage, square.sqrt(), "dynamic φ");

        let fold = case.quasi_static().expect("a > 0");
        let x = (a / 4.0).cbrt();
        assert_rounded(fold.thickness_stretch, x, "static λ3");
        assert_rounded(fold.voltage, (4.0 * tau + 0.75 * a * x).sqrt(), "static φ");
    }
}

/// E = 0 and τ = γ + 1/2: the linear force vanishes, and only compression,
/// S < 0, makes a fold, on the equilibrium curve at 1/λ⁵ = (3/8)|S|.
#[test]
fn linear_force_cancelled() {
    let cancelled = Case {
        tau: 0.5,
        ..Case::IDEAL
    };
    for prestress in [-0.01_f64, -1.0, -1000.0] {
        let z = (-0.375 * prestress).powf(0.2);
        let fold = Case {
            prestress,
            ..cancelled
        }
        .quasi_static();
        let fold = fold.expect("compression makes a fold");
        assert_rounded(fold.thickness_stretch, z * z, "λ3");
        let square = 2.0 - prestress * z.powi(3) - z.powi(8);
        assert_rounded(fold.voltage, square.sqrt(), "φ");
    }
    for prestress in [0.0, 1.0] {
        let case = Case {
            prestress,
            ..cancelled
        };
        assert_eq!(case.quasi_static(), None);
        assert_eq!(case.dynamic(), None);
    }
}

/// The limit γ = 3/2 between a maximum at λ > 1 and one at λ = 1 itself.
#[test]
fn maximum_reaches_rest() {
    for (gamma, at_rest) in [(1.4, false), (1.5 - 1e-6, false), (1.5, true), (1.6, true)] {
        let fold = Case {
            gamma,
            ..Case::IDEAL
        }
        .dynamic()
        .expect("E = 0");
        let distance = (1.0 - fold.thickness_stretch).abs();
        assert_eq!(distance < ROUNDING_ERROR, at_rest, "γ = {gamma}: {fold:?}");
    }
}

#[test]
fn escape() {
    let ideal = Case::IDEAL;
    for (case, square) in [
        // The fold is above the level 4τ at infinity ...
        (ideal, ideal.dynamic().map(|fold| fold.voltage.powi(2))),
        // ... or there is none ...
        (Case { tau: 0.8, ..ideal }, Some(3.2)),
        // ... or it is λ = 1 with φ² = 2(γ+τ) − S, above the level or below.
        (
            Case {
                tau: 0.5,
                gamma: 3.0,
                ..ideal
            },
            Some(7.0),
        ),
        (
            Case {
                tau: 5.0,
                prestress: -9.0,
                ..ideal
            },
            Some(20.0),
        ),
        (
            Case {
                elasticity: 1e-6,
                ..ideal
            },
            None,
        ),
    ] {
        let escape = case.escape_voltage();
        assert_eq!(escape.is_some(), square.is_some(), "{case:?}");
        if let (Some(escape), Some(square)) = (escape, square) {
            assert_rounded(escape, square.sqrt(), &format!("{case:?}"));
        }
    }
}
