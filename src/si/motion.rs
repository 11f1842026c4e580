//! The motion of the actuator in SI units, from communication point to communication point.
//!
//! The clock is in seconds, the trajectory in nondimensional time. The conversion of a step rounds it.
//! The next step corrects this, so that rounding errors do not add up.

mod energy;

use serde::{Deserialize, Serialize};

use super::folded::{Described, Folded};
use super::scene::{BRANCHES, OnBreakdown, SiScene, SiState};
use super::trajectory::SiTrajectory;
use super::{Si, SiLimit};
use crate::actuator::device::{DeviceMotion, Elasticity, LocalDevice};
use crate::actuator::scales::Scales;
use crate::arithmetic::double_double::DoubleDouble;
use crate::model::Integration;
use crate::shortest::Shortest;
use crate::solver::State;
use crate::solver::coupled::{self, CoupledEquation, LocalCoupledEquation, Stage};
use crate::solver::extremes::Extremes;
use crate::solver::trajectory::{Failure, Progress};

/// A motion in SI units.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct SiMotion {
    trajectory: SiTrajectory,
    /// By how much the trajectory is ahead of the clock, nondimensional: the rounding error of the steps so far.
    lead: f64,
    /// The last communication step, in s and nondimensional. Most hosts take equal steps.
    #[serde(skip)]
    converted: (f64, DoubleDouble),
    /// What the trajectory follows, nondimensional.
    motion: DeviceMotion,
    scales: Scales,
    tolerance: f64,
    /// The actuator as the host has described it. It is not saved: after a restore it is unknown.
    #[serde(skip)]
    described: Option<Described>,
    /// The scene has changed since the last advance.
    stale: bool,
    /// The charge at the start in C, which counts where the charge is not a state.
    charge: f64,
    /// The dashpots of absent branches.
    dashpots: [f64; BRANCHES],
    /// When the true field first reached breakdown, in s.
    breakdown: Option<DoubleDouble>,
    /// The extremes before the present trajectory began.
    earlier: Option<Extremes>,
}

impl SiMotion {
    /// The origin of the stretch, and the stretch counted from it.
    #[must_use]
    pub fn stretch_from_origin(&self) -> (DoubleDouble, f64) {
        self.trajectory.position_from_origin()
    }

    /// The stretch.
    #[must_use]
    pub fn stretch(&self) -> f64 {
        self.trajectory.position()
    }

    /// The stretch and its rate in 1/s.
    #[must_use]
    pub fn stretch_and_rate(&self) -> State {
        let State { position, rate } = self.trajectory.state();
        State {
            position,
            rate: rate / self.scales.time,
        }
    }

    /// The present state in SI units.
    #[must_use]
    pub fn state(&self) -> SiState {
        let states = self.trajectory.internal();
        let device = &self.motion.device;
        let mut places = states.into_iter();
        let charge = if device.has_charge_state() {
            places.next().unwrap_or_default() * self.scales.charge
        } else {
            self.charge
        };
        let mut dashpots = self.dashpots;
        for (dashpot, branch) in dashpots.iter_mut().zip(device.branches) {
            if branch.modulus > 0.0 {
                *dashpot = places.next().unwrap_or(1.0).sqrt();
            }
        }
        SiState {
            motion: self.stretch_and_rate(),
            charge,
            dashpots,
        }
    }

    /// The present state in SI units in a scene that may have changed since the last advance. Where the charge
    /// has become a state, it is the charge on the electrodes.
    #[must_use]
    pub fn state_in(&self, scene: &SiScene, time: &DoubleDouble) -> SiState {
        let mut state = self.state();
        let is_new = self.stale && !self.motion.device.has_charge_state();
        if is_new && scene.folded().device.has_charge_state() {
            state.charge = self.charge_on_electrodes(time);
        }
        state
    }

    /// The present state in SI units, with the charge that is on the electrodes: a changed actuator begins in it.
    fn carried_over(&self, time: &DoubleDouble) -> SiState {
        SiState {
            charge: self.charge_on_electrodes(time),
            ..self.state()
        }
    }

    /// The charge on the electrodes in C, before the changes since the last advance.
    pub(super) fn charge_on_electrodes(&self, time: &DoubleDouble) -> f64 {
        let charge = self.at_present(time, |local, stage| {
            let load = local.load(0.0);
            local.membrane_voltage(&load, stage) * local.capacitance(local.stretch(stage.position))
        });
        charge * self.scales.charge
    }

    /// The derivative of the charge in A, from the polynomial of the last step. None where the charge is not a
    /// state, or where the nondimensional `source` of the scene at `time` is not that of the last step.
    #[must_use]
    pub fn charging(&self, scene: &SiScene, time: &DoubleDouble, source: f64) -> Option<f64> {
        let SiTrajectory::Coupled(trajectory) = &self.trajectory else {
            return None;
        };
        let slopes = trajectory.slopes()?;
        let is_the_same = |load: f64| load == source && self.follows(scene);
        let goes_on = self.motion.device.has_charge_state()
            && (!self.stale
                || is_the_same(self.at_present(time, |local, _| local.load(0.0).source)));
        goes_on.then_some(slopes[0] * self.scales.current())
    }

