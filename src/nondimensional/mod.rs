//! The nondimensional actuator of the paper as a [`Model`]: its table of variables and the
//! physics behind it.

pub mod scene;
mod table;
pub mod view;

pub use table::{ALIASES, VARIABLES};

use serde::{Deserialize, Serialize};

use crate::arithmetic::double_double::DoubleDouble;
use crate::arithmetic::jet::{Dual, TimeSeries};
use crate::arithmetic::number::Number;
use crate::description::guid;
use crate::model::variables::{self, Alias, Variable};
use crate::model::{AtLimit, DefaultExperiment, Direction, Model, View};
use crate::nondimensional::scene::Scene;
use crate::nondimensional::view::{Quantities, Sample};
use crate::shortest::Shortest;
use crate::solver::State;
use crate::solver::extremes::Extremes;
use crate::solver::limits::{Limit, Limits};
use crate::solver::trajectory::Trajectory;

/// The marker of the model.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Nondimensional;

/// Stretches below this, stretches and rates above its inverse, are none of a motion.
const FAR: f64 = 1e-20;

impl Model for Nondimensional {
    const IDENTIFIER: &'static str = "DielectricElastomerActuator";
    const DESCRIPTION: &'static str = env!("CARGO_PKG_DESCRIPTION");
    const GUID: &'static str = guid::text(&GUID);
    const VARIABLES: &'static [Variable<Nondimensional>] = &VARIABLES;
    const ALIASES: &'static [Alias] = &ALIASES;
    const INPUTS: &'static [u32] = &variables::inputs::<Nondimensional, 2>(&VARIABLES);
    const STATES: &'static [u32] = &variables::states::<Nondimensional, 2>(&VARIABLES);
    const DERIVATIVES: &'static [u32] = &variables::derivatives::<Nondimensional, 2>(&VARIABLES);
    /// λ − λ_min and λ_max − λ.
    const INDICATOR_COUNT: usize = 2;
    const EXPERIMENT: DefaultExperiment = DefaultExperiment {
        stop_time: 100.0,
        step_size: 0.1,
    };

    type Scene = Scene;
    type State = State;
    type Integration = Trajectory;
    type Account = ();
    type Limit = Limit;
    type Sample<N: Number> = Sample<N>;

    fn blank() -> Scene {
        Scene::BLANK
    }

    fn inputs_are_finite(scene: &Scene) -> bool {
        scene.drive.is_finite()
    }

    fn check_start(scene: &Scene) -> Result<(), String> {
        let start = scene.start.position;
        let limits = scene.limits;
        if limits.lower < start && start < limits.upper {
            return Ok(());
        }
        Err(format!(
            "lambda_start = {} does not lie between lambda_min = {} and lambda_max = {}; \
             set it, or the limits, so that it does",
            Shortest(start),
            Shortest(limits.lower),
            Shortest(limits.upper)
        ))
    }

    #[inline]
    fn start(scene: &Scene) -> State {
        scene.start
    }

    #[inline]
    fn rebase_inputs(scene: &mut Scene, time: DoubleDouble) {
        scene.drive.rebase(time);
    }

    #[inline]
    fn begin_inputs(scene: &mut Scene, time: DoubleDouble) {
        scene.drive.since = time;
    }

    #[inline]
    fn inputs_since(scene: &Scene) -> &DoubleDouble {
        &scene.drive.since
    }

    fn depends_on_time(scene: &Scene) -> bool {
        !scene.drive.is_constant()
    }

    #[inline]
    fn at_limit(scene: &Scene, _limit: Limit) -> AtLimit {
        scene.at_limit()
    }

    fn describe(scene: &Scene, limit: Limit, time: f64) -> String {
        let time = Shortest(time);
        let [lower, upper] = [scene.limits.lower, scene.limits.upper].map(Shortest);
        match limit {
            Limit::Upper => format!(
                "the actuator was pulled in: at time {time} its stretch reached lambda_max = {upper}"
            ),
            Limit::Lower => format!(
                "the actuator collapsed: at time {time} its stretch came down to lambda_min = {lower}"
            ),
        }
    }

    fn limit_reached(
        scene: &Scene,
        _time: &DoubleDouble,
        state: &State,
        tolerance: f64,
    ) -> Option<Limit> {
        scene.limits.reached(state, tolerance)
    }

    /// λ − λ_min and λ_max − λ, of which one vanishes where the actuator collapses; once it has,
    /// nothing is awaited any more and both stay at λ_max − λ_min.
    fn indicators(view: &View<Nondimensional>, indicators: &mut [f64]) {
        let limits = view.scene.limits;
        let stretch = view.stretch();
        let width = limits.upper - limits.lower;
        let (lower, upper) = if view.collapse.is_some() {
            (width, width)
        } else {
            (stretch - limits.lower, limits.upper - stretch)
        };
        indicators.copy_from_slice(&[lower, upper]);
    }

    fn is_finite(state: &State) -> bool {
        state.position.is_finite() && state.rate.is_finite()
    }

    #[inline]
    fn component(state: &mut State, place: usize) -> Option<&mut f64> {
        match place {
            0 => Some(&mut state.position),
            1 => Some(&mut state.rate),
            _ => None,
        }
    }

    fn second_order(state: &State) -> State {
        *state
    }

    fn limits(scene: &Scene) -> Limits {
        scene.limits
    }

    fn records_extremes(scene: &Scene) -> bool {
        scene.records_extremes()
    }

    fn extremes(view: &View<Nondimensional>) -> Option<Extremes> {
        view.extremes()
    }

    #[inline]
    fn window(scene: &Scene) -> f64 {
        scene.extremes_window
    }

    fn check_state(view: &View<Nondimensional>) -> Result<(), String> {
        let State { position, rate } = view.state();
        if position > 0.0 && view.stretch_acceleration().is_finite() {
            return Ok(());
        }
        let [stretch, speed] = [position, rate].map(Shortest);
        Err(if !(FAR..1.0 / FAR).contains(&position) {
            format!("there is no motion at the stretch {stretch}")
        } else if rate.abs() > 1.0 / FAR {
            format!("there is no motion at the stretch rate {speed}")
        } else {
            format!("there is no motion at the stretch {stretch} and its rate {speed}")
        })
    }

    fn state(view: &View<Nondimensional>) -> State {
        view.state()
    }

    fn along(view: &View<Nondimensional>, direction: &Direction<Nondimensional>) -> Sample<Dual> {
        Sample::along(view.scene, *view.time, view.state(), view.held(), direction)
    }

    fn from_now_on(view: &View<Nondimensional>, order: usize) -> Sample<TimeSeries> {
        Sample::from_now_on(view.scene, *view.time, view.state(), view.held(), order)
    }
}

const GUID: guid::Text = guid::of::<Nondimensional>();

/// An instance of the nondimensional actuator.
pub type Instance = crate::instance::Instance<Nondimensional>;

/// Value reference of a variable, by its name.
#[must_use]
pub fn value_reference(name: &str) -> Option<u32> {
    variables::value_reference::<Nondimensional>(name)
}

impl Scene {
    /// The scene in which each variable has its start value.
    #[must_use]
    pub fn at_start() -> Scene {
        <Nondimensional as Model>::at_start()
    }
}
