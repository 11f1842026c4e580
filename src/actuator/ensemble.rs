//! Many actuators under alternating voltages, their numbers in SIMD lanes.

use fearless_simd::Simd;

use super::coefficients::Coefficients;
use super::drive::Drive;
use super::motion::{self, Load, Motion};
use crate::arithmetic::double_double::DoubleDouble;
use crate::arithmetic::lanes::Lanes;
use crate::arithmetic::number::Number;
use crate::ensemble::{self, LANES, PerLane};

/// The equations of motion of as many actuators as there are lanes. Voltage and
/// prestress are constant but for the built-in alternating voltage.
#[derive(Clone, Copy, Debug)]
pub struct Ensemble {
    coefficients: Coefficients<PerLane>,
    voltage: PerLane,
    prestress: PerLane,
    amplitude: PerLane,
    /// The alternating part of the voltage, and by how much it grew in the last step.
    alternating: [PerLane; 2],
    /// Sine of ωh of a step h, and 2 − 2 cos ωh.
    turn: [PerLane; 2],
}

impl Ensemble {
    /// Actuators without a drive.
    #[must_use]
    pub fn new() -> Ensemble {
        Ensemble {
            coefficients: Coefficients {
                inertia: [1.0; LANES],
                linear: [1.0; LANES],
                cubic: [0.0; LANES],
                quintic: [0.0; LANES],
            },
            voltage: [0.0; LANES],
            prestress: [0.0; LANES],
            amplitude: [0.0; LANES],
            alternating: [[0.0; LANES]; 2],
            turn: [[0.0; LANES]; 2],
        }
    }
}

impl Default for Ensemble {
    fn default() -> Ensemble {
        Ensemble::new()
    }
}

impl ensemble::Ensemble for Ensemble {
    type Equation = Motion;
    type Packed<N: Number> = Packed<N>;

    fn takes(motion: &Motion) -> bool {
        motion.drive.voltage.is_constant() && motion.drive.prestress.is_constant()
    }

    fn put(&mut self, lane: usize, motion: &Motion, time: &DoubleDouble, step: f64) {
        let Coefficients {
            inertia,
            linear,
            cubic,
            quintic,
        } = motion.coefficients;
        self.coefficients.inertia[lane] = inertia;
        self.coefficients.linear[lane] = linear;
        self.coefficients.cubic[lane] = cubic;
        self.coefficients.quintic[lane] = quintic;
        let Drive {
            voltage,
            prestress,
            harmonic,
            ..
        } = &motion.drive;
        self.voltage[lane] = voltage.value();
        self.prestress[lane] = prestress.value();
        self.amplitude[lane] = harmonic.amplitude;
        let (sine, cosine) = (0.5 * harmonic.frequency * step).sin_cos();
        (self.turn[0][lane], self.turn[1][lane]) = (2.0 * sine * cosine, 4.0 * sine * sine);
        self.see_from(lane, motion, time);
    }

    fn see_from(&mut self, lane: usize, motion: &Motion, time: &DoubleDouble) {
        let (sine, cosine) = motion.drive.angle(*time).sin_cos();
        let [by_cosine, by_sine] = self.turn.map(|row| row[lane]);
        let growth = 0.5 * by_sine * sine + by_cosine * cosine;
        self.alternating[0][lane] = self.amplitude[lane] * sine;
        self.alternating[1][lane] = self.amplitude[lane] * growth;
    }

    #[inline(always)]
    fn pack<S: Simd, V: Lanes<S, LANES>>(&self, simd: S) -> Packed<V> {
        let load = |numbers: &PerLane| V::load(simd, numbers);
        Packed {
            coefficients: Coefficients {
                inertia: load(&self.coefficients.inertia),
                linear: load(&self.coefficients.linear),
                cubic: load(&self.coefficients.cubic),
                quintic: load(&self.coefficients.quintic),
            },
            voltage: load(&self.voltage),
            prestress: load(&self.prestress),
            amplitude: load(&self.amplitude),
            alternating: [load(&self.alternating[0]), load(&self.alternating[1])],
            turn: load(&self.turn[1]),
        }
    }

    #[inline(always)]
    fn keep<S: Simd, V: Lanes<S, LANES>>(&mut self, packed: &Packed<V>) {
        self.alternating = packed.alternating.map(Lanes::store);
    }
}

/// An [`Ensemble`] with its numbers in lanes.
#[derive(Clone, Copy, Debug)]
pub struct Packed<N> {
    coefficients: Coefficients<N>,
    voltage: N,
    prestress: N,
    amplitude: N,
    alternating: [N; 2],
    turn: N,
}

impl<N: Number> ensemble::Packed<N> for Packed<N> {
    /// By the second difference of the sine, which in the form of C. Reinsch (J. Stoer, R. Bulirsch,
    /// "Introduction to Numerical Analysis", section 2.3.2) keeps the digits where ωh is small.
    #[inline(always)]
    fn turn(&mut self) {
        let [voltage, growth] = self.alternating;
        let growth = growth - self.turn * voltage;
        self.alternating = [voltage + growth, growth];
    }

    #[inline(always)]
    fn acceleration(&self, position: N, way: N, step: N, inverse: N) -> N {
        let voltage = self.voltage + self.alternating[0];
        let load = Load {
            voltage_squared: voltage * voltage,
            prestress: self.prestress,
        };
        motion::acceleration_in_steps(&self.coefficients, load, [position, way], [step, inverse])
    }

    #[inline(always)]
    fn stiffness(&self, position: N) -> N {
        let largest = self.voltage.magnitude() + self.amplitude.magnitude();
        let [stiffness, mass] = motion::stiffness_and_mass(&self.coefficients, largest, position);
        stiffness / mass
    }
}
