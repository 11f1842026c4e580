//! A script of FMI calls, right and wrong, and the player that judges every
//! answer. Scripts are written by the generator of `random.rs` and by the fuzzer
//! (`fuzz/src/calls.rs`); as bytes they are what postcard makes of them.

use std::ptr::{null, null_mut};

use dielectric_elastomer_actuator::fmi2::*;
use dielectric_elastomer_actuator::model::Model;
use dielectric_elastomer_actuator::model::variables::{Access, Kind, value_reference};
use fmi::fmi2::binding::*;
use serde::{Deserialize, Serialize};

use super::host::{ERROR, Host, OK, bytes_of};

/// A pointer that leads nowhere.
const NOWHERE: fmi2FMUstate = std::ptr::without_provenance_mut(8);

/// Where the saved instance begins in a serialized state: after "DEA state",
/// layout, GUID, length and checksum.
pub const CONTENTS: usize = 9 + 2 + 38 + 4 + 4;

/// States that a script can hold at a time.
pub const SLOTS: u8 = 3;

const FUNCTIONS_OF_STATUS: u8 = 5;
const UNTOUCHED: f64 = 7.25;

/// One call of the host, with its arguments.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub enum Act {
    Renew,
    SetLogging(bool, Vec<u8>),
    SetupExperiment(Option<f64>, f64, Option<f64>),
    EnterInitialization,
    ExitInitialization,
    Terminate,
    Reset,
    GetReal(Vec<u32>),
    SetReal(Vec<(u32, f64)>),
    GetWhole(bool, Vec<u32>),
    SetWhole(bool, Vec<(u32, i32)>),
    Strings(Vec<u32>),
    SetInputDerivatives(Vec<(u32, i32, f64)>),
    GetOutputDerivatives(Vec<(u32, i32)>),
    GetDirectional(Vec<u32>, Vec<(u32, f64)>),
    /// At the present communication point where none is given.
    Step(Option<f64>, f64, bool),
    Cancel,
    GetStatus(u8, i32),
    Save(u8),
    Restore(u8),
    Free(u8),
    /// Serializes a state, changes these bytes, cuts what is beyond the length,
    /// and reads it into another slot; with its right checksum or with that from before.
    Damage(u8, u8, Vec<(u16, u8)>, Option<u16>, bool),
    EnterEvent,
    NewDiscreteStates,
    EnterContinuous,
    CompletedStep(bool),
    SetTime(f64),
    SetStates(Vec<f64>),
    GetDerivatives(u8),
    GetIndicators(u8),
    GetStates(u8),
    GetNominals(u8),
    /// Null for the component, or for each pointer in turn.
    Null(u8),
}

/// Acts, each of the model-exchange instance (true) or the co-simulation instance.
pub type Script = Vec<(bool, Act)>;

/// Plays a script.
///
/// # Errors
/// The first answer that is not as it has to be.
pub fn play<M: Model>(script: &[(bool, Act)]) -> Result<(), String> {
    let mut stage = Stage::<M>::new();
    for (number, (exchange, act)) in script.iter().enumerate() {
        let played = stage.play(usize::from(*exchange), act);
        played.map_err(|fault| format!("call {number}, {act:?}: {fault}"))?;
    }
    Ok(())
}

/// The time in which the motion turns some times: the steps of scripts are some of it.
pub fn time_unit<M: Model>() -> f64 {
    10.0 * M::EXPERIMENT.step_size
}

/// The script of which these bytes are the acts, one after the other, as far as
/// they go.
pub fn from_fuzzed(mut bytes: &[u8]) -> Script {
    std::iter::from_fn(|| {
        let (act, rest) = postcard::take_from_bytes(bytes).ok()?;
        bytes = rest;
        Some(act)
    })
    .take(200)
    .collect()
}

