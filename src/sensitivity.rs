//! How a motion depends on its parameters: exact derivatives along the trajectory.
//!
//! Under a voltage that is given piece by piece, the motion is followed together with its
//! variational equations, one for each of [`Known::ALL`], solved by the same
//! collocation. They are the exact derivatives of the computed motion at the substeps chosen;
//! nothing is differenced.

use crate::actuator::coefficients::Coefficients;
use crate::actuator::drive::Polynomial;
use crate::actuator::motion::{self, Load};
use crate::actuator::{Drive, Parameters};
use crate::arithmetic::double_double::DoubleDouble;
use crate::arithmetic::jet::Dual;
use crate::nondimensional::scene::Scene;
use crate::solver::dense_output::Segment;
use crate::solver::limits::Limit;
use crate::solver::linearized::{Linearized, StageVector, offsets};
use crate::solver::trajectory::{Failure, Progress, Trajectory};
use crate::solver::{Equation, LocalEquation, State};

/// Substeps that one experiment may take: some seconds of work.
const MOST_SUBSTEPS: u32 = 200_000;

/// What the motion is differentiated by.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Known {
    /// c.
    Aspect,
    /// γ̄_s.
    SurfaceEnergy,
    /// τ̄_s.
    SurfaceTension,
    /// Ē_s.
    SurfaceElasticity,
    /// S̄, constant.
    Prestress,
    /// By what the given voltage is multiplied.
    VoltageScale,
    /// By what the given times are multiplied.
    TimeScale,
    /// λ at the start.
    Stretch,
    /// dλ/dt̄ at the start.
    StretchRate,
}

impl Known {
    /// All of them, in the order of [`Prediction::slopes`].
    pub const ALL: [Known; 9] = [
        Known::Aspect,
        Known::SurfaceEnergy,
        Known::SurfaceTension,
        Known::SurfaceElasticity,
        Known::Prestress,
        Known::VoltageScale,
        Known::TimeScale,
        Known::Stretch,
        Known::StretchRate,
    ];
}

/// The voltage from `time` on, until the next one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ramp {
    /// When it begins, in the given times.
    pub time: f64,
    /// Voltage then, before it is scaled.
    pub voltage: f64,
    /// Its derivative by the given time.
    pub slope: f64,
}

/// An actuator under a given voltage.
#[derive(Clone, Copy, Debug)]
pub struct Experiment<'a> {
    /// Parameters, start, limits and prestress; its voltage does not count.
    pub scene: Scene,
    /// By what the voltage is multiplied.
    pub voltage_scale: f64,
    /// By what the times are multiplied to be t̄.
    pub time_scale: f64,
    /// The voltage in the order of time; the motion starts with the first.
    pub voltage: &'a [Ramp],
    /// When the stretch is asked for, increasing, not before the start.
    pub times: &'a [f64],
    /// Relative tolerance of the stretch.
    pub tolerance: f64,
}

/// The stretch at one of the times.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Prediction {
    /// λ.
    pub stretch: f64,
    /// ∂λ/∂ of each of [`Known::ALL`].
    pub slopes: [f64; 9],
}

/// Why an experiment could not be followed to its end.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Interruption {
    /// The actuator collapsed, at this of the given times.
    Collapse(Limit, f64),
    /// The integration could not go on.
    Failure(Failure),
}

/// Follows an experiment and returns a prediction for each of its times.
///
/// # Errors
/// [`Interruption`] before the last time was reached.
pub fn follow(experiment: &Experiment) -> Result<Vec<Prediction>, Interruption> {
    let Experiment {
        mut scene,
        voltage_scale,
        time_scale,
        voltage,
        times,
        tolerance,
    } = *experiment;
    let mut predictions = Vec::with_capacity(times.len());
    let mut budget = MOST_SUBSTEPS;
    let mut clock = DoubleDouble::ZERO;
    let mut trajectory = Trajectory::new(scene.start, scene.limits, tolerance);
    let mut beside = Known::ALL.map(start_of);
    let Some(&last) = times.last() else {
        return Ok(predictions);
    };
    scene.drive = Drive::constant(0.0, scene.drive.prestress.value());
    for (index, ramp) in voltage.iter().enumerate() {
        let next = voltage.get(index + 1).map(|ramp| ramp.time);
        let border = next.map_or(last, |time| time.min(last));
        scene.drive.since = clock;
        scene.drive.voltage = line(
            voltage_scale * ramp.voltage,
            voltage_scale * ramp.slope / time_scale,
        );
        let directions = Known::ALL.map(|known| direction(known, experiment, ramp));
        let span = time_scale * (border - ramp.time);
        let mut passed = 0.0;
        loop {
            let rest = span - passed;
            if rest <= 0.0 {
                break;
            }
            if budget == 0 {
                return Err(Interruption::Failure(Failure::TooManySubsteps {
                    most: MOST_SUBSTEPS,
                    after: passed,
                }));
            }
            budget -= 1;
            let begin = clock;
            let (segment, progress) = trajectory
                .advance_by_substep(&scene, &mut clock, rest)
                .map_err(Interruption::Failure)?;
            if let Progress::Stopped { limit, after } = progress {
                let when = ramp.time + (passed + after) / time_scale;
                return Err(Interruption::Collapse(limit, when));
            }
            let Some(segments) = variation(&scene, begin, &segment, &beside, &directions) else {
                let length = segment.length();
                return Err(Interruption::Failure(Failure::SubstepTooShort {
                    length,
                    after: 0.0,
                }));
            };
            let whole = segment.length() >= rest;
            while let Some(&time) = times.get(predictions.len()) {
                let offset = time_scale * (time - ramp.time) - passed;
                if !(offset <= segment.length() || whole && time <= border) {
                    break;
                }
                let offset = offset.min(segment.length());
                let since = time - ramp.time;
                predictions.push(prediction(&segment, &segments, offset, since));
            }
            beside = segments.map(|segment| segment.end());
            passed = if whole {
                span
            } else {
                passed + segment.length()
            };
        }
        // With the scale of time, the border moves along the motion.
        let local = scene.seen_from(&clock);
        let state = trajectory.state();
        let since = border - ramp.time;
        let moved = &mut beside[Known::TimeScale as usize];
        moved.position += since * state.rate;
        moved.rate += since * local.acceleration_from(state);
        if border == last {
            break;
        }
    }
    // Those at the very start need no motion.
    while predictions.len() < times.len() {
        predictions.push(Prediction {
            stretch: trajectory.position(),
            slopes: beside.map(|state| state.position),
        });
    }
    Ok(predictions)
}

