//! Model exchange: the host integrates the motion, the actuator gives the
//! derivatives of its state and handles the collapse as an event.

use serde::{Deserialize, Serialize};

use super::phase::Phase;
use super::run::describe_collapse;
use super::{Course, Event, Fault, Instance};
use crate::scene::{OnPullIn, Scene};
use crate::solver::State;
use crate::solver::double::Double;
use crate::solver::limits::Limit;
use crate::variables::{Access, DERIVATIVES, Kind, STATES, VARIABLES};
use crate::view::{Collapse, Quantities};

/// Number of continuous states, λ and dλ/dt.
pub const STATE_COUNT: usize = STATES.len();

/// Number of event indicators: λ − λ_min and λ_max − λ.
pub const INDICATOR_COUNT: usize = 2;

/// A host finds the crossing of a limit to a tolerance, from either side of it:
/// closer than this part of the limit it has been reached.
const REACHED: f64 = 1e-9;

/// The moment up to which the host has integrated.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Exchange {
    pub(super) time: Double,
    pub(super) state: State,
    pub(super) collapse: Option<Collapse>,
}

/// What an event has changed.
#[derive(Clone, Debug, PartialEq)]
pub struct Update {
    /// The host is asked to end the simulation.
    pub terminate: bool,
    /// The continuous states have jumped.
    pub states_changed: bool,
    /// Something for the host's log.
    pub event: Option<Event>,
}

impl Exchange {
    pub(super) fn new(scene: &Scene, time: Double) -> Exchange {
        Exchange {
            time,
            state: scene.start,
            collapse: None,
        }
    }

    /// Whether the numbers can be those of a motion.
    pub(super) fn is_sound(&self) -> bool {
        let State { position, rate } = self.state;
        let collapsed = self.collapse.map_or(Double::ZERO, |collapse| collapse.time);
        position.is_finite() && rate.is_finite() && self.time.is_finite() && collapsed.is_finite()
    }

    /// The limit that lies less than `tolerance`, relative to it, before the
    /// stretch, which moves towards it, or behind the stretch.
    fn limit_reached(&self, scene: &Scene, tolerance: f64) -> Option<Limit> {
        let State { position, rate } = self.state;
        let limits = scene.limits;
        let margin = |toward: f64| if toward > 0.0 { tolerance } else { 0.0 };
        if position >= limits.upper * (1.0 - margin(rate)) {
            Some(Limit::Upper)
        } else if position <= limits.lower * (1.0 + margin(-rate)) {
            Some(Limit::Lower)
        } else {
            None
        }
    }
}

impl Instance {
    fn exchange(&mut self) -> Result<&mut Exchange, Fault> {
        match &mut self.course {
            Course::Exchange(exchange) => Ok(exchange),
            _ => Err(Fault::error("the initialization has not been ended".into())),
        }
    }

    /// Begins the handling of an event.
    pub fn enter_event_mode(&mut self) {
        self.phase = Phase::EventMode;
    }

    /// Ends the handling of events.
    pub fn enter_continuous_time(&mut self) {
        self.phase = Phase::ContinuousTime;
    }

    /// Handles an event: where the stretch has reached a limit, the actuator
    /// collapses.
    ///
    /// # Errors
    /// Error before initialization has ended.
    pub fn new_discrete_states(&mut self) -> Result<Update, Fault> {
        let scene = self.scene;
        let exchange = self.exchange()?;
        let mut update = Update {
            terminate: exchange.collapse.is_some() && scene.on_pull_in == OnPullIn::Terminate,
            states_changed: false,
            event: None,
        };
        if exchange.collapse.is_some() {
            return Ok(update);
        }
        let Some(limit) = exchange.limit_reached(&scene, REACHED) else {
            return Ok(update);
        };
        let time = exchange.time;
        exchange.collapse = Some(Collapse { limit, time });
        let text = describe_collapse(&scene, limit, time.value());
        let consequence = match scene.on_pull_in {
            OnPullIn::Hold => {
                update.states_changed = true;
                "it stays there (on_pull_in = hold)"
            }
            OnPullIn::Terminate => {
                update.terminate = true;
                "the simulation should end here (on_pull_in = terminate)"
            }
        };
        if update.states_changed {
            let state = self.view().state();
            self.exchange()?.state = state;
        }
        update.event = Some(Event {
            warning: false,
            text: format!("{text}; {consequence}"),
        });
        Ok(update)
    }

