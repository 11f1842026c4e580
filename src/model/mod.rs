//! What a model says, so that an instance, its description and its C functions can be made of it.
//!
//! A model is a table of variables and the physics behind it. Everything that concerns FMI is
//! written once, over this trait: adding a model adds nothing there.

mod recording;
pub mod variables;

pub use recording::Recording;

use std::cell::OnceCell;
use std::fmt::Debug;

use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

use self::variables::{Alias, Kind, Variable};
use crate::arithmetic::double_double::DoubleDouble;
use crate::arithmetic::jet::{Dual, TimeSeries};
use crate::arithmetic::number::Number;
use crate::shortest::Shortest;
use crate::solver::State;
use crate::solver::extremes::Extremes;
use crate::solver::limits::Limits;
use crate::solver::trajectory::{Failure, Progress};

/// A model: a marker type that names its table and its physics.
pub trait Model: Copy + Debug + PartialEq + 'static {
    /// The name of the FMU and of the binary in it.
    const IDENTIFIER: &'static str;

    /// What it is, in one line.
    const DESCRIPTION: &'static str;

    /// A hash of the description, which ties the binary to it.
    const GUID: &'static str;

    /// The variables; the position of a row is its value reference.
    const VARIABLES: &'static [Variable<Self>];

    /// Further names of variables.
    const ALIASES: &'static [Alias] = &[];

    /// Value references of the inputs.
    const INPUTS: &'static [u32];

    /// Value references of the continuous states.
    const STATES: &'static [u32];

    /// Value references of their derivatives, in the same order.
    const DERIVATIVES: &'static [u32];

    /// The number of event indicators.
    const INDICATOR_COUNT: usize;

    /// The experiment that a host proposes to its user.
    const EXPERIMENT: DefaultExperiment;

    /// Everything that a host sets.
    type Scene: Clone + Debug + PartialEq + Serialize + DeserializeOwned;

    /// The continuous states.
    type State: Copy + Debug + PartialEq + Serialize + DeserializeOwned;

    /// The motion, where the model integrates it itself.
    type Integration: Integration<Self>;

    /// What is recorded beside the extremes of a motion that the host integrates.
    type Account: Account<Self>;

    /// Where a motion ends.
    type Limit: Copy + Debug + PartialEq + Serialize + DeserializeOwned;

    /// The quantities that can be differentiated, as numbers that carry derivatives along.
    type Sample<N: Number>;

    /// A scene with every number 0, to be filled in.
    fn blank() -> Self::Scene;

    /// A scene with each variable at its start value.
    #[must_use]
    fn at_start() -> Self::Scene {
        crate::model::variables::at_start::<Self>(Self::blank())
    }

    /// Whether the inputs are polynomials in finite numbers.
    fn inputs_are_finite(scene: &Self::Scene) -> bool;

    /// Checks, at the end of initialization, what no single variable can tell.
    ///
    /// # Errors
    /// A message that says which value does not go with which other.
    fn check_start(scene: &Self::Scene) -> Result<(), String>;

    /// Checks that the settings do not exclude each other, also where the host tunes them later.
    ///
    /// # Errors
    /// A message that says which value does not go with which other.
    fn check_settings(_scene: &Self::Scene) -> Result<(), String> {
        Ok(())
    }

    /// The state at the start time.
    fn start(scene: &Self::Scene) -> Self::State;

    /// Counts the time of the inputs from `time` on; the inputs stay the same functions of time.
    fn rebase_inputs(scene: &mut Self::Scene, time: DoubleDouble);

    /// Makes the time of the inputs count from `time`; their numbers are kept.
    fn begin_inputs(scene: &mut Self::Scene, time: DoubleDouble);

    /// The time from which that of the inputs counts.
    fn inputs_since(scene: &Self::Scene) -> &DoubleDouble;

    /// Whether what drives the motion depends on time.
    fn depends_on_time(scene: &Self::Scene) -> bool;

    /// What happens at a limit.
    fn at_limit(scene: &Self::Scene, limit: Self::Limit) -> AtLimit;

    /// The name of the variable that chooses what happens at a limit.
    fn choice(_limit: Self::Limit) -> &'static str {
        "on_pull_in"
    }

    /// What has happened at a limit, in words, the time included.
    fn describe(scene: &Self::Scene, limit: Self::Limit, time: f64) -> String;

    /// The limit that lies less than `tolerance`, relative to it, before a state that moves
    /// towards it, or behind the state.
    fn limit_reached(
        scene: &Self::Scene,
        time: &DoubleDouble,
        state: &Self::State,
        tolerance: f64,
    ) -> Option<Self::Limit>;

    /// Writes the event indicators, as many as [`Model::INDICATOR_COUNT`].
    fn indicators(view: &View<Self>, indicators: &mut [f64]);

    /// Whether the numbers can be those of a state.
    fn is_finite(state: &Self::State) -> bool;

    /// The component of a state that is the `place`-th of [`Model::STATES`].
    fn component(state: &mut Self::State, place: usize) -> Option<&mut f64>;

    /// Position and rate of the second-order equation.
    fn second_order(state: &Self::State) -> State;

    /// The positions between which the motion is followed.
    fn limits(scene: &Self::Scene) -> Limits;

    /// Whether the extremes of the position are recorded.
    fn records_extremes(scene: &Self::Scene) -> bool;

    /// The extremes of the position since their recording began, where they are recorded.
    fn extremes(view: &View<Self>) -> Option<Extremes>;

    /// The number of the window over which something is recorded; a change of it starts the
    /// records anew.
    fn window(_scene: &Self::Scene) -> f64 {
        0.0
    }

    /// Checks that there is a motion from the present state. There is none where the host's
    /// integrator has tried a state that is too far out.
    ///
    /// # Errors
    /// A message that names the value.
    fn check_state(view: &View<Self>) -> Result<(), String>;

    /// The setting that leads results beyond the largest number, or the integration into steps that are too
    /// short, where the model knows one: its value, the limit, and what to do.
    fn excess(_view: &View<Self>) -> Option<String> {
        None
    }

    /// The present state.
    fn state(view: &View<Self>) -> Self::State;

    /// The present state, where the host tunes parameters to those of `scene`: what becomes a state
    /// by that has the value that it has.
    fn state_tuned_to(view: &View<Self>, _scene: &Self::Scene) -> Self::State {
        Self::state(view)
    }

    /// The typical size of a state, by its place, of the actuator of a scene.
    fn nominal(_scene: &Self::Scene, place: usize) -> f64 {
        match Self::VARIABLES[Self::STATES[place] as usize].kind {
            Kind::Real { nominal, .. } => nominal,
            Kind::Boolean | Kind::Enumeration(_) => 1.0,
        }
    }

    /// The present as it changes in a direction.
    fn along(view: &View<Self>, direction: &Direction<Self>) -> Self::Sample<Dual>;

    /// The motion from now on, as power series in time that are right up to the derivatives of
    /// `order`.
    fn from_now_on(view: &View<Self>, order: usize) -> Self::Sample<TimeSeries>;
}

