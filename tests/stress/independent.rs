//! An integrator that shares nothing with the library: Taylor series of Eq. 16
//! as it stands in the paper, the surface terms not folded, in about 30 digits.
//!
//! Origin of the step size: À. Jorba and M. Zou, "A software package for the
//! numerical integration of ODEs by means of high-order Taylor methods",
//! Experimental Mathematics 14 (2005) 99–117. With [`Tangent`] for a number the
//! same formulas integrate the variational equation.

use std::ops::{Add, Div, Mul, RangeInclusive, Sub};

use super::doubled::Doubled;

/// Most terms of a series.
const TERMS: usize = 34;

/// Terms in a row that must be negligible: at rest every second one vanishes.
const LAST: usize = 3;

/// What a series can be of.
pub trait Number:
    Copy
    + From<Doubled>
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
{
    /// What the last terms of a series may add, relative to the stretch.
    const NEGLIGIBLE: f64;

    /// Its value, rounded.
    fn value(&self) -> f64;

    /// Σ a·b.
    fn sum_of_products(pairs: impl Iterator<Item = (Self, Self)>) -> Self {
        let zero = Self::from(Doubled::from(0.0));
        pairs.fold(zero, |sum, (a, b)| sum + a * b)
    }
}

impl Number for Doubled {
    const NEGLIGIBLE: f64 = 1e-20;

    fn value(&self) -> f64 {
        self.high + self.low
    }

    fn sum_of_products(pairs: impl Iterator<Item = (Doubled, Doubled)>) -> Doubled {
        Doubled::sum_of_products(pairs)
    }
}

/// A number and how it changes with the stretch and the rate at the start.
#[derive(Clone, Copy, Debug)]
pub struct Tangent {
    pub value: f64,
    pub along: [f64; 2],
}

impl From<Doubled> for Tangent {
    fn from(constant: Doubled) -> Tangent {
        Tangent {
            value: constant.value(),
            along: [0.0; 2],
        }
    }
}

impl Tangent {
    fn combine(self, other: Tangent, value: f64, weights: [f64; 2]) -> Tangent {
        let along = [0, 1].map(|i| weights[0] * self.along[i] + weights[1] * other.along[i]);
        Tangent { value, along }
    }
}

impl Add for Tangent {
    type Output = Tangent;

    fn add(self, other: Tangent) -> Tangent {
        self.combine(other, self.value + other.value, [1.0, 1.0])
    }
}

impl Sub for Tangent {
    type Output = Tangent;

    fn sub(self, other: Tangent) -> Tangent {
        self.combine(other, self.value - other.value, [1.0, -1.0])
    }
}

impl Mul for Tangent {
    type Output = Tangent;

    fn mul(self, other: Tangent) -> Tangent {
        self.combine(other, self.value * other.value, [other.value, self.value])
    }
}

impl Div for Tangent {
    type Output = Tangent;

    fn div(self, other: Tangent) -> Tangent {
        let quotient = self.value / other.value;
        self.combine(
            other,
            quotient,
            [1.0 / other.value, -quotient / other.value],
        )
    }
}

/// To know by how much an error grows, few digits will do.
impl Number for Tangent {
    const NEGLIGIBLE: f64 = 1e-7;

    fn value(&self) -> f64 {
        self.value
    }
}

/// c, γ, τ, E.
#[derive(Clone, Copy, Debug)]
pub struct Actuator {
    pub aspect: f64,
    pub surface: [f64; 3],
}

impl Actuator {
    /// T, the time scale of the calm motion.
    pub fn time_scale(&self) -> f64 {
        ((self.aspect + 2.0) / 6.0).sqrt()
    }
}

/// φ + φ_a sin(ωt + ϑ) and S.
#[derive(Clone, Copy, Debug)]
pub struct Load {
    /// φ and its derivatives of orders 1 to 4 at the time when it was set.
    pub voltage: [f64; 5],
    /// S and its derivatives.
    pub prestress: [f64; 5],
    /// φ_a, ω, ϑ.
    pub harmonic: [f64; 3],
}

impl Load {
    pub fn constant(voltage: f64, prestress: f64) -> Load {
        let constant = |value| [value, 0.0, 0.0, 0.0, 0.0];
        Load {
            voltage: constant(voltage),
            prestress: constant(prestress),
            harmonic: [0.0; 3],
        }
    }
}

