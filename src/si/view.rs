//! What a host can read at the present beside the quantities of a sample: energies, thresholds,
//! margins, extremes.

use super::sample::Basis;
use super::scene::SiScene;
use super::{Si, SiLimit, SiState};
use crate::actuator::device::{Elasticity, Exchanged, Source, Stored};
use crate::model::{AtLimit, Model, Place, View};
use crate::pull_in::device::{Fold, Glassy, dynamic, from_rest, quasi_static};
use crate::shortest::Shortest;
use crate::solver::State;
use crate::solver::coupled::{LocalCoupledEquation, Stage};
use crate::solver::double::Double;
use crate::solver::extremes::Extremes;
use crate::solver::limits::Limit;

impl View<'_, Si> {
    /// The limit at which the actuator is held. Where the simulation ends instead, the state on
    /// arrival remains.
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
            Place::On(motion) => motion.state(),
            Place::At { state, .. } => state,
        };
        if let Some(limit) = self.held() {
            state.motion.rate = 0.0;
            match limit {
                SiLimit::Stretch(Limit::Lower) => state.motion.position = self.scene.limits.lower,
                SiLimit::Stretch(Limit::Upper) => state.motion.position = self.scene.limits.upper,
                SiLimit::Breakdown => {}
            }
        }
        state
    }

    /// What the quantities are computed with, and the present stage.
    pub(super) fn basis(&self) -> (Basis, Stage) {
        let state = self.state();
        let held = matches!(self.held(), Some(SiLimit::Stretch(_)));
        let (origin, position) = match self.place {
            Place::On(motion) if !held => motion.stretch_from_origin(),
            _ => (Double::ZERO, state.motion.position),
        };
        let basis = Basis::of(self.scene, self.time, origin);
        let stage = basis.stage(&state, position);
        (basis, stage)
    }

    /// The derivative of the charge in A, where it is known from the motion.
    pub(super) fn charging(&self) -> Option<f64> {
        match self.place {
            Place::On(motion) if !self.is_held() => motion.charging(),
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

    /// What is stored, in J.
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

    /// What was lost and supplied since the start, in J; 0 where it is not recorded.
    #[must_use]
    pub fn exchanged(&self) -> Exchanged {
        match self.place {
            Place::On(motion) => motion.exchanged(),
            Place::At { .. } => Exchanged::from_integrals(&Default::default()),
        }
    }

    /// What is lost at present, in W.
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
        frequency / (std::f64::consts::TAU * basis.scales.time.value())
    }

    /// By how much the true field may still grow until breakdown, in V/m.
    #[must_use]
    pub fn breakdown_margin(&self) -> f64 {
        let (basis, stage) = self.basis();
        let local = basis.local();
        local.breakdown_margin(&local.load(0.0), &stage) * basis.scales.field
    }

    /// The same as a part of the breakdown field; 1 where none is given.
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
            _ => None,
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

    fn voltage_of(&self, fold: impl FnOnce(&Basis, f64) -> Option<f64>) -> f64 {
        let (basis, _) = self.basis();
        let prestress = basis.local().load(0.0_f64).prestress;
        fold(&basis, prestress).map_or(f64::INFINITY, |voltage| voltage * basis.scales.voltage)
    }

    /// The static pull-in voltage at the present force, in V; +∞ where there is none.
    #[must_use]
    pub fn static_pull_in(&self) -> f64 {
        self.voltage_of(|basis, prestress| voltage(quasi_static(&basis.device, prestress)))
    }

    /// That of a step without losses.
    #[must_use]
    pub fn dynamic_pull_in(&self) -> f64 {
        self.voltage_of(|basis, prestress| voltage(dynamic(&basis.device, prestress)))
    }

    /// That of a step with them.
    #[must_use]
    pub fn pull_in_from_rest(&self) -> f64 {
        self.voltage_of(|basis, prestress| from_rest(&basis.device, prestress))
    }

    /// The static one of the actuator whose branches have not relaxed.
    #[must_use]
    pub fn glassy_static_pull_in(&self) -> f64 {
        self.voltage_of(|basis, prestress| voltage(Glassy(&basis.device).quasi_static(prestress)))
    }

    /// That of a step of it.
    #[must_use]
    pub fn glassy_dynamic_pull_in(&self) -> f64 {
        self.voltage_of(|basis, prestress| voltage(Glassy(&basis.device).dynamic(prestress)))
    }

    /// The stretch to which the actuator snaps at the static pull-in voltage; 0 where it
    /// escapes or there is no such voltage.
    #[must_use]
    pub fn snaps_to(&self) -> f64 {
        let (basis, _) = self.basis();
        let prestress = basis.local().load(0.0_f64).prestress;
        let fold = quasi_static(&basis.device, prestress);
        fold.and_then(|fold| fold.snaps_to).unwrap_or(0.0)
    }

    /// By how much the voltage may grow until a step from rest pulls in, or else a slow ramp, in
    /// V; +∞ where neither does.
    #[must_use]
    pub fn pull_in_margin(&self) -> f64 {
        let limit = self.voltage_of(|basis, prestress| {
            from_rest(&basis.device, prestress)
                .or_else(|| voltage(quasi_static(&basis.device, prestress)))
        });
        limit - self.supply_voltage().abs()
    }
}

fn voltage(fold: Option<Fold>) -> Option<f64> {
    fold.map(|fold| fold.voltage)
}

impl SiScene {
    /// Why the actuator cannot begin as it is described, if it cannot.
    ///
    /// # Errors
    /// A message with the values that do not go together, and which to change.
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
        if self.source() != Source::Voltage && self.alternating[0] != 0.0 {
            return Err(format!(
                "V_ac = {} V is added to the supply voltage only, and the source imposes the {}; \
                 set V_ac to 0 or source to voltage",
                Shortest(self.alternating[0]),
                if self.source() == Source::Current {
                    "current"
                } else {
                    "charge"
                }
            ));
        }
        let device = self.described().nondimensional();
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
        let mut end = limits.lower;
        while end <= limits.upper {
            let [value, _] = device.permittivity.at(end);
            if value <= 0.0 {
                return Err(format!(
                    "k1, k2 and k3 make the permittivity {} of what it is at 1 where the stretch \
                     is {}; it must stay above 0 up to lambda_max = {upper}, set that lower or \
                     other k",
                    Shortest(value),
                    Shortest(end)
                ));
            }
            end *= 1.02;
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
