//! The equation of motion (Eq. 16) and its energy (Eq. 18), nondimensional.

use serde::{Deserialize, Serialize};

use super::coefficients::Coefficients;
use super::drive::{Drive, LocalDrive};
use crate::arithmetic::double_double::DoubleDouble;
use crate::arithmetic::number::Number;
use crate::solver::{Equation, LocalEquation, Sensitivity, State};

/// The motion of an actuator under a drive.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub struct Motion {
    /// The actuator.
    pub coefficients: Coefficients,
    /// Its voltage and prestress.
    pub drive: Drive,
}

/// Squared voltage φ² and prestress S at a time, or at lanes of times.
#[derive(Clone, Copy, Debug)]
pub struct Load<N> {
    /// φ².
    pub voltage_squared: N,
    /// S.
    pub prestress: N,
}

/// Acceleration λ'' of the stretch λ with rate λ' under a load, Eq. 16 solved
/// for it. Multiplied by λ⁷ it needs a single division:
///
/// ```text
/// λ'' = {6λ'² + λ² + λ⁴ [S λ³ − λ⁴ (linear + (cubic − φ²) λ² + quintic λ⁴)]} / (c λ⁷ + 2λ)
/// ```
#[inline(always)]
pub fn acceleration<N: Number>(
    coefficients: &Coefficients<N>,
    load: Load<N>,
    stretch: N,
    rate: N,
) -> N {
    let [numerator, inverse] = numerator_and_inverse(coefficients, load, stretch, rate);
    numerator * inverse
}

/// The numerator of [`acceleration`], and the inverse of its denominator.
///
/// The powers are arranged so that the division, which takes the longest, waits for as few operations as
/// possible; the numerator is there before it ends. In registers of two numbers there are as few as possible: there
/// motions take 2 to 5 % less time by it.
#[inline(always)]
fn numerator_and_inverse<N: Number>(
    coefficients: &Coefficients<N>,
    load: Load<N>,
    stretch: N,
    rate: N,
) -> [N; 2] {
    let [one, six] = [1.0, 6.0].map(|value| stretch.same(value));
    if N::IS_NARROW {
        let [numerator, denominator] = in_few_operations(coefficients, load, [stretch, rate], six);
        return [numerator, one / denominator];
    }
    let Coefficients {
        inertia,
        linear,
        cubic,
        quintic,
    } = *coefficients;
    let square = stretch * stretch;
    let fourth = square * square;
    let third = (inertia * stretch) * square;
    let inverse = one / third.mul_add(fourth, stretch + stretch);
    let lower = (cubic - load.voltage_squared).mul_add(square, linear);
    let elastic = fourth.mul_add(quintic, lower);
    let force = (stretch * square) * load.prestress - fourth * elastic;
    let free = (rate * rate).mul_add(six, square);
    [fourth.mul_add(force, free), inverse]
}

/// h²λ'' by λ and hλ' for steps h with their inverse 1/h: [`acceleration`] in as few operations as possible,
/// for lanes that keep the processor busy while a division is waited for. An ensemble takes 9 % less time by it at a
/// tolerance of 1e-9, 3 % at 1e-12.
#[inline(always)]
pub fn acceleration_in_steps<N: Number>(
    coefficients: &Coefficients<N>,
    load: Load<N>,
    motion: [N; 2],
    [step, inverse]: [N; 2],
) -> N {
    let by_rate = step.same(6.0) * (inverse * inverse);
    let [numerator, denominator] = in_few_operations(coefficients, load, motion, by_rate);
    numerator * ((step * step) / denominator)
}

/// Numerator and denominator of [`acceleration`], where 6λ'² is the square of a rate times `by_rate`.
#[inline(always)]
fn in_few_operations<N: Number>(
    coefficients: &Coefficients<N>,
    load: Load<N>,
    [stretch, rate]: [N; 2],
    by_rate: N,
) -> [N; 2] {
    let &Coefficients {
        inertia,
        linear,
        cubic,
        quintic,
    } = coefficients;
    let square = stretch * stretch;
    let fourth = square * square;
    let seventh = (stretch * square) * fourth;
    let lower = (cubic - load.voltage_squared).mul_add(square, linear);
    let force = load.prestress - stretch * fourth.mul_add(quintic, lower);
    let free = (rate * rate).mul_add(by_rate, square);
    let denominator = seventh.mul_add(inertia, stretch + stretch);
    [seventh.mul_add(force, free), denominator]
}

