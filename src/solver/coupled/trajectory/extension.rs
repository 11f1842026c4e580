//! The next step of a motion.

use super::Trajectory;
use crate::arithmetic::double_double::DoubleDouble;
use crate::solver::collocation::Series;
use crate::solver::coupled::polynomials::Polynomials;
use crate::solver::coupled::stages::{self, Demands, Iteration, Slopes, Step, Task};
use crate::solver::coupled::{CoupledEquation, FullState, LocalCoupledEquation, Sizes, Slope};
use crate::solver::dense_output::Segment;
use crate::solver::integrator::Mode;
use crate::solver::iteration::{Diverged, IterationTolerance};
use crate::solver::step_control::{
    HALVED, SLOW, StepControl, first_accepted, goes_on_from, judge, most_growth,
};

/// Part of the tolerance that one step may spend between its ends: a motion may swing by much
/// less than its position is large. With 16 nodes that costs a tenth more steps.
const SHARE: f64 = 0.1;

/// First step in units of the motion's time scale.
const FIRST_STEP: f64 = 1.5;

/// First step after a jump, in units of the relaxation time.
const FIRST_RELAXATION: f64 = 0.5;

/// A step shorter than this part of the time scale cannot go on: no transient is shorter, which a resistance of
/// a milliohm makes at a load of a hundred kilograms.
const SHORTEST_TRANSIENT: f64 = 1e-28;

/// A state that relaxes by less than this part in half a step does not hamper fixed-point iteration.
const SLOW_RELAXATION: f64 = 0.25;

/// Sums over the nodes round by some units in the last place.
const ROUNDED: f64 = 4.0;

/// The states at the nodes are rounded, and so are the last coefficients of what leads from one to the other: of an
/// error below this part of the sizes nothing is seen.
const ERROR_NOISE: f64 = 32.0 * f64::EPSILON;

/// Steps that the error allows to be longer by this factor than fixed-point iteration does are left to Newton's method.
const MUCH_LONGER: f64 = 3.0;

/// The growth of a step counts twice for how much the next one may grow: after a transient, steps become longer by
/// powers of ten.
const ACCELERATION: i32 = 2;

/// The typical size may shrink by this factor in a step: f is then singular ahead.
const SHRINKING: f64 = 0.3;

impl Trajectory {
    /// Follows the motion over one more step from the end of the last step, which the caller
    /// needs for `rest` at least. Returns by how much the origin of time has moved.
    pub(super) fn extend<E: CoupledEquation>(
        &mut self,
        equation: &E,
        rest: f64,
        work: &mut u32,
    ) -> Result<DoubleDouble, f64> {
        let begin = self.history.end();
        let first = self.history.is_empty();
        let (mut origin, mut start) = (self.start.origin, self.full_start());
        if let Some(step) = self.history.steps().last() {
            origin = step.origin;
            start.motion = step.segment.end();
        }
        if let Some(polynomials) = &self.method.polynomials {
            start = polynomials.end;
        }
        let nearest = equation.origin_near(start.motion.position, origin);
        if nearest != origin {
            let moved = origin.sub(nearest).plus(start.motion.position);
            start.motion.position = moved.value();
            origin = nearest;
        }
        let local = equation.at(&self.start.time.add(begin), &origin);
        let (states, integrals) = (equation.states(), equation.integrals());
        let repeats = equation.repeats();
        if equation.is_autonomous() && first && integrals == 0 && stands(&local, &start, states) {
            self.mode = Mode::AtRest;
            return Ok(DoubleDouble::ZERO);
        }
        let demands = Demands {
            states,
            integrals,
            few: self.restarts.at_every_step(),
            control: if repeats || self.restarts.at_every_step() {
                self.settings.control.repeated()
            } else {
                StepControl::new(SHARE * self.settings.control.tolerance)
            },
        };
        let most = if self.restarts.at_every_step() {
            rest
        } else {
            f64::INFINITY
        };
        let step = self.step(&local, &start, origin, &demands, most, work)?;
        let segment = Segment::new(
            start.motion,
            step.end.motion,
            &Series::new(step.series.half, &step.series.motion),
        );
        // The steps are kept while they may still make an orbit.
        let shift = self.push(origin, segment, repeats);
        if states > 0 || integrals > 0 {
            self.method.internal = start.internal;
            self.method.integrals = start.integrals;
            self.method.polynomials = Some(Polynomials {
                half: step.series.half,
                start,
                end: step.end,
                slopes: step.series.internal,
                powers: step.powers,
            });
        }
        self.look_for_events(equation, &local, step.range);
        if repeats {
            self.look_for_turn();
        }
        Ok(shift)
    }

