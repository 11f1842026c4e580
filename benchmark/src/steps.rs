//! The pattern of a co-simulation: set, step, get, at a given communication step.

use std::hint::black_box;
use std::time::Duration;

use crate::case::{Case, Pair, larger};
use crate::fmu::Fmu;
use crate::host::Host;
use crate::rivals::one_step;
use crate::row::Row;
use crate::timing::{BATCHES, median, processor_time};
use crate::van_der_pol::Oscillator;

const STEPS: [f64; 5] = [0.001, 0.01, 0.1, 1.0, 10.0];

/// Tolerances at which the FMU is run.
const TOLERANCES: [f64; 2] = [1e-6, 1e-12];

/// Calls in one run, unless the first time of the reference needs more.
const MOST_CALLS: f64 = 5e4;

/// Orders of the derivatives of the voltage that are set at each call.
const CHANGES: [(&str, usize); 3] = [("held", 0), ("linear", 1), ("cubic", 3)];

/// Errors above this many tolerances are not worth a time. Inputs that jump at
/// each step make each step a start of its own, whose errors add up.
const ALLOWED: f64 = 1e3;

/// Inputs unchanged, and nothing read after the step.
const STEP_ALONE: &str = "unchanged; nothing read";

/// The voltage set to what it is.
const SET_AGAIN: &str = "set to what they are";

/// A voltage that is held until the next step; nothing read after it.
const HELD_ALONE: &str = "held; nothing read";

/// A run in communication steps to a time of the reference.
struct Plan<'a> {
    case: &'a Case,
    step: f64,
    calls: u64,
    /// Times of the reference that are reached.
    reached: usize,
}

impl Plan<'_> {
    fn new(case: &Case, step: f64) -> Plan<'_> {
        let within = |time: &&f64| **time <= step * MOST_CALLS * (1.0 + 1e-9);
        let reached = case.times.iter().take_while(within).count().max(1);
        // A step of 10 does not meet 25: only every second time is compared.
        let reached = if reached > 1 && !meets(case.times[reached - 1], step) {
            reached - 1
        } else {
            reached
        };
        let calls = (case.times[reached - 1] / step).round() as u64;
        Plan {
            case,
            step,
            calls,
            reached,
        }
    }

    /// Nanoseconds for each call; making a fresh instance for each run is not timed.
    fn time<H>(
        &self,
        least: Duration,
        fresh: impl Fn() -> H,
        each: impl Fn(&H, u64),
    ) -> Option<f64> {
        let batch = least / BATCHES as u32;
        let one = || {
            let (mut passed, mut runs) = (Duration::ZERO, 0_u64);
            while passed < batch {
                let host = fresh();
                let begin = processor_time();
                for call in 0..self.calls {
                    each(&host, call);
                }
                passed += processor_time() - begin;
                runs += 1;
            }
            1e9 * passed.as_secs_f64() / (runs * self.calls) as f64
        };
        one();
        Some(median([(); BATCHES].map(|()| one())))
    }

    /// The index of the reference at the end of a call, if it has one.
    fn compared(&self, call: u64) -> Option<usize> {
        let time = (call + 1) as f64 * self.step;
        let times = &self.case.times[..self.reached];
        times
            .iter()
            .position(|t| (t - time).abs() < 1e-3 * self.step)
    }
}

fn meets(time: f64, step: f64) -> bool {
    ((time / step).round() * step - time).abs() < 1e-6 * step
}

/// The voltage that the inputs follow, and its derivatives: the alternating one
/// of the case, or a ripple on the constant one.
fn voltage(case: &Case, time: f64) -> [f64; 4] {
    let (mean, amplitude, frequency) = if case.amplitude == 0.0 {
        (case.voltage, 0.01, 0.3)
    } else {
        (case.voltage, case.amplitude, case.frequency)
    };
    let (sine, cosine) = (frequency * time).sin_cos();
    [
        mean + amplitude * sine,
        amplitude * frequency * cosine,
        -amplitude * frequency.powi(2) * sine,
        -amplitude * frequency.powi(3) * cosine,
    ]
}

/// Times all patterns once.
pub fn run(case: &Case, least: Duration) {
    for step in STEPS {
        let plan = Plan::new(case, step);
        for tolerance in TOLERANCES {
            unchanged(&plan, tolerance, least);
        }
        for (name, order) in CHANGES {
            changing(&plan, name, order, least);
        }
    }
}

