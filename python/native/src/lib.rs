//! The core of the actuator for Python, as a few C functions: ensembles on every processor core, and
//! motions with their exact derivatives by the parameters.
//!
//! `python/dielectric_actuator/native.py` calls them. Arrays are those of NumPy, laid out row by row;
//! the columns have the names that [`dea_scene_names`] and [`dea_known_names`] tell. No panic
//! leaves a function, and no thread outlives it.
#![allow(unsafe_code)] // C functions

use std::ffi::{CStr, c_char};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::slice;

use dielectric_elastomer_actuator::actuator::drive::Polynomial;
use dielectric_elastomer_actuator::nondimensional::scene::Scene;
use dielectric_elastomer_actuator::sensitivity::{self, Experiment, Interruption, Ramp};
use dielectric_elastomer_actuator::solver::limits::Limit;
use dielectric_elastomer_actuator::sweep;
use rayon::ThreadPoolBuilder;
use rayon::prelude::*;

/// What the columns of a scene are called, as the FMU's variables are.
const SCENE_NAMES: &CStr = c"c gamma_s tau_s E_s phi S phi_ac omega_ac phase_ac \
    lambda_start lambda_dot_start lambda_min lambda_max";

/// What `sensitivity::Known::ALL` is called.
const KNOWN_NAMES: &CStr =
    c"c gamma_s tau_s E_s S phi_scale time_scale lambda_start lambda_dot_start";

/// Scenes that a thread follows at a time: enough that all SIMD lanes are busy nearly always.
const CHUNK: usize = 128;

/// The numbers of one scene, in the order of `SCENE_NAMES`.
pub type SceneRow = [f64; 13];

/// The parameters of an experiment in the order of `KNOWN_NAMES`.
pub type Knowns = [f64; 9];

/// A stretch, then its derivatives in the order of `KNOWN_NAMES`.
pub type SampleRow = [f64; 10];

/// What became of a scene.
#[repr(C)]
pub struct OutcomeRow {
    /// λ at the end, or where the actuator collapsed.
    pub stretch: f64,
    /// dλ/dt̄ there.
    pub stretch_rate: f64,
    /// Smallest λ on the way.
    pub lowest: f64,
    /// Largest λ on the way.
    pub highest: f64,
    /// When it collapsed; +inf where it did not.
    pub collapse_time: f64,
    /// Whether the integration could not go on: then all numbers are NaN.
    pub failed: f64,
}

/// How a call ended.
#[repr(i32)]
pub enum Ending {
    /// As asked.
    Done = 0,
    /// The actuator collapsed on the way.
    Collapse = 1,
    /// The integration could not go on.
    Failure = 2,
    /// A fault of this library.
    Panic = 3,
}

/// The names of a scene's columns, separated by spaces.
#[unsafe(no_mangle)]
pub extern "C" fn dea_scene_names() -> *const c_char {
    SCENE_NAMES.as_ptr()
}

/// The names of the parameters of an experiment, separated by spaces.
#[unsafe(no_mangle)]
pub extern "C" fn dea_known_names() -> *const c_char {
    KNOWN_NAMES.as_ptr()
}

/// Follows `count` scenes from time 0 to `end` with a relative `tolerance`, on `threads` threads, or on one
/// a processor core where that is 0, and writes an outcome for each. Returns an [`Ending`].
///
/// # Safety
/// `scenes` and `outcomes` must point to `count` rows each; `outcomes` must not be in use elsewhere.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn dea_sweep(
    scenes: *const SceneRow,
    count: usize,
    end: f64,
    tolerance: f64,
    threads: usize,
    outcomes: *mut OutcomeRow,
) -> i32 {
    // SAFETY: the caller promises as many rows.
    let (scenes, outcomes) = unsafe {
        (
            slice::from_raw_parts(scenes, count),
            slice::from_raw_parts_mut(outcomes, count),
        )
    };
    caught(|| {
        let Ok(pool) = ThreadPoolBuilder::new().num_threads(threads).build() else {
            return Ending::Failure;
        };
        pool.install(|| {
            let chunks = scenes.par_chunks(CHUNK).zip(outcomes.par_chunks_mut(CHUNK));
            chunks.for_each(|(rows, outcomes)| {
                let scenes: Vec<Scene> = rows.iter().map(scene).collect();
                for (row, outcome) in outcomes
                    .iter_mut()
                    .zip(sweep::follow(&scenes, end, tolerance))
                {
                    *row = outcome_row(outcome.ok());
                }
            });
        });
        Ending::Done
    })
}

