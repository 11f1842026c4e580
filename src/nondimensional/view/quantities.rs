//! What follows from the state and the load by formulas, each written once for
//! plain numbers, for numbers that change in a direction, and for series in time.

use crate::actuator::Coefficients;
use crate::actuator::motion::{self, Load};
use crate::arithmetic::double_double::DoubleDouble;
use crate::arithmetic::jet::{Dual, HIGHEST_ORDER, TimeSeries};
use crate::arithmetic::number::Number;
use crate::model::Direction;
use crate::nondimensional::Nondimensional;
use crate::nondimensional::scene::Scene;
use crate::solver::State;
use crate::solver::limits::Limit;

/// The quantities that follow from the stretch, its derivatives and the voltage.
pub trait Quantities<N: Number> {
    /// Stretch λ.
    fn stretch(&self) -> N;

    /// Stretch rate dλ/dt; 0 where the actuator is held at a limit.
    fn stretch_rate(&self) -> N;

    /// d²λ/dt² by Eq. 16; 0 where the actuator is held at a limit.
    fn stretch_acceleration(&self) -> N;

    /// Voltage φ with the built-in alternating voltage added.
    fn total_voltage(&self) -> N;

    /// Thickness stretch λ3 = 1/λ².
    fn thickness_stretch(&self) -> N {
        let stretch = self.stretch();
        stretch.same(1.0) / (stretch * stretch)
    }

    /// dλ3/dt = −2 λ⁻³ dλ/dt.
    fn thickness_stretch_rate(&self) -> N {
        let stretch = self.stretch();
        stretch.same(-2.0) * self.stretch_rate() / (stretch * stretch * stretch)
    }

    /// The true electric field φλ², nondimensional like the voltage.
    fn electric_field(&self) -> N {
        let stretch = self.stretch();
        self.total_voltage() * stretch * stretch
    }
}

/// The actuator at one time, as numbers that carry their derivatives along.
#[derive(Clone, Copy, Debug)]
pub struct Sample<N> {
    stretch: N,
    rate: N,
    acceleration: N,
    voltage: N,
}

impl<N: Number> Quantities<N> for Sample<N> {
    fn stretch(&self) -> N {
        self.stretch
    }

    fn stretch_rate(&self) -> N {
        self.rate
    }

    fn stretch_acceleration(&self) -> N {
        self.acceleration
    }

    fn total_voltage(&self) -> N {
        self.voltage
    }
}

impl Sample<Dual> {
    /// A scene in this state, `held` at a limit or not, as it changes in a direction.
    pub(crate) fn along(
        scene: &Scene,
        time: DoubleDouble,
        state: State,
        held: Option<Limit>,
        direction: &Direction<Nondimensional>,
    ) -> Sample<Dual> {
        let mut change = direction.scene.drive;
        if direction.from_now_on {
            change.harmonic.frequency = 0.0;
        }
        let (voltage, prestress) = scene.drive.along(&change, time);
        if let Some(limit) = held {
            let change = direction.scene.limits;
            let change = match limit {
                Limit::Lower => change.lower,
                Limit::Upper => change.upper,
            };
            return Sample::held(Dual::new(state.position, change), voltage);
        }
        let stretch = Dual::new(state.position, direction.state.position);
        let rate = Dual::new(state.rate, direction.state.rate);
        let parameters = scene.parameters.along(&direction.scene.parameters);
        let load = Load {
            voltage_squared: voltage * voltage,
            prestress,
        };
        Sample {
            stretch,
            rate,
            acceleration: motion::acceleration(
                &Coefficients::fold(&parameters),
                load,
                stretch,
                rate,
            ),
            voltage,
        }
    }
}

impl Sample<TimeSeries> {
    /// The motion of a scene from this state on, `held` at a limit or not, as
    /// power series in the time, right up to the derivatives of `order`.
    pub(crate) fn from_now_on(
        scene: &Scene,
        time: DoubleDouble,
        state: State,
        held: Option<Limit>,
        order: usize,
    ) -> Sample<TimeSeries> {
        let drive = scene.drive.at(&time);
        let offset = TimeSeries::variable();
        let voltage = drive.voltage(offset);
        let mut stretch = TimeSeries::constant(state.position);
        if held.is_some() {
            return Sample::held(stretch, voltage);
        }
        let load = Load {
            voltage_squared: voltage * voltage,
            prestress: drive.prestress(offset),
        };
        let coefficients = Coefficients::fold(&scene.parameters).same(offset);
        let mut rate = TimeSeries::constant(state.rate);
        stretch.term[1] = state.rate;
        // The equation of motion gives one more term of the stretch at a time.
        let mut acceleration = TimeSeries::constant(0.0);
        for k in 0..=order.min(HIGHEST_ORDER) {
            acceleration = motion::acceleration(&coefficients, load, stretch, rate);
            rate.term[k + 1] = acceleration.term[k] / (k + 1) as f64;
            stretch.term[k + 2] = rate.term[k + 1] / (k + 2) as f64;
        }
        Sample {
            stretch,
            rate,
            acceleration,
            voltage,
        }
    }
}

impl<N: Number> Sample<N> {
    fn held(stretch: N, voltage: N) -> Sample<N> {
        let nothing = stretch.same(0.0);
        Sample {
            stretch,
            rate: nothing,
            acceleration: nothing,
            voltage,
        }
    }
}