    /// The extremes of the stretch, where they are recorded.
    #[must_use]
    pub fn extremes(&self) -> Option<Extremes> {
        let mut extremes = self.trajectory.extremes()?;
        if let Some(earlier) = self.earlier {
            extremes.include_all(earlier);
        }
        Some(extremes)
    }

    /// When the true field first reached breakdown.
    #[must_use]
    pub fn breakdown(&self) -> Option<DoubleDouble> {
        self.breakdown
    }

    /// The nondimensional time of the trajectory when the clock is at `time`.
    fn reached(&self, time: &DoubleDouble) -> DoubleDouble {
        self.scales.time(*time).plus(self.lead)
    }

    /// Evaluates something at the present, with the equation that is followed; the clock is at `time`.
    fn at_present<T>(
        &self,
        time: &DoubleDouble,
        look: impl FnOnce(&LocalDevice, &Stage) -> T,
    ) -> T {
        let (origin, position) = self.stretch_from_origin();
        let stage = Stage {
            position,
            rate: self.trajectory.state().rate,
            internal: self.trajectory.internal(),
        };
        look(&self.motion.at(&self.reached(time), &origin), &stage)
    }

    /// Whether the actuator of the scene is known to be the one that is followed.
    fn is_described(&self, scene: &SiScene) -> bool {
        let described = self.described.as_ref();
        described.is_some_and(|described| scene.is_still(described))
    }

    /// Whether the actuator of the scene is the one that is followed. Nondimensional numbers are compared: a
    /// parameter without effect does not count, and a restored motion, which has no description, continues.
    fn follows(&self, scene: &SiScene) -> bool {
        let same = self.is_described(scene) || {
            let Folded { device, scales, .. } = scene.folded();
            device == self.motion.device && scales == self.scales
        };
        same && scene.record_energy == self.motion.records_energy
    }

    /// Takes over the changed scene. Where only inputs have changed, the trajectory restarts. Where the
    /// actuator has changed, a new trajectory begins from the present state in SI units.
    fn refold(&mut self, scene: &SiScene, time: &DoubleDouble) {
        self.stale = false;
        if self.follows(scene) {
            if !self.is_described(scene) {
                self.described = Some(scene.folded().of);
            }
            let records = self.motion.records_energy;
            let before = records.then(|| self.at_present(time, |local, _| local.load(0.0).source));
            self.motion.drive = scene.drive(&self.scales);
            self.trajectory.restart();
            if let Some(before) = before {
                self.book_step(time, before);
            }
            return;
        }
        let (motion, scales) = (scene.motion(), scene.scales());
        let state = self.carried_over(time);
        let (sums, extremes) = (self.trajectory.integrals(), self.extremes());
        let energy = self.scales.energy / scales.energy;
        self.trajectory
            .begin_anew(scene, &motion, &scales, &state, self.tolerance);
        self.lead = 0.0;
        self.converted = (0.0, DoubleDouble::ZERO);
        self.dashpots = state.dashpots;
        (self.motion, self.scales) = (motion, scales);
        self.described = Some(scene.folded().of);
        self.earlier = extremes;
        self.trajectory.record_extremes_anew(extremes.is_some());
        self.trajectory.book(&sums.map(|sum| sum * energy));
        self.book_charging(scene, time, state.charge);
    }

    /// The nondimensional step that brings the trajectory to the clock after a communication step in s, and
    /// the lead that rounding leaves.
    #[inline]
    fn nondimensional(&mut self, step: f64) -> (f64, f64) {
        if step != self.converted.0 {
            self.converted = (step, self.scales.time(DoubleDouble::new(step)));
        }
        let DoubleDouble { high, low } = self.converted.1;
        let low = low - self.lead;
        let rest = high + low;
        (rest, (rest - high) - low)
    }

    /// The rest of [`Integration::advance`], where the motion leaves its step.
    #[inline(never)]
    fn advance_beyond_step(
        &mut self,
        scene: &SiScene,
        clock: &mut DoubleDouble,
        step: f64,
    ) -> Result<Progress<SiLimit>, Failure> {
        let (begin, second) = (*clock, self.scales.time);
        let target = begin.plus(step).renormalized();
        let end = self.scales.time(target);
        let from = self.reached(&begin);
        let mut reached = from;
        loop {
            let rest = end.since(reached);
            let progress = if rest > 0.0 {
                self.trajectory
                    .advance_beyond_step(&self.motion, &mut reached, rest)
            } else {
                Ok(Progress::Whole)
            };
            if progress == Ok(Progress::Whole) {
                *clock = target;
                self.lead = reached.since(end);
                return Ok(Progress::Whole);
            }
            // In s. Where the motion stops at once, rounding must not move the host's clock.
            let after = if reached == from {
                0.0
            } else {
                (step - end.since(reached) * second).max(0.0)
            };
            *clock = begin.plus(after).renormalized();
            self.lead = reached.since(self.scales.time(*clock));
            let limit = match progress {
                Ok(Progress::Whole) => continue,
                Ok(Progress::Stopped { limit, .. }) => match limit {
                    coupled::Event::Limit(limit) => SiLimit::Stretch(limit),
                    coupled::Event::Margin => {
                        self.break_down(*clock);
                        if scene.at_breakdown() == OnBreakdown::Flag {
                            continue;
                        }
                        SiLimit::Breakdown
                    }
                },
                Err(Failure::SubstepTooShort { length, .. }) => {
                    let length = length * second;
                    return Err(Failure::SubstepTooShort { length, after });
                }
                Err(Failure::TooManySubsteps { most, .. }) => {
                    return Err(Failure::TooManySubsteps { most, after });
                }
            };
            return Ok(Progress::Stopped { limit, after });
        }
    }