/// Follows an experiment and writes for each of its `sample_count` times the stretch and its derivatives.
/// The voltage is given by `ramp_count` rows of time, voltage and slope; `limits` are λ_min and λ_max. Where
/// the actuator collapses, `when` is set to the time. Returns an [`Ending`].
///
/// # Safety
/// The pointers must lead to as many rows as said; `samples` and `when` must not be in use elsewhere.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn dea_sensitivities(
    knowns: *const Knowns,
    limits: *const [f64; 2],
    tolerance: f64,
    ramps: *const [f64; 3],
    ramp_count: usize,
    times: *const f64,
    sample_count: usize,
    samples: *mut SampleRow,
    when: *mut f64,
) -> i32 {
    // SAFETY: the caller promises as many rows.
    let (knowns, limits, ramps, times, samples, when) = unsafe {
        (
            &*knowns,
            &*limits,
            slice::from_raw_parts(ramps, ramp_count),
            slice::from_raw_parts(times, sample_count),
            slice::from_raw_parts_mut(samples, sample_count),
            &mut *when,
        )
    };
    caught(|| {
        let ramps: Vec<Ramp> = ramps.iter().map(ramp).collect();
        let experiment = experiment(knowns, limits, tolerance, &ramps, times);
        match sensitivity::follow(&experiment) {
            Ok(found) => {
                for (row, sample) in samples.iter_mut().zip(found) {
                    row[0] = sample.stretch;
                    row[1..].copy_from_slice(&sample.slopes);
                }
                Ending::Done
            }
            Err(Interruption::Collapse(Limit::Lower | Limit::Upper, time)) => {
                *when = time;
                Ending::Collapse
            }
            Err(Interruption::Failure(_)) => Ending::Failure,
        }
    })
}

/// Runs a call; a panic in it becomes an ending.
fn caught(call: impl FnOnce() -> Ending) -> i32 {
    catch_unwind(AssertUnwindSafe(call)).unwrap_or(Ending::Panic) as i32
}

/// A scene from its numbers.
fn scene(row: &SceneRow) -> Scene {
    let mut scene = Scene::at_start();
    let parameters = &mut scene.parameters;
    let [
        aspect,
        energy,
        tension,
        elasticity,
        voltage,
        prestress,
        amplitude,
        frequency,
        phase,
        stretch,
        rate,
        lower,
        upper,
    ] = *row;
    parameters.aspect = aspect;
    parameters.surface_energy = energy;
    parameters.surface_tension = tension;
    parameters.surface_elasticity = elasticity;
    scene.drive.voltage = Polynomial::constant(voltage);
    scene.drive.prestress = Polynomial::constant(prestress);
    scene.drive.harmonic.amplitude = amplitude;
    scene.drive.harmonic.frequency = frequency;
    scene.drive.harmonic.phase = phase;
    scene.start.position = stretch;
    scene.start.rate = rate;
    scene.limits.lower = lower;
    scene.limits.upper = upper;
    scene
}

/// The numbers of an outcome; NaN where there is none.
fn outcome_row(outcome: Option<sweep::Outcome>) -> OutcomeRow {
    let Some(outcome) = outcome else {
        return OutcomeRow {
            stretch: f64::NAN,
            stretch_rate: f64::NAN,
            lowest: f64::NAN,
            highest: f64::NAN,
            collapse_time: f64::NAN,
            failed: 1.0,
        };
    };
    OutcomeRow {
        stretch: outcome.state.position,
        stretch_rate: outcome.state.rate,
        lowest: outcome.extremes.lowest,
        highest: outcome.extremes.highest,
        collapse_time: outcome.collapse.map_or(f64::INFINITY, |(_, time)| time),
        failed: 0.0,
    }
}

fn ramp(&[time, voltage, slope]: &[f64; 3]) -> Ramp {
    Ramp {
        time,
        voltage,
        slope,
    }
}

/// An experiment from its numbers.
fn experiment<'a>(
    knowns: &Knowns,
    limits: &[f64; 2],
    tolerance: f64,
    voltage: &'a [Ramp],
    times: &'a [f64],
) -> Experiment<'a> {
    let [
        aspect,
        energy,
        tension,
        elasticity,
        prestress,
        voltage_scale,
        time_scale,
        stretch,
        rate,
    ] = *knowns;
    let [lower, upper] = *limits;
    Experiment {
        scene: scene(&[
            aspect, energy, tension, elasticity, 0.0, prestress, 0.0, 0.0, 0.0, stretch, rate,
            lower, upper,
        ]),
        voltage_scale,
        time_scale,
        voltage,
        times,
        tolerance,
    }
}
