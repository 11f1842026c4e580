//! Getting and setting variables by their value references.

use super::beyond::{means_none, one_cannot_be_worked_out};
use super::derivatives::state_component;
use super::phase::Phase;
use super::{Fault, Instance, Simulation};
use crate::actuator::drive::Polynomial;
use crate::arithmetic::double_double::DoubleDouble;
use crate::model::Model;
use crate::model::variables::{Access, Kind, Variability, Variable};
use crate::shortest::Shortest;

/// The types of FMI under which a variable can be got and set.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Type {
    /// A real number.
    Real,
    /// A whole number, also the number of an item of an enumeration.
    Integer,
    /// True or false.
    Boolean,
    /// A text.
    String,
}

impl Type {
    fn name(self) -> &'static str {
        match self {
            Type::Real => "a real number",
            Type::Integer => "a whole number or an item of an enumeration",
            Type::Boolean => "a Boolean",
            Type::String => "a text",
        }
    }

    fn is_of<M: Model>(self, variable: &Variable<M>) -> bool {
        match variable.kind {
            Kind::Real { .. } => self == Type::Real,
            Kind::Boolean => self == Type::Boolean,
            Kind::Enumeration(_) => self == Type::Integer,
        }
    }
}

/// The variable of a value reference.
pub(super) fn row<M: Model>(reference: u32) -> Result<&'static Variable<M>, Fault> {
    M::VARIABLES.get(reference as usize).ok_or_else(|| {
        Fault::error(format!(
            "there is no variable with value reference {reference}; the largest is {}",
            M::VARIABLES.len() - 1
        ))
    })
}

#[inline]
fn typed<M: Model>(reference: u32, wanted: Type) -> Result<&'static Variable<M>, Fault> {
    match M::VARIABLES.get(reference as usize) {
        Some(variable) if wanted.is_of(variable) => Ok(variable),
        _ => Err(not_of_type::<M>(reference, wanted)),
    }
}

/// Why a value reference is not that of a variable of this type.
#[cold]
fn not_of_type<M: Model>(reference: u32, wanted: Type) -> Fault {
    match row::<M>(reference) {
        Ok(variable) => Fault::error(format!(
            "{} (value reference {reference}) is not {}",
            variable.name,
            wanted.name()
        )),
        Err(fault) => fault,
    }
}

/// The bit of an input in [`Instance::fresh_derivatives`]: inputs are counted among themselves.
pub(super) fn input_bit<M: Model>(reference: u32) -> u64 {
    const { assert!(M::INPUTS.len() <= u64::BITS as usize, "too many inputs") };
    let place = M::INPUTS.iter().position(|input| *input == reference);
    place.map_or(0, |place| 1 << place)
}

/// A place in a scene.
type PlaceIn<Scene> = fn(&mut Scene) -> &mut Polynomial;

/// Where an input lies in the scene, and its limits; inputs are counted among themselves.
const fn nth_input<M: Model>(nth: usize) -> Option<(PlaceIn<M::Scene>, [f64; 2])> {
    if nth >= M::INPUTS.len() {
        return None;
    }
    let variable = &M::VARIABLES[M::INPUTS[nth] as usize];
    match (&variable.access, &variable.kind) {
        (Access::Input { of, .. }, Kind::Real { min, max, .. }) => Some((*of, [*min, *max])),
        _ => None,
    }
}

/// Whether the value lies between the limits. Compares bits: the floating-point environment is neither asked nor
/// changed.
#[inline(always)]
fn lies_between(value: f64, [min, max]: [f64; 2]) -> bool {
    min.total_cmp(&value).is_le() && value.total_cmp(&max).is_le()
}

