//! The paper's equation with damping.
//!
//! A damped actuator has no state but stretch and rate. The integrator of the paper's equation follows it,
//! which takes a third of the time of a coupled system or less.

use crate::actuator::Motion;
use crate::actuator::device::Damping;
use crate::actuator::motion::{Load, LocalMotion};
use crate::arithmetic::double_double::DoubleDouble;
use crate::arithmetic::number::Number;
use crate::solver::{Equation, LocalEquation, Sensitivity, State};

/// The motion of the paper with damping.
#[derive(Clone, Copy, Debug)]
pub struct DampedMotion {
    /// The motion without it.
    pub motion: Motion,
    /// The damping.
    pub damping: Damping,
}

impl Equation for DampedMotion {
    type Local<'a> = LocalDampedMotion<'a>;

    #[inline(always)]
    fn at(&self, time: &DoubleDouble) -> LocalDampedMotion<'_> {
        LocalDampedMotion {
            local: self.motion.at(time),
            damping: self.damping,
        }
    }

    fn is_autonomous(&self) -> bool {
        self.motion.is_autonomous()
    }
}

/// A [`DampedMotion`] with its origin of time moved.
#[derive(Clone, Copy, Debug)]
pub struct LocalDampedMotion<'a> {
    local: LocalMotion<'a>,
    damping: Damping,
}

impl LocalDampedMotion<'_> {
    /// λ⁷ times the damping force, (b̄ + 6η̄λ⁻²)λ'.
    #[inline(always)]
    fn resistance<N: Number>(&self, stretch: N, rate: N) -> N {
        let square = stretch * stretch;
        let factor = self.damping.scaled([square, stretch.same(1.0)]);
        (square * square) * (stretch * rate) * factor
    }
}

impl LocalEquation for LocalDampedMotion<'_> {
    type Load<N: Number> = Load<N>;

    #[inline(always)]
    fn load<N: Number>(&self, offset: N) -> Load<N> {
        self.local.load(offset)
    }

    #[inline(always)]
    fn harmonic(&self) -> Option<[f64; 2]> {
        self.local.harmonic()
    }

    #[inline(always)]
    fn load_with_sine<N: Number>(&self, offset: N, sine: N) -> Load<N> {
        self.local.load_with_sine(offset, sine)
    }

    #[inline(always)]
    fn acceleration<N: Number>(&self, load: Load<N>, position: N, rate: N) -> N {
        let [numerator, inverse] = self.local.numerator_and_inverse(load, position, rate);
        (numerator - self.resistance(position, rate)) * inverse
    }

    #[inline(always)]
    fn load_frequency(&self) -> f64 {
        self.local.load_frequency()
    }

    #[inline(always)]
    fn eighth_degree(&self, half: f64, factor: f64) -> Option<[f64; 2]> {
        self.local.eighth_degree(half, factor)
    }

    #[inline(always)]
    fn parts<N: Number>(load: Load<N>) -> [N; 2] {
        LocalMotion::parts(load)
    }

    /// That of the motion without damping, and (b̄ + 6η̄λ⁻²)/M. How the damping changes with the stretch is left
    /// out: it is as small as the rate.
    #[inline(always)]
    fn sensitivity(&self, state: State) -> Sensitivity {
        let undamped = self.local.sensitivity(state);
        let [_, by_force] = undamped.load;
        let damping = self.damping.coefficient(state.position) * by_force;
        Sensitivity {
            rate: undamped.rate + damping,
            ..undamped
        }
    }

    #[inline(always)]
    fn natural_frequency(&self, state: State) -> f64 {
        self.local.natural_frequency(state)
    }
}
