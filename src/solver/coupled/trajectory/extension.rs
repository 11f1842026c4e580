//! The next step of a motion.

use super::{CAPACITY, Piece, Trajectory};
use crate::solver::collocation::{Closeness, Diverged, ROUNDING, Series as MotionSeries};
use crate::solver::coupled::piece::Rest;
use crate::solver::coupled::stages::{self, Series, Step, Task};
use crate::solver::coupled::{CoupledEquation, FullState, LocalCoupledEquation, Sizes, Slope};
use crate::solver::double::Double;
use crate::solver::orbit::Orbit;
use crate::solver::segment::{PAIRS, Segment};
use crate::solver::step_control::{SLOW, StepControl, Verdict, verdict};

/// Part of the tolerance that one step may spend between its ends: a motion may swing by much
/// less than its position is large. With 16 nodes that costs a tenth more steps.
const SHARE: f64 = 0.1;

/// First step in units of the motion's time scale.
const FIRST_STEP: f64 = 1.5;

/// First step after a jump, in units of the relaxation time.
const FIRST_RELAXATION: f64 = 0.5;

/// A step shorter than this part of what it was to be cannot go on.
const SHORTEST: f64 = 1e-14;

/// The typical size may shrink by this factor in a step: f is then singular ahead.
const SHRINKING: f64 = 0.3;

/// What ends a step: its equation and how it is to be solved.
struct Method {
    states: usize,
    integrals: usize,
    stiff: bool,
    few: bool,
    control: StepControl,
}

impl Trajectory {
    /// Follows the motion over one more step from the end of the last piece, which the caller
    /// needs for `rest` at least. Returns by how much the origin of time has moved.
    pub(super) fn extend<E: CoupledEquation>(
        &mut self,
        equation: &E,
        rest: f64,
    ) -> Result<Double, f64> {
        let begin = self.end();
        let first = self.pieces.is_empty();
        let (mut origin, mut start) = match self.pieces.last() {
            Some(piece) => {
                let mut state = self.start;
                state.motion = piece.segment.end();
                if let Some(rest) = &self.rest {
                    state.internal = rest.end.internal;
                    state.integrals = rest.end.integrals;
                }
                (piece.origin, state)
            }
            None => (self.origin, self.start),
        };
        let nearest = equation.origin_near(start.motion.position, origin);
        if nearest != origin {
            let moved = origin.sub(nearest).plus(start.motion.position);
            start.motion.position = moved.value();
            origin = nearest;
        }
        let local = equation.at(&self.since.add(begin), &origin);
        let (states, integrals) = (equation.states(), equation.integrals());
        let repeats = states == 0
            && integrals == 0
            && equation.is_autonomous()
            && equation.is_time_reversible();
        if equation.is_autonomous() && first && integrals == 0 && stands(&local, &start, states) {
            self.at_rest = true;
            return Ok(Double::ZERO);
        }
        let method = Method {
            states,
            integrals,
            stiff: equation.is_stiff(),
            few: self.restless,
            control: if repeats || self.restless {
                self.control.repeated()
            } else {
                StepControl::new(SHARE * self.control.tolerance)
            },
        };
        let most = if self.restless { rest } else { f64::INFINITY };
        let step = self.step(&local, &start, origin, &method, most)?;
        // What has been passed is forgotten, and time counted from here, unless the pieces may
        // still make an orbit.
        let keep = repeats && self.pieces.len() < CAPACITY;
        let mut shift = Double::ZERO;
        if !keep {
            if !first {
                self.arrive(begin);
            }
            shift = begin;
            self.since = self.since.add(begin);
            self.now = self.now.sub(begin);
            self.recorded = self.recorded.sub(begin);
            self.index = 0;
            self.first_turn = None;
            self.pieces.clear();
        }
        if self.pieces.is_empty() {
            self.start = start;
            self.origin = origin;
        }
        let begin = begin.sub(shift);
        let segment = Segment::new(start.motion, step.end.motion, &motion_series(&step));
        self.rest = (states > 0 || integrals > 0).then_some(Rest {
            half: step.series.half,
            start,
            end: step.end,
            slopes: step.series.internal,
            powers: step.powers,
        });
        self.pieces.push(Piece {
            begin,
            origin,
            segment,
        });
        self.look_for_events(equation, &local, step.range);
        if repeats && self.stop.is_none() {
            self.look_for_turn(start.motion.rate);
        }
        Ok(shift)
    }

