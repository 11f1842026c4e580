//! The table of variables: one row each, the only place that says what a
//! variable is called, what it means, between which limits it lies, where it
//! starts, and how it is read and set. The model description, the checks of the
//! setters and the generators of the tests all follow from it.
//!
//! The position of a row in [`VARIABLES`] is the variable's value reference.

use crate::actuator::drive::Polynomial;
use crate::scene::Scene;
use crate::solver::jet::Dual;
use crate::view::{Moment, Series, View};

mod rows;
mod table;

pub use table::VARIABLES;

/// Role of a variable (FMI 2.0, section 2.2.7).
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Causality {
    /// The host sets it at communication points.
    Input,
    /// The host sets it once, or between steps where it is tunable.
    Parameter,
    /// For other units to use.
    Output,
    /// For people to look at.
    Local,
}

/// When a variable may change (FMI 2.0, section 2.2.7).
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Variability {
    /// Fixed after initialization.
    Fixed,
    /// A parameter that may be changed between communication steps.
    Tunable,
    /// Changes at events only.
    Discrete,
    /// Changes at any time.
    Continuous,
}

/// The type of a variable and, for a real one, its limits.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Kind {
    /// A nondimensional real number.
    Real {
        /// Smallest value allowed or possible.
        min: f64,
        /// Largest value allowed or possible.
        max: f64,
        /// Typical size.
        nominal: f64,
    },
    /// True or false; 1 or 0 in this table.
    Boolean,
    /// One of the items of [`ON_PULL_IN`]; its number in this table.
    Enumeration,
}

/// The unit of a variable. Time and length have none here, so that there are two.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Unit {
    /// 1, a pure number.
    One,
    /// Radian, to be shown in degrees.
    Angle,
    /// Radians per unit of time.
    AngularFrequency,
}

/// How a variable is read and set.
#[derive(Clone, Copy)]
pub enum Access {
    /// A function of time that the host prescribes.
    Input {
        /// The present value.
        get: fn(&View) -> f64,
        /// The function of time.
        of: fn(&mut Scene) -> &mut Polynomial,
    },
    /// A number that the host sets.
    Setting {
        /// The number.
        get: fn(&Scene) -> f64,
        /// Sets it.
        set: fn(&mut Scene, f64),
    },
    /// A result.
    Result {
        /// Computes it.
        get: fn(&View) -> f64,
        /// Its derivatives, where it has any that are offered.
        derivatives: Option<Derivatives>,
        /// On what it depends.
        dependencies: Dependencies,
    },
}

/// The derivatives of a result.
#[derive(Clone, Copy)]
pub struct Derivatives {
    /// The result as it changes in a direction.
    pub along: fn(&Moment<Dual>) -> Dual,
    /// The result as a series in time.
    pub from_now_on: fn(&Moment<Series>) -> Series,
}

/// The names of the variables on which a result depends.
#[derive(Clone, Copy)]
pub struct Dependencies {
    /// Inputs and states that determine it during the motion.
    pub now: &'static [&'static str],
    /// Inputs and parameters that determine it at the start.
    pub at_start: &'static [&'static str],
}

/// One variable.
#[derive(Clone, Copy)]
pub struct Variable {
    /// The name in the model description.
    pub name: &'static str,
    /// Its meaning, for people.
    pub description: &'static str,
    /// Its role.
    pub causality: Causality,
    /// When it may change.
    pub variability: Variability,
    /// Its type and limits.
    pub kind: Kind,
    /// The unit of a real one.
    pub unit: Unit,
    /// The value before the host sets another; none for results.
    pub start: Option<f64>,
    /// The name of the state of which this is the derivative.
    pub derivative_of: Option<&'static str>,
    /// How it is read and set.
    pub access: Access,
}

/// The items of the enumeration type of `on_pull_in`, numbered from 1.
pub const ON_PULL_IN: [(&str, &str); 2] = [
    ("hold", "the actuator stays at the limit and steps go on"),
    (
        "terminate",
        "the step ends there and the host is asked to terminate",
    ),
];

