//! Voltage and prestress as functions of time.
//!
//! Each input is a polynomial in the time since the host last set it: its value
//! and its derivatives. A harmonic voltage may be added to it (Eq. 21), which
//! the model follows exactly at any communication step.

use serde::{Deserialize, Serialize};

pub use super::harmonic::Harmonic;
pub(crate) use super::harmonic::TURN;
use crate::arithmetic::double_double::DoubleDouble;
use crate::arithmetic::jet::Dual;
use crate::arithmetic::number::Number;

/// Derivatives of an input that are taken into account: orders 1 to 4.
pub const HIGHEST_DERIVATIVE: usize = 4;

/// An input from the time at which it was set: Σ `term[k]` sᵏ.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Polynomial {
    term: [f64; HIGHEST_DERIVATIVE + 1],
}

impl Polynomial {
    /// A constant input.
    #[must_use]
    pub const fn constant(value: f64) -> Polynomial {
        let mut term = [0.0; HIGHEST_DERIVATIVE + 1];
        term[0] = value;
        Polynomial { term }
    }

    /// The input with its value replaced.
    #[inline]
    pub fn set_value(&mut self, value: f64) {
        self.term[0] = value;
    }

    /// This input with its value replaced and its derivatives kept.
    #[must_use]
    pub fn with_value(mut self, value: f64) -> Polynomial {
        self.set_value(value);
        self
    }

    /// The input with its derivative of `order` 1 to 4 replaced.
    pub fn set_derivative(&mut self, order: usize, value: f64) {
        let factorial: f64 = (1..=order).map(|k| k as f64).product();
        self.term[order] = value / factorial;
    }

    /// Whether it is a polynomial in finite numbers.
    #[must_use]
    pub fn is_finite(&self) -> bool {
        self.term.iter().all(|term| term.is_finite())
    }

    /// Whether the input keeps its value.
    #[must_use]
    #[inline(always)]
    pub fn is_constant(&self) -> bool {
        // Without a branch for each; the shift drops the sign of −0.
        let bits = |sum, term: &f64| sum | term.to_bits();
        self.term[1..].iter().fold(0, bits) << 1 == 0
    }

    /// Whether the input is of this degree at most.
    #[inline(always)]
    fn is_of_degree(&self, degree: usize) -> bool {
        self.term[degree + 1..].iter().all(|term| *term == 0.0)
    }

    /// Moves the time from which its own counts by `shift`.
    #[inline(always)]
    pub fn shift(&mut self, shift: f64) {
        if self.is_constant() {
            return;
        }
        // Repeated synthetic division by (s − shift).
        for low in 0..HIGHEST_DERIVATIVE {
            for k in (low..HIGHEST_DERIVATIVE).rev() {
                self.term[k] += shift * self.term[k + 1];
            }
        }
    }

    /// The value at the time at which the input was set.
    #[must_use]
    #[inline]
    pub fn value(&self) -> f64 {
        self.term[0]
    }

    /// The value at `offset` later.
    #[inline(always)]
    pub fn at<N: Number>(&self, offset: N) -> N {
        let term = |k: usize| offset.same(self.term[k]);
        let mut sum = term(HIGHEST_DERIVATIVE);
        for k in (0..HIGHEST_DERIVATIVE).rev() {
            sum = sum.mul_add(offset, term(k));
        }
        sum
    }
}

/// Voltage and prestress from `since` on.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Drive {
    /// Time of the model at which the inputs were set.
    pub since: DoubleDouble,
    /// φ, the voltage that the host sets.
    pub voltage: Polynomial,
    /// S, prestress.
    pub prestress: Polynomial,
    /// The built-in alternating voltage.
    pub harmonic: Harmonic,
    /// By how much its angle is ahead of ωt + ϑ, radians: the frequency has changed on
    /// the way, and the phase has run on.
    pub lead: f64,
}

