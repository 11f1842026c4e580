//! Dense output: the motion over one step as a polynomial, and the steps that are kept, one after
//! another without a gap.

use std::ops::RangeInclusive;

use serde::{Deserialize, Serialize};

use super::State;
use super::collocation::Series;
use super::position_origin::PositionOrigin;
use super::tables::PAIRED_16;
pub use super::tables::PAIRS;
use super::tables::product::product;
use crate::arithmetic::double_double::DoubleDouble;
use crate::arithmetic::roots::crossing;

/// Number of coefficients: the twice integrated polynomial of degree 15.
const TERMS: usize = 2 * PAIRS + 2;

/// Parts of a segment in each of which the motion turns at most once.
pub const PARTS: usize = 32;

/// Numbers that differ by more than this part do not differ by rounding: where stored numbers are
/// validated.
pub const VALIDATION_TOLERANCE: f64 = 1e-6;

/// x(t) over one substep, u = t/half − 1 ∈ [−1, 1].
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub struct Segment {
    start: State,
    end: State,
    /// f over it.
    series: Series,
    /// Coefficients of the powers of u; worked out when first needed, since
    /// whoever runs over a whole segment needs its end only.
    #[serde(skip)]
    power: [f64; TERMS],
    /// 1/half, worked out with them.
    #[serde(skip)]
    inverse: f64,
    #[serde(skip)]
    expanded: bool,
}

impl Segment {
    /// The motion from `start` to `end` with f given by its series.
    pub fn new(start: State, end: State, series: &Series) -> Segment {
        Segment {
            start,
            end,
            series: *series,
            power: [0.0; TERMS],
            inverse: 0.0,
            expanded: false,
        }
    }

    /// f over the substep.
    pub fn series(&self) -> &Series {
        &self.series
    }

    /// The length of the substep.
    #[inline]
    pub fn length(&self) -> f64 {
        2.0 * self.series.half
    }

    /// The state at the begin.
    #[inline]
    pub fn start(&self) -> State {
        self.start
    }

    /// The state at the end, more accurate than the polynomial between.
    #[inline]
    pub fn end(&self) -> State {
        self.end
    }

    /// Whether the numbers can be those of a substep: from its start f, whatever it
    /// follows, leads to its end.
    pub fn is_valid(&self) -> bool {
        let State { position, rate } = self.start;
        let drift = self.length() * rate;
        let [mean, tilt] = [self.series.even[0], self.series.odd[0] / 3.0];
        let moved = self.end.position - position - drift - 2.0 * (mean - tilt);
        let turned = self.series.half * (self.end.rate - rate) - 2.0 * mean;
        let size = position.abs() + drift.abs() + self.bend();
        self.series.half > 0.0
            && size.is_finite()
            && moved.abs() <= VALIDATION_TOLERANCE * size
            && turned.abs() <= VALIDATION_TOLERANCE * (drift.abs() + self.bend())
    }

    /// Whether it begins in this state, bit for bit as the one before ends.
    pub fn begins_in(&self, state: State) -> bool {
        self.start == state
    }

    /// Whether the motion turns at `offset`, as far as that can be told.
    pub fn turns_at(&self, offset: f64) -> bool {
        self.series.half * self.rate(offset).abs() <= VALIDATION_TOLERANCE * self.bend()
    }

    /// How far f can bend the motion, as a length.
    fn bend(&self) -> f64 {
        let all = self.series.even.iter().chain(&self.series.odd);
        all.map(|coefficient| coefficient.abs()).sum()
    }

    /// Works out the powers of u, which [`Segment::position`] and
    /// [`Segment::rate`] need.
    #[inline]
    pub fn expand(&mut self) {
        if !self.expanded {
            self.expand_now();
        }
    }

    #[inline(never)]
    fn expand_now(&mut self) {
        let even = product(&PAIRED_16.powers_from_even, &self.series.even);
        let odd = product(&PAIRED_16.powers_from_odd, &self.series.odd);
        for i in 0..PAIRS {
            self.power[2 * i + 2] = even[i];
            self.power[2 * i + 3] = odd[i];
        }
        // The first two powers follow from the state at u = −1.
        let (mut slope, mut value) = (0.0, 0.0);
        for k in (2..TERMS).rev() {
            let sign = if k % 2 == 0 { 1.0 } else { -1.0 };
            slope += sign * k as f64 * self.power[k];
            value += sign * self.power[k];
        }
        self.power[1] = self.series.half * self.start.rate + slope;
        self.power[0] = self.start.position + (self.power[1] - value);
        self.inverse = 1.0 / self.series.half;
        self.expanded = true;
    }

