//! What is skipped where a scene does not need it: each beside the same run with
//! nothing skipped, on the actuator of the case.

use std::hint::black_box;
use std::time::Duration;

use dielectric_elastomer_actuator::actuator::motion::{Load, LocalMotion};
use dielectric_elastomer_actuator::actuator::{Drive, Motion};
use dielectric_elastomer_actuator::arithmetic::double_double::DoubleDouble;
use dielectric_elastomer_actuator::arithmetic::number::Number;
use dielectric_elastomer_actuator::nondimensional::value_reference;
use dielectric_elastomer_actuator::solver::limits::Limits;
use dielectric_elastomer_actuator::solver::trajectory::Trajectory;
use dielectric_elastomer_actuator::solver::{Equation, LocalEquation, Sensitivity, State};

use crate::case::Case;
use crate::host::Host;
use crate::ours;
use crate::row::Row;
use crate::timing::seconds_per_call;

/// Two runs that must come to the same result.
struct Skip<'a> {
    name: &'static str,
    tolerance: f64,
    /// Calls or units of time of a run.
    units: f64,
    skipped: Box<dyn FnMut() -> f64 + 'a>,
    full: Box<dyn FnMut() -> f64 + 'a>,
}

/// Times every skip once.
pub fn run(case: &Case, least: Duration) {
    let motion = ours::motion(case);
    let constant = Case {
        voltage: 0.5,
        amplitude: 0.0,
        ..case.clone()
    };
    let skips = integration(case, &motion)
        .into_iter()
        .chain(calls(case, &constant));
    for mut skip in skips {
        let (skipped, full) = ((skip.skipped)(), (skip.full)());
        let difference = (skipped - full).abs();
        assert!(
            difference <= skip.tolerance,
            "{}: the results differ by {difference:e}",
            skip.name
        );
        let runs = [
            ("skipped", &mut skip.skipped),
            ("not skipped", &mut skip.full),
        ];
        for (inputs, run) in runs {
            let seconds = seconds_per_call(least, || {
                black_box(run());
            });
            Row {
                method: skip.name,
                tolerance: skip.tolerance,
                step: None,
                inputs,
                nanoseconds: Some(1e9 * seconds / skip.units),
                error: Some(difference),
                hold_error: None,
                note: String::new(),
            }
            .print();
        }
    }
}

/// The stretch after `time` in steps of `step`.
fn follow<E: Equation>(mut trajectory: Trajectory, equation: &E, time: f64, step: f64) -> f64 {
    let mut clock = DoubleDouble::ZERO;
    for _ in 0..(time / step).round() as u64 {
        assert!(trajectory.advance(equation, &mut clock, step).is_ok());
    }
    trajectory.position()
}

