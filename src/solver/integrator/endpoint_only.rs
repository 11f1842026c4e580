//! A way that is gone by endpoint-only steps, of which nothing is kept.

use super::{Integrator, Method};
use crate::arithmetic::double_double::DoubleDouble;
use crate::solver::coupled::Stage;
use crate::solver::endpoint::{End, Way};
use crate::solver::extremes::Extremes;
use crate::solver::limits::Limits;
use crate::solver::position_origin::PositionOrigin;
use crate::solver::step_control::StepControl;

impl<M: Method> Integrator<M> {
    /// The positions between which nothing happens.
    pub(in crate::solver) fn bounds(&self) -> (f64, f64) {
        let Limits { lower, upper } = self.settings.limits;
        match self.extremes() {
            Some(Extremes { lowest, highest }) => (lower.max(lowest), upper.min(highest)),
            None => (lower, upper),
        }
    }

    /// What a step may miss: less where its error is made again and again, by an orbit that repeats or by
    /// restarts at every step.
    pub(in crate::solver) fn step_control(&self, repeats: bool) -> StepControl {
        if repeats || self.restarts.at_every_step() {
            self.settings.control.repeated()
        } else {
            self.settings.control
        }
    }

    /// Follows the motion from the end of the last step toward `target`, keeping none of it, and moves
    /// the origin there. Takes the first-order states along. Returns by how much, 0 where it goes nowhere, and whether
    /// the next such step would meet no limit and no extreme.
    pub(in crate::solver) fn go_to_end<const K: usize>(
        &mut self,
        target: DoubleDouble,
        internal: &mut [f64; K],
        control: StepControl,
        budget: &mut u32,
        go: impl FnOnce(&mut M, &mut Way<K>) -> End,
    ) -> (DoubleDouble, bool) {
        let begin = self.history.end();
        self.arrive(begin);
        let mut way = Way {
            begin: self.start.time.add(begin),
            now: DoubleDouble::ZERO,
            state: Stage::of(self.state(), *internal),
            target: target.sub(begin),
            bounds: self.bounds(),
            control,
            budget: *budget,
        };
        let end = go(&mut self.method, &mut way);
        *budget = way.budget;
        if way.now == DoubleDouble::ZERO {
            // What is kept serves the step with dense output that follows.
            return (DoubleDouble::ZERO, end != End::Blocked);
        }
        *internal = way.state.internal;
        let shift = if end == End::Reached {
            target
        } else {
            begin.add(way.now)
        };
        self.start.origin = M::Origin::ZERO;
        self.stand_at(way.time(), way.state.motion());
        (shift, end != End::Blocked)
    }
}
