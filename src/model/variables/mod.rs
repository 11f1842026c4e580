//! What a table of variables is made of: one row each, the only place that says
//! what a variable is called, what it means, between which limits it lies, where
//! it starts, and how it is read and set. The model description, the checks of
//! the setters and the generators of the tests all follow from it.
//!
//! Each [`Model`] has a table of its own. The position of a row in it is the
//! variable's value reference.

use crate::actuator::drive::Polynomial;
use crate::arithmetic::jet::{Dual, TimeSeries};
use crate::model::{Model, View};
use crate::shortest::Shortest;

pub mod rows;
pub mod units;

pub use units::Unit;

/// Role of a variable, as FMI defines it.
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

/// When a variable may change, as FMI defines it.
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
    /// One of the items of an enumeration; its number in this table.
    Enumeration(&'static Enumeration),
}

/// A type whose values are named.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Enumeration {
    /// The name of the type.
    pub name: &'static str,
    /// Name and meaning of each item, numbered from 1.
    pub items: &'static [(&'static str, &'static str)],
}

/// Which values between its limits a real variable can have.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Meant {
    /// All of them.
    Any,
    /// 0, which stands for "none", and all from this one on.
    NoneOrFrom(f64),
    /// Whole ones.
    Whole,
}

/// A variable as part of a terminal: what is connected to its like in another unit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Member {
    /// The terminal.
    pub terminal: &'static Terminal,
    /// Its name in the terminal, by which variables are connected.
    pub name: &'static str,
    /// Whether it flows into the unit: at a connection such variables add up to 0.
    pub flows: bool,
}

/// Variables that belong to one physical port.
#[derive(Debug, PartialEq)]
pub struct Terminal {
    /// The name.
    pub name: &'static str,
    /// What it is, for people.
    pub description: &'static str,
    /// Its place on the icon, whose edges are at −100 and 100: to the right, upwards.
    pub place: [f64; 2],
    /// The colour of its lines: red, green, blue.
    pub colour: [u8; 3],
}

/// How a variable is read and set.
pub enum Access<M: Model> {
    /// A function of time that the host prescribes.
    Input {
        /// The present value.
        get: fn(&View<M>) -> f64,
        /// The function of time.
        of: fn(&mut M::Scene) -> &mut Polynomial,
    },
    /// A number that the host sets.
    Setting {
        /// The number.
        get: fn(&M::Scene) -> f64,
        /// Sets it.
        set: fn(&mut M::Scene, f64),
        /// Sets it once the motion has begun, where that is another thing: nothing
        /// then changes at once, only what follows. The time of the inputs counts from
        /// the present.
        from_now_on: Option<fn(&mut M::Scene, f64)>,
    },
    /// A result.
    Result {
        /// Computes it.
        get: fn(&View<M>) -> f64,
        /// Its derivatives, where it has any that are offered.
        derivatives: Option<Derivatives<M>>,
        /// On what it depends.
        dependencies: Dependencies,
    },
}

/// The derivatives of a result.
pub struct Derivatives<M: Model> {
    /// The result as it changes in a direction.
    pub along: fn(&M::Sample<Dual>) -> Dual,
    /// The result as a series in time.
    pub from_now_on: fn(&M::Sample<TimeSeries>) -> TimeSeries,
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
pub struct Variable<M: Model> {
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
    pub unit: &'static Unit,
    /// Which values between its limits it can have.
    pub meant: Meant,
    /// The terminal to which it belongs.
    pub member: Option<Member>,
    /// For messages: how the value follows from the number in another unit that a user is likely
    /// to type instead.
    pub conversion: Option<&'static str>,
    /// The value before the host sets another; none for results.
    pub start: Option<f64>,
    /// The name of the state of which this is the derivative.
    pub derivative_of: Option<&'static str>,
    /// Whether +inf is one of its values. It then means that there is none.
    pub may_be_infinite: bool,
    /// How it is read and set.
    pub access: Access<M>,
}

/// A further name of a variable, of the same value reference.
#[derive(Clone, Copy, Debug)]
pub struct Alias {
    /// The further name.
    pub name: &'static str,
    /// What it is good for, for people.
    pub description: &'static str,
    /// The name of the variable.
    pub of: &'static str,
}

// Not derived: that would require `Copy` of the model's types, to which there are only function
// pointers here.
macro_rules! copied {
    ($($name:ident),*) => {$(
        impl<M: Model> Clone for $name<M> {
            fn clone(&self) -> Self {
                *self
            }
        }

        impl<M: Model> Copy for $name<M> {}
    )*};
}

copied!(Access, Derivatives, Variable);

/// Value references of the continuous states of a table, in its order: of the
/// variables that have a derivative in it.
///
/// # Panics
/// If there is another number of states; at compile time.
#[must_use]
pub const fn states<M: Model, const COUNT: usize>(table: &[Variable<M>]) -> [u32; COUNT] {
    let mut states = [0; COUNT];
    let (mut found, mut row) = (0, 0);
    while row < table.len() {
        if row_of_derivative(table, table[row].name).is_some() {
            states[found] = row as u32;
            found += 1;
        }
        row += 1;
    }
    assert!(found == COUNT, "another number of states");
    states
}

/// Value references of the inputs; another number than `COUNT` does not compile.
#[must_use]
pub const fn inputs<M: Model, const COUNT: usize>(table: &[Variable<M>]) -> [u32; COUNT] {
    let mut inputs = [0; COUNT];
    let (mut found, mut row) = (0, 0);
    while row < table.len() {
        if table[row].is_input() {
            inputs[found] = row as u32;
            found += 1;
        }
        row += 1;
    }
    assert!(found == COUNT, "another number of inputs");
    inputs
}

/// Value references of the derivatives of the continuous states, in the order of
/// the states.
#[must_use]
pub const fn derivatives<M: Model, const COUNT: usize>(table: &[Variable<M>]) -> [u32; COUNT] {
    let states: [u32; COUNT] = states(table);
    let mut derivatives = [0; COUNT];
    let mut i = 0;
    while i < COUNT {
        if let Some(row) = row_of_derivative(table, table[states[i] as usize].name) {
            derivatives[i] = row as u32;
        }
        i += 1;
    }
    derivatives
}

const fn row_of_derivative<M: Model>(table: &[Variable<M>], name: &str) -> Option<usize> {
    let mut row = 0;
    while row < table.len() {
        if let Some(state) = table[row].derivative_of
            && same(state, name)
        {
            return Some(row);
        }
        row += 1;
    }
    None
}

/// Value reference of a variable of a model, by its name or a further name.
#[must_use]
pub fn value_reference<M: Model>(name: &str) -> Option<u32> {
    let alias = M::ALIASES.iter().find(|alias| alias.name == name);
    let name = alias.map_or(name, |alias| alias.of);
    M::VARIABLES
        .iter()
        .position(|variable| variable.name == name)
        .map(|row| row as u32)
}

impl<M: Model> Variable<M> {
    /// Its role in words, for tables.
    #[must_use]
    pub fn role(&self) -> &'static str {
        match (self.causality, self.variability) {
            (Causality::Parameter, Variability::Tunable) => "tunable parameter",
            (Causality::Parameter, _) => "parameter",
            (Causality::Input, _) => "input",
            (Causality::Output, _) => "output",
            (Causality::Local, _) => "local",
        }
    }