/// In the integration; nanoseconds for each unit of time.
fn integration<'a>(case: &'a Case, motion: &'a Motion) -> Vec<Skip<'a>> {
    const TIME: f64 = 500.0;
    let integrated = |tolerance: f64| ours::start(tolerance).without_orbits();
    let unfolded = Unfolded {
        motion: *motion,
        surface: case.surface,
    };
    let mut constant = *motion;
    constant.drive = Drive::constant(0.5, 0.0);
    // An amplitude that changes nothing but has to be looked at.
    let mut vanishing = constant;
    vanishing.drive.harmonic.amplitude = 1e-300;
    vanishing.drive.harmonic.frequency = 0.1;
    let mut ideal = constant;
    ideal.coefficients.linear = 1.0;
    ideal.coefficients.cubic = 0.0;
    ideal.coefficients.quintic = 0.0;
    let resting = |position: f64| {
        let start = State {
            position,
            rate: 0.0,
        };
        let limits = Limits {
            lower: 0.05,
            upper: 10.0,
        };
        Trajectory::new(start, limits, 1e-9)
    };
    let mut nothing = ideal;
    nothing.drive = Drive::constant(0.0, 0.0);
    let skip = |name, tolerance, skipped: Box<dyn FnMut() -> f64 + 'a>, full| Skip {
        name,
        tolerance,
        units: TIME,
        skipped,
        full,
    };
    vec![
        skip(
            "separate surface terms, combined into three coefficients",
            1e-9,
            Box::new(move || follow(integrated(1e-9), motion, TIME, 100.0)),
            Box::new(move || follow(integrated(1e-9), &unfolded, TIME, 100.0)),
        ),
        skip(
            "terms that are zero, by a formula of their own (not built)",
            1e-9,
            Box::new(move || follow(integrated(1e-9), &Ideal(ideal), TIME, 100.0)),
            Box::new(move || follow(integrated(1e-9), &ideal, TIME, 100.0)),
        ),
        skip(
            "the sine, where no voltage alternates",
            1e-9,
            Box::new(move || follow(integrated(1e-9), &constant, TIME, 100.0)),
            Box::new(move || follow(integrated(1e-9), &vanishing, TIME, 100.0)),
        ),
        skip(
            "the integration, where an orbit repeats",
            1e-9,
            Box::new(move || follow(ours::start(1e-9), &constant, TIME, 10.0)),
            Box::new(move || follow(integrated(1e-9), &constant, TIME, 10.0)),
        ),
        skip(
            "everything, at rest in an equilibrium (the other starts 1e-9 off)",
            1e-9,
            Box::new(move || follow(resting(1.0), &nothing, TIME, 1.0)),
            Box::new(move || follow(resting(1.0 + 1e-9).without_orbits(), &nothing, TIME, 1.0)),
        ),
        skip(
            "dense output, where only the end of a step is asked for (endpoint-only steps of 8 nodes beside dense ones of 16)",
            1e-6,
            Box::new(move || follow(ours::start(1e-6), motion, TIME, 100.0)),
            Box::new(move || {
                follow(
                    ours::start(1e-6).without_endpoint_steps(),
                    motion,
                    TIME,
                    100.0,
                )
            }),
        ),
        skip(
            "extremes, where they are not recorded (endpoint-only steps beside dense ones that are searched)",
            1e-9,
            Box::new(move || follow(ours::start(1e-9), motion, TIME, 100.0)),
            Box::new(move || {
                let recording = ours::start(1e-9).recording_extremes();
                follow(recording, motion, TIME, 100.0)
            }),
        ),
    ]
}

/// At the C functions; nanoseconds for each communication step of 0.1.
fn calls<'a>(case: &'a Case, constant: &'a Case) -> Vec<Skip<'a>> {
    const STEPS: u32 = 2000;
    const STEP: f64 = 0.1;
    let run = |case: &Case, prepare: fn(&Host), at_each: &dyn Fn(&Host, u32)| {
        let host = Host::new(case, 1e-9, true);
        prepare(&host);
        for call in 0..STEPS {
            at_each(&host, call);
            host.step(f64::from(call) * STEP, STEP);
            black_box(host.stretch());
        }
        host.stretch()
    };
    let plain = move |case: &Case| run(case, |_| {}, &|_, _| {});
    let all: Vec<u32> = [
        "hamiltonian",
        "phi_pull_in",
        "phi_pull_in_static",
        "pull_in_margin",
    ]
    .iter()
    .map(|name| value_reference(name).expect("a variable"))
    .collect();
    let skip = |name, skipped: Box<dyn FnMut() -> f64 + 'a>, full| Skip {
        name,
        tolerance: 1e-9,
        units: f64::from(STEPS),
        skipped,
        full,
    };
    let nudged = move |host: &Host, call: u32| {
        // Two neighbouring numbers in turn: another input, the same motion.
        let voltage = f64::from_bits(0.5_f64.to_bits() + u64::from(call % 2));
        host.set(&[voltage, 0.0, 0.0, 0.0], 0);
    };
    let unchanged = move |host: &Host, _| host.set(&[0.5, 0.0, 0.0, 0.0], 0);
    vec![
        skip(
            "a restart, where the inputs are unchanged",
            Box::new(move || plain(constant)),
            Box::new(move || run(constant, |_| {}, &nudged)),
        ),
        skip(
            "a restart, where the inputs are set to what they are",
            Box::new(move || run(constant, |_| {}, &unchanged)),
            Box::new(move || run(constant, |_| {}, &nudged)),
        ),
        skip(
            "energy and thresholds, where they are not read",
            Box::new(move || plain(case)),
            Box::new(move || {
                run(case, |_| {}, &|host, _| {
                    let mut values = [0.0; 4];
                    host.read(&all, &mut values);
                    black_box(values);
                })
            }),
        ),
        skip(
            "the log, which a step never writes",
            Box::new(move || plain(case)),
            Box::new(move || run(case, Host::log, &|_, _| {})),
        ),
    ]
}

/// Eq. 16 with its surface terms as they stand in the paper.
#[derive(Clone, Copy)]
struct Unfolded {
    motion: Motion,
    surface: [f64; 3],
}

