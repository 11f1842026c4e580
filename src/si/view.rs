//! What a host reads beside the quantities of a sample: energies, thresholds, margins, extremes.

use super::sample::Basis;
use super::scene::SiScene;
use super::{Si, SiLimit, SiState};
use crate::actuator::device::{Elasticity, Exchanged, Source, Stored};
use crate::actuator::scales::Scales;
use crate::arithmetic::double_double::DoubleDouble;
use crate::model::{AtLimit, Model, Place, View};
use crate::shortest::Shortest;
use crate::solver::State;
use crate::solver::coupled::{LocalCoupledEquation, Stage};
use crate::solver::extremes::Extremes;
use crate::solver::limits::Limit;

impl View<'_, Si> {
    /// The limit at which the actuator is held. None where the simulation ends there instead: the host then
    /// reads the state of arrival.
    fn held(&self) -> Option<SiLimit> {
        let limit = self.collapse?.limit;
        (Si::at_limit(self.scene, limit) == AtLimit::Hold).then_some(limit)
    }

    /// Whether the actuator is held.
    pub(super) fn is_held(&self) -> bool {
        self.held().is_some()
    }

    /// The present state; at rest where it is held.
    #[must_use]
    pub fn state(&self) -> SiState {
        let mut state = match self.place {
            Place::On(motion) => motion.state_in(self.scene, self.time),
            Place::At { state, .. } => state,
        };
        self.hold(&mut state.motion);
        state
    }

    /// The stretch and its rate at present.
    pub(super) fn motion(&self) -> State {
        let mut motion = match self.place {
            Place::On(motion) => motion.stretch_and_rate(),
            Place::At { state, .. } => state.motion,
        };
        self.hold(&mut motion);
        motion
    }

    /// The stretch at present, without its rate.
    pub(super) fn present_stretch(&self) -> f64 {
        match self.place {
            Place::On(motion) if self.collapse.is_none() => motion.stretch(),
            _ => self.motion().position,
        }
    }

    fn hold(&self, motion: &mut State) {
        let Some(limit) = self.held() else {
            return;
        };
        motion.rate = 0.0;
        match limit {
            SiLimit::Stretch(Limit::Lower) => motion.position = self.scene.limits.lower,
            SiLimit::Stretch(Limit::Upper) => motion.position = self.scene.limits.upper,
            SiLimit::Breakdown => {}
        }
    }

    /// What the quantities are computed with, and the present stage.
    pub(super) fn basis(&self) -> (Basis, Stage) {
        let state = self.state();
        let held = matches!(self.held(), Some(SiLimit::Stretch(_)));
        let (origin, position) = match self.place {
            Place::On(motion) if !held => motion.stretch_from_origin(),
            _ => (DoubleDouble::ZERO, state.motion.position),
        };
        let basis = Basis::of(self.scene, self.time, origin);
        let stage = basis.stage(&state, position);
        (basis, stage)
    }

    /// The derivative of the charge in A, where the motion knows it under this nondimensional source.
    pub(super) fn charging(&self, source: f64) -> Option<f64> {
        match self.place {
            Place::On(motion) if !self.is_held() => motion.charging(self.scene, self.time, source),
            _ => None,
        }
    }

    /// Whether the equation is defined at the present state.
    pub(super) fn is_admitted(&self) -> bool {
        let (basis, stage) = self.basis();
        basis.local().admits(&stage)
    }

    /// The present value of an input.
    pub(super) fn input(&self, of: fn(&SiScene) -> &crate::actuator::drive::Polynomial) -> f64 {
        of(self.scene).at(self.time.since(self.scene.since))
    }

    /// The stored energies in J.
    #[must_use]
    pub fn stored(&self) -> Stored {
        let (basis, stage) = self.basis();
        let stored = basis.local().stored(0.0, &stage);
        let joule = basis.scales.energy;
        Stored {
            kinetic: stored.kinetic * joule,
            elastic: stored.elastic * joule,
            surface: stored.surface * joule,
            spring: stored.spring * joule,
            branches: stored.branches * joule,
            electric: stored.electric * joule,
        }
    }

    /// The energies lost and supplied since the start in J; 0 where they are not recorded.
    #[must_use]
    pub fn exchanged(&self) -> Exchanged {
        match self.place {
            Place::On(motion) => motion.exchanged(self.scene, self.time),
            Place::At { account, .. } => Exchanged::from_integrals(&account.exchanged),
        }
    }

    /// The power that is lost at present, in W.
    #[must_use]
    pub fn lost_power(&self) -> f64 {
        let (basis, stage) = self.basis();
        let local = basis.local();
        let slopes = local
            .slopes(local.load(0.0), &stage)
            .map(|slope| slope.value);
        let Exchanged {
            damping,
            branches,
            series,
            leakage,
            ..
        } = local.powers_at(0.0, &stage, &slopes);
        (damping + branches + series + leakage) * basis.scales.power()
    }

    /// The frequency of small oscillations at present, in Hz.
    #[must_use]
    pub fn small_signal_frequency(&self) -> f64 {
        let (basis, stage) = self.basis();
        let local = basis.local();
        let frequency = local.small_signal_frequency(&local.load(0.0), &stage);
        frequency / (std::f64::consts::TAU * basis.scales.time)
    }

    /// By how much the true field may still grow until breakdown, in V/m.
    #[must_use]
    pub fn breakdown_margin(&self) -> f64 {
        let (basis, stage) = self.basis();
        let local = basis.local();
        local.breakdown_margin(&local.load(0.0), &stage) * basis.scales.field
    }

    /// By how much the true field may still grow until breakdown, as a part of the breakdown field;
    /// 1 where none is given.
    pub(super) fn breakdown_margin_part(&self) -> f64 {
        let (basis, stage) = self.basis();
        let Some(breakdown) = basis.device.breakdown else {
            return 1.0;
        };
        let local = basis.local();
        local.breakdown_margin(&local.load(0.0), &stage) / breakdown.field
    }

    /// The time of breakdown in s; +∞ until then.
    #[must_use]
    pub fn breakdown_time(&self) -> f64 {
        let at = match (self.place, self.collapse) {
            (_, Some(collapse)) if collapse.limit == SiLimit::Breakdown => Some(collapse.time),
            (Place::On(motion), _) => motion.breakdown(),
            (Place::At { account, .. }, _) => account.breakdown,
        };
        at.map_or(f64::INFINITY, |time| time.value())
    }

    /// The extremes of the stretch, where they are recorded.
    #[must_use]
    pub fn extremes(&self) -> Option<Extremes> {
        match self.place {
            Place::On(motion) => motion.extremes(),
            Place::At { record, .. } => record.extremes,
        }
    }
}

