//! Free-running: a fresh start, read at the times of the reference, for a sweep
//! of tolerances.

use std::time::Duration;

use crate::case::{Case, Pair};
use crate::row::Row;
use crate::timing::{processor_time, seconds_per_call};
use crate::{ours, rivals};

/// A run that takes longer ends the sweep of its method.
const LONGEST: Duration = Duration::from_millis(500);

/// A run further off than this does not follow the motion at all.
const LOST: f64 = 0.1;

/// Integrates a case with a tolerance and pushes the states at its times.
pub type Solve = fn(&Case, f64, &mut Vec<Pair>) -> Result<(), String>;

/// A method to be timed.
pub struct Method {
    pub name: &'static str,
    pub solve: Solve,
    /// What comes before the motion and is not of it: what it takes is taken off.
    pub idle: Option<Solve>,
    /// Tolerances from 10^−first to 10^−last.
    pub exponents: [i32; 2],
    /// An error above this many tolerances is none of the method's good ones.
    pub allowed: f64,
}

/// Times all methods once.
pub fn run(case: &Case, least: Duration) {
    for method in ours::METHODS.iter().chain(rivals::METHODS) {
        sweep(method, case, least);
    }
}

fn sweep(method: &Method, case: &Case, least: Duration) {
    let mut states = Vec::with_capacity(case.times.len() + 2);
    for exponent in method.exponents[0]..=method.exponents[1] {
        let tolerance = 10_f64.powi(-exponent);
        let mut row = Row {
            method: method.name,
            tolerance,
            step: None,
            inputs: "unchanged",
            nanoseconds: None,
            error: None,
            hold_error: None,
            note: String::new(),
        };
        states.clear();
        let begin = processor_time();
        if let Err(message) = (method.solve)(case, tolerance, &mut states) {
            row.note = format!("failed: {message}");
            row.print();
            continue;
        }
        let single = processor_time() - begin;
        let error = case.error(&states);
        row.error = Some(error);
        // 1e-12: what rounding the parameters alone may do to a case, with room.
        let bound = (method.allowed * tolerance + 1e-12).min(LOST);
        if error.is_nan() || error > bound {
            row.note = format!("not timed: error above {bound:.1e}");
            row.print();
            continue;
        }
        let mut time = |solve: Solve| {
            seconds_per_call(least, || {
                states.clear();
                let done = solve(case, tolerance, &mut states);
                assert!(std::hint::black_box(done).is_ok());
            })
        };
        let seconds = if single > LONGEST {
            single.as_secs_f64()
        } else {
            time(method.solve) - method.idle.map_or(0.0, &mut time)
        };
        row.nanoseconds = Some(1e9 * seconds / case.end());
        row.print();
        if single > LONGEST {
            break;
        }
    }
}