impl Drive {
    /// Constant voltage and prestress, nothing alternating.
    #[must_use]
    pub const fn constant(voltage: f64, prestress: f64) -> Drive {
        Drive {
            since: DoubleDouble::ZERO,
            voltage: Polynomial::constant(voltage),
            prestress: Polynomial::constant(prestress),
            harmonic: Harmonic::OFF,
            lead: 0.0,
        }
    }

    /// The angle of the alternating voltage at `time`.
    #[inline(always)]
    pub(super) fn angle(&self, time: DoubleDouble) -> f64 {
        self.harmonic.angle(time) + self.lead
    }

    /// Gives the alternating voltage another frequency from now on, the time from
    /// which the inputs count; its phase runs on from where it is.
    pub fn retune(&mut self, frequency: DoubleDouble) {
        let carrier = Harmonic {
            phase: 0.0,
            ..self.harmonic
        };
        let [before, after] =
            [carrier, carrier.with_frequency(frequency)].map(|carrier| carrier.angle(self.since));
        let lead = self.lead + (before - after);
        let turns = (lead * (1.0 / TURN.high)).round();
        self.lead = (lead - turns * TURN.high) - turns * TURN.low;
        self.harmonic = self.harmonic.with_frequency(frequency);
    }

    /// Whether its numbers are finite, but for the settings of the alternating voltage.
    #[must_use]
    pub fn is_finite(&self) -> bool {
        self.since.value().is_finite()
            && self.lead.is_finite()
            && self.harmonic.frequency_rest.is_finite()
            && self.voltage.is_finite()
            && self.prestress.is_finite()
    }

    /// Whether voltage and prestress keep their values.
    #[must_use]
    pub fn is_constant(&self) -> bool {
        let alternating = self.harmonic.amplitude != 0.0 && self.harmonic.frequency != 0.0;
        !alternating && self.voltage.is_constant() && self.prestress.is_constant()
    }

    /// Counts the time of the inputs from `time` on.
    #[inline(always)]
    pub fn rebase(&mut self, time: DoubleDouble) {
        let shift = time.since(self.since);
        self.since = time;
        self.voltage.shift(shift);
        self.prestress.shift(shift);
    }

    /// Total voltage and prestress at `time` as they change in a direction,
    /// whose numbers are the rates of change of those in their places.
    #[must_use]
    pub fn along(&self, direction: &Drive, time: DoubleDouble) -> (Dual, Dual) {
        let offset = time.since(self.since);
        let input = |value: &Polynomial, change: &Polynomial| {
            Dual::new(value.at(offset), change.at(offset))
        };
        let voltage = input(&self.voltage, &direction.voltage);
        let prestress = input(&self.prestress, &direction.prestress);
        let (harmonic, change) = (&self.harmonic, &direction.harmonic);
        let angle = Dual::new(
            self.angle(time),
            change.frequency * time.value() + change.phase,
        );
        let alternating = Dual::new(harmonic.amplitude, change.amplitude) * angle.sin();
        (voltage + alternating, prestress)
    }

    /// [`LocalDrive::eighth_degree`] where the inputs have derivatives: from `shift` after they were
    /// set on, the alternating voltage being there or not.
    #[inline(never)]
    fn eighth_degree_of_polynomials(
        &self,
        alternates: bool,
        shift: f64,
        [half, factor]: [f64; 2],
    ) -> Option<[f64; 2]> {
        let (voltage, prestress) = (&self.voltage, &self.prestress);
        if !alternates && voltage.is_of_degree(1) && prestress.is_of_degree(3) {
            return None;
        }
        let about_middle = |input: &Polynomial| {
            let mut input = *input;
            input.shift(shift + half);
            let mut power = 1.0;
            input.term.map(|term| {
                let size = term.abs() * power;
                power *= half;
                size
            })
        };
        let mut series = [0.0; 9];
        series[..=HIGHEST_DERIVATIVE].copy_from_slice(&about_middle(voltage));
        if alternates {
            let harmonic = &self.harmonic;
            let turn = harmonic.frequency.abs() * half;
            let mut size = harmonic.amplitude.abs();
            for (k, sum) in series.iter_mut().enumerate() {
                *sum += size;
                size *= turn / (k + 1) as f64;
            }
        }
        let squared = |k: usize| -> f64 { (0..=k).map(|i| series[i] * series[k - i]).sum() };
        let voltage_squared = (4..=8).fold(0.0, |sum, k| sum * factor + squared(k));
        let square = factor * factor;
        Some([
            voltage_squared,
            about_middle(prestress)[4] * (square * square),
        ])
    }