impl SiScene {
    /// Checks that the described actuator has a motion from its start.
    ///
    /// # Errors
    /// A message with the values that exclude each other, and which of them to change.
    pub(super) fn check(&self) -> Result<(), String> {
        let State { position, .. } = self.start.motion;
        let limits = self.limits;
        let [stretch, lower, upper] = [position, limits.lower, limits.upper].map(Shortest);
        if !(limits.lower < position && position < limits.upper) {
            return Err(format!(
                "lambda_start = {stretch} does not lie between lambda_min = {lower} and \
                 lambda_max = {upper}; set it, or the limits, so that it does"
            ));
        }
        let [limit, second, third] = self.stiffening;
        if limit > 0.0 && (second != 0.0 || third != 0.0) {
            return Err(format!(
                "J_m = {} chooses the Gent law and kappa2 = {}, kappa3 = {} the Yeoh law; set \
                 one of them to 0",
                Shortest(limit),
                Shortest(second),
                Shortest(third)
            ));
        }
        let source = self.source();
        for (other, name, unit) in [
            (Source::Current, "current", "A"),
            (Source::Charge, "charge_imposed", "C"),
        ] {
            let value = self.sources[super::scene::place(other)].value();
            if other != source && value != 0.0 {
                return Err(format!(
                    "{name} = {} {unit} is given, and the source imposes the {}; set source to \
                     {}, or {name} to 0",
                    Shortest(value),
                    source.name(),
                    other.name()
                ));
            }
        }
        if source != Source::Voltage && self.alternating[0] != 0.0 {
            return Err(format!(
                "V_ac = {} V is added to the supply voltage only, and the source imposes the {}; \
                 set V_ac to 0 or source to voltage",
                Shortest(self.alternating[0]),
                source.name()
            ));
        }
        let described = self.described();
        self.check_size(&Scales::of(&described))?;
        self.check_leak()?;
        let device = described.nondimensional();
        if let Elasticity::Gent(locking) = &device.elasticity {
            let [low, high] = [locking.smallest(), locking.largest()].map(|wall| wall.value());
            if !(low < position && position < high) {
                return Err(format!(
                    "lambda_start = {stretch} lies beyond locking, which J_m = {} puts at {} and \
                     {}; set it in between",
                    Shortest(limit),
                    Shortest(low),
                    Shortest(high)
                ));
            }
        }
        let permittivity = &device.permittivity;
        for stretch in permittivity
            .extremes()
            .into_iter()
            .filter(|stretch| (limits.lower..=limits.upper).contains(stretch))
            .chain([limits.lower, limits.upper])
        {
            let [value, _] = permittivity.at(stretch);
            if value <= 0.0 {
                let [k1, k2, k3] = permittivity.terms.map(Shortest);
                return Err(format!(
                    "k1 = {k1}, k2 = {k2} and k3 = {k3} make the permittivity {} of what it is at 1 \
                     where the stretch is {}; it must stay above 0 between lambda_min = {lower} and \
                     lambda_max = {upper}, set these nearer to 1 or other k",
                    Shortest(value),
                    Shortest(stretch)
                ));
            }
        }
        for k in 0..super::scene::BRANCHES {
            let dashpot = self.start.dashpots[k];
            let limit = device.branches[k].limit;
            let ratio = (position / dashpot).powi(2);
            let stretched = 2.0 * ratio + 1.0 / (ratio * ratio) - 3.0;
            if device.branches[k].modulus > 0.0 && stretched >= limit {
                return Err(format!(
                    "xi{0}_start = {1} stretches the spring of branch {0} beyond locking at \
                     lambda_start = {stretch}; set it nearer to lambda_start",
                    k + 1,
                    Shortest(dashpot)
                ));
            }
        }
        Ok(())
    }
}

