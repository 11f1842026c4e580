//! A motion that is followed forward in time, whatever its equation: the steps that are kept, what
//! the motion does in them, and the loop that takes further steps. The clock is the caller's, who
//! lends it to each advance.
//!
//! What depends on the kind of equation is a [`Method`]: how the next step is solved, and what is
//! carried along beside position and rate.

use std::fmt::Debug;

use fearless_simd::Level;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

use super::State;
use super::dense_output::{History, KeptStep, Segment};
use super::extremes::Extremes;
use super::limits::Limits;
use super::outcome::{Failure, Progress};
use super::position_origin::PositionOrigin;
use super::step_control::StepControl;
use crate::arithmetic::double_double::DoubleDouble;

mod endpoint_only;
mod events;
mod mode;
mod validation;

pub use mode::Mode;

/// Whether steps may do without dense output. Not in WebAssembly: the live page reads the motion at short intervals, and
/// its core is smaller by a quarter without such steps.
pub(super) const SKIPS_DENSE_OUTPUT: bool = !cfg!(target_arch = "wasm32");

/// What rounding may leave of a step that has been made.
const LAST_BITS: f64 = 1e-18;

/// How the steps of a kind of equation are solved, and what it carries along.
pub trait Method: Clone + Debug + Serialize + DeserializeOwned {
    /// Why a motion stops before the time asked for.
    type Event: Copy + Debug + PartialEq + Serialize + DeserializeOwned;
    /// Where positions are counted from.
    type Origin: PositionOrigin;

    /// Steps that one call may take: some seconds of work.
    const MOST_STEPS: u32;

    /// Whether its own numbers fit to those of the motion.
    fn is_valid(&self, integrator: &Integrator<Self>) -> bool;
}

/// Where the present lies.
pub enum Present<'a, O> {
    /// At the start.
    Start,
    /// Inside a step, at this offset after its begin.
    Inside(&'a KeptStep<O>, f64),
    /// At the end of a step.
    End(&'a KeptStep<O>),
}

/// How a motion is followed.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(super) struct Settings {
    #[serde(skip, default = "Level::new")]
    pub level: Level,
    pub control: StepControl,
    pub limits: Limits,
}

/// Where the kept steps begin.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(super) struct Start<O> {
    /// The origin of time; of no meaning where no step is kept.
    pub time: DoubleDouble,
    /// The origin of the position.
    pub origin: O,
    /// The state there, its position counted from that origin.
    pub state: State,
}

/// Where the present lies in the kept steps.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(super) struct Cursor {
    /// The step that holds it.
    pub step: usize,
    /// The present, counted from the origin of time; on an orbit folded into it.
    pub now: DoubleDouble,
    /// For less time than this the present stays in its step and meets nothing.
    pub time_left: f64,
}

impl Cursor {
    const START: Cursor = Cursor {
        step: 0,
        now: DoubleDouble::ZERO,
        time_left: 0.0,
    };
}

/// How often the equation changes.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(super) struct Restarts {
    /// Advances since the last restart.
    pub advances: u32,
    /// The start before this one was good for a single advance.
    after_single_advance: bool,
}

impl Restarts {
    /// Whether the host changes the equation at each communication point, so that a longer step would be thrown
    /// away.
    #[inline(always)]
    pub fn at_every_step(&self) -> bool {
        self.after_single_advance && self.advances <= 1
    }
}

/// How far the motion has swung.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
struct Recording {
    extremes: Extremes,
    /// Up to this time, counted from the origin of time.
    until: DoubleDouble,
}

/// A motion that is followed forward in time. It can be stored, and goes on bit for bit on
/// processors of the same SIMD level; check what was stored with [`Integrator::is_valid`] where it
/// may have been tampered with.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(bound = "M: Method")]
pub struct Integrator<M: Method> {
    pub(super) settings: Settings,
    pub(super) start: Start<M::Origin>,
    /// From the start on.
    pub(super) history: History<M::Origin>,
    pub(super) cursor: Cursor,
    pub(super) mode: Mode<M::Event>,
    pub(super) restarts: Restarts,
    /// Length of the next step with dense output.
    pub(super) next_length: Option<f64>,
    recording: Option<Recording>,
    pub(super) method: M,
}

