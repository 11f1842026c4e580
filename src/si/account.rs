//! Model exchange: energies and the time of breakdown, recorded over the steps of the host.

use serde::{Deserialize, Serialize};

use super::sample::Basis;
use super::{Si, SiScene, SiState};
use crate::actuator::device::Source;
use crate::actuator::drive::Polynomial;
use crate::arithmetic::double_double::DoubleDouble;
use crate::model::Account;
use crate::solver::State;
use crate::solver::coupled::{LocalCoupledEquation, MOST_INTEGRALS, MOST_STATES, Stage};

/// The energies exchanged, the time of breakdown, and where the host's last step ended.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct SiAccount {
    /// Energies lost and supplied since the start in J, where they are recorded.
    pub exchanged: [f64; MOST_INTEGRALS],
    /// When the true field was first found at breakdown, where breakdown does not end the motion.
    pub breakdown: Option<DoubleDouble>,
    /// The charge on the electrodes in C at which the event began that is handled.
    pub before: Option<f64>,
    time: DoubleDouble,
    state: SiState,
    inputs: Inputs,
}

/// What drove the actuator, in SI units.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
struct Inputs {
    /// The input of the source.
    source: f64,
    /// The input of the source with the built-in voltage.
    total: f64,
    force: f64,
}

impl Inputs {
    fn of(scene: &SiScene, time: DoubleDouble) -> Inputs {
        let offset = time.since(scene.since);
        let scales = scene.scales();
        let drive = scene.drive(&scales);
        let total = drive.at(&scales.time(time)).voltage(0.0);
        Inputs {
            source: scene.source_input().at(offset),
            total: total * scales.source(scene.source()),
            force: scene.force.at(offset),
        }
    }
}

impl Default for SiAccount {
    fn default() -> SiAccount {
        SiAccount {
            exchanged: [0.0; MOST_INTEGRALS],
            breakdown: None,
            before: None,
            time: DoubleDouble::ZERO,
            state: SiState {
                motion: State {
                    position: 1.0,
                    rate: 0.0,
                },
                charge: 0.0,
                dashpots: [1.0; super::scene::BRANCHES],
            },
            inputs: Inputs::default(),
        }
    }
}

impl Account<Si> for SiAccount {
    fn begin(scene: &SiScene, time: DoubleDouble, state: &SiState) -> SiAccount {
        let mut account = SiAccount {
            time,
            state: *state,
            ..SiAccount::default()
        };
        if scene.record_energy {
            account.add(scene.exchanged_at_once(&time, state, scene.start.charge));
            account.inputs = Inputs::of(scene, time);
        }
        account.look_for_breakdown(scene, time, state);
        account.before = charge_on_electrodes(scene, time, state);
        account
    }

    fn include_step(&mut self, scene: &SiScene, time: DoubleDouble, state: &SiState) -> bool {
        if scene.record_energy && time.since(self.time) > 0.0 {
            self.integrate(scene, time, state);
        }
        (self.time, self.state) = (time, *state);
        // What changes at events only is recorded when the host handles this one.
        self.is_first_breakdown(scene, time, state)
    }

    fn enter_event(&mut self, scene: &SiScene, time: DoubleDouble, state: &SiState) {
        if scene.record_energy {
            let basis = Basis::of(scene, &time, DoubleDouble::ZERO);
            let before = self.inputs.total / basis.scales.source(scene.source());
            self.add(exchanged_by_step(&basis, state, before));
            self.inputs = Inputs::of(scene, time);
        }
        self.arrive(scene, time, state);
        self.before = charge_on_electrodes(scene, time, state);
    }

    fn include(&mut self, scene: &SiScene, time: DoubleDouble, state: &SiState) {
        let before = self.before.take();
        if scene.record_energy {
            if let Some(charge) = before {
                self.add(scene.exchanged_at_once(&time, state, charge));
            }
            self.inputs = Inputs::of(scene, time);
        }
        self.arrive(scene, time, state);
    }

    fn is_valid(&self) -> bool {
        let SiState {
            motion: State { position, rate },
            charge,
            dashpots,
        } = self.state;
        let Inputs {
            source,
            total,
            force,
        } = self.inputs;
        let numbers = [position, rate, charge, source, total, force];
        let mut numbers = numbers.iter().chain(&dashpots).chain(&self.exchanged);
        numbers.all(|number| number.is_finite())
            && self.time.is_finite()
            && self.before.is_none_or(f64::is_finite)
            && self.breakdown.is_none_or(|time| time.is_finite())
    }
}

/// The charge on the electrodes in C, where the state is not too far out for one.
fn charge_on_electrodes(scene: &SiScene, time: DoubleDouble, state: &SiState) -> Option<f64> {
    let charge = scene.seen_in(&time, state).charge();
    charge.is_finite().then_some(charge)
}

impl SiAccount {
    fn arrive(&mut self, scene: &SiScene, time: DoubleDouble, state: &SiState) {
        (self.time, self.state) = (time, *state);
        self.look_for_breakdown(scene, time, state);
    }