/// The state at the start as it changes with a parameter.
fn start_of(known: Known) -> State {
    let [position, rate] = match known {
        Known::Stretch => [1.0, 0.0],
        Known::StretchRate => [0.0, 1.0],
        _ => [0.0, 0.0],
    };
    State { position, rate }
}

/// An input that starts at `value` and changes at the rate `slope`.
fn line(value: f64, slope: f64) -> Polynomial {
    let mut line = Polynomial::constant(value);
    line.set_derivative(1, slope);
    line
}

/// The scene under a ramp as it changes with a parameter, its drive counted from the begin of the ramp.
fn direction(known: Known, experiment: &Experiment, ramp: &Ramp) -> Scene {
    let mut direction = Scene::BLANK;
    let Parameters {
        aspect,
        surface_energy,
        surface_tension,
        surface_elasticity,
    } = &mut direction.parameters;
    let Experiment {
        voltage_scale,
        time_scale,
        ..
    } = experiment;
    match known {
        Known::Aspect => *aspect = 1.0,
        Known::SurfaceEnergy => *surface_energy = 1.0,
        Known::SurfaceTension => *surface_tension = 1.0,
        Known::SurfaceElasticity => *surface_elasticity = 1.0,
        Known::Prestress => direction.drive.prestress = Polynomial::constant(1.0),
        Known::VoltageScale => {
            direction.drive.voltage = line(ramp.voltage, ramp.slope / time_scale);
        }
        Known::TimeScale => {
            let slope = -voltage_scale * ramp.slope / (time_scale * time_scale);
            direction.drive.voltage = line(0.0, slope);
        }
        Known::Stretch | Known::StretchRate => {}
    }
    direction
}

/// The motions beside a substep that began at `begin`, one for each direction.
fn variation(
    scene: &Scene,
    begin: DoubleDouble,
    segment: &Segment,
    starts: &[State; 9],
    directions: &[Scene; 9],
) -> Option<[Segment; 9]> {
    let times = offsets(segment.length());
    let states = times.map(|offset| segment.state(offset));
    let along = |direction: &Scene, change: State| {
        StageVector::from_fn(|i, _| {
            slope(scene, begin.plus(times[i]), states[i], direction, change)
        })
    };
    let still = State {
        position: 0.0,
        rate: 0.0,
    };
    let stretched = start_of(Known::Stretch);
    let moving = start_of(Known::StretchRate);
    let linearized = Linearized::new(
        segment.length(),
        along(&Scene::BLANK, stretched),
        along(&Scene::BLANK, moving),
    );
    let mut segments = [*segment; 9];
    for ((solved, start), direction) in segments.iter_mut().zip(starts).zip(directions) {
        *solved = linearized.solve(*start, along(direction, still))?;
        solved.expand();
    }
    Some(segments)
}

/// How λ'' changes where the scene and the state change in a direction.
fn slope(scene: &Scene, time: DoubleDouble, state: State, direction: &Scene, change: State) -> f64 {
    let coefficients = Coefficients::fold(&scene.parameters.along(&direction.parameters));
    let (voltage, prestress) = scene.drive.along(
        &Drive {
            since: scene.drive.since,
            ..direction.drive
        },
        time,
    );
    let load = Load {
        voltage_squared: voltage * voltage,
        prestress,
    };
    let stretch = Dual::new(state.position, change.position);
    let rate = Dual::new(state.rate, change.rate);
    motion::acceleration(&coefficients, load, stretch, rate).slope()
}

/// The stretch at `offset` after the begin of a substep, the time `since` after that of its ramp.
fn prediction(segment: &Segment, beside: &[Segment; 9], offset: f64, since: f64) -> Prediction {
    let mut slopes = beside.each_ref().map(|segment| segment.position(offset));
    slopes[Known::TimeScale as usize] += since * segment.rate(offset);
    Prediction {
        stretch: segment.position(offset),
        slopes,
    }
}
