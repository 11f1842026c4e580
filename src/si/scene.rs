//! Everything that a host sets of the actuator in SI units.

use serde::{Deserialize, Serialize};

use super::folded::Memory;
use super::thresholds::Thresholds;
use crate::actuator::Drive;
use crate::actuator::device::{Device, DeviceMotion, Source};
use crate::actuator::drive::{HIGHEST_DERIVATIVE, Harmonic, Polynomial, TURN};
use crate::actuator::scales::{Scales, SiDevice, SiElasticity};
use crate::arithmetic::double_double::DoubleDouble;
use crate::arithmetic::jet::Jet;
use crate::arithmetic::number::Parameter;
use crate::model::AtLimit;
use crate::solver::State;
use crate::solver::coupled::MOST_STATES;
use crate::solver::limits::Limits;

/// Maxwell branches.
pub const BRANCHES: usize = crate::actuator::device::parameters::MOST_BRANCHES;

/// What happens where the true field reaches breakdown.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum OnBreakdown {
    /// It is reported, and the motion goes on.
    Flag,
    /// The actuator stays where it is.
    Hold,
    /// The host is asked to end the simulation.
    Terminate,
}

/// Position, rate and first-order states in SI units.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct SiState {
    /// λ and dλ/dt in 1/s.
    pub motion: State,
    /// The charge as a state, in C.
    pub charge: f64,
    /// ξ, the stretches of the dashpots.
    pub dashpots: [f64; BRANCHES],
}

/// One scenario in SI units.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SiScene {
    /// The actuator.
    pub device: SiDevice,
    /// J of the Gent law, 0 for none; κ2, κ3 of the Yeoh law, 0 for none.
    pub stiffening: [f64; 3],
    /// The state at the start time.
    pub start: SiState,
    /// The stretches between which the motion is followed.
    pub limits: Limits,
    /// What happens at them.
    pub on_pull_in: AtLimit,
    /// What happens at breakdown.
    pub on_breakdown: OnBreakdown,
    /// Whether extremes are recorded.
    pub record_extremes: bool,
    /// The number of the window over which extremes are recorded. A changed number begins a new window;
    /// with any number but 0 they are recorded.
    pub extremes_window: f64,
    /// Whether supplied and lost energies are recorded.
    pub record_energy: bool,
    /// What the source imposes, for hosts that set real numbers only: 1, 2, 3 are voltage, current, charge;
    /// 0 leaves it to the enumeration.
    pub source_number: f64,
    /// Time in s at which the inputs were set.
    pub since: DoubleDouble,
    /// Voltage in V, current in A, charge in C, of which the source imposes one.
    pub sources: [Polynomial; 3],
    /// The force on each pair of opposite edges, in N.
    pub force: Polynomial,
    /// Amplitude in V, frequency in Hz and phase in rad of the built-in alternating voltage.
    pub alternating: [f64; 3],
    /// What is added to its angle, in rad, so that a change of frequency during the run keeps the phase.
    pub lead: f64,
    /// [`SiScene::on_pull_in`] for hosts that set real numbers only: 1 is [`AtLimit::Terminate`], 0 leaves it to
    /// the enumeration.
    pub terminate_on_pull_in: f64,
    /// [`SiScene::on_breakdown`] for hosts that set real numbers only: 1, 2, 3 are flag, hold, terminate; 0
    /// leaves it to the enumeration.
    pub on_breakdown_number: f64,
    /// Pull-in voltages that have been computed.
    #[serde(skip)]
    pub thresholds: Thresholds,
    /// The actuator in nondimensional numbers.
    #[serde(skip)]
    pub memory: Memory,
}

impl SiScene {
    /// A scene with every number 0, to be filled in.
    pub(super) fn blank() -> SiScene {
        SiScene {
            device: SiDevice {
                layers: 0.0,
                surfaces: 0.0,
                load_spring_length: 0.0,
                branch_times: [0.0; BRANCHES],
                branch_limits: [0.0; BRANCHES],
                conduction_field: 0.0,
                breakdown_field: 0.0,
                ..SiDevice::sheet(0.0, 0.0, 0.0, [0.0; 2])
            },
            stiffening: [0.0; 3],
            start: SiState {
                motion: State {
                    position: 0.0,
                    rate: 0.0,
                },
                charge: 0.0,
                dashpots: [0.0; BRANCHES],
            },
            limits: Limits {
                lower: 0.0,
                upper: 0.0,
            },
            on_pull_in: AtLimit::Hold,
            on_breakdown: OnBreakdown::Flag,
            record_extremes: false,
            extremes_window: 0.0,
            record_energy: false,
            source_number: 0.0,
            since: DoubleDouble::ZERO,
            sources: [Polynomial::constant(0.0); 3],
            force: Polynomial::constant(0.0),
            alternating: [0.0; 3],
            lead: 0.0,
            terminate_on_pull_in: 0.0,
            on_breakdown_number: 0.0,
            thresholds: Thresholds::default(),
            memory: Memory::default(),
        }
    }

    /// What the source imposes.
    #[must_use]
    pub fn source(&self) -> Source {
        match self.source_number {
            1.0 => Source::Voltage,
            2.0 => Source::Current,
            3.0 => Source::Charge,
            _ => self.device.source,
        }
    }

    /// What happens at a limit of the stretch.
    #[must_use]
    pub fn at_pull_in(&self) -> AtLimit {
        if self.terminate_on_pull_in == 0.0 {
            self.on_pull_in
        } else {
            AtLimit::Terminate
        }
    }

