//! Long steps of which only the end is asked for.
//!
//! Between communication points that lie farther apart than a step, nothing of it is needed
//! but its end, which superconverges: 8 nodes reach order 16 there. Steps are equal as long as
//! their error allows, so that a [`plan`] serves many of them, and share the way to the
//! communication point evenly. First-order states, where a system has some, have plans of their own ([`relaxation`]).
//!
//! What they gain beside steps of 16 nodes with dense output stands in the table of what is skipped
//! (docs/performance.md).

#![expect(
    clippy::needless_range_loop,
    reason = "iterators and closures are functions of their own, which are not compiled for the SIMD level"
)]

use fearless_simd::{Level, Simd, dispatch};
use serde::{Deserialize, Serialize};

use super::iteration::MOST_ITERATIONS;
use super::step_control::{SHORTEST, first_accepted};

mod before;
mod continuation;
mod equal_steps;
mod length;
mod matrix;
mod mean_slope;
mod plan;
mod relaxation;
mod stages;
mod system;
mod table;
mod way;

use before::{Before, LastPlan, LastStep};
use length::Seen;
use mean_slope::MeanSlope;
use stages::Plans;
use system::LocalSystem;
pub use system::{Coupled, System};
pub use way::{End, Way};

/// How many times as long it is where that is not known, and at least: one that was taken long ago tells little.
/// Measured: 0.8 at a tolerance of 1e-4, 1.2 at 1e-9, 2.3 at 1e-12, 3 to 5 at 1e-14.
const LENGTH_OF_DENSE: f64 = 2.0;
const LEAST_LENGTH_OF_DENSE: f64 = 0.75;

/// A load whose period is less than this part of the time scale is left to 16 nodes, which need
/// half as many steps.
const FAST: f64 = 0.1;

/// The slope of a plan is bounded so that its matrices are well conditioned.
const STEEPEST: f64 = 8.0;

const FIRST_ITERATIONS: u32 = 4;
const LEAST_ITERATIONS: u32 = 2;

/// What steps leave behind for the next ones, of a system with no more than K first-order states. Plans are not stored:
/// they follow from the rest.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(bound(
    serialize = "[Before; K]: Serialize, [f64; K]: Serialize",
    deserialize = "[Before; K]: Deserialize<'de>, [f64; K]: Deserialize<'de>"
))]
pub struct EndpointSteps<const K: usize> {
    /// Length of the next one, where it is free.
    length: Option<f64>,
    last_plan: LastPlan<K>,
    before: Option<LastStep<K>>,
    /// The equation has changed since the last one: f jumps at its end.
    restarted: bool,
    /// How often the stages are iterated before it is looked whether that was enough.
    iterations: u32,
    seen: Seen,
    slope: MeanSlope,
    #[serde(skip)]
    plans: Option<Box<Plans<K>>>,
}

/// The longest step under this load, half of what 16 nodes can do: a period.
#[inline(always)]
fn longest<const K: usize, L: LocalSystem<K>>(local: &L) -> f64 {
    0.5 * local.longest_substep()
}

impl<const K: usize> EndpointSteps<K> {
    /// No step yet.
    pub fn none() -> EndpointSteps<K> {
        EndpointSteps::none_within(Some(Box::default()))
    }

    /// No step yet, in the memory of those that there were.
    pub fn anew(&mut self) -> EndpointSteps<K> {
        EndpointSteps::none_within(self.plans.take())
    }

    fn none_within(plans: Option<Box<Plans<K>>>) -> EndpointSteps<K> {
        EndpointSteps {
            length: None,
            last_plan: LastPlan {
                half: 0.0,
                product: 0.0,
                relaxations: [0.0; K],
            },
            before: None,
            restarted: false,
            iterations: FIRST_ITERATIONS,
            seen: Seen::BEGIN,
            slope: MeanSlope::UNKNOWN,
            plans,
        }
    }

    /// Whether ways of this length take less time than with dense output, one step of which serves as many as
    /// fit into it: the next one would be this long, as far as is known, and takes so many times as long.
    pub fn are_faster(&self, rest: f64, dense: Option<f64>, time_of_dense: f64) -> bool {
        self.length.is_none_or(|length| {
            let dense = dense.unwrap_or(LENGTH_OF_DENSE * length);
            dense.max(LEAST_LENGTH_OF_DENSE * length) < time_of_dense * rest.min(length)
        })
    }

    /// Whether so many of them, as far as is known, reach so far.
    pub fn reach(&self, rest: f64, steps: f64) -> bool {
        self.length.is_none_or(|length| rest <= steps * length)
    }

    /// Whether so many as long as the last one, which the load may have bounded, reach so far.
    #[inline]
    pub fn surely_reach(&self, rest: f64, steps: f64) -> bool {
        let last = 2.0 * self.last_plan.half;
        self.length
            .is_some_and(|length| rest <= steps * length.min(last))
    }

    /// x'' and z' at the end of the last one.
    pub fn derivatives(&self) -> Option<(f64, [f64; K])> {
        let last = self.before.as_ref()?;
        let internal = last.internal.map(|state| state.derivative);
        Some((last.motion.derivative, internal))
    }

    /// The equation has changed: f does not go on where it was.
    #[inline]
    pub fn restart(&mut self) {
        self.restarted = true;
    }

    /// Whether the numbers can be those of steps.
    pub fn are_valid(&self) -> bool {
        let LastPlan {
            half,
            product,
            relaxations,
        } = self.last_plan;
        let positive = |number: f64| number > 0.0 && number.is_finite();
        self.before
            .is_none_or(|before| before.is_valid() && half > 0.0)
            && relaxations
                .iter()
                .all(|part| (0.0..f64::INFINITY).contains(part))
            && (0.0..f64::INFINITY).contains(&half)
            && (-STEEPEST..=0.0).contains(&product)
            && self.length.is_none_or(positive)
            && (LEAST_ITERATIONS..=MOST_ITERATIONS).contains(&self.iterations)
            && self.seen.is_valid()
            && self.slope.is_valid()
    }

    /// Goes the way as far as it can.
    #[inline(never)]
    pub fn go<E: System<K>>(&mut self, level: Level, equation: &E, way: &mut Way<K>) -> End {
        dispatch!(level, simd => self.go_with(simd, equation, way))
    }

    #[inline(always)]
    fn go_with<S: Simd, E: System<K>>(&mut self, simd: S, equation: &E, way: &mut Way<K>) -> End {
        loop {
            let mut local = equation.at(&way.time());
            let time_scale = 1.0 / local.natural_frequency(&way.state);
            let first = || length::first(time_scale, way.control);
            let wanted = *self.length.get_or_insert_with(first);
            if longest(&local) < FAST * time_scale {
                return End::Blocked;
            }
            let shortest = SHORTEST * way.rest().min(time_scale);
            let steps = first_accepted(
                wanted,
                shortest,
                #[inline(always)]
                |length| self.equal_steps(simd, equation, way, &mut local, time_scale, length),
            );
            match steps {
                Ok(None) => {}
                Ok(Some(end)) => return end,
                Err(_) => return End::Blocked,
            }
        }
    }
}