/// Puts the right length and checksum into a serialized state.
pub fn seal(bytes: &mut [u8]) {
    let contents = &bytes[CONTENTS..];
    let length = (contents.len() as u32).to_le_bytes();
    let checksum = crc::Crc::<u32>::new(&crc::CRC_32_ISO_HDLC).checksum(contents);
    bytes[CONTENTS - 8..CONTENTS - 4].copy_from_slice(&length);
    bytes[CONTENTS - 4..CONTENTS].copy_from_slice(&checksum.to_le_bytes());
}

/// An instance, an instance for model exchange, and states, which both may be given.
struct Stage<M: Model> {
    hosts: [Host<M>; 2],
    states: [fmi2FMUstate; SLOTS as usize],
    /// Whether the log was left as it was at first.
    logging: [bool; 2],
}

impl<M: Model> Drop for Stage<M> {
    fn drop(&mut self) {
        for state in &mut self.states {
            unsafe { fmi2FreeFMUstate::<M>(self.hosts[0].component, state) };
        }
    }
}

impl<M: Model> Stage<M> {
    fn new() -> Stage<M> {
        Stage {
            hosts: [0, 1].map(new),
            states: [null_mut(); SLOTS as usize],
            logging: [true; 2],
        }
    }

    /// Makes a call. An error changes nothing and is explained; no call is fatal.
    fn play(&mut self, who: usize, act: &Act) -> Result<(), String> {
        let before = self.hosts[who].serialized();
        self.hosts[who].log.lock().expect("one thread").clear();
        let status = self.answer(who, act)?;
        let lines = self.hosts[who].log.lock().expect("one thread").clone();
        demand(
            lines.iter().all(|line| !line.contains('%')),
            "the log has a %",
        )?;
        demand((OK..=ERROR).contains(&status), &format!("status {status}"))?;
        if status == ERROR {
            let same = self.hosts[who].serialized() == before;
            demand(same, &format!("an error changed something: {lines:?}"))?;
            demand(
                !self.logging[who] || !lines.is_empty(),
                "an error without a word",
            )?;
        }
        Ok(())
    }