/// A motion that the model integrates, from communication point to communication point.
pub trait Integration<M: Model>: Clone + Debug + Serialize + DeserializeOwned {
    /// The motion of a scene from its start at `time` on.
    fn begin(scene: &M::Scene, time: &DoubleDouble, tolerance: f64) -> Self;

    /// Follows the motion for the time `step` > 0 from `clock`, the time to which it has come, and
    /// moves the clock to where it has come then. The scene is the same as in the calls before,
    /// back to the last [`Integration::restart`].
    ///
    /// # Errors
    /// [`Failure`] where the integration cannot go on; the motion then stands where it ended.
    fn advance(
        &mut self,
        scene: &M::Scene,
        clock: &mut DoubleDouble,
        step: f64,
    ) -> Result<Progress<M::Limit>, Failure>;

    /// The scene is not what has been followed any more: what is read before the next step follows it.
    fn scene_changed(&mut self) {}

    /// Takes over a changed scene at `time` where the actuator is held in its state.
    fn rest(&mut self, _scene: &M::Scene, _time: &DoubleDouble) {}

    /// Starts anew from the present state: the scene has changed.
    fn restart(&mut self);

    /// Starts what it records anew, at the present.
    fn record_anew(&mut self, scene: &M::Scene);

    /// The present state, where it lies stored as finite numbers: found out and copied without
    /// floating-point operations.
    #[inline]
    fn stored_state(&self) -> Option<M::State> {
        None
    }

    /// Whether the numbers fit together as those of a motion of the scene: to be checked where
    /// they do not come from this process.
    fn is_valid(&self, scene: &M::Scene, tolerance: f64) -> bool;

    /// Where the motion is, in words, for messages.
    fn whereabouts(&self) -> String;
}

/// What is recorded, beside the extremes, of a motion that the host integrates in steps of its own.
pub trait Account<M: Model>:
    Copy + Debug + Default + PartialEq + Serialize + DeserializeOwned
{
    /// Records from this state on.
    fn begin(scene: &M::Scene, time: DoubleDouble, state: &M::State) -> Self;

    /// Records the host's step that has come to this state. Returns whether an event is to be handled there.
    fn include_step(&mut self, scene: &M::Scene, time: DoubleDouble, state: &M::State) -> bool;

    /// An event begins, in this state and with the inputs that have led to it.
    fn enter_event(&mut self, _scene: &M::Scene, _time: DoubleDouble, _state: &M::State) {}

    /// The event has ended. Records this state alone: it, or an input, may have jumped.
    fn include(&mut self, scene: &M::Scene, time: DoubleDouble, state: &M::State);

    /// Whether the numbers can be those of an account.
    fn is_valid(&self) -> bool;
}