    /// The drive seen from `time`.
    #[must_use]
    #[inline(always)]
    pub fn at(&self, time: &DoubleDouble) -> LocalDrive<'_> {
        let constant = self.voltage.is_constant() && self.prestress.is_constant();
        LocalDrive {
            drive: self,
            shift: if constant {
                None
            } else {
                Some(time.since(self.since))
            },
            angle: if self.harmonic.amplitude == 0.0 {
                None
            } else {
                Some(self.angle(*time))
            },
        }
    }
}

/// A [`Drive`] with its origin of time moved.
#[derive(Clone, Copy, Debug)]
pub struct LocalDrive<'a> {
    drive: &'a Drive,
    /// The origin, counted as the time of the inputs; nothing where both keep their
    /// values.
    shift: Option<f64>,
    /// The angle of the alternating voltage at the origin; nothing where nothing
    /// alternates.
    angle: Option<f64>,
}

impl LocalDrive<'_> {
    /// An input at `offset` after the origin.
    #[inline(always)]
    fn input<N: Number>(&self, input: &Polynomial, offset: N) -> N {
        match self.shift {
            None => offset.same(input.value()),
            Some(shift) => input.at(offset + offset.same(shift)),
        }
    }

    /// Total voltage φ + φ_a sin(ωt + ϑ) at `offset` after the origin.
    #[inline(always)]
    pub fn voltage<N: Number>(&self, offset: N) -> N {
        let Some([frequency, angle]) = self.harmonic() else {
            return self.input(&self.drive.voltage, offset);
        };
        let angle = offset.mul_add(offset.same(frequency), offset.same(angle));
        self.voltage_with_sine(offset, angle.sin())
    }

    /// Total voltage at `offset` after the origin, where the sine in it is known.
    #[inline(always)]
    pub fn voltage_with_sine<N: Number>(&self, offset: N, sine: N) -> N {
        let voltage = self.input(&self.drive.voltage, offset);
        sine.mul_add(offset.same(self.drive.harmonic.amplitude), voltage)
    }

    /// Angular frequency of the alternating voltage and its angle at the origin, less whole
    /// turns; nothing where nothing alternates.
    #[inline(always)]
    pub fn harmonic(&self) -> Option<[f64; 2]> {
        Some([self.drive.harmonic.frequency, self.angle?])
    }

    /// Prestress at `offset` after the origin.
    #[inline(always)]
    pub fn prestress<N: Number>(&self, offset: N) -> N {
        self.input(&self.drive.prestress, offset)
    }

    /// How much φ² and the prestress add, at most, to the coefficient of u⁸ of a force over a time
    /// of `half` to either side of its middle, which begins at the origin, u = −1…1: from degree 4
    /// on they are multiplied by a power series whose coefficients fall by `factor`. Nothing where
    /// both are of a lower degree.
    #[inline(always)]
    pub fn eighth_degree(&self, half: f64, factor: f64) -> Option<[f64; 2]> {
        if let Some(shift) = self.shift {
            let drive = self.drive;
            return drive.eighth_degree_of_polynomials(self.angle.is_some(), shift, [half, factor]);
        }
        self.angle?;
        // Of (|φ| + |φ_a| eᵗᵘ)², t being the turn of the voltage: each coefficient of 2eᵗᵘ is
        // at most an eighth of that of e²ᵗᵘ.
        let harmonic = &self.drive.harmonic;
        let amplitude = harmonic.amplitude.abs();
        let size = amplitude * (amplitude + 0.125 * self.drive.voltage.value().abs());
        let turn = 2.0 * (harmonic.frequency * half).abs();
        Some([size * eighth_degree_of_exponential(turn, factor), 0.0])
    }

    /// A bound of the absolute voltage over the next steps.
    #[inline(always)]
    pub fn largest_voltage(&self) -> f64 {
        self.input(&self.drive.voltage, 0.0).abs() + self.drive.harmonic.amplitude.abs()
    }

    /// What the absolute voltage is to be compared with: a polynomial that passes through zero is a sum of terms that
    /// do not, and is no more accurate than they are.
    pub fn voltage_size(&self) -> f64 {
        let terms = Polynomial {
            term: self.drive.voltage.term.map(f64::abs),
        };
        terms.at(self.shift.unwrap_or(0.0).abs()) + self.drive.harmonic.amplitude.abs()
    }

    /// Angular frequency of the alternating voltage, 0 where there is none.
    #[must_use]
    #[inline(always)]
    pub fn frequency(&self) -> f64 {
        match self.angle {
            Some(_) => self.drive.harmonic.frequency,
            None => 0.0,
        }
    }
}