impl SiScene {
    /// Refuses a voltage, a charge or a force far beyond what the actuator can bear. Most likely the power of
    /// ten is wrong, of this value or of the geometry or the modulus.
    fn check_size(&self, scales: &Scales) -> Result<(), String> {
        let voltage = self.sources[0].value().abs() + self.alternating[0].abs();
        let ideal = self.source() == Source::Voltage && self.device.series_resistance == 0.0;
        let force = self.force.value();
        for (given, name, value, most, unit, scale) in [
            (
                ideal,
                "voltage",
                voltage,
                MOST_VOLTAGE * scales.voltage,
                "V",
                "H*sqrt(mu/eps)",
            ),
            (
                true,
                "force",
                force,
                MOST_FORCE * scales.force,
                "N",
                "mu*L*H*n_layers",
            ),
            (
                self.source() == Source::Charge,
                "charge_imposed",
                self.sources[2].value(),
                MOST_CHARGE * scales.charge,
                "C",
                "n_layers*L^2*sqrt(eps*mu)",
            ),
            (
                self.folded().device.has_charge_state(),
                "charge_start",
                self.start.charge,
                MOST_CHARGE * scales.charge,
                "C",
                "n_layers*L^2*sqrt(eps*mu)",
            ),
        ] {
            if given && value.abs() > most {
                return Err(format!(
                    "{name} = {} {unit} is out of proportion to {scale}; set a value between -{} \
                     and {1} {unit}, or check H, L, mu, eps_r and n_layers",
                    Shortest(value),
                    Shortest(rounded(most))
                ));
            }
        }
        Ok(())
    }
}

impl SiScene {
    /// Refuses a conductivity that overflows in the field of the supply voltage.
    fn check_leak(&self) -> Result<(), String> {
        let (limit, voltage) = (self.device.conduction_field, self.sources[0].value());
        let field = voltage.abs() / self.device.thickness;
        if self.source() != Source::Voltage || limit == 0.0 || field <= MOST_FIELDS * limit {
            return Ok(());
        }
        Err(format!(
            "E_conduction = {} V/m is out of proportion to the field voltage/H = {} V/m, in which the \
             conductivity would grow by e^{:.0}; set 0 or at least {} V/m, or check voltage and H",
            Shortest(limit),
            Shortest(field),
            field / limit,
            Shortest(rounded(1.1 * field / MOST_FIELDS))
        ))
    }
}

/// Largest field at the start, in units of E_conduction.
const MOST_FIELDS: f64 = 100.0;

/// Largest voltage at the start, in units of V0: pull-in lies near 0.7.
const MOST_VOLTAGE: f64 = 10.0;

/// Largest charge at the start, in units of Q0: a neo-Hookean sheet that holds it has the stretch 10.
const MOST_CHARGE: f64 = 1000.0;

/// Largest force at the start, in units of P0.
const MOST_FORCE: f64 = 100.0;

/// A positive number to two digits.
fn rounded(value: f64) -> f64 {
    let unit = 10.0_f64.powi(value.log10().floor() as i32 - 1);
    (value / unit).floor() * unit
}

impl View<'_, Si> {
    /// The time at which the stretch came to a limit, in s; +∞ until then.
    #[must_use]
    pub fn pull_in_time(&self) -> f64 {
        match self.collapse {
            Some(collapse) if matches!(collapse.limit, SiLimit::Stretch(_)) => {
                collapse.time.value()
            }
            _ => f64::INFINITY,
        }
    }
}
