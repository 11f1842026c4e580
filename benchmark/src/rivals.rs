//! The rivals in Rust, each set up as its documentation shows, with the same
//! number for relative and absolute tolerance.

use differential_equations::prelude::{ExplicitRungeKutta, IVP, ODE};
use diffsol::{NalgebraMat, OdeBuilder, OdeSolverMethod};
use ode_solvers::dop_shared::OutputType;
use ode_solvers::{Dop853, Dopri5, SVector, System};

use crate::case::{Case, Pair, RightHandSide};
use crate::free::Method;

/// Errors of general methods add up over the run: a case near pull-in or near
/// resonance takes them far beyond the tolerance of a step.
const fn method(name: &'static str, last: i32, solve: crate::free::Solve) -> Method {
    Method {
        name,
        solve,
        idle: None,
        exponents: [3, last],
        allowed: f64::INFINITY,
    }
}

pub const METHODS: &[Method] = &[
    method("ode_solvers Dop853", 14, dop853),
    method("ode_solvers Dopri5", 12, dopri5),
    method("differential-equations rkv988e", 14, verner),
    method("diffsol tsit45", 12, tsit45),
];

/// Enough for every tolerance, and an end for a run that escapes.
const MOST_STEPS: usize = 2_000_000;

type Vector = SVector<f64, 2>;

impl System<f64, Vector> for RightHandSide {
    fn system(&self, time: f64, state: &Vector, slope: &mut Vector) {
        let [first, second] = self.at(time, state[0], state[1]);
        slope[0] = first;
        slope[1] = second;
    }
}

/// Both methods of ode_solvers take their settings in the same order. Those that
/// differ from their `new`: more steps, and no test for stiffness,
/// which stops an alternating case by mistake. Ending a little after the last
/// time keeps clear of their interpolation at the very end, which goes wrong
/// where the outputs are further apart than the steps.
macro_rules! hairer {
    ($name:ident, $method:ident, $beta:expr, [$least:expr, $most:expr]) => {
        fn $name(case: &Case, tolerance: f64, states: &mut Vec<Pair>) -> Result<(), String> {
            let spacing = case.times[0];
            let end = case.end() + 1e-3 * spacing;
            let rest = Vector::new(1.0, 0.0);
            let mut solver = $method::from_param(
                case.right_hand_side(),
                0.0,
                end,
                spacing,
                rest,
                tolerance,
                tolerance,
                0.9,
                $beta,
                $least,
                $most,
                end,
                0.0,
                MOST_STEPS as u32,
                u32::MAX,
                OutputType::Dense,
            );
            solver.integrate().map_err(|error| error.to_string())?;
            states.extend(solver.y_out().iter().skip(1).map(|y| [y[0], y[1]]));
            Ok(())
        }
    };
}

hairer!(dop853, Dop853, 0.0, [0.333, 6.0]);
hairer!(dopri5, Dopri5, 0.04, [0.2, 10.0]);

/// What `differential-equations` is given.
struct Actuator(RightHandSide);

impl ODE<f64, Pair> for Actuator {
    fn diff(&self, time: f64, state: &Pair, slope: &mut Pair) {
        *slope = self.0.at(time, state[0], state[1]);
    }
}

/// The best method of `differential-equations` on these cases; its `dop853` loses order.
fn verner(case: &Case, tolerance: f64, states: &mut Vec<Pair>) -> Result<(), String> {
    let system = Actuator(case.right_hand_side());
    let problem = IVP::ode(&system, 0.0, case.end(), [1.0, 0.0]).t_eval(&case.times);
    let method = ExplicitRungeKutta::rkv988e()
        .rtol(tolerance)
        .atol(tolerance)
        .max_steps(MOST_STEPS);
    let solution = problem.method(method).solve();
    let solution = solution.map_err(|error| format!("{error:?}"))?;
    states.extend(solution.y.iter());
    Ok(())
}

/// The state a time `step` after `state`, by a rival: an answer that shares
/// nothing with ours.
pub fn one_step(right_hand_side: RightHandSide, state: Pair, step: f64) -> Pair {
    // `Dop853` loses its order where the right-hand side depends on time, hence
    // the third state; the parts are so short that only rounding is left.
    let system = Clocked(right_hand_side);
    let parts = (step / 0.25).ceil();
    let (mut state, mut time) = (state, 0.0);
    for _ in 0..parts as u32 {
        let start = SVector::<f64, 3>::new(state[0], state[1], time);
        let span = step / parts;
        let mut solver = Dop853::from_param(
            system,
            0.0,
            span,
            span,
            start,
            1e-14,
            1e-14,
            0.9,
            0.0,
            0.333,
            6.0,
            span,
            span,
            1000,
            u32::MAX,
            OutputType::Sparse,
        );
        solver.integrate().unwrap_or_else(|error| panic!("{error}"));
        let end = solver.y_out().last().expect("it has an end");
        (state, time) = ([end[0], end[1]], end[2]);
    }
    state
}

/// A right-hand side with the time as a third state.
#[derive(Clone, Copy)]
struct Clocked(RightHandSide);

impl System<f64, SVector<f64, 3>> for Clocked {
    fn system(&self, _: f64, state: &SVector<f64, 3>, slope: &mut SVector<f64, 3>) {
        let [first, second] = self.0.at(state[2], state[0], state[1]);
        *slope = SVector::<f64, 3>::new(first, second, 1.0);
    }
}

fn tsit45(case: &Case, tolerance: f64, states: &mut Vec<Pair>) -> Result<(), String> {
    let system = case.right_hand_side();
    // Setting the problem up is no work of the method, but small beside a run.
    let problem = OdeBuilder::<NalgebraMat<f64>>::new()
        .rtol(tolerance)
        .atol([tolerance])
        .rhs(move |state, _parameters, time, slope| {
            let [first, second] = system.at(time, state[0], state[1]);
            slope[0] = first;
            slope[1] = second;
        })
        .init(
            |_parameters, _time, state| {
                state[0] = 1.0;
                state[1] = 0.0;
            },
            2,
        )
        .build()
        .map_err(|error| error.to_string())?;
    let mut solver = problem.tsit45().map_err(|error| error.to_string())?;
    let (solution, _) = solver
        .solve_dense(&case.times)
        .map_err(|error| error.to_string())?;
    for column in 0..case.times.len() {
        states.push([solution[(0, column)], solution[(1, column)]]);
    }
    Ok(())
}