/// Stretch and rate at a time.
#[derive(Clone, Copy)]
pub struct Taylor<N = Doubled> {
    pub stretch: N,
    pub rate: N,
    pub time: Doubled,
    /// The time when the inputs were set.
    since: Doubled,
    /// What the angle of the drive is ahead of ωt + ϑ since its frequency was changed.
    lead: Doubled,
}

impl Taylor {
    pub fn new(stretch: f64, rate: f64) -> Taylor {
        Taylor::starting([stretch, rate].map(Doubled::from), 0.0.into())
    }

    pub fn state(&self) -> [f64; 2] {
        [self.stretch.value(), self.rate.value()]
    }

    /// This motion, with its variational equation from here on.
    pub fn varied(&self) -> Taylor<Tangent> {
        let [value, rate] = self.state();
        let along = |value, along| Tangent { value, along };
        Taylor {
            since: self.since,
            lead: self.lead,
            ..Taylor::starting(
                [along(value, [1.0, 0.0]), along(rate, [0.0, 1.0])],
                self.time,
            )
        }
    }
}

/// The series of all that enters Eq. 16.
struct Series<N> {
    x: [N; TERMS],
    known: usize,
}

impl<N: Number> Taylor<N> {
    pub fn starting([stretch, rate]: [N; 2], time: Doubled) -> Taylor<N> {
        Taylor {
            stretch,
            rate,
            time,
            since: time,
            lead: 0.0.into(),
        }
    }

    /// The inputs are those of a new load from here on; the drive goes on from its angle
    /// where its frequency changes.
    pub fn set_inputs(&mut self, before: &Load, after: &Load) {
        self.since = self.time;
        let [before, after] = [before, after].map(|load| Doubled::from(load.harmonic[1]));
        self.lead = self.lead + (before - after) * self.time;
    }

    /// Follows the motion for `duration`.
    pub fn advance(&mut self, actuator: &Actuator, load: &Load, duration: f64) {
        let ended = self.advance_within(actuator, load, duration, 0.0..=f64::MAX);
        assert!(ended, "the independent integrator is stuck in {load:?}");
    }

    /// Follows the motion as long as the stretch stays in `range`. False where it does not, or
    /// where the motion ends in a singularity.
    pub fn advance_within(
        &mut self,
        actuator: &Actuator,
        load: &Load,
        duration: f64,
        range: RangeInclusive<f64>,
    ) -> bool {
        let number = |value: f64| N::from(Doubled::from(value));
        let mut rest = Doubled::from(duration);
        while rest.value() > 0.0 {
            let (series, h) = self.series(actuator, load, rest.value());
            if !(h > 1e-12 * duration && range.contains(&self.stretch.value())) {
                return false;
            }
            // The last step takes all that is left, to the last digit.
            let length = if h == rest.value() { rest } else { h.into() };
            let length_n = N::from(length);
            let (mut stretch, mut rate) = (number(0.0), number(0.0));
            for k in (1..series.known).rev() {
                stretch = (stretch + series.x[k]) * length_n;
                if k > 1 {
                    rate = (rate + series.x[k] * number(k as f64)) * length_n;
                }
            }
            self.stretch = self.stretch + stretch;
            self.rate = self.rate + rate;
            self.time = self.time + length;
            rest = rest - length;
        }
        range.contains(&self.stretch.value())
    }

