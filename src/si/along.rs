//! The quantities as they change in a direction.

use super::Si;
use super::sample::{Basis, Sample, own};
use super::scene::{BRANCHES, SiScene, SiState, place};
use crate::actuator::device::equation::Load;
use crate::model::variables::{Access, Kind};
use crate::model::{Direction, Model, Place, View};
use crate::solver::coupled::{MOST_STATES, Stage};
use crate::solver::jet::Dual;

impl View<'_, Si> {
    /// The present as it changes in a direction: exact for inputs and states; for parameters, on
    /// which the units depend too, by central differences of fourth order.
    pub(super) fn sample_along(&self, direction: &Direction<Si>) -> Sample<Dual> {
        let (basis, stage) = self.basis();
        let scales = &basis.scales;
        let source = self.scene.source();
        let change = direction.scene.sources[place(source)];
        let dual = |value: f64, slope: f64| Dual::new(value, slope);
        let load = basis.load(0.0);
        let time = scales.time.value();
        let unit = scales.source(source);
        let loaded = Load {
            source: dual(load.source, change.at(0.0) / unit),
            prestress: dual(load.prestress, direction.scene.force.at(0.0) / scales.force),
        };
        let slopes = self.state_slopes(&basis, &direction.state);
        let held = self.is_held();
        let moved = Stage {
            position: dual(
                stage.position,
                if held {
                    0.0
                } else {
                    direction.state.motion.position
                },
            ),
            rate: dual(
                stage.rate,
                if held {
                    0.0
                } else {
                    direction.state.motion.rate * time
                },
            ),
            internal: std::array::from_fn(|k| dual(stage.internal[k], slopes[k])),
        };
        let rate = Dual::constant(basis.source_rate());
        let [now, change] = [own(&self.state()), own(&direction.state)];
        let states = std::array::from_fn(|k| dual(now[k], change[k]));
        let sample = basis.sample(loaded, rate, &moved, None, (held, states));
        match self.by_parameters(direction) {
            Some(slope) => sample.plus(&slope),
            None => sample,
        }
    }

    /// The changes of the nondimensional first-order states.
    fn state_slopes(&self, basis: &Basis, change: &SiState) -> [f64; MOST_STATES] {
        let state = self.state();
        let mut all = [0.0; MOST_STATES];
        let mut next = 0;
        if basis.device.has_charge_state() {
            all[0] = change.charge / basis.scales.charge;
            next = 1;
        }
        for k in 0..BRANCHES {
            if basis.device.branches[k].modulus > 0.0 {
                all[next] = 2.0 * state.dashpots[k] * change.dashpots[k];
                next += 1;
            }
        }
        all
    }

    /// How the quantities change with the parameters of a direction, if it has any.
    fn by_parameters(&self, direction: &Direction<Si>) -> Option<Sample<f64>> {
        let mut size = 0.0_f64;
        for (get, _) in numbers() {
            let change = get(&direction.scene);
            if change != 0.0 {
                let value = get(self.scene).abs();
                size = size.max(change.abs() / if value > 0.0 { value } else { 1.0 });
            }
        }
        if size == 0.0 {
            return None;
        }
        let step = 1e-3 / size;
        let state = self.state();
        let at = |steps: f64| {
            let mut scene = self.scene.clone();
            for (get, set) in numbers() {
                let change = get(&direction.scene);
                if change != 0.0 {
                    let value = get(&scene) + steps * step * change;
                    set(&mut scene, value);
                }
            }
            View::<Si> {
                scene: &scene,
                place: Place::of_state(*self.time, state),
                ..*self
            }
            .sample()
        };
        let weight = |part: f64| part / (12.0 * step);
        Some(Sample::sum([
            (weight(1.0), at(-2.0)),
            (weight(-8.0), at(-1.0)),
            (weight(8.0), at(1.0)),
            (weight(-1.0), at(2.0)),
        ]))
    }
}

/// How a number that a host sets is read and set.
type Setting = (fn(&SiScene) -> f64, fn(&mut SiScene, f64));

/// How the numbers that a host sets are read and set.
fn numbers() -> impl Iterator<Item = Setting> {
    Si::VARIABLES
        .iter()
        .filter_map(|variable| match (variable.access, variable.kind) {
            (Access::Setting { get, set, .. }, Kind::Real { .. }) => Some((get, set) as Setting),
            _ => None,
        })
}