impl<M: Method> Integrator<M> {
    /// A motion with this method, which keeps its steps in the memory of an empty history.
    pub(super) fn with_method(
        history: History<M::Origin>,
        method: M,
        start: State,
        limits: Limits,
        tolerance: f64,
    ) -> Self {
        Integrator {
            settings: Settings {
                level: Level::new(),
                control: StepControl::new(tolerance),
                limits,
            },
            start: Start {
                time: DoubleDouble::ZERO,
                origin: M::Origin::ZERO,
                state: start,
            },
            history,
            cursor: Cursor::START,
            mode: Mode::UNKNOWN,
            restarts: Restarts {
                advances: 0,
                after_single_advance: false,
            },
            next_length: None,
            recording: None,
            method,
        }
    }

    /// Computes the motion with this set of processor instructions.
    #[must_use]
    pub fn with_level(mut self, level: Level) -> Self {
        self.settings.level = level;
        self
    }

    /// The present position, counted from 0.
    pub fn position(&self) -> f64 {
        let (origin, position) = self.position_from_origin();
        origin.absolute(position)
    }

    /// The present position, counted from the origin that is returned with it.
    pub fn position_from_origin(&self) -> (M::Origin, f64) {
        match self.present() {
            Present::Start => (self.start.origin, self.start.state.position),
            Present::Inside(step, offset) => (step.origin, step.segment.position(offset)),
            Present::End(step) => (step.origin, step.segment.end().position),
        }
    }

    /// The present rate.
    pub fn rate(&self) -> f64 {
        self.mode.direction()
            * match self.present() {
                Present::Start => self.start.state.rate,
                Present::Inside(step, offset) => step.segment.rate(offset),
                Present::End(step) => step.segment.end().rate,
            }
    }

    /// The present position, counted from 0, and rate.
    pub fn state(&self) -> State {
        State {
            position: self.position(),
            rate: self.rate(),
        }
    }

