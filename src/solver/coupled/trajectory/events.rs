//! Where a step meets a limit of the position, or the margin of the equation vanishes.

use super::{Event, Trajectory};
use crate::arithmetic::roots::{crossing, lowest_between};
use crate::solver::coupled::{CoupledEquation, LocalCoupledEquation, Stage};
use crate::solver::dense_output::{PARTS, Segment};

impl Trajectory {
    /// Looks for the first event in the last step, whose nodes lie in the `range`.
    pub(super) fn look_for_events<E: CoupledEquation>(
        &mut self,
        equation: &E,
        local: &E::Local<'_>,
        [lowest, highest]: [f64; 2],
    ) {
        let beyond = 0.25 * (highest - lowest);
        let contact = self.first_contact(lowest - beyond, highest + beyond);
        let mut stop = contact.map(|(limit, offset)| (Event::Limit(limit), offset));
        if self.method.awaits_margin
            && equation.awaits_event()
            && let Some(step) = self.history.steps_mut().last_mut()
        {
            step.segment.expand();
            let segment = &step.segment;
            let internal = |offset| match &self.method.polynomials {
                Some(polynomials) => polynomials.internal(offset),
                None => self.method.internal,
            };
            let margin = |segment: &Segment, offset: f64| {
                let stage = Stage {
                    position: segment.position(offset),
                    rate: segment.rate(offset),
                    internal: internal(offset),
                };
                local.margin(offset, &stage)
            };
            let until = stop.map_or(segment.length(), |(_, offset)| offset);
            if let Some(offset) = first_below(segment, until, margin) {
                stop = Some((Event::Margin, offset));
            }
        }
        self.stop_in_last_step(stop);
    }
}

/// The first offset up to `until` at which `margin` is not above 0.
fn first_below(
    segment: &Segment,
    until: f64,
    margin: impl Fn(&Segment, f64) -> f64,
) -> Option<f64> {
    let at = |i: usize| i as f64 / PARTS as f64 * until;
    let below_in_dip = |from: f64, to: f64| {
        let lowest = lowest_between(from, to, |t| margin(segment, t));
        (margin(segment, lowest) <= 0.0).then(|| crossing(from, lowest, |t| margin(segment, t)))
    };
    let mut values = [0.0; PARTS + 1];
    for i in 0..=PARTS {
        values[i] = margin(segment, at(i));
        if values[i] <= 0.0 {
            if i == 0 {
                return Some(0.0);
            }
            return Some(crossing(at(i - 1), at(i), |t| margin(segment, t)));
        }
        // A dip beside the begin may go below 0 though the points rise from there on; that beside the end is looked at below.
        if i == 2
            && is_deep_beside([values[0], values[1], values[2]])
            && let Some(offset) = below_in_dip(at(0), at(1))
        {
            return Some(offset);
        }
        // A dip between three points may go below 0 and come back; that of a parabola is an eighth as deep as its ends
        // are high.
        let is_deep = |middle: f64, ends: f64| 3.0 * middle <= ends;
        if i >= 2
            && values[i - 1] <= values[i - 2]
            && values[i - 1] <= values[i]
            && is_deep(values[i - 1], values[i - 2] + values[i])
            && let Some(offset) = below_in_dip(at(i - 2), at(i))
        {
            return Some(offset);
        }
    }
    let by_the_end = [values[PARTS], values[PARTS - 1], values[PARTS - 2]];
    is_deep_beside(by_the_end)
        .then(|| below_in_dip(at(PARTS - 1), at(PARTS)))
        .flatten()
}

/// Whether the parabola through an end and the two points next to it may have a dip between the first two that is half as
/// deep as the end is high. That of a parabola is an eighth of its second difference deep at most.
fn is_deep_beside([end, next, third]: [f64; 3]) -> bool {
    end <= next && 4.0 * end <= end - 2.0 * next + third
}
