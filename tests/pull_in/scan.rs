//! Thresholds against a slow scan of the curves, and properties, on random
//! parameters far beyond the paper's γ, τ ≤ 0.1, E ≤ 0.4, S ≤ 0.5.

use super::ROUNDING_ERROR;
use super::case::{Case, stretch};
use dielectric_elastomer_actuator::pull_in::Threshold;
use proptest::prelude::*;

/// Error of φ², relative to the sum of the sizes of the parameters, 1, and φ²:
/// rounding in a hundred operations on terms a few times larger than these.
const SCAN_ERROR: f64 = 1e-13;

/// Ratio of neighbouring stretches of a scan. A scan does not see a dip that is
/// narrower, and places a maximum to within it.
const SCAN_RATIO: f64 = 1.001;

/// Largest stretch of a scan. Far beyond, a cell changes φ² by rounding only.
const SCAN_END: f64 = 1e3;

/// The first maximum of `curve` with growing stretch from `start` on: the
/// naive twin. Returns stretch and φ².
fn scan(curve: impl Fn(f64) -> f64, start: f64) -> Option<(f64, f64)> {
    let mut stretch = start;
    while curve(stretch * SCAN_RATIO) >= curve(stretch) {
        stretch *= SCAN_RATIO;
        if stretch > SCAN_END {
            return None;
        }
    }
    // Golden section between the neighbours of the highest point.
    let (mut low, mut high) = ((stretch / SCAN_RATIO).max(start), stretch * SCAN_RATIO);
    let golden = (5.0_f64.sqrt() - 1.0) / 2.0;
    for _ in 0..60 {
        let width = golden * (high - low);
        if curve(high - width) >= curve(low + width) {
            high = low + width;
        } else {
            low = high - width;
        }
    }
    Some((low, curve(low)))
}

/// Where the force alone leads from λ = 1 without voltage: the last point of
/// the scan before it changes sign.
fn rest_without_voltage(case: Case) -> f64 {
    let inward = case.restoring_force(1.0) > 0.0;
    let ratio = if inward {
        SCAN_RATIO.recip()
    } else {
        SCAN_RATIO
    };
    let mut stretch = 1.0;
    while (case.restoring_force(stretch * ratio) > 0.0) == inward {
        stretch *= ratio;
    }
    stretch
}

/// Holds a threshold against the scan of `curve` from `start` on.
fn assert_like_scan(
    case: Case,
    threshold: Option<Threshold>,
    curve: impl Fn(f64) -> f64,
    start: f64,
) {
    match (threshold, scan(&curve, start)) {
        (None, None) => {}
        (Some(fold), Some((place, square))) => {
            let apart = (stretch(fold) / place).ln().abs();
            assert!(apart < SCAN_RATIO.ln(), "{case:?} {fold:?} {place}");
            let scale = 1.0 + case.gamma + case.tau + case.elasticity + case.prestress.abs();
            let error = (fold.voltage.powi(2) - square).abs();
            assert!(error < SCAN_ERROR * (scale + square), "{case:?} {error:e}");
        }
        (Some(fold), None) => {
            // Beyond the scan, or a dip between its points: then the curve is
            // above the threshold again a few cells further on.
            let beyond = curve(stretch(fold) * SCAN_RATIO.powi(5));
            assert!(
                stretch(fold) > SCAN_END || beyond > fold.voltage.powi(2),
                "{case:?}: the scan does not have {fold:?}"
            );
        }
        (None, Some(maximum)) => panic!("{case:?}: the scan has a maximum {maximum:?}"),
    }
}