    /// What happens at breakdown.
    #[must_use]
    pub fn at_breakdown(&self) -> OnBreakdown {
        match self.on_breakdown_number {
            1.0 => OnBreakdown::Flag,
            2.0 => OnBreakdown::Hold,
            3.0 => OnBreakdown::Terminate,
            _ => self.on_breakdown,
        }
    }

    /// The oscillation of the built-in voltage in seconds, without its amplitude.
    pub(super) fn oscillation(&self) -> Harmonic {
        let [_, frequency, phase] = self.alternating;
        Harmonic {
            phase,
            ..Harmonic::OFF.with_frequency(TURN.scale(frequency))
        }
    }

    /// Changes the frequency of the built-in voltage, in Hz, at the time at which the inputs were set. Its phase
    /// stays continuous.
    pub fn retune(&mut self, frequency: f64) {
        let mut drive = Drive::constant(0.0, 0.0);
        drive.since = self.since;
        drive.harmonic = self.oscillation();
        drive.lead = self.lead;
        drive.retune(TURN.scale(frequency));
        self.lead = drive.lead;
        self.alternating[1] = frequency;
    }

    /// The input that is in use.
    #[must_use]
    pub fn source_input(&self) -> &Polynomial {
        &self.sources[place(self.source())]
    }

    /// The actuator as it is described. Where 0 means "none", the number becomes one without effect.
    #[must_use]
    pub fn described(&self) -> SiDevice {
        described(self.device, self.source(), self.stiffening)
    }

    /// The units of its nondimensional numbers.
    #[must_use]
    pub fn scales(&self) -> Scales {
        self.folded().scales
    }

    /// Its inputs in nondimensional numbers.
    #[must_use]
    pub fn drive(&self, scales: &Scales) -> Drive {
        let source = self.source();
        let unit = scales.source(source);
        let [amplitude, frequency, phase] = self.alternating;
        let alternates = source == Source::Voltage && amplitude != 0.0;
        let time = scales.time;
        let mut drive = Drive::constant(0.0, 0.0);
        drive.since = scales.time(self.since);
        drive.voltage = scaled(self.source_input(), 1.0 / unit, time);
        drive.prestress = scaled(&self.force, 1.0 / scales.force, time);
        if alternates {
            let turning = TURN.scale(frequency).div(scales.exact_frequency());
            drive.harmonic = Harmonic {
                amplitude: amplitude / unit,
                phase,
                ..Harmonic::OFF.with_frequency(turning)
            };
            drive.lead = self.lead;
        }
        drive
    }

    /// Its motion in nondimensional numbers.
    #[must_use]
    pub fn motion(&self) -> DeviceMotion {
        let folded = self.folded();
        DeviceMotion {
            device: folded.device,
            drive: self.drive(&folded.scales),
            records_energy: self.record_energy,
        }
    }

    /// Whether extremes are recorded.
    #[must_use]
    pub fn records_extremes(&self) -> bool {
        self.record_extremes || self.extremes_window != 0.0
    }

    /// Whether what drives the motion depends on time.
    #[must_use]
    pub fn depends_on_time(&self) -> bool {
        let [amplitude, frequency, _] = self.alternating;
        !(self.source_input().is_constant() && self.force.is_constant())
            || amplitude != 0.0 && frequency != 0.0
    }
}

/// A device with this source and J, κ2, κ3. Where 0 means "none", the number becomes one without effect.
pub(super) fn described<P: Parameter>(
    mut device: SiDevice<P>,
    source: Source,
    [limit, second, third]: [P; 3],
) -> SiDevice<P> {
    let none = |value: P| {
        if value.value() > 0.0 {
            value
        } else {
            value.same(f64::INFINITY)
        }
    };
    device.source = source;
    device.elasticity = if limit.value() > 0.0 {
        SiElasticity::Gent { limit }
    } else if second.is_nothing() && third.is_nothing() {
        SiElasticity::NeoHookean
    } else {
        SiElasticity::Yeoh { second, third }
    };
    if device.load_spring_length.value() == 0.0 {
        device.load_spring_length = device.side;
    }
    device.branch_limits = device.branch_limits.map(none);
    device.conduction_field = none(device.conduction_field);
    device.breakdown_field = none(device.breakdown_field);
    device
}

/// An input in other units: its value is multiplied by `value`, and its time is counted in units of `time`.
fn scaled(input: &Polynomial, value: f64, time: f64) -> Polynomial {
    if input.is_constant() {
        return Polynomial::constant(value * input.value());
    }
    let mut offset = Jet::<{ HIGHEST_DERIVATIVE + 1 }>::constant(0.0);
    offset.term[1] = time;
    let series = input.at(offset);
    let mut scaled = Polynomial::constant(value * series.term[0]);
    let mut factorial = 1.0;
    for (order, term) in series.term.into_iter().enumerate().skip(1) {
        factorial *= order as f64;
        scaled.set_derivative(order, factorial * value * term);
    }
    scaled
}

/// The place of a source among the inputs.
pub(super) fn place(source: Source) -> usize {
    match source {
        Source::Voltage => 0,
        Source::Current => 1,
        Source::Charge => 2,
    }
}

/// The nondimensional first-order states of a device, from the charge and the dashpots.
pub(super) fn internal<P: Parameter>(
    device: &Device<P>,
    charge: P,
    dashpots: &[P; BRANCHES],
) -> [P; MOST_STATES] {
    let mut all = [charge.same(0.0); MOST_STATES];
    let mut places = all.iter_mut();
    if device.has_charge_state()
        && let Some(place) = places.next()
    {
        *place = charge;
    }
    for (branch, dashpot) in device.branches.iter().zip(dashpots) {
        if branch.modulus.value() > 0.0
            && let Some(place) = places.next()
        {
            *place = *dashpot * *dashpot;
        }
    }
    all
}
