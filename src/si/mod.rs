//! The real actuator in SI units as a [`Model`]: its table of variables and the physics behind
//! it. The equations are those of the nondimensional core; only `actuator::scales` converts units.

mod account;
mod along;
mod check;
mod folded;
mod motion;
mod sample;
mod scene;
mod table;
mod thresholds;
mod trajectory;
mod view;

use folded::Folded;

pub use account::SiAccount;
pub use motion::SiMotion;
pub use sample::Sample;
pub use scene::{OnBreakdown, SiScene, SiState};
pub use table::{ALIASES, VARIABLES};

use serde::{Deserialize, Serialize};

use crate::arithmetic::double_double::DoubleDouble;
use crate::arithmetic::jet::{Dual, TimeSeries};
use crate::arithmetic::number::Number;
use crate::description::guid;
use crate::model::variables::{self, Alias, Kind, Variable};
use crate::model::{AtLimit, DefaultExperiment, Direction, Model, Place, View};
use crate::shortest::Shortest;
use crate::solver::State;
use crate::solver::extremes::Extremes;
use crate::solver::limits::{Limit, Limits};

/// The marker of the model.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Si;

/// Where a motion ends.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum SiLimit {
    /// At a limit of the stretch.
    Stretch(Limit),
    /// At breakdown.
    Breakdown,
}

/// Breakdown counts as reached where the margin is below this part of the breakdown field: a host locates
/// events to a tolerance.
const REACHED: f64 = 1e-9;

/// Continuous states: λ, dλ/dt, the charge and three dashpots.
const STATE_COUNT: usize = 6;

impl Model for Si {
    const IDENTIFIER: &'static str = "DielectricElastomerActuatorSI";
    const DESCRIPTION: &'static str = "A dielectric elastomer actuator in SI units, with an electrical and a mechanical port, \
         losses, strain stiffening and breakdown";
    const GUID: &'static str = guid::text(&GUID);
    const VARIABLES: &'static [Variable<Si>] = &VARIABLES;
    const ALIASES: &'static [Alias] = &ALIASES;
    const INPUTS: &'static [u32] = &variables::inputs::<Si, 4>(&VARIABLES);
    const STATES: &'static [u32] = &variables::states::<Si, STATE_COUNT>(&VARIABLES);
    const DERIVATIVES: &'static [u32] = &variables::derivatives::<Si, STATE_COUNT>(&VARIABLES);
    /// λ − λ_min, λ_max − λ, and the margin of the true field to breakdown as a part of the breakdown field.
    const INDICATOR_COUNT: usize = 3;
    /// Some periods of the actuator with the start values.
    const EXPERIMENT: DefaultExperiment = DefaultExperiment {
        stop_time: 3e-5,
        step_size: 1e-7,
    };

    type Scene = SiScene;
    type State = SiState;
    type Integration = SiMotion;
    type Account = SiAccount;
    type Limit = SiLimit;
    type Sample<N: Number> = Sample<N>;

    fn blank() -> SiScene {
        SiScene::blank()
    }

    fn inputs_are_finite(scene: &SiScene) -> bool {
        scene.since.is_finite()
            && scene.lead.is_finite()
            && scene.force.is_finite()
            && scene.sources.iter().all(|source| source.is_finite())
    }

    fn check_start(scene: &SiScene) -> Result<(), String> {
        scene.check()
    }

    fn start(scene: &SiScene) -> SiState {
        scene.start
    }

    fn rebase_inputs(scene: &mut SiScene, time: DoubleDouble) {
        let shift = time.since(scene.since);
        scene.since = time;
        scene.force.shift(shift);
        for source in &mut scene.sources {
            source.shift(shift);
        }
    }

    fn begin_inputs(scene: &mut SiScene, time: DoubleDouble) {
        scene.since = time;
    }

    fn inputs_since(scene: &SiScene) -> &DoubleDouble {
        &scene.since
    }

    fn depends_on_time(scene: &SiScene) -> bool {
        scene.depends_on_time()
    }

    fn at_limit(scene: &SiScene, limit: SiLimit) -> AtLimit {
        match limit {
            SiLimit::Stretch(_) => scene.at_pull_in(),
            SiLimit::Breakdown if scene.at_breakdown() == OnBreakdown::Terminate => {
                AtLimit::Terminate
            }
            SiLimit::Breakdown => AtLimit::Hold,
        }
    }

