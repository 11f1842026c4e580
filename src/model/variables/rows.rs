//! What the rows of the table are made with.

use super::{
    Access, Causality, Dependencies, Derivatives, Enumeration, Kind, Meant, Member, Terminal, Unit,
    Variability, Variable, units,
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
            Some($crate::model::variables::Derivatives {
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
pub const fn positive(nominal: f64) -> Kind {
    real(0.0, f64::INFINITY, nominal)
}

/// A result without limits.
pub const fn unlimited(nominal: f64) -> Kind {
    real(f64::NEG_INFINITY, f64::INFINITY, nominal)
}

/// A result as it is read, and its derivatives.
pub type Formula<M> = (fn(&View<M>) -> f64, Option<Derivatives<M>>);

/// A result that is only read.
pub const fn value<M: Model>(get: fn(&View<M>) -> f64) -> Formula<M> {
    (get, None)
}

/// The lowest and the highest stretch since their recording began, and those of the thickness
/// stretch.
pub const fn extremes<M: Model>() -> [Variable<M>; 4] {
    const fn row<M: Model>(
        name: &'static str,
        description: &'static str,
        get: fn(&View<M>) -> f64,
    ) -> Variable<M> {
        let kind = real(0.0, 1e6, 1.0);
        Variable::result(
            name,
            description,
            Causality::Local,
            kind,
            value(get),
            UNDECLARED,
        )
    }
    [
        row(
            "lambda_lowest",
            "smallest lambda since the recording began; 0 where extremes are not recorded",
            |view| M::extremes(view).map_or(0.0, |e| e.lowest),
        ),
        row(
            "lambda_highest",
            "largest lambda since the recording began; 0 where extremes are not recorded",
            |view| M::extremes(view).map_or(0.0, |e| e.highest),
        ),
        row(
            "lambda3_lowest",
            "smallest lambda3 since the recording began; 0 where extremes are not recorded",
            |view| M::extremes(view).map_or(0.0, |e| 1.0 / (e.highest * e.highest)),
        ),
        row(
            "lambda3_highest",
            "largest lambda3 since the recording began; 0 where extremes are not recorded",
            |view| M::extremes(view).map_or(0.0, |e| 1.0 / (e.lowest * e.lowest)),
        ),
    ]
}

/// On which variables a result depends, during the motion and at the start.
pub const fn depends(
    now: &'static [&'static str],
    at_start: &'static [&'static str],
) -> Dependencies {
    Dependencies { now, at_start }
}

/// The dependencies of results that the model structure does not list.
pub const UNDECLARED: Dependencies = depends(&[], &[]);

/// What happens at a limit of the stretch.
pub static ON_PULL_IN: Enumeration = Enumeration {
    name: "OnPullIn",
    items: &[
        ("hold", "the actuator stays at the limit and steps go on"),
        (
            "terminate",
            "the step ends there and the host is asked to terminate",
        ),
    ],
};

impl<M: Model> Variable<M> {
    /// A row for an input of the host.
    pub const fn input(
        name: &'static str,
        description: &'static str,
        kind: Kind,
        get: fn(&View<M>) -> f64,
        of: fn(&mut M::Scene) -> &mut Polynomial,
    ) -> Variable<M> {
        let role = (Causality::Input, Variability::Continuous);
        Variable::new(name, description, role, kind, Access::Input { get, of }).starting_at(0.0)
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
        let role = (Causality::Parameter, variability);
        let access = Access::Setting {
            get,
            set,
            from_now_on: None,
        };
        Variable::new(name, description, role, kind, access).starting_at(start)
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
        let access = Access::Result {
            get,
            derivatives,
            dependencies,
        };
        Variable::new(name, description, (causality, variability), kind, access)
    }

    /// A row of a pure number without a start value.
    const fn new(
        name: &'static str,
        description: &'static str,
        (causality, variability): (Causality, Variability),
        kind: Kind,
        access: Access<M>,
    ) -> Variable<M> {
        Variable {
            name,
            description,
            causality,
            variability,
            kind,
            unit: &units::ONE,
            meant: Meant::Any,
            member: None,
            conversion: None,
            start: None,
            derivative_of: None,
            may_be_infinite: false,
            access,
        }
    }

    /// The row as that of a result that changes at events only.
    pub const fn at_events(mut self) -> Variable<M> {
        self.variability = Variability::Discrete;
        self
    }

    /// The row with a hint for a user who has typed a value in another unit.
    pub const fn converted(mut self, conversion: &'static str) -> Variable<M> {
        self.conversion = Some(conversion);
        self
    }

    /// The row of a number that can only have these values between its limits.
    pub const fn meant(mut self, meant: Meant) -> Variable<M> {
        self.meant = meant;
        self
    }

    /// The row as a member of a terminal, by this name.
    pub const fn member(mut self, terminal: &'static Terminal, name: &'static str) -> Variable<M> {
        self.member = Some(Member {
            terminal,
            name,
            flows: false,
        });
        self
    }

    /// The row as a member of a terminal that flows into the unit.
    pub const fn flow(mut self, terminal: &'static Terminal, name: &'static str) -> Variable<M> {
        self.member = Some(Member {
            terminal,
            name,
            flows: true,
        });
        self
    }

    /// The row of a setting whose change during the motion leaves the present as it is.
    pub const fn from_now_on(mut self, change: fn(&mut M::Scene, f64)) -> Variable<M> {
        if let Access::Setting { from_now_on, .. } = &mut self.access {
            *from_now_on = Some(change);
        }
        self
    }

    /// The row with this value until the host sets another.
    pub const fn starting_at(mut self, start: f64) -> Variable<M> {
        self.start = Some(start);
        self
    }

    /// The row in another unit than 1.
    pub const fn in_unit(mut self, unit: &'static Unit) -> Variable<M> {
        self.unit = unit;
        self
    }

    /// The row of a result that is +inf where there is none.
    pub const fn or_infinite(mut self) -> Variable<M> {
        self.may_be_infinite = true;
        self
    }

    /// The row as that of the derivative of a state.
    pub const fn derivative_of(mut self, state: &'static str) -> Variable<M> {
        self.derivative_of = Some(state);
        self
    }
}
