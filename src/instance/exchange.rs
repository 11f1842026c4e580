//! Model exchange: the host integrates the motion, the actuator gives the
//! derivatives of its state and handles the collapse as an event.

use serde::{Deserialize, Serialize};

use super::beyond::cannot_be_worked_out;
use super::phase::Phase;
use super::{Fault, Instance, Message, Simulation, check_time};
use crate::arithmetic::double_double::DoubleDouble;
use crate::model::{Account, AtLimit, Collapse, Model, Place, Recording};
use crate::shortest::Shortest;

/// A limit counts as reached closer than this part of it: a host locates events to a tolerance, from either
/// side.
const REACHED: f64 = 1e-9;

/// How far the host has integrated.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(bound = "")]
pub struct Exchange<M: Model> {
    pub(super) time: DoubleDouble,
    pub(super) state: M::State,
    /// A tuned parameter has changed the state, and the host does not know that yet.
    pub(super) states_changed: bool,
    /// The typical sizes of the states that the host has been told of.
    nominals: M::State,
    pub(super) collapse: Option<Collapse<M::Limit>>,
    /// The limit at which the host's last step has ended, where the simulation is to end there. Hosts read
    /// results for the last time before they handle this event.
    pub(super) arrival: Option<Collapse<M::Limit>>,
    pub(super) record: Recording,
    pub(super) account: M::Account,
}

/// What an event has changed.
#[derive(Clone, Debug, PartialEq)]
pub struct Update {
    /// The host is asked to end the simulation.
    pub terminate: bool,
    /// The continuous states have jumped.
    pub states_changed: bool,
    /// The typical sizes of the continuous states have changed.
    pub nominals_changed: bool,
    /// For the host's log.
    pub message: Option<Message>,
}

/// A recording of the extremes from this state on, where the scene asks for one.
fn recording<M: Model>(scene: &M::Scene, time: DoubleDouble, state: &M::State) -> Recording {
    let limits = M::records_extremes(scene).then(|| M::limits(scene));
    Recording::begin(limits, time, M::second_order(state))
}

/// The typical sizes of the states, as a state.
fn nominals<M: Model>(scene: &M::Scene) -> M::State {
    let mut nominals = M::start(scene);
    for place in 0..M::STATES.len() {
        if let Some(component) = M::component(&mut nominals, place) {
            *component = M::nominal(scene, place);
        }
    }
    nominals
}

impl<M: Model> Exchange<M> {
    pub(super) fn new(scene: &M::Scene, time: DoubleDouble) -> Exchange<M> {
        let state = M::start(scene);
        Exchange {
            time,
            state,
            states_changed: false,
            nominals: nominals::<M>(scene),
            collapse: None,
            arrival: None,
            record: recording::<M>(scene, time, &state),
            account: M::Account::begin(scene, time, &state),
        }
    }

    /// The present state and what was recorded up to it.
    pub(super) fn place<'a>(&self) -> Place<'a, M> {
        Place::At {
            state: self.state,
            record: self.record,
            account: self.account,
        }
    }

    /// The collapse that the host reads. Where the simulation is to end, it is there before its event has been
    /// handled.
    pub(super) fn visible_collapse(&self, scene: &M::Scene) -> Option<&Collapse<M::Limit>> {
        let ends = |at: &&Collapse<M::Limit>| M::at_limit(scene, at.limit) == AtLimit::Terminate;
        self.collapse
            .as_ref()
            .or(self.arrival.as_ref().filter(ends))
    }

    /// Begins new recordings at the present.
    pub(super) fn record_anew(&mut self, scene: &M::Scene) {
        self.record = recording::<M>(scene, self.time, &self.state);
    }

    /// Whether the numbers can be those of a motion.
    pub(super) fn is_valid(&self, scene: &M::Scene) -> bool {
        let mut collapses = self.collapse.iter().chain(&self.arrival);
        M::is_finite(&self.state)
            && M::is_finite(&self.nominals)
            && self.time.is_finite()
            && collapses.all(|collapse| collapse.time.is_finite())
            && self.record.is_valid(M::records_extremes(scene))
            && self.account.is_valid()
    }
}

impl<M: Model> Instance<M> {
    fn exchange(&mut self) -> Result<&mut Exchange<M>, Fault> {
        match &mut self.simulation {
            Simulation::Exchange(exchange) => Ok(exchange),
            _ => Err(Fault::error("initialization has not ended".into())),
        }
    }

    /// Begins the handling of an event, unless one is being handled.
    pub fn enter_event_mode(&mut self) {
        if self.phase == Phase::EventMode {
            return;
        }
        self.phase = Phase::EventMode;
        if let Simulation::Exchange(now) = &mut self.simulation {
            now.account.enter_event(&self.scene, now.time, &now.state);
        }
    }

    /// Ends the handling of events.
    pub fn enter_continuous_time(&mut self) {
        self.phase = Phase::ContinuousTime;
        if let Simulation::Exchange(Exchange {
            time,
            state,
            record,
            account,
            ..
        }) = &mut self.simulation
        {
            account.include(&self.scene, *time, state);
            record.include(M::limits(&self.scene), *time, M::second_order(state));
        }
    }

