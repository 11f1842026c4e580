//! A case: the actuator, its drive and the exact values to hold a run against.

use std::collections::HashMap;

use crate::fmu::Fmu;

/// Position and rate.
pub type Pair = [f64; 2];

/// The larger error; NaN, which must not pass for a small one, if either is.
pub fn larger(worst: f64, error: f64) -> f64 {
    if error <= worst || worst.is_nan() {
        worst
    } else {
        error
    }
}

/// One motion from rest at λ = 1 with its reference.
#[derive(Clone, Debug)]
pub struct Case {
    pub aspect: f64,
    pub surface: [f64; 3],
    pub prestress: f64,
    /// Constant voltage.
    pub voltage: f64,
    /// Amplitude and angular frequency of an alternating one; 0 without.
    pub amplitude: f64,
    pub frequency: f64,
    /// Times of the reference without the start.
    pub times: Vec<f64>,
    pub exact: Vec<Pair>,
    /// The packed FMU.
    pub fmu: &'static Fmu,
}

impl Case {
    /// From arguments `name=value` and the reference that one of them names.
    pub fn new(arguments: &HashMap<String, String>) -> Case {
        let number = |name: &str| -> f64 {
            arguments[name]
                .parse()
                .unwrap_or_else(|_| panic!("{name} is no number"))
        };
        let text = std::fs::read_to_string(&arguments["reference"]).expect("a reference");
        let rows = text.lines().skip(1).map(|line| {
            let mut cells = line.split(',').map(|cell| cell.parse().expect("a number"));
            let mut next = || cells.next().expect("three columns");
            (next(), [next(), next()])
        });
        let (times, exact) = rows.filter(|(time, _)| *time > 0.0).unzip();
        Case {
            aspect: number("c"),
            surface: [number("gamma_s"), number("tau_s"), number("E_s")],
            prestress: number("S"),
            voltage: number("phi"),
            amplitude: number("phi_ac"),
            frequency: number("omega_ac"),
            times,
            exact,
            fmu: Box::leak(Box::new(Fmu::load(&arguments["fmu"]))),
        }
    }

    /// The last time of the reference.
    pub fn end(&self) -> f64 {
        *self.times.last().expect("a reference has rows")
    }

    /// Largest difference of position or rate from the reference.
    pub fn error(&self, states: &[Pair]) -> f64 {
        if states.len() != self.exact.len() {
            return f64::INFINITY;
        }
        let differences = states
            .iter()
            .zip(&self.exact)
            .flat_map(|(state, exact)| state.iter().zip(exact).map(|(a, b)| (a - b).abs()));
        differences.fold(0.0, larger)
    }

    /// The right-hand side for the rivals.
    pub fn right_hand_side(&self) -> RightHandSide {
        let [gamma, tau, elasticity] = self.surface;
        RightHandSide {
            inertia: self.aspect,
            linear: 1.0 + 2.0 * (gamma - tau) + elasticity,
            cubic: 4.0 * (tau - elasticity),
            quintic: 3.0 * elasticity,
            prestress: self.prestress,
            voltage: [self.voltage, 0.0, 0.0, 0.0],
            amplitude: self.amplitude,
            frequency: self.frequency,
        }
    }
}

/// Eq. 16 with its surface terms folded and multiplied by λ⁷, one division: the
/// cheapest form known, the same for every rival.
#[derive(Clone, Copy, Debug)]
pub struct RightHandSide {
    inertia: f64,
    linear: f64,
    cubic: f64,
    quintic: f64,
    prestress: f64,
    /// Voltage as a polynomial in the time.
    pub voltage: [f64; 4],
    amplitude: f64,
    frequency: f64,
}

impl RightHandSide {
    /// dλ/dt and d²λ/dt².
    #[inline(always)]
    pub fn at(&self, time: f64, stretch: f64, rate: f64) -> Pair {
        let [zeroth, first, second, third] = self.voltage;
        let mut voltage = zeroth + time * (first + time * (second + time * third));
        if self.amplitude != 0.0 {
            voltage += self.amplitude * (self.frequency * time).sin();
        }
        let square = stretch * stretch;
        let sixth = square * square * square;
        let cubic = self.cubic - voltage * voltage;
        let elastic = square * (self.linear + square * (cubic + self.quintic * square));
        let upper = 6.0 * rate * rate + square + sixth * (self.prestress * stretch - elastic);
        [rate, upper / (stretch * (self.inertia * sixth + 2.0))]
    }

    /// The same actuator under a voltage polynomial and nothing else.
    pub fn under(&self, voltage: [f64; 4]) -> RightHandSide {
        RightHandSide {
            voltage,
            amplitude: 0.0,
            ..*self
        }
    }
}
