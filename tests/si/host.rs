//! A host of the actuator in SI units.

use dielectric_elastomer_actuator::instance::{Fault, Interface, Type};
use dielectric_elastomer_actuator::model::Model;
use dielectric_elastomer_actuator::model::variables::{Kind, Variable};
use dielectric_elastomer_actuator::si::{Instance, Si, value_reference};

/// Everything beyond the paper, off the places where it is 0.
pub const RICH: [(&str, f64); 27] = [
    ("lambda_max", 4.0),
    ("lambda_start", 1.1),
    ("lambda_dot_start", 1e4),
    ("charge_start", 3e-12),
    ("k1", -0.1),
    ("k2", 0.05),
    ("k3", 0.01),
    ("m_load", 1e-12),
    ("k_load", 1.0),
    ("l_load", 1.2e-4),
    ("eta", 0.02),
    ("b", 1e-8),
    ("mu_1", 1e5),
    ("mu_2", 1e5),
    ("mu_3", 1e5),
    ("tau_1", 1e-6),
    ("tau_2", 2e-6),
    ("tau_3", 3e-6),
    ("J_1", 40.0),
    ("J_2", 50.0),
    ("xi1_start", 1.02),
    ("xi2_start", 1.03),
    ("xi3_start", 1.04),
    ("G_p", 1e-9),
    ("sigma", 1e-7),
    ("E_conduction", 4e7),
    ("force", 1e-5),
];

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
