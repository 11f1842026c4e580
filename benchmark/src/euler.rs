//! A stand-in for the usual example FMU: the van der Pol oscillator by forward
//! Euler with an internal step of 0.01, which makes up a communication step.

use std::hint::black_box;

/// The internal step.
pub const INNER: f64 = 0.01;

/// State and time of the oscillator.
pub struct VanDerPol {
    pub state: [f64; 2],
    pub damping: f64,
    pub time: f64,
    pub steps: u64,
}

impl VanDerPol {
    pub fn new() -> VanDerPol {
        VanDerPol {
            state: [2.0, 0.0],
            damping: 1.0,
            time: 0.0,
            steps: 0,
        }
    }

    /// A communication step to `until`. Behind a call, as in a shared library.
    #[inline(never)]
    pub fn step(&mut self, until: f64) {
        while (self.steps + 1) as f64 * INNER <= until + 1e-9 {
            let [x, v] = self.state;
            let slope = [v, self.damping * (1.0 - x * x) * v - x];
            self.state = [x + INNER * slope[0], v + INNER * slope[1]];
            self.steps += 1;
        }
        self.time = until;
    }

    #[inline(never)]
    pub fn get(&self) -> f64 {
        black_box(self.state[0])
    }
}
