//! What the rows of the table are made with.

use super::{
    Access, Causality, Dependencies, Derivatives, Kind, Unit, Variability, Variable, units,
};
use crate::actuator::drive::Polynomial;
use crate::model::{Model, View};

/// A quantity as it is read and with its derivatives: a method of the model's view
/// and of its samples.
#[macro_export]
macro_rules! formula {
    ($quantity:ident) => {
        (
            |view| view.$quantity(),
            Some($crate::variables::Derivatives {
                along: |sample| sample.$quantity(),
                from_now_on: |sample| sample.$quantity(),
            }),
        )
    };
}

pub use formula;

/// A real number between limits, with its typical size.
pub const fn real(min: f64, max: f64, nominal: f64) -> Kind {
    Kind::Real { min, max, nominal }
}

/// A result that is not negative and has no largest value.
pub const fn positive() -> Kind {
    real(0.0, f64::MAX, 1.0)
}

/// A result without limits.
pub const fn unlimited(nominal: f64) -> Kind {
    real(f64::MIN, f64::MAX, nominal)
}

/// A result as it is read, and its derivatives.
pub type Formula<M> = (fn(&View<M>) -> f64, Option<Derivatives<M>>);

/// A result that is only read.
pub const fn value<M: Model>(get: fn(&View<M>) -> f64) -> Formula<M> {
    (get, None)
}

/// On which variables a result depends, during the motion and at the start.
pub const fn depends(
    now: &'static [&'static str],
    at_start: &'static [&'static str],
) -> Dependencies {
    Dependencies { now, at_start }
}

/// Of results that the model structure does not list.
pub const UNDECLARED: Dependencies = depends(&[], &[]);

impl<M: Model> Variable<M> {
    /// A row for an input of the host.
    pub const fn input(
        name: &'static str,
        description: &'static str,
        kind: Kind,
        get: fn(&View<M>) -> f64,
        of: fn(&mut M::Scene) -> &mut Polynomial,
    ) -> Variable<M> {
        Variable {
            name,
            description,
            causality: Causality::Input,
            variability: Variability::Continuous,
            kind,
            unit: &units::ONE,
            start: Some(0.0),
            derivative_of: None,
            access: Access::Input { get, of },
        }
    }

    /// A row for a parameter.
    pub const fn parameter(
        name: &'static str,
        description: &'static str,
        variability: Variability,
        kind: Kind,
        start: f64,
        get: fn(&M::Scene) -> f64,
        set: fn(&mut M::Scene, f64),
    ) -> Variable<M> {
        Variable {
            name,
            description,
            causality: Causality::Parameter,
            variability,
            kind,
            unit: &units::ONE,
            start: Some(start),
            derivative_of: None,
            access: Access::Setting { get, set },
        }
    }

    /// A row for a result.
    pub const fn result(
        name: &'static str,
        description: &'static str,
        causality: Causality,
        kind: Kind,
        (get, derivatives): Formula<M>,
        dependencies: Dependencies,
    ) -> Variable<M> {
        let variability = match kind {
            Kind::Boolean | Kind::Enumeration(_) => Variability::Discrete,
            Kind::Real { .. } => Variability::Continuous,
        };
        Variable {
            name,
            description,
            causality,
            variability,
            kind,
            unit: &units::ONE,
            start: None,
            derivative_of: None,
            access: Access::Result {
                get,
                derivatives,
                dependencies,
            },
        }
    }

    /// The row in another unit than 1.
    pub const fn in_unit(mut self, unit: &'static Unit) -> Variable<M> {
        self.unit = unit;
        self
    }

    /// The row as that of the derivative of a state.
    pub const fn derivative_of(mut self, state: &'static str) -> Variable<M> {
        self.derivative_of = Some(state);
        self
    }
}