    /// Taylor coefficients of the stretch at the present time, and how far they lead: to
    /// `rest`, if that can be.
    fn series(&self, actuator: &Actuator, load: &Load, rest: f64) -> (Series<N>, f64) {
        let number = |value: f64| N::from(Doubled::from(value));
        let zero = [number(0.0); TERMS];
        let [gamma, tau, elasticity] = actuator.surface.map(number);
        let (mut x, mut v, mut s, mut q, mut q2, mut q3) = (zero, zero, zero, zero, zero, zero);
        let (mut r5, mut r7, mut w, mut x3, mut x5) = (zero, zero, zero, zero, zero);
        let (mut spin, mut acceleration, mut mass, mut squared) = (zero, zero, zero, zero);
        let voltage = self.voltage(load);
        let prestress = polynomial(&load.prestress, self.time - self.since);
        (x[0], x[1]) = (self.stretch, self.rate);
        // A term is judged by what it adds to the rate.
        let unit = actuator.time_scale() + rest;
        let most = N::NEGLIGIBLE * x[0].value().abs();
        let adds = |x: &[N], k: usize, h: f64| {
            let size = k as f64 * x[k].value().abs() * unit;
            size * h.powi(k as i32 - 1)
        };
        for k in 0..TERMS - 2 {
            v[k] = x[k + 1] * number((k + 1) as f64);
            squared[k] = product(&voltage, &voltage, k);
            s[k] = product(&x, &x, k);
            q[k] = quotient(number(if k == 0 { 1.0 } else { 0.0 }), &q, &s, k);
            q2[k] = product(&q, &q, k);
            q3[k] = product(&q2, &q, k);
            r5[k] = product(&q3, &x, k);
            r7[k] = product(&r5, &q, k);
            w[k] = product(&v, &v, k);
            spin[k] = product(&r7, &w, k);
            x3[k] = product(&s, &x, k);
            x5[k] = product(&s, &x3, k);
            // γλ + τ(2λ³ − λ) + ½Eλ(λ² − 1)(3λ² − 1).
            let surface = gamma * x[k]
                + tau * (number(2.0) * x3[k] - x[k])
                + number(0.5) * elasticity * (number(3.0) * x5[k] - number(4.0) * x3[k] + x[k]);
            let mut force = number(6.0) * spin[k] - x[k] + r5[k] + product(&squared, &x3, k)
                - number(2.0) * surface;
            if k < prestress.len() {
                force = force + N::from(prestress[k]);
            }
            mass[k] = number(2.0) * q3[k];
            if k == 0 {
                mass[0] = mass[0] + number(actuator.aspect);
            }
            acceleration[k] = quotient(force, &acceleration, &mass, k);
            x[k + 2] = acceleration[k] / number(((k + 1) * (k + 2)) as f64);
            let known = k + 3;
            // The polynomial inputs enter with up to 8 terms.
            let last = known.saturating_sub(LAST)..known;
            if known > 10 && last.clone().all(|k| adds(&x, k, rest) <= most) {
                return (Series { x, known }, rest);
            }
        }
        let far = |k: usize| (most / adds(&x, k, 1.0)).powf(1.0 / (k as f64 - 1.0));
        let h = (TERMS - LAST..TERMS).map(far).fold(rest, f64::min);
        (Series { x, known: TERMS }, h)
    }

    /// Taylor coefficients of the voltage at the present time.
    fn voltage(&self, load: &Load) -> [N; TERMS] {
        let mut series = [N::from(0.0.into()); TERMS];
        let [amplitude, frequency, phase] = load.harmonic.map(Doubled::from);
        if load.harmonic[0] != 0.0 {
            let [sine, cosine] = (frequency * self.time + phase + self.lead).sin_cos();
            let turned = [sine, cosine, -sine, -cosine];
            let mut factor = amplitude;
            for k in 0..TERMS {
                series[k] = N::from(factor * turned[k % 4]);
                factor = factor * frequency / ((k + 1) as f64).into();
            }
        }
        let held = polynomial(&load.voltage, self.time - self.since);
        for k in 0..held.len() {
            series[k] = series[k] + N::from(held[k]);
        }
        series
    }
}

/// The Taylor coefficients, `offset` later, of an input with these derivatives.
fn polynomial(derivatives: &[f64; 5], offset: Doubled) -> [Doubled; 5] {
    let mut factorial = 1.0;
    let mut terms = [Doubled::from(0.0); 5];
    for k in 0..5 {
        terms[k] = Doubled::from(derivatives[k]) / factorial.into();
        factorial *= (k + 1) as f64;
    }
    for low in 0..4 {
        for k in (low..4).rev() {
            terms[k] = terms[k] + offset * terms[k + 1];
        }
    }
    terms
}

/// Coefficient k of a·b.
fn product<N: Number>(a: &[N; TERMS], b: &[N; TERMS], k: usize) -> N {
    N::sum_of_products((0..=k).map(|j| (a[j], b[k - j])))
}

/// Coefficient k of n/d, `n` being that of n and `before` those found so far.
fn quotient<N: Number>(n: N, before: &[N; TERMS], d: &[N; TERMS], k: usize) -> N {
    (n - N::sum_of_products((0..k).map(|j| (before[j], d[k - j])))) / d[0]
}