    /// Handles an event: where the stretch has reached a limit, the actuator
    /// collapses.
    ///
    /// # Errors
    /// Error before initialization has ended.
    pub fn new_discrete_states(&mut self) -> Result<Update, Fault> {
        let scene = self.scene.clone();
        let exchange = self.exchange()?;
        exchange.arrival = None;
        let before = std::mem::replace(&mut exchange.nominals, nominals::<M>(&scene));
        let mut update = Update {
            terminate: false,
            states_changed: std::mem::take(&mut exchange.states_changed),
            nominals_changed: exchange.nominals != before,
            message: None,
        };
        if let Some(Collapse { limit, .. }) = exchange.collapse {
            update.terminate = M::at_limit(&scene, limit) == AtLimit::Terminate;
            return Ok(update);
        }
        let Some(limit) = M::limit_reached(&scene, &exchange.time, &exchange.state, REACHED) else {
            return Ok(update);
        };
        let time = exchange.time;
        exchange.collapse = Some(Collapse { limit, time });
        let text = M::describe(&scene, limit, time.value());
        let choice = M::choice(limit);
        let consequence = match M::at_limit(&scene, limit) {
            AtLimit::Hold => {
                update.states_changed = true;
                format!("it stays there ({choice} = hold)")
            }
            AtLimit::Terminate => {
                update.terminate = true;
                format!("the simulation should end here ({choice} = terminate)")
            }
        };
        if update.states_changed {
            let state = M::state(&self.view());
            self.exchange()?.state = state;
        }
        update.message = Some(Message {
            warning: false,
            text: format!("{text}; {consequence}"),
        });
        Ok(update)
    }

    /// Whether an event is to be handled after this step of the host's integrator, whose search for events may
    /// have missed a limit. Where the simulation is to end there, the collapse can be read from now on.
    ///
    /// # Errors
    /// Error before initialization has ended.
    pub fn completed_integrator_step(&mut self) -> Result<bool, Fault> {
        let scene = self.scene.clone();
        let exchange = self.exchange()?;
        let (time, state) = (exchange.time, exchange.state);
        if exchange.collapse.is_some() {
            return Ok(false);
        }
        let motion = M::second_order(&state);
        exchange
            .record
            .include_step(M::limits(&scene), time, motion);
        let event = exchange.account.include_step(&scene, time, &state);
        exchange.arrival = M::limit_reached(&scene, &time, &state, REACHED)
            .filter(|&limit| M::at_limit(&scene, limit) == AtLimit::Terminate)
            .map(|limit| Collapse { limit, time });
        Ok(event
            || exchange.arrival.is_some()
            || M::limit_reached(&scene, &time, &state, 0.0).is_some())
    }

    /// Sets the time of the model.
    ///
    /// # Errors
    /// Error for a time that is not finite.
    pub fn set_time(&mut self, time: f64) -> Result<(), Fault> {
        check_time("time", time)?;
        let exchange = self.exchange()?;
        exchange.time = DoubleDouble::new(time);
        exchange.arrival = None;
        Ok(())
    }

    /// Sets the continuous states, in the order of [`Model::STATES`].
    ///
    /// # Errors
    /// Error for another count than there are states, or a number that is not finite.
    pub fn set_continuous_states(&mut self, states: &[f64]) -> Result<(), Fault> {
        let count = M::STATES.len();
        if states.len() != count {
            return Err(wrong_count("continuous states", states.len(), count));
        }
        if let Some(bad) = states.iter().find(|state| !state.is_finite()) {
            return Err(Fault::error(format!(
                "the continuous state {} is not a finite number",
                Shortest(*bad)
            )));
        }
        let exchange = self.exchange()?;
        exchange.arrival = None;
        for (place, &value) in states.iter().enumerate() {
            if let Some(component) = M::component(&mut exchange.state, place) {
                *component = value;
            }
        }
        Ok(())
    }

    /// The continuous states, in the order of [`Model::STATES`].
    ///
    /// # Errors
    /// Error for another count than there are states.
    pub fn continuous_states(&self, states: &mut [f64]) -> Result<(), Fault> {
        self.read_rows("continuous states", M::STATES, states)
    }

    /// The derivatives of the continuous states.
    ///
    /// # Errors
    /// Error for another count than there are states; Discard where the model has no
    /// motion from the present state on.
    pub fn derivatives(&self, derivatives: &mut [f64]) -> Result<(), Fault> {
        self.read_rows("derivatives", M::DERIVATIVES, derivatives)?;
        M::check_state(&self.view())
            .map_err(|why| Fault::discard(format!("{why}; try a shorter step")))
    }

    /// The event indicators of the model.
    ///
    /// # Errors
    /// Error for another count than [`Model::INDICATOR_COUNT`]; Discard where an indicator leads beyond the
    /// largest number.
    pub fn event_indicators(&self, indicators: &mut [f64]) -> Result<(), Fault> {
        let count = indicators.len();
        if count != M::INDICATOR_COUNT {
            return Err(wrong_count("event indicators", count, M::INDICATOR_COUNT));
        }
        let view = self.view();
        M::indicators(&view, indicators);
        if indicators.iter().all(|indicator| indicator.is_finite()) {
            return Ok(());
        }
        Err(cannot_be_worked_out(&view, "an event indicator"))
    }

    /// The typical sizes of the continuous states.
    ///
    /// # Errors
    /// Error for another count than there are states.
    pub fn nominals_of_states(&self, nominals: &mut [f64]) -> Result<(), Fault> {
        let count = M::STATES.len();
        if nominals.len() != count {
            return Err(wrong_count("nominals", nominals.len(), count));
        }
        for (place, value) in nominals.iter_mut().enumerate() {
            *value = M::nominal(&self.scene, place);
        }
        Ok(())
    }

    fn read_rows(&self, what: &str, rows: &[u32], values: &mut [f64]) -> Result<(), Fault> {
        if values.len() != rows.len() {
            return Err(wrong_count(what, values.len(), rows.len()));
        }
        let view = self.view();
        for (value, &row) in values.iter_mut().zip(rows) {
            *value = M::VARIABLES[row as usize].value(&view);
        }
        Ok(())
    }
}

fn wrong_count(what: &str, given: usize, right: usize) -> Fault {
    Fault::error(format!(
        "the array is for {given} {what}; the model has {right}"
    ))
}