/// Nothing is recorded.
impl<M: Model> Account<M> for () {
    fn begin(_scene: &M::Scene, _time: DoubleDouble, _state: &M::State) {}

    fn include_step(&mut self, _scene: &M::Scene, _time: DoubleDouble, _state: &M::State) -> bool {
        false
    }

    fn include(&mut self, _scene: &M::Scene, _time: DoubleDouble, _state: &M::State) {}

    fn is_valid(&self) -> bool {
        true
    }
}

/// What a host does with a model at first.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DefaultExperiment {
    /// Stop time.
    pub stop_time: f64,
    /// Communication step.
    pub step_size: f64,
}

/// What happens where a motion reaches a limit.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum AtLimit {
    /// It stays at the limit, and communication steps go on.
    Hold,
    /// The host is asked to end the simulation.
    Terminate,
}

impl AtLimit {
    /// Its number as an item of an enumeration: 1 for hold, 2 for terminate.
    #[must_use]
    pub fn item(self) -> f64 {
        match self {
            AtLimit::Hold => 1.0,
            AtLimit::Terminate => 2.0,
        }
    }

    /// The one of this number, 1 or 2.
    #[must_use]
    pub fn of_item(item: f64) -> AtLimit {
        if item == 2.0 {
            AtLimit::Terminate
        } else {
            AtLimit::Hold
        }
    }
}

/// The limit that a motion has reached, and when.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Collapse<L> {
    /// The limit.
    pub limit: L,
    /// Time of the model.
    pub time: DoubleDouble,
}

/// Where the state of the motion is known from.
pub enum Place<'a, M: Model> {
    /// It is this one: at the start, or where the host integrates.
    At {
        /// The state.
        state: M::State,
        /// What is recorded of the motion to it: the extremes,
        record: Recording,
        /// and what else.
        account: M::Account,
    },
    /// The present of this motion.
    On(&'a M::Integration),
}

/// What a host can read in one call at the present communication point. Each quantity is computed when it is
/// read, and only then. Those that are computed together are kept for the rest of the call.
pub struct View<'a, M: Model> {
    /// What the host has set.
    pub scene: &'a M::Scene,
    /// The state of the motion.
    pub place: Place<'a, M>,
    /// Time of the model.
    pub time: &'a DoubleDouble,
    /// Whether and when the motion came to a limit.
    pub collapse: Option<&'a Collapse<M::Limit>>,
    /// The quantities that are computed together, once one of them was read.
    pub(crate) sample: OnceCell<M::Sample<f64>>,
}

impl<M: Model> Place<'_, M> {
    /// A state of which nothing else is known.
    pub fn of_state(time: DoubleDouble, state: M::State) -> Self {
        Place::At {
            state,
            record: Recording::begin(None, time, M::second_order(&state)),
            account: M::Account::default(),
        }
    }
}

// Derived, these would ask the motion to be copied too.
impl<M: Model> Clone for Place<'_, M> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<M: Model> Copy for Place<'_, M> {}

impl<'a, M: Model> View<'a, M> {
    /// What can be read there.
    #[inline]
    #[must_use]
    pub fn new(
        scene: &'a M::Scene,
        place: Place<'a, M>,
        time: &'a DoubleDouble,
        collapse: Option<&'a Collapse<M::Limit>>,
    ) -> Self {
        View {
            scene,
            place,
            time,
            collapse,
            sample: OnceCell::new(),
        }
    }

    /// A result by its value reference, with its value, for messages.
    #[must_use]
    pub fn in_words(&self, reference: u32) -> String {
        let variable = &M::VARIABLES[reference as usize];
        format!("{} = {}", variable.name, Shortest(variable.value(self)))
    }

    /// The present state, for messages.
    #[must_use]
    pub fn state_in_words(&self) -> String {
        let states = M::STATES.iter().map(|state| self.in_words(*state));
        states.collect::<Vec<_>>().join(", ")
    }
}

/// A direction in which the scene and the state may change: each number is the rate of change of
/// the one in its place.
#[derive(Clone, Debug)]
pub struct Direction<M: Model> {
    /// Changes of what the host sets.
    pub scene: M::Scene,
    /// Change of the present state.
    pub state: M::State,
    /// After initialization a frequency changes from now on: the angle stays as it is.
    pub from_now_on: bool,
}