/// Times the FMU of another equation in the same pattern, loaded from its `library`.
pub fn van_der_pol(case: &Case, library: &str, least: Duration) {
    let fmu = Fmu::load(library);
    for step in STEPS {
        let plan = Plan::new(case, step);
        let fresh = || Oscillator::start(&fmu);
        let read = plan.time(least, fresh, |oscillator, call| {
            oscillator.step(call as f64 * step, step);
            black_box(oscillator.displacement());
        });
        let alone = plan.time(least, fresh, |oscillator, call| {
            oscillator.step(call as f64 * step, step);
        });
        for (inputs, nanoseconds) in [("unchanged", read), (STEP_ALONE, alone)] {
            Row {
                method: "Reference FMU VanDerPol",
                tolerance: 0.01,
                step: Some(step),
                inputs,
                nanoseconds,
                error: None,
                hold_error: None,
                note: "another equation; time only".into(),
            }
            .print();
        }
    }
}

fn unchanged(plan: &Plan, tolerance: f64, least: Duration) {
    let Plan { case, step, .. } = *plan;
    let fresh = || Host::new(case, tolerance, true);
    let host = fresh();
    let mut error = 0.0_f64;
    for call in 0..plan.calls {
        host.step(call as f64 * step, step);
        if let Some(index) = plan.compared(call) {
            error = larger(error, distance(host.state(), case.exact[index]));
        }
    }
    let mut row = Row {
        method: "ours",
        tolerance,
        step: Some(step),
        inputs: "unchanged",
        nanoseconds: None,
        error: Some(error),
        hold_error: None,
        note: String::new(),
    };
    if error <= 10.0 * tolerance + 1e-12 {
        row.nanoseconds = plan.time(least, fresh, |host, call| {
            host.step(call as f64 * step, step);
            black_box(host.stretch());
        });
    } else {
        row.note = "not timed: error above 10 tolerances".into();
        row.print();
        return;
    }
    row.print();
    row.inputs = STEP_ALONE;
    row.nanoseconds = plan.time(least, fresh, |host, call| {
        host.step(call as f64 * step, step)
    });
    row.print();
    row.inputs = SET_AGAIN;
    let same = [case.voltage, 0.0, 0.0, 0.0];
    row.nanoseconds = plan.time(least, fresh, |host, call| {
        host.set(black_box(&same), 0);
        host.step(call as f64 * step, step);
        black_box(host.stretch());
    });
    row.print();
}

fn changing(plan: &Plan, name: &str, order: usize, least: Duration) {
    let Plan { case, step, .. } = *plan;
    let inputs: Vec<[f64; 4]> = (0..plan.calls)
        .map(|call| voltage(case, call as f64 * step))
        .collect();
    let independent = independent(plan, &inputs, order);
    for tolerance in TOLERANCES {
        let fresh = || Host::new(case, tolerance, false);
        let host = fresh();
        let (mut error, mut hold_error, mut compared) = (0.0_f64, 0.0_f64, 0);
        for (call, input) in inputs.iter().enumerate() {
            host.set(input, order);
            host.step(call as f64 * step, step);
            if let Some(index) = plan.compared(call as u64) {
                let state = host.state();
                error = larger(error, distance(state, independent[compared]));
                hold_error = larger(hold_error, distance(state, case.exact[index]));
                compared += 1;
            }
        }
        let mut row = Row {
            method: "ours",
            tolerance,
            step: Some(step),
            inputs: name,
            nanoseconds: None,
            error: Some(error),
            // The reference of a constant voltage knows no ripple.
            hold_error: (case.amplitude != 0.0).then_some(hold_error),
            note: String::new(),
        };
        // 1e-12: what is left of the independent answer, restarted at each step.
        if error <= ALLOWED * tolerance + 1e-12 {
            row.nanoseconds = plan.time(least, fresh, |host, call| {
                host.set(&inputs[call as usize], order);
                host.step(call as f64 * step, step);
                black_box(host.stretch());
            });
        } else {
            row.note = "not timed: error above 1000 tolerances".into();
        }
        row.print();
        if order == 0 && row.nanoseconds.is_some() {
            row.inputs = HELD_ALONE;
            row.nanoseconds = plan.time(least, fresh, |host, call| {
                host.set(&inputs[call as usize], order);
                host.step(call as f64 * step, step);
            });
            row.print();
        }
    }
}

/// States at the compared times under the very inputs, by a rival.
fn independent(plan: &Plan, inputs: &[[f64; 4]], order: usize) -> Vec<Pair> {
    let system = plan.case.right_hand_side();
    let (mut state, mut states) = ([1.0, 0.0], Vec::new());
    for (call, input) in inputs.iter().enumerate() {
        let mut polynomial = [input[0], input[1], input[2] / 2.0, input[3] / 6.0];
        polynomial[order + 1..].fill(0.0);
        state = one_step(system.under(polynomial), state, plan.step);
        if plan.compared(call as u64).is_some() {
            states.push(state);
        }
    }
    states
}

fn distance(one: Pair, other: Pair) -> f64 {
    larger((one[0] - other[0]).abs(), (one[1] - other[1]).abs())
}
