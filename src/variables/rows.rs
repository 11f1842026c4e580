//! What the rows of the table are made with.

use super::{Access, Causality, Dependencies, Derivatives, Kind, Unit, Variability, Variable};
use crate::actuator::drive::Polynomial;
use crate::scene::Scene;
use crate::view::View;

/// One of the [`Quantities`](crate::view::Quantities) as it is read and with its
/// derivatives.
macro_rules! formula {
    ($quantity:ident) => {
        (
            |view| view.$quantity(),
            Some($crate::variables::Derivatives {
                along: |moment| moment.$quantity(),
                from_now_on: |moment| moment.$quantity(),
            }),
        )
    };
}

pub(super) use formula;

pub(super) const fn real(min: f64, max: f64, nominal: f64) -> Kind {
    Kind::Real { min, max, nominal }
}

/// A result that is not negative and has no largest value.
pub(super) const fn positive() -> Kind {
    real(0.0, f64::MAX, 1.0)
}

/// A result without limits.
pub(super) const fn unlimited(nominal: f64) -> Kind {
    real(f64::MIN, f64::MAX, nominal)
}

pub(super) const fn input(
    name: &'static str,
    description: &'static str,
    kind: Kind,
    get: fn(&View) -> f64,
    of: fn(&mut Scene) -> &mut Polynomial,
) -> Variable {
    Variable {
        name,
        description,
        causality: Causality::Input,
        variability: Variability::Continuous,
        kind,
        unit: Unit::One,
        start: Some(0.0),
        derivative_of: None,
        access: Access::Input { get, of },
    }
}

pub(super) const fn parameter(
    name: &'static str,
    description: &'static str,
    variability: Variability,
    kind: Kind,
    start: f64,
    get: fn(&Scene) -> f64,
    set: fn(&mut Scene, f64),
) -> Variable {
    Variable {
        name,
        description,
        causality: Causality::Parameter,
        variability,
        kind,
        unit: Unit::One,
        start: Some(start),
        derivative_of: None,
        access: Access::Setting { get, set },
    }
}

/// A result as it is read, and its derivatives.
pub(super) type Formula = (fn(&View) -> f64, Option<Derivatives>);

/// A result that is only read.
pub(super) const fn value(get: fn(&View) -> f64) -> Formula {
    (get, None)
}

pub(super) const fn depends(
    now: &'static [&'static str],
    at_start: &'static [&'static str],
) -> Dependencies {
    Dependencies { now, at_start }
}

/// Of results that the model structure does not list.
pub(super) const UNDECLARED: Dependencies = depends(&[], &[]);

pub(super) const fn result(
    name: &'static str,
    description: &'static str,
    causality: Causality,
    kind: Kind,
    (get, derivatives): Formula,
    dependencies: Dependencies,
) -> Variable {
    let variability = match kind {
        Kind::Boolean | Kind::Enumeration => Variability::Discrete,
        Kind::Real { .. } => Variability::Continuous,
    };
    Variable {
        name,
        description,
        causality,
        variability,
        kind,
        unit: Unit::One,
        start: None,
        derivative_of: None,
        access: Access::Result {
            get,
            derivatives,
            dependencies,
        },
    }
}

impl Variable {
    pub(super) const fn in_unit(mut self, unit: Unit) -> Variable {
        self.unit = unit;
        self
    }

    pub(super) const fn derivative_of(mut self, state: &'static str) -> Variable {
        self.derivative_of = Some(state);
        self
    }
}
