//! Many actuators under alternating voltages, their numbers in SIMD lanes.

use super::coefficients::Coefficients;
use super::drive::Drive;
use super::motion::{self, Load, Motion};
use crate::solver::batch::{self, LANES, Row};
use crate::solver::double::Double;
use crate::solver::lanes::Lanes;
use crate::solver::number::Number;
use fearless_simd::Simd;

/// The equations of motion of as many actuators as there are lanes. Voltage and
/// prestress are constant but for the built-in alternating voltage.
#[derive(Clone, Copy, Debug)]
pub struct Fleet {
    coefficients: Coefficients<Row>,
    voltage: Row,
    prestress: Row,
    amplitude: Row,
    frequency: Row,
    /// ωt + ϑ, less whole turns.
    angle: Row,
}

impl Fleet {
    /// Actuators without a drive.
    #[must_use]
    pub fn new() -> Fleet {
        Fleet {
            coefficients: Coefficients {
                inertia: [1.0; LANES],
                linear: [1.0; LANES],
                cubic: [0.0; LANES],
                quintic: [0.0; LANES],
            },
            voltage: [0.0; LANES],
            prestress: [0.0; LANES],
            amplitude: [0.0; LANES],
            frequency: [0.0; LANES],
            angle: [0.0; LANES],
        }
    }

    /// Whether a lane can hold a motion under this drive.
    #[must_use]
    pub fn takes(drive: &Drive) -> bool {
        drive.voltage.is_constant() && drive.prestress.is_constant()
    }
}

impl Default for Fleet {
    fn default() -> Fleet {
        Fleet::new()
    }
}

impl batch::Fleet for Fleet {
    type Equation = Motion;
    type Abreast<N: Number> = Abreast<N>;

    fn put(&mut self, lane: usize, motion: &Motion, time: Double) {
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
        self.frequency[lane] = harmonic.frequency;
        self.angle[lane] = motion.drive.angle(time);
    }

    #[inline(always)]
    fn abreast<S: Simd, V: Lanes<S, LANES>>(&self, simd: S) -> Abreast<V> {
        let load = |row: &Row| V::load(simd, row);
        Abreast {
            coefficients: Coefficients {
                inertia: load(&self.coefficients.inertia),
                linear: load(&self.coefficients.linear),
                cubic: load(&self.coefficients.cubic),
                quintic: load(&self.coefficients.quintic),
            },
            voltage: load(&self.voltage),
            prestress: load(&self.prestress),
            amplitude: load(&self.amplitude),
            frequency: load(&self.frequency),
            angle: load(&self.angle),
        }
    }

    #[inline(always)]
    fn advance<S: Simd, V: Lanes<S, LANES>>(&mut self, simd: S, by: &Row) {
        let load = |row: &Row| V::load(simd, row);
        let angle = load(&self.frequency).mul_add(load(by), load(&self.angle));
        self.angle = angle.within_a_turn().store();
    }
}

/// A [`Fleet`] with its numbers in lanes.
#[derive(Clone, Copy, Debug)]
pub struct Abreast<N> {
    coefficients: Coefficients<N>,
    voltage: N,
    prestress: N,
    amplitude: N,
    frequency: N,
    angle: N,
}

impl<N: Number> batch::Abreast<N> for Abreast<N> {
    type Load = Load<N>;

    #[inline(always)]
    fn load(&self, offset: N) -> Load<N> {
        let angle = offset.mul_add(self.frequency, self.angle);
        let voltage = angle.sin().mul_add(self.amplitude, self.voltage);
        Load {
            voltage_squared: voltage * voltage,
            prestress: self.prestress,
        }
    }

    #[inline(always)]
    fn acceleration(&self, load: Load<N>, position: N, rate: N) -> N {
        motion::acceleration(&self.coefficients, load, position, rate)
    }
}
