//! A host of the actuator in SI units.

use dielectric_elastomer_actuator::instance::{Fault, Interface, Type};
use dielectric_elastomer_actuator::model::Model;
use dielectric_elastomer_actuator::model::variables::{Kind, Variable};
use dielectric_elastomer_actuator::si::{Instance, Si, value_reference};

pub fn row(name: &str) -> (u32, &'static Variable<Si>) {
    let reference = value_reference(name).unwrap_or_else(|| panic!("no variable {name}"));
    (reference, &Si::VARIABLES[reference as usize])
}

fn type_of(variable: &Variable<Si>) -> Type {
    match variable.kind {
        Kind::Real { .. } => Type::Real,
        Kind::Boolean => Type::Boolean,
        Kind::Enumeration(_) => Type::Integer,
    }
}

pub struct Host {
    pub instance: Instance,
    pub time: f64,
}

impl Host {
    /// An instance in initialization mode with these values.
    pub fn initializing(interface: Interface, values: &[(&str, f64)]) -> Host {
        Host::with(interface, None, values)
    }

    /// A co-simulation with these values, begun.
    pub fn begun(values: &[(&str, f64)]) -> Host {
        Host::with(Interface::CoSimulation, None, values).started()
    }

    /// A co-simulation with this tolerance and these values, begun.
    pub fn begun_with(tolerance: f64, values: &[(&str, f64)]) -> Host {
        Host::with(Interface::CoSimulation, Some(tolerance), values).started()
    }

    fn with(interface: Interface, tolerance: Option<f64>, values: &[(&str, f64)]) -> Host {
        let mut instance = Instance::of(interface);
        instance
            .setup_experiment(tolerance, 0.0, None)
            .expect("an experiment");
        instance.enter_initialization();
        let mut host = Host {
            instance,
            time: 0.0,
        };
        for (name, value) in values {
            host.set(name, *value)
                .unwrap_or_else(|fault| panic!("{fault:?}"));
        }
        host
    }

    fn started(mut self) -> Host {
        self.instance.exit_initialization().expect("a start");
        self
    }

    pub fn set(&mut self, name: &str, value: f64) -> Result<(), Fault> {
        let (reference, variable) = row(name);
        self.instance
            .set(type_of(variable), &[reference], |_| value)
    }

    pub fn get(&self, name: &str) -> f64 {
        let (reference, variable) = row(name);
        let mut value = f64::NAN;
        self.instance
            .get(type_of(variable), &[reference], |_, number| value = number)
            .unwrap_or_else(|fault| panic!("{name}: {fault:?}"));
        value
    }

    pub fn step(&mut self, step: f64) {
        self.instance.do_step(self.time, step).expect("a step");
        self.time += step;
    }

    /// Follows to a time in steps.
    pub fn follow(&mut self, time: f64, step: f64) {
        while time - self.time > 1e-9 * step {
            self.step(step.min(time - self.time));
        }
    }
}