    fn local(&self, offset: f64) -> f64 {
        debug_assert!(self.expanded);
        (offset - self.series.half) * self.inverse
    }

    /// x at `offset` after the begin of the segment.
    pub fn position(&self, offset: f64) -> f64 {
        polynomial(self.local(offset), |k| self.power[k])
    }

    /// x' at `offset` after the begin of the segment.
    pub fn rate(&self, offset: f64) -> f64 {
        let slope = |k: usize| match self.power.get(k + 1) {
            Some(power) => (k + 1) as f64 * power,
            None => 0.0,
        };
        polynomial(self.local(offset), slope) * self.inverse
    }

    /// x and x' at `offset` after the begin of the segment.
    pub fn state(&self, offset: f64) -> State {
        State {
            position: self.position(offset),
            rate: self.rate(offset),
        }
    }

    /// The positions at which the motion turns between two offsets, where they may lie outside this
    /// range.
    pub fn turns_outside(
        &self,
        range: RangeInclusive<f64>,
        from: f64,
        to: f64,
    ) -> impl Iterator<Item = f64> + '_ {
        let parts = ((to - from) / self.length() * PARTS as f64).ceil() as usize;
        let part = (to - from) / parts.max(1) as f64;
        let border = move |i: usize| from + i as f64 * part;
        let mut last = self.rate(from);
        (0..parts).filter_map(move |i| {
            let (begin, end) = (border(i), border(i + 1));
            let rates = [last, self.rate(end)];
            last = rates[1];
            let turns = rates[0] * rates[1] < 0.0;
            if !turns {
                return None;
            }
            // The rate falls to 0 from both ends.
            let beyond = part * rates[0].abs().max(rates[1].abs());
            let ends = [self.position(begin), self.position(end)];
            let inside = |position: f64| {
                range.contains(&(position - beyond)) && range.contains(&(position + beyond))
            };
            if ends.into_iter().all(inside) {
                return None;
            }
            Some(self.position(crossing(begin, end, |offset| self.rate(offset))))
        })
    }
}

/// Σ_k coefficient(k)·u^k. In four sums in u⁴, since each operation of a single one waits for the last.
#[inline(always)]
fn polynomial(u: f64, coefficient: impl Fn(usize) -> f64) -> f64 {
    let square = u * u;
    let fourth = square * square;
    let p = coefficient;
    let mut sums = [p(16), p(17), p(14), p(15)];
    sums[0] = sums[0] * fourth + p(12);
    sums[1] = sums[1] * fourth + p(13);
    for k in [10, 6, 2] {
        sums[2] = sums[2] * fourth + p(k);
        sums[3] = sums[3] * fourth + p(k + 1);
    }
    for k in [8, 4, 0] {
        sums[0] = sums[0] * fourth + p(k);
        sums[1] = sums[1] * fourth + p(k + 1);
    }
    (sums[0] + square * sums[2]) + u * (sums[1] + square * sums[3])
}

/// Steps kept to find an orbit; an orbit near a saddle takes about 20.
pub const CAPACITY: usize = 64;

/// The motion over one step.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub struct KeptStep<O> {
    /// Time at which it begins, counted from the origin of time.
    pub begin: DoubleDouble,
    /// Where its positions are counted from.
    pub origin: O,
    /// The motion from there on.
    pub segment: Segment,
}

impl<O> KeptStep<O> {
    /// Time at which it ends.
    pub fn end(&self) -> DoubleDouble {
        self.begin.plus(self.segment.length())
    }
}

/// The steps that are kept.
#[derive(Debug, Serialize, Deserialize)]
#[serde(into = "Vec<KeptStep<O>>", try_from = "Vec<KeptStep<O>>")]
#[serde(bound = "O: PositionOrigin")]
pub struct History<O> {
    /// With room for as many as are kept, so that none is ever allocated later.
    steps: Vec<KeptStep<O>>,
}

impl<O: Copy> Clone for History<O> {
    fn clone(&self) -> History<O> {
        let mut history = History::empty();
        history.steps.extend_from_slice(&self.steps);
        history
    }
}

