//! First-order states, integrals and slopes at the present time.

use super::{Carried, MOST_WORK, Trajectory};
use crate::arithmetic::legendre;
use crate::solver::coupled::polynomials::{LegendreCoefficients, Polynomials, TERMS};
use crate::solver::coupled::{FullState, MOST_INTEGRALS, MOST_STATES};
use crate::solver::dense_output::VALIDATION_TOLERANCE;
use crate::solver::integrator::{Method, Present};

impl Trajectory {
    /// The present first-order states.
    pub fn internal(&self) -> [f64; MOST_STATES] {
        match (self.present(), &self.method.polynomials) {
            (Present::Inside(_, offset), Some(polynomials)) => polynomials.internal(offset),
            (Present::End(_), Some(polynomials)) => polynomials.end.internal,
            _ => self.method.internal,
        }
    }

    /// The present derivatives of the first-order states, from the polynomials: where a state
    /// relaxes fast, its equation would lose their digits. Nothing where no step is kept.
    pub fn slopes(&self) -> Option<[f64; MOST_STATES]> {
        let polynomials = self.method.polynomials.as_ref()?;
        Some(polynomials.slopes(match self.present() {
            Present::Start => 0.0,
            Present::Inside(_, offset) => offset,
            Present::End(_) => 2.0 * polynomials.half,
        }))
    }

    /// The present integrals.
    pub fn integrals(&self) -> [f64; MOST_INTEGRALS] {
        match (self.present(), &self.method.polynomials) {
            (Present::Inside(_, offset), Some(polynomials)) => polynomials.integrals(offset),
            (Present::End(_), Some(polynomials)) => polynomials.end.integrals,
            _ => self.method.integrals,
        }
    }

    /// All of the state at the start, its position counted from the origin of the position.
    pub(super) fn full_start(&self) -> FullState {
        FullState {
            motion: self.start.state,
            internal: self.method.internal,
            integrals: self.method.integrals,
        }
    }

    /// x'' and z' at present, from the polynomials.
    pub(super) fn slopes_at_present(&self) -> (f64, [f64; MOST_STATES]) {
        let step = &self.history.steps()[self.cursor.step];
        let series = step.segment.series();
        let u = self.cursor.now.since(step.begin) / series.half - 1.0;
        let sum = legendre::sum(u, TERMS, |degree| series.term(degree));
        let acceleration = sum / (series.half * series.half);
        (acceleration, self.slopes().unwrap_or_default())
    }
}

impl Method for Carried {
    type Event = super::Event;
    type Origin = crate::arithmetic::double_double::DoubleDouble;

    const MOST_STEPS: u32 = MOST_WORK;

    fn is_valid(&self, motion: &Trajectory) -> bool {
        let finite = |numbers: &[f64]| numbers.iter().all(|number| number.is_finite());
        motion.full_start().is_finite()
            && self
                .slopes_before
                .is_none_or(|(acceleration, slopes)| acceleration.is_finite() && finite(&slopes))
            && self
                .polynomials
                .as_ref()
                .is_none_or(|own| leads(own, motion))
            && self.endpoint.are_valid()
            && finite(&motion.internal())
            && finite(&motion.integrals())
    }
}

/// Whether the polynomials belong to the only step, and lead to their ends.
fn leads(polynomials: &Polynomials, motion: &Trajectory) -> bool {
    let [step] = motion.history.steps() else {
        return false;
    };
    let leads = |start: f64, end: f64, slopes: &[f64]| {
        let gain = 2.0 * polynomials.half * slopes[0];
        let size: f64 = slopes.iter().map(|slope| slope.abs()).sum();
        let size = start.abs() + polynomials.half * size;
        size.is_finite() && (end - start - gain).abs() <= VALIDATION_TOLERANCE * size
    };
    let (start, end) = (&polynomials.start, &polynomials.end);
    let ends = |start: &[f64], end: &[f64], slopes: &[LegendreCoefficients]| {
        let ends = start.iter().zip(end);
        { ends.zip(slopes) }.all(|((start, end), slopes)| leads(*start, *end, slopes))
    };
    2.0 * polynomials.half == step.segment.length()
        && *start == motion.full_start()
        && end.motion == step.segment.end()
        && ends(&start.internal, &end.internal, &polynomials.slopes)
        && ends(&start.integrals, &end.integrals, &polynomials.powers)
}