    /// Whether an event is to be handled after this step of the host's
    /// integrator: its search for events may have missed that a limit was passed.
    ///
    /// # Errors
    /// Error before initialization has ended.
    pub fn completed_integrator_step(&mut self) -> Result<bool, Fault> {
        let scene = self.scene;
        let exchange = self.exchange()?;
        Ok(exchange.collapse.is_none() && exchange.limit_reached(&scene, 0.0).is_some())
    }

    /// Sets the time of the model.
    ///
    /// # Errors
    /// Error for a time that is not finite.
    pub fn set_time(&mut self, time: f64) -> Result<(), Fault> {
        if !time.is_finite() {
            return Err(Fault::error(format!(
                "the time {time} is not a finite number"
            )));
        }
        self.exchange()?.time = Double::new(time);
        Ok(())
    }

    /// Sets stretch and stretch rate.
    ///
    /// # Errors
    /// Error for another count than [`STATE_COUNT`] or a number that is not finite.
    pub fn set_continuous_states(&mut self, states: &[f64]) -> Result<(), Fault> {
        let &[position, rate] = states else {
            return Err(wrong_count("continuous states", states.len(), STATE_COUNT));
        };
        if let Some(bad) = states.iter().find(|state| !state.is_finite()) {
            return Err(Fault::error(format!(
                "the continuous state {bad} is not a finite number"
            )));
        }
        self.exchange()?.state = State { position, rate };
        Ok(())
    }

    /// Stretch and stretch rate.
    ///
    /// # Errors
    /// Error for another count than [`STATE_COUNT`].
    pub fn continuous_states(&self, states: &mut [f64]) -> Result<(), Fault> {
        self.read_rows("continuous states", STATES, states)
    }

    /// The derivatives of the continuous states.
    ///
    /// # Errors
    /// Error for another count than [`STATE_COUNT`]; Discard where the stretch
    /// is not positive, or so far out that the derivatives are no numbers.
    pub fn derivatives(&self, derivatives: &mut [f64]) -> Result<(), Fault> {
        self.read_rows("derivatives", DERIVATIVES, derivatives)?;
        let stretch = self.view().stretch();
        if stretch > 0.0 && derivatives.iter().all(|value| value.is_finite()) {
            return Ok(());
        }
        Err(Fault::discard(format!(
            "there is no motion at the stretch {stretch}; try a shorter step"
        )))
    }

    /// λ − λ_min and λ_max − λ, of which one vanishes where the actuator
    /// collapses; once it has, nothing is awaited any more and both stay at
    /// λ_max − λ_min.
    ///
    /// # Errors
    /// Error for another count than [`INDICATOR_COUNT`].
    pub fn event_indicators(&self, indicators: &mut [f64]) -> Result<(), Fault> {
        let count = indicators.len();
        let [lower, upper] = indicators else {
            return Err(wrong_count("event indicators", count, INDICATOR_COUNT));
        };
        let (view, limits) = (self.view(), self.scene.limits);
        let stretch = view.stretch();
        (*lower, *upper) = if view.collapse.is_some() {
            let width = limits.upper - limits.lower;
            (width, width)
        } else {
            (stretch - limits.lower, limits.upper - stretch)
        };
        Ok(())
    }

    /// The typical sizes of the continuous states.
    ///
    /// # Errors
    /// Error for another count than [`STATE_COUNT`].
    pub fn nominals_of_states(&self, nominals: &mut [f64]) -> Result<(), Fault> {
        if nominals.len() != STATE_COUNT {
            return Err(wrong_count("nominals", nominals.len(), STATE_COUNT));
        }
        for (value, row) in nominals.iter_mut().zip(STATES) {
            if let Kind::Real { nominal, .. } = VARIABLES[row as usize].kind {
                *value = nominal;
            }
        }
        Ok(())
    }

    fn read_rows(
        &self,
        what: &str,
        rows: [u32; STATE_COUNT],
        values: &mut [f64],
    ) -> Result<(), Fault> {
        if values.len() != STATE_COUNT {
            return Err(wrong_count(what, values.len(), STATE_COUNT));
        }
        let view = self.view();
        for (value, row) in values.iter_mut().zip(rows) {
            if let Access::Result { get, .. } = VARIABLES[row as usize].access {
                *value = get(&view);
            }
        }
        Ok(())
    }
}

fn wrong_count(what: &str, given: usize, right: usize) -> Fault {
    Fault::error(format!(
        "room for {given} {what} was given; there are {right}"
    ))
}
