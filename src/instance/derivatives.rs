//! Derivatives of inputs and outputs with respect to time, and directional
//! derivatives.

use super::beyond::cannot_be_worked_out;
use super::phase::Phase;
use super::{Fault, Instance, values};
use crate::actuator::drive::{HIGHEST_DERIVATIVE, Polynomial};
use crate::arithmetic::jet::HIGHEST_ORDER;
use crate::model::variables::{Access, Causality, Derivatives, Kind, Variable};
use crate::model::{Direction, Model, View};
use crate::shortest::Shortest;

impl<M: Model> Instance<M> {
    /// Sets derivatives of inputs, each given by value reference, order and value.
    ///
    /// An input with derivatives is a polynomial in the time since they were
    /// set. It stays so until its value or a derivative is set again.
    ///
    /// # Errors
    /// Error for a variable that is no input, an order outside 1 to 4 or a
    /// value that is not finite; then nothing is set.
    pub fn set_input_derivatives(
        &mut self,
        references: &[u32],
        orders: &[i32],
        derivatives: &[f64],
    ) -> Result<(), Fault> {
        for ((&reference, &order), &value) in references.iter().zip(orders).zip(derivatives) {
            let variable = values::row::<M>(reference)?;
            let name = variable.name;
            if !matches!(variable.access, Access::Input { .. }) {
                return Err(Fault::error(format!(
                    "{name} is not an input; only inputs can have derivatives set"
                )));
            }
            check_order(name, order, HIGHEST_DERIVATIVE)?;
            check_derivative(name, value)?;
        }
        self.bring_drive_up_to_date();
        let before = self.scene.clone();
        for ((&reference, &order), &value) in references.iter().zip(orders).zip(derivatives) {
            let Access::Input { of, .. } = M::VARIABLES[reference as usize].access else {
                continue;
            };
            let input = of(&mut self.scene);
            let bit = values::input_bit::<M>(reference);
            if self.fresh_derivatives & bit == 0 {
                *input = Polynomial::constant(input.value());
                self.fresh_derivatives |= bit;
            }
            input.set_derivative(order as usize, value);
        }
        if self.scene != before {
            self.changed();
        }
        Ok(())
    }

    /// Derivatives of outputs with respect to time at the present communication
    /// point, each by value reference and order, passed to `store` with its
    /// place. They are those of the motion that goes on from here, exact to
    /// rounding; 0 where the actuator is held at a limit.
    ///
    /// # Errors
    /// Error for a variable that is no real output or an order outside 1 to 5;
    /// then nothing is stored. Discard where a derivative leads beyond the largest number.
    pub fn output_derivatives(
        &self,
        references: &[u32],
        orders: &[i32],
        mut store: impl FnMut(usize, f64),
    ) -> Result<(), Fault> {
        for (&reference, &order) in references.iter().zip(orders) {
            let variable = values::row::<M>(reference)?;
            if variable.causality != Causality::Output || derivatives_of(variable).is_none() {
                return Err(Fault::error(format!(
                    "{} is not a real output; only real outputs have derivatives with respect to time",
                    variable.name
                )));
            }
            check_order(variable.name, order, HIGHEST_ORDER)?;
        }
        let highest = orders.iter().max().map_or(0, |&order| order as usize);
        let view = self.view();
        let motion = M::from_now_on(&view, highest);
        let mut beyond = None;
        for (place, (&reference, &order)) in references.iter().zip(orders).enumerate() {
            let variable = &M::VARIABLES[reference as usize];
            let Some(derivatives) = derivatives_of(variable) else {
                continue;
            };
            let factorial: f64 = (1..=order).map(f64::from).product();
            let series = (derivatives.from_now_on)(&motion);
            let derivative = factorial * series.term[order as usize];
            if !derivative.is_finite() {
                beyond = beyond.or(Some(variable.name));
            }
            store(place, derivative);
        }
        all_finite(&view, beyond)
    }