impl<M: Model> Instance<M> {
    /// Reads the variables of type `wanted` with these value references, each
    /// passed to `store` with its place. Booleans are 0 or 1, enumerations
    /// their item's number.
    ///
    /// # Errors
    /// Error for an unknown reference or another type; then nothing is stored.
    /// Discard where a result leads beyond the largest number: a host's integrator may try states far out or at 0.
    pub fn get(
        &self,
        wanted: Type,
        references: &[u32],
        mut store: impl FnMut(usize, f64),
    ) -> Result<(), Fault> {
        // All of them are looked at before one is stored.
        if references.len() > 1 {
            for &reference in references {
                typed::<M>(reference, wanted)?;
            }
        }
        let view = self.view();
        let mut all_numbers = true;
        for (place, &reference) in references.iter().enumerate() {
            let value = typed::<M>(reference, wanted)?.value(&view);
            if !value.is_finite() {
                all_numbers &= means_none::<M>(references, place, value);
            }
            store(place, value);
        }
        if all_numbers {
            return Ok(());
        }
        Err(one_cannot_be_worked_out(&view, references))
    }

    /// Reads a state where it is stored as such. It compares integers and copies, without any floating-point
    /// operation. Returns whether the state has been read; if not, nothing is stored, and [`Instance::get`] is to
    /// be called.
    #[inline]
    pub fn get_stored(&self, reference: u32, value: &mut f64) -> bool {
        let Simulation::Run(run) = &self.simulation else {
            return false;
        };
        let Some(mut state) = run.stored_state() else {
            return false;
        };
        let component = state_component::<M>(&mut state, reference);
        if let Some(component) = &component {
            *value = **component;
        }
        component.is_some()
    }

    /// Sets an input that is constant between communication points. It compares integers and copies, without any
    /// floating-point operation. Returns whether the input has been set; if not,
    /// nothing has changed, and [`Instance::set`] is to be called.
    #[inline]
    pub fn set_held(&mut self, reference: u32, value: f64) -> bool {
        let Some(input) = self.held_input(reference, value) else {
            return false;
        };
        if input.value().to_bits() != value.to_bits() {
            // Its derivatives are 0 as it is.
            input.set_value(value);
            self.changed();
        }
        true
    }

    /// [`Instance::set_held`] of several inputs: of all, or of none.
    #[inline(never)]
    pub fn set_all_held(&mut self, references: &[u32], values: &[f64]) -> bool {
        let given = references.iter().copied().zip(values.iter().copied());
        given
            .clone()
            .all(|(reference, value)| self.held_input(reference, value).is_some())
            && given
                .into_iter()
                .all(|(reference, value)| self.set_held(reference, value))
    }

    /// The input of this value reference, if it is constant and may have this value.
    #[inline(always)]
    fn held_input(&mut self, reference: u32, value: f64) -> Option<&mut Polynomial> {
        const { assert!(M::INPUTS.len() <= 4, "as many cases as inputs") };
        match M::INPUTS.iter().position(|input| *input == reference)? {
            0 => self.nth_held_input::<0>(value),
            1 => self.nth_held_input::<1>(value),
            2 => self.nth_held_input::<2>(value),
            _ => self.nth_held_input::<3>(value),
        }
    }

    /// [`Instance::held_input`] of an input whose place and limits the compiler knows.
    #[inline(always)]
    fn nth_held_input<const NTH: usize>(&mut self, value: f64) -> Option<&mut Polynomial> {
        let (of, limits) = const { nth_input::<M>(NTH) }?;
        let input = of(&mut self.scene);
        let same = input.value().to_bits() == value.to_bits();
        (input.is_constant() && (same || lies_between(value, limits))).then_some(input)
    }