impl<O> History<O> {
    /// No step.
    pub fn empty() -> History<O> {
        History {
            steps: Vec::with_capacity(CAPACITY),
        }
    }

    /// An empty history in the memory of this one, which must not be used any more.
    pub fn take(&mut self) -> History<O> {
        self.clear();
        History {
            steps: std::mem::take(&mut self.steps),
        }
    }

    /// Whether no step is kept.
    #[inline]
    pub fn is_empty(&self) -> bool {
        self.steps.is_empty()
    }

    /// Whether no further step can be kept.
    pub fn is_full(&self) -> bool {
        self.steps.len() >= CAPACITY
    }

    /// Forgets all steps.
    pub fn clear(&mut self) {
        self.steps.clear();
    }

    /// The steps, the first one first.
    #[inline]
    pub fn steps(&self) -> &[KeptStep<O>] {
        &self.steps
    }

    /// The steps, to be expanded.
    pub fn steps_mut(&mut self) -> &mut [KeptStep<O>] {
        &mut self.steps
    }

    /// Adds a step, if there is room for it.
    pub fn push(&mut self, step: KeptStep<O>) {
        if !self.is_full() {
            self.steps.push(step);
        }
    }

    /// The end of the last step.
    #[inline]
    pub fn end(&self) -> DoubleDouble {
        self.steps.last().map_or(DoubleDouble::ZERO, KeptStep::end)
    }

    /// The step that holds `time`, looked for from the step `near` on. Of two that meet at `time`,
    /// the earlier one if `near` is not after it.
    pub fn find(&self, time: DoubleDouble, near: usize) -> usize {
        let steps = self.steps();
        let mut index = near;
        while index + 1 < steps.len() && time.since(steps[index + 1].begin) > 0.0 {
            index += 1;
        }
        while index > 0 && time.since(steps[index].begin) < 0.0 {
            index -= 1;
        }
        index
    }
}

impl<O: PositionOrigin> History<O> {
    /// Whether the numbers can be those of steps that follow each other without a gap.
    pub fn is_valid(&self) -> bool {
        let mut before: Option<&KeptStep<O>> = None;
        self.steps.iter().all(|step| {
            let follows = match before.replace(step) {
                // Where the position is counted from may change in between.
                Some(last) => {
                    step.begin == last.end()
                        && (step.origin != last.origin
                            || step.segment.begins_in(last.segment.end()))
                }
                None => step.begin == DoubleDouble::ZERO,
            };
            follows && step.segment.is_valid() && step.origin.is_finite()
        })
    }
}

impl<O> From<History<O>> for Vec<KeptStep<O>> {
    fn from(history: History<O>) -> Vec<KeptStep<O>> {
        history.steps
    }
}

impl<O> TryFrom<Vec<KeptStep<O>>> for History<O> {
    type Error = &'static str;

    fn try_from(mut steps: Vec<KeptStep<O>>) -> Result<History<O>, &'static str> {
        if steps.len() > CAPACITY {
            return Err("more steps than a trajectory keeps");
        }
        for step in &mut steps {
            step.segment.expand();
        }
        steps.reserve_exact(CAPACITY - steps.len());
        Ok(History { steps })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// x = (t − 1)³ + (t − 1) on [0, 4]: x'' = 6(t − 1) = 6 P_0 + 12 P_1(u).
    fn cubic() -> Segment {
        let start = State {
            position: -2.0,
            rate: 4.0,
        };
        let end = State {
            position: 30.0,
            rate: 28.0,
        };
        let (mut even, mut odd) = ([0.0; PAIRS], [0.0; PAIRS]);
        (even[0], odd[0]) = (4.0 * 6.0, 4.0 * 12.0);
        let half = 2.0;
        let mut segment = Segment::new(start, end, &Series { half, even, odd });
        segment.expand();
        segment
    }

    #[test]
    fn position_and_rate_are_those_of_the_polynomial() {
        let x = |t: f64| (t - 1.0).powi(3) + (t - 1.0);
        let v = |t: f64| 3.0 * (t - 1.0).powi(2) + 1.0;
        for t in [0.0, 0.3, 1.0, 2.7, 4.0] {
            assert!((cubic().position(t) - x(t)).abs() < 1e-14);
            assert!((cubic().rate(t) - v(t)).abs() < 1e-14);
        }
    }
}