    pub(super) fn present(&self) -> Present<'_, M::Origin> {
        if self.history.is_empty() || self.cursor.now == DoubleDouble::ZERO {
            return Present::Start;
        }
        let step = &self.history.steps()[self.cursor.step];
        let offset = self.cursor.now.since(step.begin);
        if offset == step.segment.length() {
            Present::End(step)
        } else {
            Present::Inside(step, offset)
        }
    }

    pub(super) fn records_extremes(&self) -> bool {
        self.recording.is_some()
    }

    /// Starts anew from the present position and rate.
    #[inline(always)]
    pub(super) fn start_from_present(&mut self) {
        self.restarts.after_single_advance = self.restarts.advances == 1;
        self.restarts.advances = 0;
        // Without a step it stands at its start.
        if !self.history.is_empty() {
            let rate = self.rate();
            let (origin, position) = self.position_from_origin();
            self.start.state = State { position, rate };
            self.start.origin = origin;
        }
        self.forget();
    }

    /// Forgets the motion so far, which has come to `state` at `time`.
    pub(super) fn stand_at(&mut self, time: DoubleDouble, state: State) {
        self.start.state = state;
        self.start.time = time;
        self.forget();
    }

    /// Forgets the motion that has led to its start.
    #[inline(always)]
    fn forget(&mut self) {
        self.history.clear();
        self.cursor = Cursor::START;
        self.mode = Mode::UNKNOWN;
        if let Some(recording) = &mut self.recording {
            recording.until = DoubleDouble::ZERO;
        }
    }

    /// Follows the motion for the time `step` where it stays in its step and meets nothing; tells
    /// whether it does. The clock is then to be moved by as much.
    #[inline(always)]
    pub(crate) fn advance_inside_step(&mut self, step: f64) -> bool {
        self.restarts.advances = self.restarts.advances.saturating_add(1);
        if step < self.cursor.time_left {
            self.cursor.time_left -= step;
            self.cursor.now = self.cursor.now.plus(self.mode.direction() * step);
            return true;
        }
        false
    }

    /// Follows the motion for the time `step` from `clock`, by steps from `further`: it takes one
    /// or more toward the time that it is given, within the budget, and returns by how much it has
    /// moved the origin of time, or the length of a step that was too short to go on.
    ///
    /// Out of the way of the steps for which the present step suffices, with its large frame.
    #[inline(never)]
    pub(super) fn advance_by_steps(
        &mut self,
        clock: &mut DoubleDouble,
        step: f64,
        further: impl FnMut(&mut Self, DoubleDouble, &mut u32) -> Result<DoubleDouble, f64>,
    ) -> Result<Progress<M::Event>, Failure> {
        let progress = self.take_steps(clock, step, further);
        let passed = match progress {
            Ok(Progress::Whole) => step,
            Ok(Progress::Stopped { after, .. })
            | Err(
                Failure::SubstepTooShort { after, .. } | Failure::TooManySubsteps { after, .. },
            ) => after,
        };
        *clock = clock.plus(passed).renormalized();
        progress
    }

    #[inline(always)]
    fn take_steps(
        &mut self,
        clock: &DoubleDouble,
        step: f64,
        mut further: impl FnMut(&mut Self, DoubleDouble, &mut u32) -> Result<DoubleDouble, f64>,
    ) -> Result<Progress<M::Event>, Failure> {
        if self.history.is_empty() {
            self.start.time = *clock;
        }
        match self.mode {
            Mode::Dense { .. } => {}
            Mode::Periodic { orbit, direction } => {
                self.run_orbit(orbit, direction, step);
                return Ok(Progress::Whole);
            }
            Mode::AtRest => return Ok(Progress::Whole),
        }
        let mut target = self.cursor.now.plus(step);
        let mut budget = M::MOST_STEPS;
        loop {
            if let Mode::Dense {
                stop: Some((limit, at)),
                ..
            } = self.mode
                && target.since(at) >= 0.0
            {
                let after = step - target.since(at);
                self.arrive(at);
                return Ok(Progress::Stopped { limit, after });
            }
            let end = self.history.end();
            let rest = target.since(end);
            if rest <= LAST_BITS * step {
                // Without a kept step, endpoint-only steps came to it.
                if !self.history.is_empty() {
                    self.arrive(if rest > 0.0 { end } else { target });
                }
                return Ok(Progress::Whole);
            }
            let added = match budget {
                0 => Err(None),
                _ => further(self, target, &mut budget).map_err(Some),
            };
            match added {
                Ok(shift) => target = target.sub(shift),
                Err(too_short) => {
                    // The present moves to the end of the last step.
                    let end = self.history.end();
                    self.arrive(end);
                    let after = step - target.since(end);
                    return Err(match too_short {
                        Some(length) => Failure::SubstepTooShort { length, after },
                        None => Failure::TooManySubsteps {
                            most: M::MOST_STEPS,
                            after,
                        },
                    });
                }
            }
            match self.mode {
                Mode::AtRest => return Ok(Progress::Whole),
                _ if target == DoubleDouble::ZERO => return Ok(Progress::Whole),
                Mode::Periodic { orbit, direction } => {
                    let rest = target.since(orbit.second_turn());
                    if rest > 0.0 {
                        self.arrive(orbit.second_turn());
                        self.run_orbit(orbit, direction, rest);
                        return Ok(Progress::Whole);
                    }
                }
                Mode::Dense { .. } => {}
            }
        }
    }

    /// Adds a step to the history, from `state`, counted from `origin`, on. Where what has been
    /// passed is not to be kept, it is forgotten and time is counted from the begin of the step:
    /// returns by how much its origin has moved.
    pub(super) fn push(
        &mut self,
        origin: M::Origin,
        segment: Segment,
        keeps: bool,
    ) -> DoubleDouble {
        let begin = self.history.end();
        let mut shift = DoubleDouble::ZERO;
        if !keeps || self.history.is_full() {
            if self.records_extremes() && !self.history.is_empty() {
                self.arrive(begin);
            }
            shift = begin;
            self.start.time = self.start.time.add(begin);
            self.cursor.now = self.cursor.now.sub(begin);
            self.cursor.step = 0;
            if let Some(recording) = &mut self.recording {
                recording.until = recording.until.sub(begin);
            }
            self.history.clear();
            self.mode = Mode::UNKNOWN;
        }
        if self.history.is_empty() {
            self.start.state = segment.start();
            self.start.origin = origin;
        }
        self.history.push(KeptStep {
            begin: begin.sub(shift),
            origin,
            segment,
        });
        shift
    }
}
