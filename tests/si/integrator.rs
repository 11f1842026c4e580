//! Model exchange: a host that integrates by the classical Runge–Kutta method.

use super::host::Host;
use dielectric_elastomer_actuator::instance::Interface;
use dielectric_elastomer_actuator::model::Model;
use dielectric_elastomer_actuator::si::Si;

/// The number of states.
pub const STATES: usize = Si::STATES.len();

/// A host that integrates.
pub struct Integrator {
    pub host: Host,
    state: [f64; STATES],
}

impl Integrator {
    pub fn begun(values: &[(&str, f64)]) -> Integrator {
        let mut host = Host::initializing(Interface::ModelExchange, values);
        host.instance.exit_initialization().expect("a start");
        let mut begun = Integrator {
            host,
            state: [0.0; STATES],
        };
        begun.handle_events();
        begun
    }

    /// Returns whether the simulation is to end.
    pub fn handle_events(&mut self) -> bool {
        let instance = &mut self.host.instance;
        let update = instance.new_discrete_states().expect("an update");
        instance.enter_continuous_time();
        instance
            .continuous_states(&mut self.state)
            .expect("the states");
        update.terminate
    }

    fn slopes(&mut self, offset: f64, state: &[f64; STATES]) -> [f64; STATES] {
        let time = self.host.time + offset;
        let instance = &mut self.host.instance;
        instance.set_time(time).expect("a time");
        instance.set_continuous_states(state).expect("states");
        let mut slopes = [0.0; STATES];
        instance.derivatives(&mut slopes).expect("derivatives");
        slopes
    }

    /// Returns whether an event is to be handled.
    pub fn step(&mut self, step: f64) -> bool {
        let start = self.state;
        let moved = |slopes: &[f64; STATES], part: f64| -> [f64; STATES] {
            std::array::from_fn(|k| start[k] + part * step * slopes[k])
        };
        let first = self.slopes(0.0, &start);
        let second = self.slopes(0.5 * step, &moved(&first, 0.5));
        let third = self.slopes(0.5 * step, &moved(&second, 0.5));
        let fourth = self.slopes(step, &moved(&third, 1.0));
        for k in 0..STATES {
            let mean = (first[k] + 2.0 * (second[k] + third[k]) + fourth[k]) / 6.0;
            self.state[k] += step * mean;
        }
        self.host.time += step;
        let instance = &mut self.host.instance;
        instance.set_time(self.host.time).expect("a time");
        instance.set_continuous_states(&self.state).expect("states");
        instance.completed_integrator_step().expect("a step")
    }

    pub fn indicators(&self) -> [f64; 3] {
        let mut indicators = [0.0; 3];
        self.host
            .instance
            .event_indicators(&mut indicators)
            .expect("indicators");
        indicators
    }
}