/// γ and τ are binary fractions, so that their sums do not round. E is 0 or
/// spread over eight decades, S of either sign, large or near the paper's.
fn cases() -> impl Strategy<Value = Case> {
    let surface = || prop_oneof![0..32_u32, 0..320_u32].prop_map(|n| f64::from(n) / 64.0);
    let elasticity = prop_oneof![Just(0.0), (-6.0..2.0).prop_map(|x| 10.0_f64.powf(x))];
    let prestress = prop_oneof![-1.0..1.0, -40.0..10.0];
    (surface(), surface(), elasticity, prestress).prop_map(|(gamma, tau, elasticity, prestress)| {
        Case {
            gamma,
            tau,
            elasticity,
            prestress,
        }
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    #[test]
    fn dynamic_threshold_is_the_first_maximum_from_rest(case in cases()) {
        assert_like_scan(case, case.dynamic(), |stretch| case.stagnation(stretch), 1.0);
    }

    #[test]
    fn quasi_static_threshold_is_the_first_maximum_from_the_prestressed_state(case in cases()) {
        let curve = |stretch: f64| case.restoring_force(stretch) / stretch.powi(3);
        assert_like_scan(case, case.quasi_static(), curve, rest_without_voltage(case));
    }

    /// (γ, τ, φ²) has the dynamics of (γ + δ, τ + δ, φ² + 4δ).
    #[test]
    fn surface_energy_and_tension_are_redundant(case in cases(), shift in 0..320_u32) {
        // Only the voltage that counts as none differs, and with it the state
        // before the quasi-static pull-in if there are two (E > 29).
        let case = Case { elasticity: case.elasticity.min(20.0), ..case };
        let shift = f64::from(shift) / 64.0;
        let twin = Case { gamma: case.gamma + shift, tau: case.tau + shift, ..case };
        for (fold, of_twin) in [
            (case.dynamic(), twin.dynamic()),
            (case.quasi_static(), twin.quasi_static()),
        ] {
            prop_assert_eq!(
                fold.map(|fold| fold.thickness_stretch),
                of_twin.map(|fold| fold.thickness_stretch)
            );
            if let (Some(fold), Some(of_twin)) = (fold, of_twin) {
                let error = fold.voltage.powi(2) + 4.0 * shift - of_twin.voltage.powi(2);
                let scale = 1.0 + of_twin.voltage.powi(2) + case.elasticity;
                prop_assert!(error.abs() < ROUNDING_ERROR * scale, "{error:e}");
            }
        }
    }

    #[test]
    fn the_dynamic_threshold_comes_first(case in cases()) {
        if let Some(fold) = case.dynamic() {
            let later = case.quasi_static().expect("a stationary Φ lies on a falling Ψ");
            prop_assert!(fold.voltage > 0.0);
            prop_assert!(fold.voltage <= later.voltage * (1.0 + ROUNDING_ERROR));
            prop_assert!(case.escape_voltage().is_none_or(|escape| escape >= fold.voltage));
        }
    }

    #[test]
    fn answers_are_finite_far_beyond_the_admissible_parameters(
        surface in prop::array::uniform3(prop_oneof![
            Just(0.0), Just(5e-324), Just(0.5), Just(100.0), Just(1e6), 0.0..100.0
        ]),
        prestress in prop_oneof![
            Just(0.0), Just(5e-324), Just(-1e6), Just(1e6), -1000.0..1000.0
        ],
    ) {
        let [gamma, tau, elasticity] = surface;
        let case = Case { gamma, tau, elasticity, prestress };
        for fold in [case.dynamic(), case.quasi_static()].into_iter().flatten() {
            prop_assert!(fold.voltage.is_finite());
            prop_assert!(fold.thickness_stretch.is_finite() && fold.thickness_stretch > 0.0);
        }
        prop_assert!(case.escape_voltage().is_none_or(f64::is_finite));
    }
}

/// E = 100: surface elasticity alone makes a second, contracted state.
#[test]
fn a_contracted_state_counts_only_if_the_actuator_rests_there() {
    let stiff = Case {
        elasticity: 100.0,
        ..Case::IDEAL
    };
    let natural = Case {
        prestress: -20.0,
        ..stiff
    };
    assert!(rest_without_voltage(natural) > 0.8);
    assert_eq!(natural.quasi_static(), None);
    let contracted = Case {
        prestress: -30.0,
        ..stiff
    };
    assert!(rest_without_voltage(contracted) < 0.7);
    assert!(contracted.quasi_static().is_some());
}