    /// Notes breakdown, which is awaited no more.
    fn break_down(&mut self, time: DoubleDouble) {
        self.breakdown = self.breakdown.or(Some(time));
        if let SiTrajectory::Coupled(trajectory) = &mut self.trajectory {
            trajectory.pass_margin();
        }
    }
}

impl Integration<Si> for SiMotion {
    fn begin(scene: &SiScene, time: &DoubleDouble, tolerance: f64) -> SiMotion {
        scene.thresholds.prepare();
        let (motion, scales) = (scene.motion(), scene.scales());
        let trajectory = SiTrajectory::of(scene, &motion, &scales, &scene.start, tolerance);
        let mut begun = SiMotion {
            trajectory,
            lead: 0.0,
            converted: (0.0, DoubleDouble::ZERO),
            motion,
            scales,
            tolerance,
            described: Some(scene.folded().of),
            stale: false,
            charge: scene.start.charge,
            dashpots: scene.start.dashpots,
            breakdown: None,
            earlier: None,
        };
        if scene.flags_breakdown(time, &scene.start) {
            begun.break_down(*time);
        }
        Integration::record_anew(&mut begun, scene);
        begun.book_charging(scene, time, scene.start.charge);
        begun
    }

    fn advance(
        &mut self,
        scene: &SiScene,
        clock: &mut DoubleDouble,
        step: f64,
    ) -> Result<Progress<SiLimit>, Failure> {
        if self.stale {
            self.refold(scene, clock);
        }
        let (rest, lead) = self.nondimensional(step);
        if self.trajectory.advance_inside_step(rest) {
            *clock = clock.plus(step);
            self.lead = lead;
            return Ok(Progress::Whole);
        }
        self.advance_beyond_step(scene, clock, step)
    }

    fn scene_changed(&mut self) {
        self.stale = true;
    }

    fn rest(&mut self, scene: &SiScene, time: &DoubleDouble) {
        if self.stale {
            self.refold(scene, time);
        }
    }

    fn restart(&mut self) {
        self.stale = true;
    }

    fn record_anew(&mut self, scene: &SiScene) {
        let records = scene.records_extremes();
        self.earlier = None;
        self.trajectory.record_extremes_anew(records);
    }

    fn is_valid(&self, scene: &SiScene, tolerance: f64) -> bool {
        let valid = self.trajectory.is_valid(scene, tolerance);
        let positive = |number: f64| number > 0.0 && number.is_finite();
        valid
            && self.tolerance == tolerance
            && self.lead.is_finite()
            && self.motion.is_plain() == self.trajectory.is_plain()
            && self.scales.are_valid()
            && self.charge.is_finite()
            && self.dashpots.into_iter().all(positive)
            && self.breakdown.is_none_or(|time| time.is_finite())
            && self.extremes().is_some() == scene.records_extremes()
            && self.earlier.is_none_or(|extremes| extremes.is_valid())
    }

    fn whereabouts(&self) -> String {
        let stretch = self.stretch();
        let locks = match &self.motion.device.elasticity {
            Elasticity::Gent(locking) => [locking.smallest(), locking.largest()]
                .iter()
                .any(|wall| wall.plus(-stretch).value().abs() <= f64::EPSILON * stretch),
            _ => false,
        };
        let remark = if locks {
            ", where the material locks (the distance to its locking stretch is too small to go on: J_m is too \
             small for these loads)"
        } else {
            ""
        };
        format!("stretch {}{remark}", Shortest(stretch))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::Model;

    /// Each conversion has a relative error of up to 1e-16, and their sum has no more.
    #[test]
    fn rounding_errors_of_converted_steps_do_not_add_up() {
        let scene = Si::at_start();
        for step in [1e-9, 6.1e-7, 1.0 / 3.0] {
            let mut motion = SiMotion::begin(&scene, &DoubleDouble::ZERO, 1e-9);
            let [mut seconds, mut reached] = [DoubleDouble::ZERO; 2];
            for _ in 0..100_000 {
                let (rest, lead) = motion.nondimensional(step);
                motion.lead = lead;
                reached = reached.add(DoubleDouble::new(rest));
                seconds = seconds.add(DoubleDouble::new(step));
            }
            let exact = motion.scales.time(seconds);
            let error = reached.since(exact).abs() / motion.nondimensional(step).0;
            assert!(error < 2e-16, "{step}: {error:e}");
        }
    }
}