    /// Solves the next step, as long as the tolerance allows but no longer than `most`.
    fn step<L: LocalCoupledEquation>(
        &mut self,
        local: &L,
        start: &FullState,
        origin: Double,
        method: &Method,
        most: f64,
    ) -> Result<Step, f64> {
        let stage = start.stage();
        let mut sizes = local.sizes(&stage);
        for sum in start.integrals {
            sizes.integrals = sizes.integrals.max(sum.abs());
        }
        let scale = 1.0 / local.natural_frequency(&stage);
        let mut free = self.next_length.unwrap_or(FIRST_STEP * scale);
        let fresh = self.pieces.is_empty();
        if fresh {
            free = free.min(self.transient(local, start, &sizes, method));
        }
        // Two periods of the load, or it would be mistaken for a slow one.
        let nodes = if method.few { 0.5 } else { 1.0 };
        let seen = nodes * 4.0 * std::f64::consts::PI / local.load_frequency();
        let most = most.min(seen);
        let shortest = (SHORTEST * scale).min(0.5 * most);
        let mut length = free.min(most);
        let before = self.series_before(fresh);
        loop {
            if length.is_nan() || length <= shortest {
                return Err(length);
            }
            let part = (length / scale).min(1.0);
            let task = Task {
                start,
                length,
                states: method.states,
                integrals: method.integrals,
                sizes: &sizes,
                closeness: Closeness {
                    settled: method.control.settled_within(part),
                    rounding: ROUNDING,
                },
                before: before.as_ref(),
            };
            let solved = stages::solve(self.level, local, &task, [method.stiff, method.few]);
            let verdict = match &solved {
                Ok(step) => {
                    let ends = step.range.map(|position| local.size_of(position));
                    let least = ends[0].min(ends[1]);
                    if least < SHRINKING * sizes.position || self.leaves(step, origin) {
                        Verdict::Reject(0.5)
                    } else {
                        let here = Sizes {
                            position: least.min(sizes.position),
                            ..sizes
                        };
                        let error = step.error(&here, method.integrals);
                        let ratio = error / method.control.tolerance;
                        verdict(ratio, (step.nodes + 1) as f64, SLOW / step.contraction)
                    }
                }
                Err(Diverged) => Verdict::Reject(0.5),
            };
            match (verdict, solved) {
                (Verdict::Accept(factor), Ok(step)) => {
                    // A step cut short says little about the next one.
                    self.next_length = Some(if length == most && factor >= 1.0 {
                        free.max(length * factor.min(2.0))
                    } else {
                        length * factor
                    });
                    return Ok(step);
                }
                (Verdict::Reject(factor) | Verdict::Accept(factor), _) => {
                    length *= factor;
                    free = free.min(length);
                }
            }
        }
    }

    /// Whether the nodes lie so far beyond the limits that the step says nothing.
    fn leaves(&self, step: &Step, origin: Double) -> bool {
        let [lowest, highest] = step.range.map(|position| origin.plus(position).value());
        self.limits.are_left_behind_by(lowest..=highest)
    }

    /// The longest first step that sees the transients which begin where slopes have jumped.
    fn transient<L: LocalCoupledEquation>(
        &self,
        local: &L,
        start: &FullState,
        sizes: &Sizes,
        method: &Method,
    ) -> f64 {
        let stage = start.stage();
        let load = local.load(0.0);
        let (before, before_internal) = self.slopes_before.unwrap_or_default();
        let mut longest = f64::INFINITY;
        let mut limit = |slope: Slope, before: f64, size: f64| {
            let excursion = (slope.value - before).abs() / slope.relaxation;
            if excursion > method.control.tolerance * size {
                longest = longest.min(FIRST_RELAXATION / slope.relaxation);
            }
        };
        limit(local.acceleration(load, &stage), before, sizes.rate);
        let slopes = local.slopes(load, &stage);
        for k in 0..method.states {
            limit(slopes[k], before_internal[k], sizes.internal[k]);
        }
        longest
    }

    /// The slopes of the last step, where the next one goes on from it.
    fn series_before(&self, fresh: bool) -> Option<Series> {
        let piece = self.pieces.last().filter(|_| !fresh)?;
        let series = piece.segment.series();
        let size = series.half * series.half;
        Some(Series {
            half: series.half,
            motion: std::array::from_fn(|k| {
                let half = if k % 2 == 0 {
                    &series.even
                } else {
                    &series.odd
                };
                half[k / 2] / size
            }),
            internal: self.rest.map(|rest| rest.slopes).unwrap_or_default(),
        })
    }

    /// Notes a turning point of the last piece; the second one closes the orbit.
    fn look_for_turn(&mut self, rate_at_begin: f64) {
        let Some(piece) = self.pieces.last_mut() else {
            return;
        };
        if rate_at_begin * piece.segment.end().rate >= 0.0 {
            return;
        }
        piece.segment.expand();
        let length = piece.segment.length();
        let offset = piece.segment.crossing(0.0, length, Segment::rate);
        let turn = piece.begin.plus(offset);
        match self.first_turn {
            None => self.first_turn = Some(turn),
            Some(first) if turn.since(first) > 0.0 => {
                self.orbit = Some(Orbit::between(first, turn));
            }
            Some(_) => {}
        }
    }
}

/// Whether nothing changes any more.
fn stands<L: LocalCoupledEquation>(local: &L, start: &FullState, states: usize) -> bool {
    let (stage, load) = (start.stage(), local.load(0.0));
    let slopes = local.slopes(load, &stage);
    stage.rate == 0.0
        && local.acceleration(load, &stage).value == 0.0
        && slopes[..states].iter().all(|slope| slope.value == 0.0)
}

/// x'' as the segment takes it.
fn motion_series(step: &Step) -> MotionSeries<{ PAIRS }> {
    let Series { half, motion, .. } = step.series;
    let square = half * half;
    MotionSeries {
        half,
        even: std::array::from_fn(|k| square * motion[2 * k]),
        odd: std::array::from_fn(|k| square * motion[2 * k + 1]),
    }
}