    fn answer(&mut self, who: usize, act: &Act) -> Result<fmi2Status, String> {
        let c = self.hosts[who].component;
        let slot = |place: u8| usize::from(place % SLOTS);
        Ok(match act {
            Act::Renew => {
                self.hosts[who] = new(who);
                self.logging[who] = true;
                OK
            }
            Act::SetLogging(on, categories) => {
                let names = [
                    c"logEvents",
                    c"logStatusWarning",
                    c"logStatusError",
                    c"none",
                ];
                let names: Vec<_> = categories
                    .iter()
                    .map(|&place| {
                        names
                            .get(usize::from(place))
                            .map_or(null(), |name| name.as_ptr())
                    })
                    .collect();
                self.logging[who] = false;
                unsafe { fmi2SetDebugLogging::<M>(c, i32::from(*on), names.len(), names.as_ptr()) }
            }
            Act::SetupExperiment(tolerance, start, stop) => unsafe {
                let (defined, tolerance) = (tolerance.is_some(), tolerance.unwrap_or(f64::NAN));
                let (ends, stop) = (stop.is_some(), stop.unwrap_or(f64::NEG_INFINITY));
                fmi2SetupExperiment::<M>(c, defined.into(), tolerance, *start, ends.into(), stop)
            },
            Act::EnterInitialization => unsafe { fmi2EnterInitializationMode::<M>(c) },
            Act::ExitInitialization => unsafe { fmi2ExitInitializationMode::<M>(c) },
            Act::Terminate => unsafe { fmi2Terminate::<M>(c) },
            Act::Reset => unsafe { fmi2Reset::<M>(c) },
            Act::GetReal(references) => {
                let numbers = filled(references.len(), |to| unsafe {
                    fmi2GetReal::<M>(c, references.as_ptr(), references.len(), to)
                })?;
                let number = numbers.0 != OK || numbers.1.iter().all(|value| !value.is_nan());
                demand(number, "a value is no number")?;
                numbers.0
            }
            Act::SetReal(values) => self.set_real(who, values)?,
            Act::GetWhole(boolean, references) => {
                let get = if *boolean {
                    fmi2GetBoolean::<M>
                } else {
                    fmi2GetInteger::<M>
                };
                let mut values = vec![7; references.len()];
                let (from, to) = (references.as_ptr(), values.as_mut_ptr());
                let status = unsafe { get(c, from, references.len(), to) };
                let whole = status != OK || !boolean || values.iter().all(|v| (0..2).contains(v));
                demand(whole, "a Boolean is neither 0 nor 1")?;
                status
            }
            Act::SetWhole(boolean, values) => unsafe {
                let set = if *boolean {
                    fmi2SetBoolean::<M>
                } else {
                    fmi2SetInteger::<M>
                };
                let (references, values): (Vec<u32>, Vec<i32>) = values.iter().copied().unzip();
                set(c, references.as_ptr(), references.len(), values.as_ptr())
            },
            Act::Strings(references) => unsafe {
                let (from, count) = (references.as_ptr(), references.len());
                let mut texts = vec![null(); count];
                let got = fmi2GetString::<M>(c, from, count, texts.as_mut_ptr());
                let texts = vec![c"text".as_ptr(); count];
                got.max(fmi2SetString::<M>(c, from, count, texts.as_ptr()))
            },
            Act::SetInputDerivatives(values) => unsafe {
                let references: Vec<u32> = values.iter().map(|value| value.0).collect();
                let orders: Vec<i32> = values.iter().map(|value| value.1).collect();
                let values: Vec<f64> = values.iter().map(|value| value.2).collect();
                let (from, count) = (references.as_ptr(), references.len());
                fmi2SetRealInputDerivatives::<M>(c, from, count, orders.as_ptr(), values.as_ptr())
            },
            Act::GetOutputDerivatives(wanted) => {
                let (references, orders): (Vec<u32>, Vec<i32>) = wanted.iter().copied().unzip();
                let (from, count) = (references.as_ptr(), references.len());
                filled(count, |to| unsafe {
                    fmi2GetRealOutputDerivatives::<M>(c, from, count, orders.as_ptr(), to)
                })?
                .0
            }
            Act::GetDirectional(unknowns, knowns) => {
                let (known, change): (Vec<u32>, Vec<f64>) = knowns.iter().copied().unzip();
                let (from, count) = (unknowns.as_ptr(), unknowns.len());
                let (by, changes) = (known.as_ptr(), change.as_ptr());
                filled(count, |to| unsafe {
                    fmi2GetDirectionalDerivative::<M>(c, from, count, by, known.len(), changes, to)
                })?
                .0
            }
            Act::Step(at, step, may_go_back) => {
                let at = at.unwrap_or_else(|| self.hosts[who].time());
                // A long step of a fast drive is work, not a fault.
                let unit = time_unit::<M>();
                let step = if step.is_finite() {
                    step.clamp(-unit, 10.0 * unit)
                } else {
                    *step
                };
                unsafe { fmi2DoStep::<M>(c, at, step, i32::from(!may_go_back)) }
            }
            Act::Cancel => unsafe { fmi2CancelStep::<M>(c) },
            Act::GetStatus(function, kind) => unsafe {
                match function % FUNCTIONS_OF_STATUS {
                    0 => fmi2GetStatus::<M>(c, *kind as u32, &mut 0),
                    1 => fmi2GetRealStatus::<M>(c, *kind as u32, &mut 0.0),
                    2 => fmi2GetIntegerStatus::<M>(c, *kind as u32, &mut 0),
                    3 => fmi2GetBooleanStatus::<M>(c, *kind as u32, &mut 0),
                    _ => fmi2GetStringStatus::<M>(c, *kind as u32, &mut null()),
                }
            },
            Act::Save(place) => unsafe { fmi2GetFMUstate::<M>(c, &mut self.states[slot(*place)]) },
            Act::Restore(place) => unsafe { fmi2SetFMUstate::<M>(c, self.states[slot(*place)]) },
            Act::Free(place) => unsafe { fmi2FreeFMUstate::<M>(c, &mut self.states[slot(*place)]) },
            Act::Damage(from, to, changes, length, sealed) => {
                let mut bytes = bytes_of::<M>(c, self.states[slot(*from)]);
                for &(place, byte) in changes {
                    if !bytes.is_empty() {
                        let place = usize::from(place) % bytes.len();
                        bytes[place] = byte;
                    }
                }
                bytes.truncate(length.map_or(bytes.len(), usize::from));
                if *sealed && bytes.len() > CONTENTS {
                    seal(&mut bytes);
                }
                // What the result held before does not matter.
                let (data, mut new) = (bytes.as_ptr().cast(), NOWHERE);
                let read = unsafe { fmi2DeSerializeFMUstate::<M>(c, data, bytes.len(), &mut new) };
                if read == OK {
                    let old = std::mem::replace(&mut self.states[slot(*to)], new);
                    unsafe { fmi2FreeFMUstate::<M>(c, &mut { old }) };
                } else {
                    demand(new == NOWHERE, "an error wrote a state")?;
                }
                read
            }
            Act::EnterEvent => unsafe { fmi2EnterEventMode::<M>(c) },
            Act::NewDiscreteStates => unsafe {
                let mut info: fmi2EventInfo = std::mem::zeroed();
                fmi2NewDiscreteStates::<M>(c, &mut info)
            },
            Act::EnterContinuous => unsafe { fmi2EnterContinuousTimeMode::<M>(c) },
            Act::CompletedStep(last) => unsafe {
                fmi2CompletedIntegratorStep::<M>(c, i32::from(*last), &mut 0, &mut 0)
            },
            Act::SetTime(time) => unsafe { fmi2SetTime::<M>(c, *time) },
            Act::SetStates(states) => unsafe {
                fmi2SetContinuousStates::<M>(c, states.as_ptr(), states.len())
            },
            Act::GetDerivatives(count) => fill(c, *count, fmi2GetDerivatives::<M>)?,
            Act::GetIndicators(count) => fill(c, *count, fmi2GetEventIndicators::<M>)?,
            Act::GetStates(count) => fill(c, *count, fmi2GetContinuousStates::<M>)?,
            Act::GetNominals(count) => fill(c, *count, fmi2GetNominalsOfContinuousStates::<M>)?,
            Act::Null(which) => nothing::<M>(c, *which, self.states[0])?,
        })
    }