    fn choice(limit: SiLimit) -> &'static str {
        match limit {
            SiLimit::Stretch(_) => "on_pull_in",
            SiLimit::Breakdown => "on_breakdown",
        }
    }

    fn describe(scene: &SiScene, limit: SiLimit, time: f64) -> String {
        let time = Shortest(time);
        let [lower, upper] = [scene.limits.lower, scene.limits.upper].map(Shortest);
        match limit {
            SiLimit::Stretch(Limit::Upper) => format!(
                "the actuator was pulled in: at time {time} s its stretch reached lambda_max = {upper}"
            ),
            SiLimit::Stretch(Limit::Lower) => format!(
                "the actuator collapsed: at time {time} s its stretch came down to lambda_min = {lower}"
            ),
            SiLimit::Breakdown => format!(
                "the material broke down: at time {time} s its true field reached \
                 E_breakdown*lambda^n_breakdown"
            ),
        }
    }

    fn limit_reached(
        scene: &SiScene,
        time: &DoubleDouble,
        state: &SiState,
        tolerance: f64,
    ) -> Option<SiLimit> {
        if let Some(limit) = scene.limits.reached(&state.motion, tolerance) {
            return Some(SiLimit::Stretch(limit));
        }
        let broken = scene.at_breakdown() != OnBreakdown::Flag
            && scene.is_at_breakdown(time, state, tolerance);
        broken.then_some(SiLimit::Breakdown)
    }

    /// Once the motion has ended at a limit, no event is awaited: the indicators stay at λ_max − λ_min and 1.
    /// The indicator of breakdown stays at 1 once breakdown has been reported.
    fn indicators(view: &View<Si>, indicators: &mut [f64]) {
        let limits = view.scene.limits;
        let stretch = view.state().motion.position;
        let width = limits.upper - limits.lower;
        let flagged =
            view.scene.at_breakdown() == OnBreakdown::Flag && view.breakdown_time() < f64::INFINITY;
        indicators.copy_from_slice(&if view.collapse.is_some() {
            [width, width, 1.0]
        } else {
            let field = if flagged {
                1.0
            } else {
                view.breakdown_margin_part()
            };
            [stretch - limits.lower, limits.upper - stretch, field]
        });
    }

    fn is_finite(state: &SiState) -> bool {
        let State { position, rate } = state.motion;
        [position, rate, state.charge]
            .into_iter()
            .chain(state.dashpots)
            .all(f64::is_finite)
    }

    fn component(state: &mut SiState, place: usize) -> Option<&mut f64> {
        let SiState {
            motion: State { position, rate },
            charge,
            dashpots: [first, second, third],
        } = state;
        [position, rate, charge, first, second, third]
            .into_iter()
            .nth(place)
    }

    fn second_order(state: &SiState) -> State {
        state.motion
    }

    fn limits(scene: &SiScene) -> Limits {
        scene.limits
    }

    fn records_extremes(scene: &SiScene) -> bool {
        scene.records_extremes()
    }

    fn extremes(view: &View<Si>) -> Option<Extremes> {
        view.extremes()
    }

    fn check_settings(scene: &SiScene) -> Result<(), String> {
        scene.check_settings()
    }

    fn window(scene: &SiScene) -> f64 {
        scene.extremes_window
    }

    fn check_state(view: &View<Si>) -> Result<(), String> {
        // The state as such: the motion may have been followed with other parameters.
        let place = Place::of_state(*view.time, view.state());
        let view = View::new(view.scene, place, view.time, view.collapse);
        let read = |row: &u32| VARIABLES[*row as usize].value(&view);
        if view.is_admitted() && Si::DERIVATIVES.iter().all(|row| read(row).is_finite()) {
            return Ok(());
        }
        // The state that lies far out is named, or else all states.
        let far = |row: &&u32| {
            let Kind::Real { nominal, min, .. } = VARIABLES[**row as usize].kind else {
                return false;
            };
            let value = read(row);
            !value.is_finite() || value.abs() >= FAR * nominal || min >= 0.0 && value <= 0.0
        };
        let state = match Si::STATES.iter().find(far) {
            Some(state) => view.in_words(*state),
            None => view.state_in_words(),
        };
        let excess = Si::excess(&view).map_or_else(String::new, |excess| format!(": {excess}"));
        Err(format!("there is no motion at {state}{excess}"))
    }

    fn excess(view: &View<Si>) -> Option<String> {
        let field = view.electric_field().abs();
        let conducts = view.scene.device.conductivity > 0.0;
        (conducts && view.scene.overflows_in(field)).then(|| {
            view.scene
                .conducts_too_much(field, "electric_field", "what drives it")
        })
    }

    fn state(view: &View<Si>) -> SiState {
        view.state()
    }

    /// Where the charge becomes a state, it is the charge on the electrodes before the changes of this instant.
    fn state_tuned_to(view: &View<Si>, scene: &SiScene) -> SiState {
        let [was, is] = [view.scene, scene].map(|scene| scene.folded().device.has_charge_state());
        let mut state = view.state();
        if is && !was {
            state.charge = view.charge_before();
        }
        state
    }

    fn nominal(scene: &SiScene, place: usize) -> f64 {
        let Folded { device, scales, .. } = scene.folded();
        match place {
            // The rate of an oscillation whose amplitude is the length of the actuator.
            1 => (6.0 / (device.sheet.aspect + 2.0)).sqrt() / scales.time,
            2 => scales.charge,
            _ => 1.0,
        }
    }

    fn along(view: &View<Si>, direction: &Direction<Si>) -> Sample<Dual> {
        view.sample_along(direction)
    }

    fn from_now_on(view: &View<Si>, order: usize) -> Sample<TimeSeries> {
        view.series(order)
    }
}

/// A state of more than this many times its typical size is not physical.
const FAR: f64 = 1e30;

const GUID: guid::Text = guid::of::<Si>();

/// An instance of the actuator in SI units.
pub type Instance = crate::instance::Instance<Si>;

/// Value reference of a variable, by its name.
#[must_use]
pub fn value_reference(name: &str) -> Option<u32> {
    variables::value_reference::<Si>(name)
}
