//! Parameters that a host tunes while the motion goes on.

use super::phase::Phase;
use super::{Fault, Instance, Simulation};
use crate::model::variables::Access;
use crate::model::{Model, Place, View};
use crate::shortest::Shortest;

impl<M: Model> Instance<M> {
    /// Refuses tunable parameters with which there is no motion from the present state. Returns the state that
    /// they make of it, where it changes.
    pub(super) fn check_tuned(
        &self,
        references: &[u32],
        value: &impl Fn(usize) -> f64,
    ) -> Result<Option<M::State>, Fault> {
        let settings = references
            .iter()
            .enumerate()
            .filter_map(|(place, &reference)| {
                let variable = &M::VARIABLES[reference as usize];
                match variable.access {
                    Access::Setting { set, .. } => Some((variable.name, set, value(place))),
                    _ => None,
                }
            });
        let mut scene = None;
        for (_, set, value) in settings.clone() {
            set(scene.get_or_insert_with(|| self.scene.clone()), value);
        }
        let Some(scene) = scene else {
            return Ok(None);
        };
        let mut why = match self.tuned_to(&scene) {
            Ok(state) => return Ok((state != M::state(&self.view())).then_some(state)),
            Err(why) => why,
        };
        // The last setting is not to blame where those before it are refused too.
        let settings: Vec<_> = settings.collect();
        let mut last = settings.len() - 1;
        while last > 0 {
            let mut scene = self.scene.clone();
            for (_, set, value) in &settings[..last] {
                set(&mut scene, *value);
            }
            match self.tuned_to(&scene) {
                Ok(_) => break,
                Err(earlier) => (why, last) = (earlier, last - 1),
            }
        }
        let (name, _, value) = settings[last];
        let value = Shortest(value);
        Err(Fault::error(format!(
            "{name} = {value} cannot be set: {why}"
        )))
    }

    /// The present state of a scene with other settings.
    fn tuned_to(&self, scene: &M::Scene) -> Result<M::State, String> {
        M::check_settings(scene)?;
        let view = self.view();
        let state = M::state_tuned_to(&view, scene);
        if self.phase == Phase::ContinuousTime && state != M::state(&view) {
            return Err("a continuous state jumps by that; set it in event mode".into());
        }
        let place = Place::of_state(*view.time, state);
        let tuned = View::new(scene, place, view.time, view.collapse);
        M::check_state(&tuned)?;
        M::excess(&tuned).map_or(Ok(state), Err)
    }

    /// Sets the state that the host integrates.
    pub(super) fn jump_to(&mut self, state: M::State) {
        if let Simulation::Exchange(now) = &mut self.simulation {
            (now.state, now.states_changed) = (state, true);
        }
    }
}