    /// Whether the actuator for model exchange has come to a limit: it may then be held.
    fn held(&self) -> bool {
        let c = self.hosts[1].component;
        ["collapsed", "breakdown"].into_iter().any(|name| {
            let mut value = 0.0;
            if let Some(reference) = value_reference::<M>(name) {
                unsafe { fmi2GetReal::<M>(c, &reference, 1, &mut value) };
            }
            value == 1.0
        })
    }

    /// Sets all or none, and only what may be set.
    fn set_real(&self, who: usize, values: &[(u32, f64)]) -> Result<fmi2Status, String> {
        let host = &self.hosts[who];
        let (references, numbers): (Vec<u32>, Vec<f64>) = values.iter().copied().unzip();
        let (from, count) = (references.as_ptr(), references.len());
        let status = unsafe { fmi2SetReal::<M>(host.component, from, count, numbers.as_ptr()) };
        if status == OK {
            for (place, &(reference, number)) in values.iter().enumerate() {
                let state = who == 1 && M::STATES.contains(&reference);
                let row = M::VARIABLES.get(reference as usize);
                let may_be_set = state && number.is_finite()
                    || row.is_some_and(|row| {
                        matches!(row.kind, Kind::Real { .. })
                            && !matches!(row.access, Access::Result { .. })
                            && row.check(number).is_ok()
                    });
                demand(may_be_set, "a value was set that may not be")?;
                let again = references[place + 1..].contains(&reference) || state && self.held();
                let mut now = number;
                unsafe { fmi2GetReal::<M>(host.component, &reference, 1, &mut now) };
                demand(again || now == number, "a value was not set")?;
            }
        }
        Ok(status)
    }
}

