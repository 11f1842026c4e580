//! Getting and setting variables by their value references.

use super::{Fault, Instance};
use crate::actuator::drive::Polynomial;
use crate::variables::{Access, Kind, ON_PULL_IN, VARIABLES, Variability, Variable};
use crate::view::Quantities;

/// The types of FMI under which a variable can be got and set.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Type {
    /// `fmi2Real`.
    Real,
    /// `fmi2Integer`, also used for enumerations.
    Integer,
    /// `fmi2Boolean`.
    Boolean,
    /// `fmi2String`.
    String,
}

impl Type {
    fn name(self) -> &'static str {
        match self {
            Type::Real => "Real",
            Type::Integer => "Integer or Enumeration",
            Type::Boolean => "Boolean",
            Type::String => "String",
        }
    }

    fn is_of(self, variable: &Variable) -> bool {
        match variable.kind {
            Kind::Real { .. } => self == Type::Real,
            Kind::Boolean => self == Type::Boolean,
            Kind::Enumeration => self == Type::Integer,
        }
    }
}

/// The variable of a value reference.
pub(super) fn row(reference: u32) -> Result<&'static Variable, Fault> {
    VARIABLES.get(reference as usize).ok_or_else(|| {
        Fault::error(format!(
            "there is no variable with value reference {reference}; the largest is {}",
            VARIABLES.len() - 1
        ))
    })
}

#[inline]
fn typed(reference: u32, wanted: Type) -> Result<&'static Variable, Fault> {
    match VARIABLES.get(reference as usize) {
        Some(variable) if wanted.is_of(variable) => Ok(variable),
        _ => Err(not_of_type(reference, wanted)),
    }
}

/// Why a value reference is not that of a variable of this type.
#[cold]
fn not_of_type(reference: u32, wanted: Type) -> Fault {
    match row(reference) {
        Ok(variable) => Fault::error(format!(
            "{} (value reference {reference}) is not of type {}",
            variable.name,
            wanted.name()
        )),
        Err(fault) => fault,
    }
}

impl Instance {
    /// Reads the variables of type `wanted` with these value references, each
    /// passed to `store` with its place. Booleans are 0 or 1, enumerations
    /// their item's number.
    ///
    /// # Errors
    /// Error for an unknown reference or another type; then nothing is stored.
    /// Discard where a result is no number, at a state that a host's integrator
    /// tried far out or at 0.
    pub fn get(
        &self,
        wanted: Type,
        references: &[u32],
        mut store: impl FnMut(usize, f64),
    ) -> Result<(), Fault> {
        for &reference in references {
            typed(reference, wanted)?;
        }
        let view = self.view();
        let mut all_numbers = true;
        for (place, &reference) in references.iter().enumerate() {
            let value = match VARIABLES[reference as usize].access {
                Access::Input { get, .. } | Access::Result { get, .. } => get(&view),
                Access::Setting { get, .. } => get(view.scene),
            };
            all_numbers &= !value.is_nan();
            store(place, value);
        }
        if all_numbers {
            return Ok(());
        }
        Err(Fault::discard(format!(
            "a result is no number at the stretch {}; try a shorter step",
            view.stretch()
        )))
    }

    /// Sets the variables of type `wanted` with these value references.
    ///
    /// # Errors
    /// Error for an unknown reference, another type, a variable that cannot be
    /// set or not in this phase, or a value outside the limits; then nothing
    /// is set.
    pub fn set(
        &mut self,
        wanted: Type,
        references: &[u32],
        value: impl Fn(usize) -> f64,
    ) -> Result<(), Fault> {
        for (place, &reference) in references.iter().enumerate() {
            let variable = typed(reference, wanted)?;
            self.check_settable(variable)?;
            check_value(variable, value(place))?;
        }
        self.bring_drive_up_to_date();
        for (place, &reference) in references.iter().enumerate() {
            let value = value(place);
            let changed = match VARIABLES[reference as usize].access {
                Access::Input { of, .. } => {
                    let input = of(&mut self.scene);
                    // Derivatives belong to the value they were set with.
                    let new = if self.fresh_derivatives & (1 << reference) == 0 {
                        Polynomial::constant(value)
                    } else {
                        input.with_value(value)
                    };
                    let changed = new != *input;
                    if changed {
                        *input = new;
                    }
                    changed
                }
                Access::Setting { get, set } => {
                    let before = get(&self.scene);
                    set(&mut self.scene, value);
                    before != value
                }
                Access::Result { .. } => false,
            };
            if changed {
                self.changed();
            }
        }
        Ok(())
    }

    #[inline]
    fn check_settable(&self, variable: &Variable) -> Result<(), Fault> {
        // Tunable parameters in continuous-time mode go beyond the standard: FMPy sets
        // them there, with the inputs.
        let fixed = variable.variability == Variability::Fixed && self.phase.has_begun();
        if fixed || matches!(variable.access, Access::Result { .. }) {
            return Err(not_settable(variable));
        }
        Ok(())
    }
}

/// Why a variable cannot be set, or not any more.
#[cold]
fn not_settable(variable: &Variable) -> Fault {
    let name = variable.name;
    Fault::error(match variable.access {
        Access::Result { .. } => format!("{name} is a result of the model and cannot be set"),
        _ => {
            format!("{name} is fixed after initialization; set it before, or call fmi2Reset first")
        }
    })
}

#[inline]
fn check_value(variable: &Variable, value: f64) -> Result<(), Fault> {
    let items = ON_PULL_IN.len();
    if variable.kind == Kind::Enumeration && !(1.0..=items as f64).contains(&value) {
        return Err(Fault::error(format!(
            "{} = {value} is not an item of its enumeration; set 1 to {items}",
            variable.name
        )));
    }
    variable.check(value).map_err(Fault::error)
}