    /// Its value at present.
    #[must_use]
    #[inline]
    pub fn value(&self, view: &View<M>) -> f64 {
        match self.access {
            Access::Input { get, .. } | Access::Result { get, .. } => get(view),
            Access::Setting { get, .. } => get(view.scene),
        }
    }

    /// Whether `value` can be handed to a host: a finite number, or +inf where that means something.
    #[must_use]
    #[inline]
    pub fn has(&self, value: f64) -> bool {
        value.is_finite() || value == f64::INFINITY && self.may_be_infinite
    }

    /// Whether the host prescribes it as a function of time.
    #[must_use]
    pub const fn is_input(&self) -> bool {
        matches!(self.access, Access::Input { .. })
    }

    /// Why `value` may not be set, in words, if it may not.
    ///
    /// # Errors
    /// A message with the value, the limit and the name of the variable.
    #[inline]
    pub fn check(&self, value: f64) -> Result<(), String> {
        match &self.kind {
            Kind::Real { min, max, .. }
                if !(*min..=*max).contains(&value) || !self.is_meant(value) =>
            {
                Err(self.refusal(value, [*min, *max]))
            }
            _ => Ok(()),
        }
    }

    #[inline]
    fn is_meant(&self, value: f64) -> bool {
        match self.meant {
            Meant::Any => true,
            Meant::NoneOrFrom(smallest) => value == 0.0 || value >= smallest,
            Meant::Whole => value.fract() == 0.0,
        }
    }

    #[cold]
    fn refusal(&self, value: f64, [min, max]: [f64; 2]) -> String {
        let unit = match self.unit.name {
            "1" => String::new(),
            unit => format!(" {unit}"),
        };
        let name = self.name;
        let [number, low, high] = [value, min, max].map(Shortest);
        let fault = if !value.is_finite() {
            "is not a finite number".into()
        } else if value < min {
            format!("is below its minimum {low}{unit}")
        } else if value > max {
            format!("is above its maximum {high}{unit}")
        } else {
            match self.meant {
                Meant::NoneOrFrom(smallest) => {
                    format!(
                        "is neither 0 nor above its minimum {}{unit}",
                        Shortest(smallest)
                    )
                }
                _ => "is not a whole number".into(),
            }
        };
        let wanted = match self.meant {
            Meant::NoneOrFrom(smallest) => {
                format!("0 or a value from {} to {high}{unit}", Shortest(smallest))
            }
            Meant::Whole => format!("a whole number from {low} to {high}"),
            Meant::Any => format!("a value from {low} to {high}{unit}"),
        };
        let conversion = match self.conversion {
            Some(conversion) => format!(" ({conversion})"),
            None => String::new(),
        };
        format!("{name} = {number}{unit} {fault}; set {wanted}{conversion}")
    }
}

/// `blank` with each variable of the table of a model at its start value.
#[must_use]
pub fn at_start<M: Model>(blank: M::Scene) -> M::Scene {
    let mut scene = blank;
    for variable in M::VARIABLES {
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

/// A table whose rows have different names and starts inside their limits.
///
/// # Panics
/// If it has not; at compile time.
#[must_use]
pub const fn checked<M: Model, const COUNT: usize>(
    rows: [Variable<M>; COUNT],
) -> [Variable<M>; COUNT] {
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