    /// Solves the next step, as long as the tolerance allows but no longer than `most`.
    fn step<L: LocalCoupledEquation>(
        &mut self,
        local: &L,
        start: &FullState,
        origin: DoubleDouble,
        demands: &Demands,
        most: f64,
        work: &mut u32,
    ) -> Result<Step, f64> {
        let stage = start.stage();
        let mut sizes = local.sizes(&stage);
        for sum in start.integrals {
            sizes.integrals = sizes.integrals.max(sum.abs());
        }
        let scale = 1.0 / local.natural_frequency(&stage);
        let (slopes, force) = local.derivatives(demands.states, local.load(0.0), &stage);
        let slopes = &slopes[..demands.states];
        let relaxations = slopes.iter().map(|slope| slope.relaxation);
        let relaxation = relaxations.fold(0.0, f64::max);
        let mut free = self.next_length.unwrap_or(FIRST_STEP * scale);
        let fresh = self.history.is_empty();
        if fresh {
            free = free.min(self.transient(force, slopes, &sizes, demands.control));
        }
        let nodes = if demands.few { 0.5 } else { 1.0 };
        let seen = nodes * local.longest_substep();
        let most = most.min(seen);
        let shortest = (SHORTEST_TRANSIENT * scale).min(0.5 * most);
        let before = self.slopes_of_last_step(fresh);
        let length_before = before.as_ref().map(|last| 2.0 * last.half);
        let longest = free.min(most);
        let control = demands.control;
        let (step, length, factor) = first_accepted(longest, shortest, |&mut length| {
            let part = (length / scale).min(1.0);
            let task = Task {
                start,
                length,
                demands,
                sizes: &sizes,
                tolerance: IterationTolerance::new(control.end_tolerance_within(part), ROUNDED),
                before: before
                    .as_ref()
                    .filter(|last| goes_on_from(last.half, length)),
            };
            let fast = |relaxation: f64| 0.5 * length * relaxation > SLOW_RELAXATION;
            let iteration = if fast(force.relaxation) {
                Iteration::Newton
            } else if fast(relaxation) {
                Iteration::States
            } else {
                Iteration::FixedPoint
            };
            let mut solve =
                |iteration| stages::solve(self.settings.level, local, &task, iteration, work);
            let solved = match solve(iteration) {
                Err(Diverged) if iteration != Iteration::Newton => solve(Iteration::Newton),
                solved => solved,
            };
            let step = solved.map_err(|Diverged| HALVED)?;
            let ends = step.range.map(|position| local.size_of(position));
            let least = ends[0].min(ends[1]);
            if least < SHRINKING * sizes.position || self.leaves(&step, origin) {
                return Err(HALVED);
            }
            let tolerance = control.tolerance.max(ERROR_NOISE);
            let part = if demands.integrals > 0 {
                (sizes.swing / sizes.position).max(ERROR_NOISE / tolerance)
            } else {
                1.0
            };
            let part = part.min(1.0);
            let here = Sizes {
                position: part * least.min(sizes.position),
                rate: part * sizes.rate,
                internal: sizes.internal.map(|size| part * size),
                ..sizes
            };
            let bends = local.bends_between(&start.stage(), &step.end.stage());
            let ratio = step.error(&here, demands.integrals, bends) / tolerance;
            let order = (step.nodes + 1) as f64;
            // Where the error allows much longer steps, Newton's method takes them.
            let effort = if ratio < MUCH_LONGER.powf(-order) {
                f64::INFINITY
            } else {
                SLOW / step.contraction
            };
            let factor = judge(ratio, order, effort)?;
            let most = most_growth(length, longest, length_before, ACCELERATION);
            Ok((step, length, factor.min(most)))
        })?;
        // A step cut short says little about the next one.
        self.next_length = Some(if length == most && factor >= 1.0 {
            free.max(length * factor.min(2.0))
        } else {
            length * factor
        });
        Ok(step)
    }

    /// Whether the nodes lie so far beyond the limits that the step says nothing.
    fn leaves(&self, step: &Step, origin: DoubleDouble) -> bool {
        let [lowest, highest] = step.range.map(|position| origin.plus(position).value());
        self.settings.limits.are_left_behind_by(lowest..=highest)
    }

    /// The longest first step that sees the transients which begin where slopes have jumped.
    fn transient(
        &self,
        force: Slope,
        slopes: &[Slope],
        sizes: &Sizes,
        control: StepControl,
    ) -> f64 {
        let (before, before_internal) = self.method.slopes_before.unwrap_or_default();
        let mut longest = f64::INFINITY;
        let mut limit = |slope: Slope, before: f64, size: f64| {
            let excursion = (slope.value - before).abs() / slope.relaxation;
            if excursion > control.tolerance * size {
                longest = longest.min(FIRST_RELAXATION / slope.relaxation);
            }
        };
        limit(force, before, sizes.rate);
        for (k, slope) in slopes.iter().enumerate() {
            limit(*slope, before_internal[k], sizes.internal[k]);
        }
        longest
    }

    /// The slopes of the last step, where the next one goes on from it.
    fn slopes_of_last_step(&self, fresh: bool) -> Option<Slopes> {
        let step = self.history.steps().last().filter(|_| !fresh)?;
        let series = step.segment.series();
        let half = series.half;
        Some(Slopes {
            half,
            motion: std::array::from_fn(|degree| series.term(degree) / (half * half)),
            internal: self
                .method
                .polynomials
                .map(|own| own.slopes)
                .unwrap_or_default(),
        })
    }
}

/// Whether nothing changes any more.
fn stands<L: LocalCoupledEquation>(local: &L, start: &FullState, states: usize) -> bool {
    let stage = start.stage();
    let (slopes, force) = local.derivatives(states, local.load(0.0), &stage);
    stage.rate == 0.0
        && force.value == 0.0
        && slopes[..states].iter().all(|slope| slope.value == 0.0)
}