fn new<M: Model>(who: usize) -> Host<M> {
    Host::of_model([fmi2Type_fmi2CoSimulation, fmi2Type_fmi2ModelExchange][who])
}

fn demand(holds: bool, fault: &str) -> Result<(), String> {
    if holds { Ok(()) } else { Err(fault.to_owned()) }
}

/// The status of a function that fills an array, and the array, which an error
/// leaves as it was.
fn filled(
    count: usize,
    function: impl FnOnce(*mut f64) -> fmi2Status,
) -> Result<(fmi2Status, Vec<f64>), String> {
    let mut values = vec![UNTOUCHED; count];
    let status = function(values.as_mut_ptr());
    let touched = values.iter().any(|&value| value != UNTOUCHED);
    demand(status != ERROR || !touched, "an error wrote into the array")?;
    Ok((status, values))
}

fn fill(
    c: fmi2Component,
    count: u8,
    function: unsafe extern "C" fn(fmi2Component, *mut f64, usize) -> fmi2Status,
) -> Result<fmi2Status, String> {
    let count = usize::from(count);
    Ok(filled(count, |to| unsafe { function(c, to, count) })?.0)
}

/// Null where there must be something; any answer but an error is a fault.
fn nothing<M: Model>(
    c: fmi2Component,
    which: u8,
    state: fmi2FMUstate,
) -> Result<fmi2Status, String> {
    let one = &0;
    let status = unsafe {
        match which % 20 {
            0 => fmi2GetReal::<M>(c, null(), 1, &mut 0.0),
            1 => fmi2GetReal::<M>(c, one, 1, null_mut()),
            2 => fmi2SetReal::<M>(c, one, 1, null()),
            3 => fmi2SetReal::<M>(c, null(), 2, [0.0; 2].as_ptr()),
            4 => fmi2GetInteger::<M>(c, null(), 1, &mut 0),
            5 => fmi2SetBoolean::<M>(c, one, 1, null()),
            6 => fmi2GetString::<M>(c, null(), 1, null_mut()),
            7 => fmi2SetDebugLogging::<M>(c, 1, 1, null()),
            8 => fmi2GetDirectionalDerivative::<M>(c, one, 1, one, 1, null(), &mut 0.0),
            9 => fmi2GetDirectionalDerivative::<M>(c, one, 1, null(), 1, &1.0, null_mut()),
            10 => fmi2SetRealInputDerivatives::<M>(c, one, 1, null(), &0.0),
            11 => fmi2GetRealOutputDerivatives::<M>(c, one, 1, &1, null_mut()),
            12 => fmi2GetFMUstate::<M>(c, null_mut()),
            13 => fmi2SetFMUstate::<M>(c, null_mut()),
            14 => fmi2SerializedFMUstateSize::<M>(c, state, null_mut()),
            15 => fmi2SerializeFMUstate::<M>(c, state, null_mut(), 9),
            16 => fmi2DeSerializeFMUstate::<M>(c, null(), 9, &mut null_mut()),
            17 => fmi2NewDiscreteStates::<M>(c, null_mut()),
            18 => fmi2CompletedIntegratorStep::<M>(c, 1, null_mut(), null_mut()),
            _ => fmi2GetDerivatives::<M>(c, null_mut(), 2),
        }
    };
    let nobody = unsafe { fmi2DoStep::<M>(null_mut(), 0.0, 0.1, 1) };
    demand((status, nobody) == (ERROR, ERROR), "null was taken")?;
    Ok(status)
}