/// A bound of Σ tᵏ/k! · factor⁸⁻ᵏ, k = 4 to 8, as a square: that of one term is by three quarters
/// too large, those of the others by 3 % at most.
#[inline(always)]
fn eighth_degree_of_exponential(turn: f64, factor: f64) -> f64 {
    let square = turn * turn;
    let root = square * (factor * (factor + 0.1 * turn) + 0.0245 * square);
    (1.0 / 24.0) * (root * root)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_shifted_input_is_the_same_function() {
        let mut input = Polynomial::constant(0.5);
        for (order, value) in [(1, 0.2), (2, -0.3), (3, 0.7), (4, 1.1)] {
            input.set_derivative(order, value);
        }
        let s: f64 = 0.4;
        let direct = 0.5 + 0.2 * s - 0.15 * s * s + 0.7 / 6.0 * s.powi(3) + 1.1 / 24.0 * s.powi(4);
        assert!((input.at(s) - direct).abs() < 1e-15);
        input.shift(0.3);
        assert!((input.at(0.1) - direct).abs() < 1e-15);
    }

    #[test]
    fn the_eighth_degree_is_bounded_closely() {
        for k in 0..=200 {
            let (turn, factor) = (0.01 * f64::from(k), 1.0 - 0.005 * f64::from(k));
            let term = |k: i32| {
                let factorial: f64 = (1..=k).map(f64::from).product();
                turn.powi(k) / factorial * factor.powi(8 - k)
            };
            let sum: f64 = (4..=8).map(term).sum();
            let bound = eighth_degree_of_exponential(turn, factor);
            assert!(
                sum <= bound && bound <= 1.5 * sum,
                "{turn} {factor}: {sum} {bound}"
            );
        }
    }

    #[test]
    fn the_phase_runs_on_through_a_hundred_thousand_frequencies() {
        let mut drive = Drive::constant(0.0, 0.0);
        drive.harmonic = Harmonic {
            amplitude: 1.0,
            frequency: 0.25,
            frequency_rest: 0.0,
            phase: 0.5,
        };
        // Sums of steps and of frequencies of few bits, so that nothing is rounded
        // in the expected angle before it is reduced.
        let (mut angle, mut time) = (DoubleDouble::ZERO, 0.0);
        for k in 0..100_000_u32 {
            let frequency = 0.125 + f64::from(k % 64) / 64.0;
            drive.since = DoubleDouble::new(time);
            drive.retune(DoubleDouble::new(frequency));
            angle = angle.plus(0.375 * frequency);
            time += 0.375;
            let turns = (angle.high / TURN.high).round();
            let expected = angle.sub(TURN.scale(turns)).value();
            let got = drive.angle(DoubleDouble::new(time)) - 0.5;
            let off = ((got - expected) / TURN.high).round() * TURN.high + expected - got;
            assert!(off.abs() < 1e-12, "{off:e} after {k} changes");
        }
    }
}