struct LocalUnfolded<'a> {
    motion: LocalMotion<'a>,
    inertia: f64,
    surface: [f64; 3],
}

impl Equation for Unfolded {
    type Local<'a> = LocalUnfolded<'a>;

    fn at(&self, time: &DoubleDouble) -> LocalUnfolded<'_> {
        LocalUnfolded {
            motion: self.motion.at(time),
            inertia: self.motion.coefficients.inertia,
            surface: self.surface,
        }
    }

    fn is_autonomous(&self) -> bool {
        self.motion.is_autonomous()
    }

    fn is_time_reversible(&self) -> bool {
        self.motion.is_time_reversible()
    }
}

impl LocalEquation for LocalUnfolded<'_> {
    type Load<N: Number> = Load<N>;

    #[inline(always)]
    fn load<N: Number>(&self, offset: N) -> Load<N> {
        self.motion.load(offset)
    }

    fn harmonic(&self) -> Option<[f64; 2]> {
        self.motion.harmonic()
    }

    #[inline(always)]
    fn load_with_sine<N: Number>(&self, offset: N, sine: N) -> Load<N> {
        self.motion.load_with_sine(offset, sine)
    }

    #[inline(always)]
    fn acceleration<N: Number>(&self, load: Load<N>, x: N, v: N) -> N {
        let number = |value: f64| x.same(value);
        let [gamma, tau, elasticity] = self.surface.map(number);
        let square = x * x;
        let seventh = square * square * square * x;
        let tension = tau * (number(2.0) * square - number(1.0));
        let growth = (square - number(1.0)) * (number(3.0) * square - number(1.0));
        let surface = number(2.0) * (gamma + tension + number(0.5) * elasticity * growth);
        let elastic = number(1.0) + surface - load.voltage_squared * square;
        let driven = number(6.0) * v * v + square + seventh * load.prestress;
        (driven - seventh * x * elastic) / (number(self.inertia) * seventh + x + x)
    }

    fn load_frequency(&self) -> f64 {
        self.motion.load_frequency()
    }

    fn eighth_degree(&self, half: f64, factor: f64) -> Option<[f64; 2]> {
        self.motion.eighth_degree(half, factor)
    }

    fn parts<N: Number>(load: Load<N>) -> [N; 2] {
        LocalMotion::parts(load)
    }

    fn sensitivity(&self, state: State) -> Sensitivity {
        self.motion.sensitivity(state)
    }
}

/// Eq. 16 without surface effects and prestress.
#[derive(Clone, Copy)]
struct Ideal(Motion);

struct LocalIdeal<'a>(LocalMotion<'a>, f64);

impl Equation for Ideal {
    type Local<'a> = LocalIdeal<'a>;

    fn at(&self, time: &DoubleDouble) -> LocalIdeal<'_> {
        LocalIdeal(self.0.at(time), self.0.coefficients.inertia)
    }

    fn is_autonomous(&self) -> bool {
        self.0.is_autonomous()
    }

    fn is_time_reversible(&self) -> bool {
        self.0.is_time_reversible()
    }
}

impl LocalEquation for LocalIdeal<'_> {
    type Load<N: Number> = Load<N>;

    #[inline(always)]
    fn load<N: Number>(&self, offset: N) -> Load<N> {
        self.0.load(offset)
    }

    fn harmonic(&self) -> Option<[f64; 2]> {
        self.0.harmonic()
    }

    #[inline(always)]
    fn load_with_sine<N: Number>(&self, offset: N, sine: N) -> Load<N> {
        self.0.load_with_sine(offset, sine)
    }

    #[inline(always)]
    fn acceleration<N: Number>(&self, load: Load<N>, x: N, v: N) -> N {
        let number = |value: f64| x.same(value);
        let square = x * x;
        let fourth = square * square;
        let seventh = (x * square) * fourth;
        let elastic = number(1.0) - load.voltage_squared * square;
        let driven = (v * v).mul_add(number(6.0), square);
        (driven - (fourth * fourth) * elastic) / seventh.mul_add(number(self.1), x + x)
    }

    fn load_frequency(&self) -> f64 {
        self.0.load_frequency()
    }

    fn eighth_degree(&self, half: f64, factor: f64) -> Option<[f64; 2]> {
        self.0.eighth_degree(half, factor)
    }

    fn parts<N: Number>(load: Load<N>) -> [N; 2] {
        LocalMotion::parts(load)
    }

    fn sensitivity(&self, state: State) -> Sensitivity {
        self.0.sensitivity(state)
    }
}
