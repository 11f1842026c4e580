//! What a host reads beside the quantities of a sample: energies, thresholds, margins, extremes.

use super::sample::Basis;
use super::scene::SiScene;
use super::{OnBreakdown, REACHED, Si, SiLimit, SiState};
use crate::actuator::device::{Exchanged, Stored};
use crate::arithmetic::double_double::DoubleDouble;
use crate::model::{AtLimit, Model, Place, View};
use crate::solver::State;
use crate::solver::coupled::{LocalCoupledEquation, Stage};
use crate::solver::extremes::Extremes;
use crate::solver::limits::Limit;

impl SiScene {
    /// What can be read in a state.
    pub(super) fn seen_in<'a>(&'a self, time: &'a DoubleDouble, state: &SiState) -> View<'a, Si> {
        View::new(self, Place::of_state(*time, *state), time, None)
    }

    /// Whether the true field of a state has come to breakdown, but for this part of the breakdown field.
    pub(super) fn is_at_breakdown(
        &self,
        time: &DoubleDouble,
        state: &SiState,
        tolerance: f64,
    ) -> bool {
        self.device.breakdown_field > 0.0
            && self.seen_in(time, state).breakdown_margin_part() <= tolerance
    }

    /// Whether a state has come to a breakdown that does not end the motion.
    pub(super) fn flags_breakdown(&self, time: &DoubleDouble, state: &SiState) -> bool {
        self.at_breakdown() == OnBreakdown::Flag && self.is_at_breakdown(time, state, REACHED)
    }
}

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

    /// Whether the actuator is held at a limit of the stretch.
    pub(super) fn is_held_at_a_stretch(&self) -> bool {
        matches!(self.held(), Some(SiLimit::Stretch(_)))
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
        self.basis_in(&self.state())
    }

    /// The same, where the present state is known.
    pub(super) fn basis_in(&self, state: &SiState) -> (Basis, Stage) {
        let held = self.is_held_at_a_stretch();
        let (origin, position) = match self.place {
            Place::On(motion) if !held => motion.stretch_from_origin(),
            _ => (DoubleDouble::ZERO, state.motion.position),
        };
        let basis = Basis::of(self.scene, self.time, origin);
        let stage = basis.stage(state, position);
        (basis, stage)
    }

    /// The derivative of the charge in A, where the motion knows it under this nondimensional source.
    pub(super) fn charging(&self, source: f64) -> Option<f64> {
        match self.place {
            Place::On(motion) if !self.is_held() => motion.charging(self.scene, self.time, source),
            _ => None,
        }
    }

    /// The charge on the electrodes in C, before the changes of this instant.
    pub(super) fn charge_before(&self) -> f64 {
        match self.place {
            Place::On(motion) => motion.charge_on_electrodes(self.time),
            Place::At { account, .. } => account.before.unwrap_or_else(|| self.charge()),
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
            .first_order(&local.load(0.0), &stage)
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
