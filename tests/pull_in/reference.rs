//! The multiprecision values in `tests/reference/thresholds_periods.json`.

use super::case::Case;
use super::{ROUNDING_ERROR, assert_within};
use serde_json::Value;

fn rows(table: &str, count: usize) -> Vec<Value> {
    let path = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/tests/reference/thresholds_periods.json"
    );
    let text = std::fs::read_to_string(path).expect("the reference file is checked in");
    let all: Value = serde_json::from_str(&text).expect("the reference file is JSON");
    let rows = all[table].as_array().expect("the table is a list").clone();
    assert_eq!(rows.len(), count, "{table}");
    rows
}

/// A number that the file keeps as a string of its trusted digits.
struct Printed {
    value: f64,
    /// Half a unit of the last digit.
    half_unit: f64,
}

impl Printed {
    /// `None` for null.
    fn of(row: &Value, key: &str) -> Option<Self> {
        assert!(row[key].is_string() || row[key].is_null(), "{key} of {row}");
        let text = row[key].as_str()?;
        let decimals = text.split_once('.').map_or(0, |(_, digits)| digits.len());
        Some(Self {
            value: text.parse().expect("the string is a number"),
            half_unit: format!("0.5e-{decimals}").parse().expect("a power of ten"),
        })
    }

    #[track_caller]
    fn assert_is(&self, actual: f64, what: &str) {
        let error = self.half_unit + ROUNDING_ERROR * self.value.abs();
        assert_within(actual, self.value, error, what);
    }
}

fn parameter(row: &Value, key: &str) -> f64 {
    Printed::of(row, key)
        .expect("a parameter is never null")
        .value
}

#[test]
fn thresholds_of_both_tables() {
    for row in [rows("table1", 13), rows("thresholds_combined", 30)].concat() {
        let case = Case {
            gamma: parameter(&row, "g"),
            tau: parameter(&row, "tau"),
            elasticity: parameter(&row, "E"),
            prestress: parameter(&row, "S"),
        };
        for (fold, voltage, stretch) in [
            (case.dynamic(), "phiC", "lam3C"),
            (case.quasi_static(), "phi_static", "lam3_static"),
        ] {
            for (actual, key) in [
                (fold.map(|fold| fold.voltage), voltage),
                (fold.map(|fold| fold.thickness_stretch), stretch),
            ] {
                let what = format!("{key} of {case:?}");
                match (actual, Printed::of(&row, key)) {
                    (Some(actual), Some(expected)) => expected.assert_is(actual, &what),
                    (None, None) => {}
                    (actual, _) => panic!("{what}: {actual:?}"),
                }
            }
        }
    }
}

#[test]
fn folds_end_at_the_cusps() {
    for row in rows("cusp_E_star", 12) {
        let of_dynamic = row["kind"] == "dynamic";
        // Only the difference of γ and τ matters.
        let difference = parameter(&row, "g_minus_tau");
        let fold = |elasticity: f64| {
            let case = Case {
                gamma: difference.max(0.0),
                tau: (-difference).max(0.0),
                elasticity,
                prestress: parameter(&row, "S"),
            };
            if of_dynamic {
                case.dynamic()
            } else {
                case.quasi_static()
            }
        };
        let cusp = parameter(&row, "E_star");
        assert!(fold(cusp * (1.0 - 1e-6)).is_some(), "{row}");
        assert!(fold(cusp * (1.0 + 1e-6)).is_none(), "{row}");

        let (mut with, mut without) = (0.0, 1.0);
        for _ in 0..60 {
            let middle = 0.5 * (with + without);
            if fold(middle).is_some() {
                with = middle;
            } else {
                without = middle;
            }
        }
        let what = row.to_string();
        let assert_is = |actual: f64, key: &str| {
            if let Some(expected) = Printed::of(&row, key) {
                expected.assert_is(actual, &what);
            }
        };
        assert_is(with, "E_star");
        let last = fold(with).expect("the bisection keeps a fold on this side");
        assert_is(last.voltage.powi(2), "phi2_minus_4tau");
        // The fold has shrunk to a double zero of the descent, whose place is
        // known only to the square root of a rounding error.
        assert_within(last.thickness_stretch, parameter(&row, "lam3"), 1e-7, &what);
    }
}