    /// The directional derivatives Σ ∂unknown/∂known · change of the `unknowns`, exact to rounding, each passed to
    /// `store` with its place. The `knowns` are inputs, parameters and, after initialization, states; `changes`
    /// has one number for each. A start value has an effect in initialization mode only.
    ///
    /// # Errors
    /// Error for an unknown reference, an unknown without a derivative, a known
    /// that is neither input, parameter nor state, or a change that is not
    /// finite; then nothing is stored. Discard where a derivative leads beyond the largest number.
    pub fn directional_derivative(
        &self,
        unknowns: &[u32],
        knowns: &[u32],
        changes: &[f64],
        mut store: impl FnMut(usize, f64),
    ) -> Result<(), Fault> {
        for &unknown in unknowns {
            let variable = values::row::<M>(unknown)?;
            if derivatives_of(variable).is_none() {
                return Err(Fault::error(format!(
                    "{} has no directional derivative; ask for an output, the derivative \
                     of a state or a local that follows from them by a formula",
                    variable.name
                )));
            }
        }
        let view = self.view();
        let sample = M::along(&view, &self.direction(knowns, changes)?);
        let mut beyond = None;
        for (place, &unknown) in unknowns.iter().enumerate() {
            let variable = &M::VARIABLES[unknown as usize];
            if let Some(derivatives) = derivatives_of(variable) {
                let derivative = (derivatives.along)(&sample).slope();
                if !derivative.is_finite() {
                    beyond = beyond.or(Some(variable.name));
                }
                store(place, derivative);
            }
        }
        all_finite(&view, beyond)
    }

    /// The direction of these changes: a scene and a state into which the setters of the table write them.
    fn direction(&self, knowns: &[u32], changes: &[f64]) -> Result<Direction<M>, Fault> {
        let begun = self.phase != Phase::Initialization;
        let mut direction = Direction {
            state: M::start(&M::blank()),
            scene: M::blank(),
            from_now_on: begun,
        };
        for (&known, &change) in knowns.iter().zip(changes) {
            let variable = values::row::<M>(known)?;
            check_derivative(variable.name, change)?;
            match (variable.access, variable.kind) {
                (Access::Input { of, .. }, _) => {
                    let input = of(&mut direction.scene);
                    input.set_value(input.value() + change);
                }
                (Access::Setting { get, set, .. }, Kind::Real { .. }) => {
                    let sum = get(&direction.scene) + change;
                    set(&mut direction.scene, sum);
                }
                _ => match state_component::<M>(&mut direction.state, known) {
                    Some(component) if begun => *component += change,
                    _ => return Err(not_known(variable)),
                },
            }
        }
        if !begun {
            direction.state = M::start(&direction.scene);
        }
        Ok(direction)
    }
}

/// The number of a state to which a state variable belongs.
#[inline]
pub(super) fn state_component<M: Model>(state: &mut M::State, reference: u32) -> Option<&mut f64> {
    let place = M::STATES.iter().position(|state| *state == reference)?;
    M::component(state, place)
}

/// Discards the answer where the derivative of a variable, of this name, is no finite number.
fn all_finite<M: Model>(view: &View<M>, beyond: Option<&str>) -> Result<(), Fault> {
    match beyond {
        None => Ok(()),
        Some(name) => Err(cannot_be_worked_out(
            view,
            &format!("a derivative of {name}"),
        )),
    }
}

fn derivatives_of<M: Model>(variable: &Variable<M>) -> Option<Derivatives<M>> {
    match variable.access {
        Access::Result { derivatives, .. } => derivatives,
        _ => None,
    }
}

fn not_known<M: Model>(variable: &Variable<M>) -> Fault {
    let states = M::STATES
        .iter()
        .map(|&state| M::VARIABLES[state as usize].name);
    Fault::error(format!(
        "derivatives with respect to {} are not offered; ask for them with respect to real inputs \
         and parameters, and after initialization with respect to the states {}",
        variable.name,
        states.collect::<Vec<_>>().join(", ")
    ))
}

fn check_order(name: &str, order: i32, highest: usize) -> Result<(), Fault> {
    if (1..=highest as i32).contains(&order) {
        return Ok(());
    }
    Err(Fault::error(format!(
        "there is no derivative of {name} of order {order}; orders 1 to {highest} are offered"
    )))
}

/// Largest derivative of an input, and largest component of a direction: they are multiplied by powers of the
/// time, and must not overflow.
const LARGEST_DERIVATIVE: f64 = 1e50;

fn check_derivative(name: &str, value: f64) -> Result<(), Fault> {
    if value.abs() <= LARGEST_DERIVATIVE {
        return Ok(());
    }
    let [number, largest] = [value, LARGEST_DERIVATIVE].map(Shortest);
    Err(Fault::error(if value.is_finite() {
        format!("the derivative {number} of {name} is not between -{largest} and {largest}")
    } else {
        format!("the derivative {number} of {name} is not a finite number")
    }))
}
