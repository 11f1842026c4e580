//! A motion that is followed without an instance, with a clock of its own.

use std::ops::{Deref, DerefMut};

use dielectric_elastomer_actuator::arithmetic::double_double::DoubleDouble;
use dielectric_elastomer_actuator::solver::Equation;
use dielectric_elastomer_actuator::solver::coupled::trajectory::Carried;
use dielectric_elastomer_actuator::solver::coupled::{self, CoupledEquation};
use dielectric_elastomer_actuator::solver::integrator::{Integrator, Method};
use dielectric_elastomer_actuator::solver::trajectory::{Failure, Progress, Steps};

/// A motion and the time to which it has come.
#[derive(Clone)]
pub struct Clocked<M: Method> {
    motion: Integrator<M>,
    pub clock: DoubleDouble,
}

/// From time 0 on.
impl<M: Method> From<Integrator<M>> for Clocked<M> {
    fn from(motion: Integrator<M>) -> Clocked<M> {
        Clocked::at(DoubleDouble::ZERO, motion)
    }
}

impl<M: Method> Clocked<M> {
    /// A motion that has come to this time.
    pub fn at(clock: DoubleDouble, motion: Integrator<M>) -> Clocked<M> {
        Clocked { motion, clock }
    }

    /// The motion with something about it changed.
    pub fn with(self, change: impl FnOnce(Integrator<M>) -> Integrator<M>) -> Clocked<M> {
        Clocked::at(self.clock, change(self.motion))
    }
}

impl Clocked<Steps> {
    pub fn advance<E: Equation>(&mut self, equation: &E, step: f64) -> Result<Progress, Failure> {
        self.motion.advance(equation, &mut self.clock, step)
    }
}

impl Clocked<Carried> {
    pub fn advance<E: CoupledEquation>(
        &mut self,
        equation: &E,
        step: f64,
    ) -> Result<coupled::Progress, Failure> {
        let mut work = coupled::MOST_WORK;
        self.motion
            .advance(equation, &mut self.clock, step, &mut work)
    }
}

impl<M: Method> Deref for Clocked<M> {
    type Target = Integrator<M>;

    fn deref(&self) -> &Integrator<M> {
        &self.motion
    }
}

impl<M: Method> DerefMut for Clocked<M> {
    fn deref_mut(&mut self) -> &mut Integrator<M> {
        &mut self.motion
    }
}