    /// Sets the variables of type `wanted` with these value references. In model
    /// exchange the states are among them, between the end of initialization and
    /// that of the simulation: as `set_continuous_states` does.
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
            let variable = typed::<M>(reference, wanted)?;
            if self.is_settable_state(reference) {
                check_state(variable, value(place))?;
            } else {
                self.check_settable(variable)?;
                check_value(variable, value(place))?;
            }
        }
        let window = M::window(&self.scene);
        let begun = self.phase.has_begun();
        let elsewhere = if begun {
            self.check_tuned(references, &value)?
        } else {
            None
        };
        self.bring_drive_up_to_date();
        if let Some(state) = elsewhere {
            self.jump_to(state);
        }
        for (place, &reference) in references.iter().enumerate() {
            let value = value(place);
            let changed = match M::VARIABLES[reference as usize].access {
                Access::Input { of, .. } => {
                    let input = of(&mut self.scene);
                    // Derivatives belong to the value they were set with.
                    let new = if self.fresh_derivatives & input_bit::<M>(reference) == 0 {
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
                Access::Setting {
                    get,
                    set,
                    from_now_on,
                } => {
                    let changed = get(&self.scene) != value;
                    match from_now_on {
                        Some(change) if begun && changed => change(&mut self.scene, value),
                        _ => set(&mut self.scene, value),
                    }
                    changed
                }
                Access::Result { .. } => {
                    if let Simulation::Exchange(now) = &mut self.simulation
                        && let Some(component) = state_component::<M>(&mut now.state, reference)
                    {
                        *component = value;
                        now.arrival = None;
                    }
                    false
                }
            };
            if changed {
                self.changed();
            }
        }
        if M::window(&self.scene) != window {
            self.record_anew();
        }
        Ok(())
    }

    /// Counts the time of the drive from the present communication point on.
    pub(super) fn bring_drive_up_to_date(&mut self) {
        if let Some(time) = self.now() {
            M::rebase_inputs(&mut self.scene, time);
        }
    }

    /// The present communication point; none before the motion has begun.
    fn now(&self) -> Option<DoubleDouble> {
        match &self.simulation {
            Simulation::NotBegun => None,
            Simulation::Run(run) => Some(*run.time()),
            Simulation::Exchange(now) => Some(now.time),
        }
    }

    /// Begins new recordings at the present.
    fn record_anew(&mut self) {
        match &mut self.simulation {
            Simulation::NotBegun => {}
            Simulation::Run(run) => run.record_anew(&self.scene),
            Simulation::Exchange(now) => now.record_anew(&self.scene),
        }
    }

    /// Notes that the scene has changed.
    pub(super) fn changed(&mut self) {
        if let Simulation::Run(run) = &mut self.simulation {
            run.scene_changed();
        }
    }

    /// Whether this is a state that the host integrates, and may set at present.
    #[inline]
    fn is_settable_state(&self, reference: u32) -> bool {
        matches!(self.phase, Phase::EventMode | Phase::ContinuousTime)
            && M::STATES.contains(&reference)
    }

    #[inline]
    fn check_settable(&self, variable: &Variable<M>) -> Result<(), Fault> {
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
fn not_settable<M: Model>(variable: &Variable<M>) -> Fault {
    let name = variable.name;
    Fault::error(match variable.access {
        Access::Result { .. } => format!("{name} is a result of the model and cannot be set"),
        _ => {
            format!(
                "{name} is fixed after initialization; set it before, or reset the instance first"
            )
        }
    })
}

/// A state may be any finite number: a host's integrator may try states far out.
fn check_state<M: Model>(variable: &Variable<M>, value: f64) -> Result<(), Fault> {
    if value.is_finite() {
        return Ok(());
    }
    let name = variable.name;
    Err(Fault::error(format!(
        "{name} = {} is not a finite number",
        Shortest(value)
    )))
}

#[inline]
fn check_value<M: Model>(variable: &Variable<M>, value: f64) -> Result<(), Fault> {
    if let Kind::Enumeration(enumeration) = variable.kind
        && let items = enumeration.items.len()
        && !(1.0..=items as f64).contains(&value)
    {
        return Err(Fault::error(format!(
            "{} = {} is not an item of its enumeration; set 1 to {items}",
            variable.name,
            Shortest(value)
        )));
    }
    variable.check(value).map_err(Fault::error)
}