    fn look_for_breakdown(&mut self, scene: &SiScene, time: DoubleDouble, state: &SiState) {
        if self.is_first_breakdown(scene, time, state) {
            self.breakdown = Some(time);
        }
    }

    /// Whether the true field has come to breakdown, which is not recorded yet and does not end the motion.
    fn is_first_breakdown(&self, scene: &SiScene, time: DoubleDouble, state: &SiState) -> bool {
        self.breakdown.is_none() && scene.flags_breakdown(&time, state)
    }

    /// Adds energies in J. None is added where one is no number: a host's integrator may try states far out.
    fn add(&mut self, energies: [f64; MOST_INTEGRALS]) {
        let sums: [f64; MOST_INTEGRALS] = std::array::from_fn(|k| self.exchanged[k] + energies[k]);
        if sums.iter().all(|sum| sum.is_finite()) {
            self.exchanged = sums;
        }
    }

    /// Integrates the powers over the host's step with three Gauss points. Between the ends each state is
    /// the cubic through its values and slopes there, and each input is linear.
    fn integrate(&mut self, scene: &SiScene, time: DoubleDouble, state: &SiState) {
        const NODE: f64 = 0.387_298_334_620_741_7; // √15/10
        let mut basis = Basis::of(scene, &self.time, DoubleDouble::ZERO);
        let span = time.since(self.time) / basis.scales.time;
        let (before, now) = (self.inputs, Inputs::of(scene, time));
        let line = |from: f64, to: f64, unit: f64| {
            let mut line = Polynomial::constant(from / unit);
            line.set_derivative(1, (to - from) / (unit * span));
            line
        };
        let unit = basis.scales.source(scene.source());
        basis.drive.since = basis.time;
        basis.drive.voltage = line(before.source, now.source, unit);
        basis.drive.prestress = line(before.force, now.force, basis.scales.force);
        let local = basis.local();
        let end = |state: &SiState, offset: f64| {
            let stage = basis.stage(state, state.motion.position);
            let load = local.load(offset);
            let (slopes, force) = local.derivatives(MOST_STATES, load, &stage);
            (stage, force.value, slopes.map(|slope| slope.value))
        };
        let (first, last) = (end(&self.state, 0.0), end(state, span));
        let mut sum = [0.0; MOST_INTEGRALS];
        for (part, weight) in [
            (0.5 - NODE, 5.0 / 18.0),
            (0.5, 8.0 / 18.0),
            (0.5 + NODE, 5.0 / 18.0),
        ] {
            let between = |from: [f64; 2], to: [f64; 2]| cubic(from, to, span, part);
            let stage = Stage {
                position: between(
                    [first.0.position, first.0.rate],
                    [last.0.position, last.0.rate],
                ),
                rate: between([first.0.rate, first.1], [last.0.rate, last.1]),
                internal: std::array::from_fn(|k| {
                    between(
                        [first.0.internal[k], first.2[k]],
                        [last.0.internal[k], last.2[k]],
                    )
                }),
            };
            let offset = part * span;
            let slopes = local.first_order(&local.load(offset), &stage);
            let powers = local.powers_at(offset, &stage, &slopes.map(|slope| slope.value));
            for (sum, power) in sum.iter_mut().zip(powers.all()) {
                *sum += weight * power;
            }
        }
        let energy = span * basis.scales.energy;
        self.add(sum.map(|power| energy * power));
        self.inputs = now;
    }
}

/// The cubic with these values and slopes at both ends of a span, at this part of the span.
fn cubic([from, begin]: [f64; 2], [to, end]: [f64; 2], span: f64, part: f64) -> f64 {
    let left = 1.0 - part;
    let growth = part * part * (3.0 - 2.0 * part);
    from + (to - from) * growth + span * part * left * (begin * left - end * part)
}

/// The energies in J that an ideal source exchanges at once when it jumps from this nondimensional value.
fn exchanged_by_step(basis: &Basis, state: &SiState, before: f64) -> [f64; MOST_INTEGRALS] {
    let stage = basis.stage(state, state.motion.position);
    let exchanged = basis.local().exchanged_by_step(before, &stage);
    exchanged.all().map(|energy| energy * basis.scales.energy)
}

impl SiScene {
    /// The energies in J that an ideal source exchanges at once when it meets this charge in C on the electrodes.
    pub(super) fn exchanged_at_once(
        &self,
        time: &DoubleDouble,
        state: &SiState,
        charge: f64,
    ) -> [f64; MOST_INTEGRALS] {
        let basis = Basis::of(self, time, DoubleDouble::ZERO);
        let before = self.source_before(&basis.scales, charge, basis.capacitance(state));
        exchanged_by_step(&basis, state, before)
    }

    /// The nondimensional value from which an ideal source jumps when it meets this charge in C on the
    /// electrodes.
    pub(super) fn source_before(
        &self,
        scales: &crate::actuator::scales::Scales,
        charge: f64,
        capacitance: f64,
    ) -> f64 {
        let charge = charge / scales.charge;
        match self.source() {
            Source::Voltage => charge / capacitance,
            Source::Current | Source::Charge => charge,
        }
    }
}