/// The Hamiltonian 𝓗 of Eq. 18, nondimensional as in Eq. 19 and 0 for the
/// actuator at rest at λ = 1. Constant while voltage and prestress are.
#[must_use]
pub fn energy(coefficients: &Coefficients, load: Load<f64>, state: State) -> f64 {
    let State {
        position: stretch,
        rate,
    } = state;
    let square = stretch * stretch;
    // λ² − 1 without cancellation near λ = 1.
    let growth = (stretch - 1.0) * (stretch + 1.0);
    let kinetic = 2.0 * (coefficients.inertia + 2.0 / square.powi(3)) * rate * rate;
    // 2λ² + λ⁻⁴ − 3 = (λ²−1)² (2λ²+1) / λ⁴.
    let bulk = growth * growth * (2.0 * square + 1.0) / (square * square);
    let electric = load.voltage_squared * growth * (square + 1.0);
    let mechanical = 4.0 * load.prestress * (stretch - 1.0);
    // 4[γ(λ²−1) + τλ²(λ²−1) + ½Eλ²(λ²−1)²] in the folded coefficients:
    // λ² = 1 + g gives 2(linear−1+cubic+quintic)g + (cubic + 2·quintic)g² + ⅔·quintic·g³.
    let Coefficients {
        linear,
        cubic,
        quintic,
        ..
    } = *coefficients;
    let surface = growth
        * (2.0 * (linear - 1.0 + cubic + quintic)
            + growth * (cubic + 2.0 * quintic + growth * (2.0 / 3.0) * quintic));
    kinetic + bulk - electric - mechanical + surface
}

impl Equation for Motion {
    type Local<'a> = LocalMotion<'a>;

    #[inline(always)]
    fn at(&self, time: &DoubleDouble) -> LocalMotion<'_> {
        LocalMotion::new(self.coefficients, &self.drive, time)
    }

    fn is_autonomous(&self) -> bool {
        self.drive.is_constant()
    }

    /// Eq. 16 is that of a Hamiltonian (Eq. 18), with x' in it squared.
    fn is_time_reversible(&self) -> bool {
        true
    }
}

/// A [`Motion`] with its origin of time moved.
#[derive(Clone, Copy, Debug)]
pub struct LocalMotion<'a> {
    coefficients: Coefficients,
    drive: LocalDrive<'a>,
}

impl LocalMotion<'_> {
    /// The motion of an actuator with these coefficients under a drive, seen from `time`.
    #[inline(always)]
    pub(crate) fn new<'a>(
        coefficients: Coefficients,
        drive: &'a Drive,
        time: &DoubleDouble,
    ) -> LocalMotion<'a> {
        LocalMotion {
            coefficients,
            drive: drive.at(time),
        }
    }
}

impl LocalEquation for LocalMotion<'_> {
    type Load<N: Number> = Load<N>;

    #[inline(always)]
    fn load<N: Number>(&self, offset: N) -> Load<N> {
        let voltage = self.drive.voltage(offset);
        Load {
            voltage_squared: voltage * voltage,
            prestress: self.drive.prestress(offset),
        }
    }

    #[inline(always)]
    fn harmonic(&self) -> Option<[f64; 2]> {
        self.drive.harmonic()
    }

    #[inline(always)]
    fn load_with_sine<N: Number>(&self, offset: N, sine: N) -> Load<N> {
        let voltage = self.drive.voltage_with_sine(offset, sine);
        Load {
            voltage_squared: voltage * voltage,
            prestress: self.drive.prestress(offset),
        }
    }

    #[inline(always)]
    fn acceleration<N: Number>(&self, load: Load<N>, position: N, rate: N) -> N {
        acceleration(&self.coefficients.same(position), load, position, rate)
    }

    #[inline(always)]
    fn acceleration_and<N: Number>(&self, load: Load<N>, position: N, rate: N, addend: N) -> N {
        let [numerator, inverse] = self.numerator_and_inverse(load, position, rate);
        numerator.mul_add(inverse, addend)
    }

    /// That of φ² under the alternating voltage.
    #[inline(always)]
    fn load_frequency(&self) -> f64 {
        2.0 * self.drive.frequency()
    }

    #[inline(always)]
    fn eighth_degree(&self, half: f64, factor: f64) -> Option<[f64; 2]> {
        self.drive.eighth_degree(half, factor)
    }

    #[inline(always)]
    fn parts<N: Number>(load: Load<N>) -> [N; 2] {
        [load.voltage_squared, load.prestress]
    }

    /// M being the inertia c + 2λ⁻⁶: |∂λ''/∂λ| with the absolute values of the terms of the
    /// stiffness added up; λ³/M and 1/M; |12λ'λ⁻⁷/M|.
    #[inline(always)]
    fn sensitivity(&self, state: State) -> Sensitivity {
        let stretch = state.position;
        let cube = stretch * stretch * stretch;
        let [stiffness, mass] = self.stiffness_and_mass(stretch);
        let inverse = 1.0 / mass;
        let by_prestress = (cube * cube) * inverse;
        Sensitivity {
            position: stiffness * inverse,
            load: [cube * by_prestress, by_prestress],
            rate: 12.0 * (state.rate * inverse / stretch).abs(),
        }
    }

    #[inline(always)]
    fn natural_frequency(&self, state: State) -> f64 {
        let [stiffness, mass] = self.stiffness_and_mass(state.position);
        root_of_quotient(stiffness, mass)
    }
}