/// Value references of the continuous states, in the order of the table.
pub const STATES: [u32; ORDER] = states();

/// Value references of their derivatives, in the same order.
pub const DERIVATIVES: [u32; ORDER] = derivatives();

/// Number of continuous states.
const ORDER: usize = 2;

const fn states() -> [u32; ORDER] {
    let mut states = [0; ORDER];
    let (mut found, mut row) = (0, 0);
    while row < VARIABLES.len() {
        if row_of_derivative(VARIABLES[row].name).is_some() {
            states[found] = row as u32;
            found += 1;
        }
        row += 1;
    }
    assert!(found == ORDER, "another number of states");
    states
}

const fn derivatives() -> [u32; ORDER] {
    let mut derivatives = [0; ORDER];
    let mut i = 0;
    while i < ORDER {
        if let Some(row) = row_of_derivative(VARIABLES[STATES[i] as usize].name) {
            derivatives[i] = row as u32;
        }
        i += 1;
    }
    derivatives
}

const fn row_of_derivative(name: &str) -> Option<usize> {
    let mut row = 0;
    while row < VARIABLES.len() {
        if let Some(state) = VARIABLES[row].derivative_of
            && same(state, name)
        {
            return Some(row);
        }
        row += 1;
    }
    None
}

/// Value reference of a variable, by its name.
#[must_use]
pub fn value_reference(name: &str) -> Option<u32> {
    VARIABLES
        .iter()
        .position(|variable| variable.name == name)
        .map(|row| row as u32)
}

impl Variable {
    /// Why `value` may not be set, in words, if it may not.
    ///
    /// # Errors
    /// A message with the value, the limit and the name of the variable.
    #[inline]
    pub fn check(&self, value: f64) -> Result<(), String> {
        match &self.kind {
            Kind::Real { min, max, .. } if !(*min..=*max).contains(&value) => {
                Err(self.refusal(value, [*min, *max]))
            }
            _ => Ok(()),
        }
    }

    #[cold]
    fn refusal(&self, value: f64, [min, max]: [f64; 2]) -> String {
        let name = self.name;
        if !value.is_finite() {
            format!("{name} = {value} is not a finite number")
        } else if value < min {
            format!("{name} = {value} is below its minimum {min}; set a value from {min} on")
        } else {
            format!("{name} = {value} is above its maximum {max}; set a value up to {max}")
        }
    }
}

impl Scene {
    /// The scene in which each variable has its start value.
    #[must_use]
    pub fn at_start() -> Scene {
        let mut scene = Scene::BLANK;
        for variable in &VARIABLES {
            let Some(start) = variable.start else {
                continue;
            };
            match variable.access {
                Access::Input { of, .. } => *of(&mut scene) = Polynomial::constant(start),
                Access::Setting { set, .. } => set(&mut scene, start),
                Access::Result { .. } => {}
            }
        }
        scene
    }
}

/// A table whose rows have different names and starts inside their limits; the
/// compiler refuses any other.
const fn checked<const COUNT: usize>(rows: [Variable; COUNT]) -> [Variable; COUNT] {
    let mut i = 0;
    while i < COUNT {
        let mut k = 0;
        while k < i {
            assert!(!same(rows[i].name, rows[k].name), "a name occurs twice");
            k += 1;
        }
        if let (Some(start), Kind::Real { min, max, .. }) = (rows[i].start, rows[i].kind) {
            assert!(start >= min, "a start value lies below the minimum");
            assert!(start <= max, "a start value lies above the maximum");
        }
        i += 1;
    }
    rows
}

const fn same(a: &str, b: &str) -> bool {
    let (a, b) = (a.as_bytes(), b.as_bytes());
    if a.len() != b.len() {
        return false;
    }
    let mut i = 0;
    while i < a.len() {
        if a[i] != b[i] {
            return false;
        }
        i += 1;
    }
    true
}