impl LocalMotion<'_> {
    /// λ'' as a numerator and the inverse of its denominator, c λ⁷ + 2λ.
    #[inline(always)]
    pub(super) fn numerator_and_inverse<N: Number>(
        &self,
        load: Load<N>,
        stretch: N,
        rate: N,
    ) -> [N; 2] {
        numerator_and_inverse(&self.coefficients.same(stretch), load, stretch, rate)
    }

    #[inline(always)]
    fn stiffness_and_mass(&self, stretch: f64) -> [f64; 2] {
        stiffness_and_mass(&self.coefficients, self.drive.largest_voltage(), stretch)
    }
}

/// Numerator and denominator of |∂λ''/∂λ| = (5λ⁻⁶ + |a1| + 3(|a3| + φ²)λ² + 5a5 λ⁴)/(c + 2λ⁻⁶), times
/// λ⁶, where φ is the largest voltage. The absolute values of the terms of the stiffness are added up,
/// since their sum may vanish.
#[inline(always)]
pub fn stiffness_and_mass<N: Number>(
    coefficients: &Coefficients<N>,
    largest_voltage: N,
    stretch: N,
) -> [N; 2] {
    let number = |value: f64| stretch.same(value);
    let &Coefficients {
        inertia,
        linear,
        cubic,
        quintic,
    } = coefficients;
    let square = stretch * stretch;
    let cube = square * stretch;
    let sixth = cube * cube;
    let by_square = number(3.0) * (cubic.magnitude() + largest_voltage * largest_voltage);
    let bracket = linear.magnitude() + square * (by_square + square * number(5.0) * quintic);
    [number(5.0) + sixth * bracket, inertia * sixth + number(2.0)]
}

/// √(a/b) of positive numbers, to 10 %. The bits of a number are its logarithm, linear
/// between powers of 2.
#[inline(always)]
fn root_of_quotient(a: f64, b: f64) -> f64 {
    const ONE: i64 = 1.0_f64.to_bits() as i64;
    let difference = a.to_bits() as i64 - b.to_bits() as i64;
    f64::from_bits((ONE + (difference >> 1)) as u64)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::actuator::Parameters;

    fn reference() -> Coefficients {
        Coefficients::fold(&Parameters {
            aspect: 100.0,
            surface_energy: 0.05,
            surface_tension: 0.03,
            surface_elasticity: 0.2,
        })
    }

    /// Eq. 16 as it stands in the paper, solved for the acceleration.
    fn paper(load: Load<f64>, x: f64, v: f64) -> f64 {
        let (gamma, tau, elasticity) = (0.05, 0.03, 0.2);
        let surface = gamma * x
            + tau * (2.0 * x.powi(3) - x)
            + 0.5 * elasticity * x * (x * x - 1.0) * (3.0 * x * x - 1.0);
        let force = 6.0 * v * v / x.powi(7) - (x - x.powi(-5))
            + load.prestress
            + load.voltage_squared * x.powi(3)
            - 2.0 * surface;
        force / (100.0 + 2.0 / x.powi(6))
    }

    #[test]
    fn the_acceleration_is_that_of_the_paper() {
        let load = Load {
            voltage_squared: 0.36,
            prestress: 0.2,
        };
        for (x, v) in [(1.0, 0.0), (0.6, 0.3), (1.7, -0.1), (3.0, 0.5)] {
            let ours = acceleration(&reference(), load, x, v);
            assert!((ours - paper(load, x, v)).abs() < 1e-14 * ours.abs().max(1.0));
            let step = 0.3;
            let state = [x, step * v];
            let in_steps = acceleration_in_steps(&reference(), load, state, [step, 1.0 / step]);
            assert!((in_steps - step * step * ours).abs() < 1e-14 * ours.abs().max(1.0));
        }
    }

    #[test]
    fn the_root_of_a_quotient_is_right_to_a_tenth() {
        let mut a = 1e-9_f64;
        while a < 1e12 {
            for b in [2.0, 2.9, 3.7, 102.0, 1e10] {
                let error = root_of_quotient(a, b) / (a / b).sqrt() - 1.0;
                assert!(error.abs() < 0.1, "{error} for {a}/{b}");
            }
            a *= 1.013;
        }
    }

    /// d𝓗/dt = 0 along Eq. 16, by central differences of 𝓗.
    #[test]
    fn the_energy_is_that_of_the_motion() {
        let load = Load {
            voltage_squared: 0.36,
            prestress: 0.2,
        };
        let coefficients = reference();
        let at = |x: f64, v: f64| {
            energy(
                &coefficients,
                load,
                State {
                    position: x,
                    rate: v,
                },
            )
        };
        for (x, v) in [(1.1, 0.05), (0.7, -0.02), (1.6, 0.1)] {
            let step = 1e-5;
            let by_stretch = (at(x + step, v) - at(x - step, v)) / (2.0 * step);
            let by_rate = (at(x, v + step) - at(x, v - step)) / (2.0 * step);
            let drift = by_stretch * v + by_rate * acceleration(&coefficients, load, x, v);
            assert!(drift.abs() < 1e-9, "drift {drift} at ({x}, {v})");
        }
        assert_eq!(at(1.0, 0.0), 0.0);
    }
}
