//! The motion of the actuator in SI units, from communication point to communication point.
//!
//! The time of the host is a sum of seconds in double length, divided once by the unit of time
//! at each step: what is rounded does not add up.

use serde::{Deserialize, Serialize};

use super::scene::{BRANCHES, OnBreakdown, SiScene, SiState, internal};
use super::{Si, SiLimit};
use crate::actuator::device::{DeviceMotion, Exchanged, LocalDevice};
use crate::actuator::scales::Scales;
use crate::model::Motion;
use crate::shortest::Shortest;
use crate::solver::State;
use crate::solver::coupled::{
    self, CoupledEquation, FullState, MOST_INTEGRALS, MOST_STATES, Stage,
};
use crate::solver::double::Double;
use crate::solver::extremes::Extremes;
use crate::solver::trajectory::{Failure, Progress, Trajectory};

/// How the motion is followed.
#[derive(Clone, Debug, Serialize, Deserialize)]
enum Course {
    /// As the paper's equation.
    Plain(Box<Trajectory>),
    /// As that of a real actuator.
    Coupled(Box<coupled::Trajectory>),
}

/// A motion in SI units.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct SiMotion {
    /// Present time of the model in s.
    clock: Double,
    course: Course,
    /// What the course follows, nondimensional.
    motion: DeviceMotion,
    scales: Scales,
    tolerance: f64,
    /// The scene has changed since.
    stale: bool,
    /// The charge at the start, in C, for as long as it is no state.
    charge: f64,
    /// The dashpots of absent branches.
    dashpots: [f64; BRANCHES],
    /// When the true field first reached breakdown, in s.
    breakdown: Option<Double>,
    /// The extremes before the course began.
    earlier: Option<Extremes>,
}

impl SiMotion {
    /// Where the stretch is counted from, and the stretch from there.
    #[must_use]
    pub fn stretch_from_origin(&self) -> (Double, f64) {
        match &self.course {
            Course::Plain(trajectory) => (Double::ZERO, trajectory.position()),
            Course::Coupled(trajectory) => trajectory.position_from_origin(),
        }
    }

    /// The present state in SI units.
    #[must_use]
    pub fn state(&self) -> SiState {
        let State { position, rate } = match &self.course {
            Course::Plain(trajectory) => trajectory.state(),
            Course::Coupled(trajectory) => trajectory.state(),
        };
        let states = self.internal();
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
            motion: State {
                position,
                rate: rate / self.scales.time.value(),
            },
            charge,
            dashpots,
        }
    }

    fn internal(&self) -> [f64; MOST_STATES] {
        match &self.course {
            Course::Plain(_) => [0.0; MOST_STATES],
            Course::Coupled(trajectory) => trajectory.internal(),
        }
    }

    /// The derivative of the charge in A, from its polynomial, where it is a state that has moved.
    #[must_use]
    pub fn charging(&self) -> Option<f64> {
        let Course::Coupled(trajectory) = &self.course else {
            return None;
        };
        let has_charge = self.motion.device.has_charge_state() && !self.stale;
        let slopes = trajectory.slopes().filter(|_| has_charge)?;
        Some(slopes[0] * self.scales.current())
    }

    /// Energies lost and supplied since the start in J; 0 where they are not recorded.
    #[must_use]
    pub fn exchanged(&self) -> Exchanged {
        Exchanged::from_integrals(&self.integrals().map(|sum| sum * self.scales.energy))
    }

    fn integrals(&self) -> [f64; MOST_INTEGRALS] {
        match &self.course {
            Course::Plain(_) => [0.0; MOST_INTEGRALS],
            Course::Coupled(trajectory) => trajectory.integrals(),
        }
    }

    /// The extremes of the stretch, where they are recorded.
    #[must_use]
    pub fn extremes(&self) -> Option<Extremes> {
        let mut extremes = match &self.course {
            Course::Plain(trajectory) => trajectory.extremes(),
            Course::Coupled(trajectory) => trajectory.extremes(),
        }?;
        if let Some(Extremes { lowest, highest }) = self.earlier {
            extremes.include(lowest);
            extremes.include(highest);
        }
        Some(extremes)
    }

    /// When the true field first reached breakdown.
    #[must_use]
    pub fn breakdown(&self) -> Option<Double> {
        self.breakdown
    }

    fn time(&self) -> Double {
        match &self.course {
            Course::Plain(trajectory) => *trajectory.time(),
            Course::Coupled(trajectory) => *trajectory.time(),
        }
    }

    /// A course from this state on, at the time of the clock.
    fn course(
        scene: &SiScene,
        motion: &DeviceMotion,
        scales: &Scales,
        state: &SiState,
        (clock, tolerance): (Double, f64),
    ) -> Course {
        let start = State {
            position: state.motion.position,
            rate: state.motion.rate * scales.time.value(),
        };
        let time = scales.time(clock);
        if motion.is_plain() {
            return Course::Plain(Box::new(Trajectory::new(
                start,
                time,
                scene.limits,
                tolerance,
            )));
        }
        let full = FullState {
            internal: internal(
                &motion.device,
                state.charge / scales.charge,
                &state.dashpots,
            ),
            ..FullState::of(start)
        };
        Course::Coupled(Box::new(coupled::Trajectory::new(
            full,
            time,
            scene.limits,
            tolerance,
        )))
    }

    /// The present as the motion that is followed sees it.
    fn at_present<T>(&self, look: impl FnOnce(&LocalDevice, &Stage) -> T) -> T {
        let (origin, position) = self.stretch_from_origin();
        let rate = match &self.course {
            Course::Plain(trajectory) => trajectory.rate(),
            Course::Coupled(trajectory) => trajectory.rate(),
        };
        let stage = Stage {
            position,
            rate,
            internal: self.internal(),
        };
        look(&self.motion.at(&self.time(), &origin), &stage)
    }

    /// Follows what the scene has become. Where only inputs have changed, the course goes on
    /// with what it knows; where the actuator has, it begins anew from the state in SI units.
    fn refold(&mut self, scene: &SiScene) {
        use crate::solver::coupled::LocalCoupledEquation;
        self.stale = false;
        let (motion, scales) = (scene.motion(), scene.scales());
        let same = motion.device == self.motion.device
            && motion.records_energy == self.motion.records_energy
            && scales == self.scales;
        let source = self.at_present(|local, _| local.load(0.0).source);
        let before = source * self.scales.source(self.motion.device.port.source);
        if same {
            self.motion = motion;
            match &mut self.course {
                Course::Plain(trajectory) => trajectory.restart(),
                Course::Coupled(trajectory) => trajectory.restart(),
            }
            self.book_step(before);
            return;
        }
        let charge = self.at_present(|local, stage| {
            let load = local.load(0.0);
            local.membrane_voltage(&load, stage) * local.capacitance(local.stretch(stage.position))
        });
        let state = SiState {
            charge: charge * self.scales.charge,
            ..self.state()
        };
        let (exchanged, extremes) = (self.exchanged(), self.extremes());
        let begin = (self.clock, self.tolerance);
        self.course = SiMotion::course(scene, &motion, &scales, &state, begin);
        (self.charge, self.dashpots) = (state.charge, state.dashpots);
        (self.motion, self.scales) = (motion, scales);
        self.earlier = extremes;
        match &mut self.course {
            Course::Plain(trajectory) => trajectory.record_extremes_anew(extremes.is_some()),
            Course::Coupled(trajectory) => {
                trajectory.record_extremes_anew(extremes.is_some());
                let sums = exchanged.all().map(|sum| sum / scales.energy);
                trajectory.jump(&[0.0; MOST_STATES], &sums);
            }
        }
    }

    /// Books what a step of an ideal source from this value, in its unit, exchanges at once.
    fn book_step(&mut self, before: f64) {
        if !self.motion.records_energy {
            return;
        }
        let previous = before / self.scales.source(self.motion.device.port.source);
        let exchanged = self.at_present(|local, stage| local.exchanged_by_step(previous, stage));
        if let Course::Coupled(trajectory) = &mut self.course {
            trajectory.jump(&[0.0; MOST_STATES], &exchanged.all());
        }
    }

    fn advance_course(&mut self, step: f64) -> Result<Progress<coupled::Event>, Failure> {
        match &mut self.course {
            Course::Plain(trajectory) => {
                let progress = trajectory.advance(&self.motion.plain(), step)?;
                Ok(match progress {
                    Progress::Whole => Progress::Whole,
                    Progress::Stopped { limit, after } => Progress::Stopped {
                        limit: coupled::Event::Limit(limit),
                        after,
                    },
                })
            }
            Course::Coupled(trajectory) => trajectory.advance(&self.motion, step),
        }
    }
}

impl Motion<Si> for SiMotion {
    fn begin(scene: &SiScene, time: Double, tolerance: f64) -> SiMotion {
        let (motion, scales) = (scene.motion(), scene.scales());
        let course = SiMotion::course(scene, &motion, &scales, &scene.start, (time, tolerance));
        let mut begun = SiMotion {
            clock: time,
            course,
            motion,
            scales,
            tolerance,
            stale: false,
            charge: scene.start.charge,
            dashpots: scene.start.dashpots,
            breakdown: None,
            earlier: None,
        };
        Motion::record_anew(&mut begun, scene);
        // An ideal source charges the membrane at once.
        let capacitance =
            begun.at_present(|local, stage| local.capacitance(local.stretch(stage.position)));
        let before = match motion.device.port.source {
            crate::actuator::device::Source::Voltage => {
                scene.start.charge / (scales.capacitance * capacitance)
            }
            _ => scene.start.charge,
        };
        begun.book_step(before);
        begun
    }

    fn advance(&mut self, scene: &SiScene, step: f64) -> Result<Progress<SiLimit>, Failure> {
        if self.stale {
            self.refold(scene);
        }
        let (begin, second) = (self.clock, self.scales.time.value());
        let target = begin.plus(step).tightened();
        let end = self.scales.time(target);
        loop {
            let rest = end.since(self.time());
            if rest <= 0.0 {
                self.clock = target;
                return Ok(Progress::Whole);
            }
            let progress = self.advance_course(rest);
            // What is left of the step, in s.
            let passed = |left: f64| step - left * second;
            match progress {
                Ok(Progress::Whole) => {
                    self.clock = target;
                    return Ok(Progress::Whole);
                }
                Ok(Progress::Stopped { limit, .. }) => {
                    let after = passed(end.since(self.time()));
                    self.clock = begin.plus(after).tightened();
                    let limit = match limit {
                        coupled::Event::Limit(limit) => SiLimit::Stretch(limit),
                        coupled::Event::Margin => {
                            self.breakdown = self.breakdown.or(Some(self.clock));
                            if let Course::Coupled(trajectory) = &mut self.course {
                                trajectory.pass_margin();
                            }
                            if scene.on_breakdown == OnBreakdown::Flag {
                                continue;
                            }
                            SiLimit::Breakdown
                        }
                    };
                    return Ok(Progress::Stopped { limit, after });
                }
                Err(failure) => {
                    let after = passed(end.since(self.time()));
                    self.clock = begin.plus(after).tightened();
                    return Err(match failure {
                        Failure::SubstepTooShort { length, .. } => Failure::SubstepTooShort {
                            length: length * second,
                            after,
                        },
                        Failure::TooManySubsteps { most, .. } => {
                            Failure::TooManySubsteps { most, after }
                        }
                    });
                }
            }
        }
    }

    fn restart(&mut self) {
        self.stale = true;
    }

    fn record_anew(&mut self, scene: &SiScene) {
        let records = scene.records_extremes();
        self.earlier = None;
        match &mut self.course {
            Course::Plain(trajectory) => trajectory.record_extremes_anew(records),
            Course::Coupled(trajectory) => trajectory.record_extremes_anew(records),
        }
    }

    fn wait(&mut self, time: Double) {
        self.clock = self.clock.add(time);
        let time = self.scales.time(time);
        match &mut self.course {
            Course::Plain(trajectory) => trajectory.wait(time),
            Course::Coupled(trajectory) => trajectory.wait(time),
        }
    }

    fn set_clock(&mut self, scene: &SiScene, time: Double) -> bool {
        self.clock = time;
        let time = self.scales.time(time);
        match &mut self.course {
            Course::Plain(trajectory) => trajectory.set_clock(time),
            Course::Coupled(trajectory) => trajectory.set_clock(time),
        }
        scene.depends_on_time()
    }

    fn time(&self) -> &Double {
        &self.clock
    }

    fn is_valid(&self, scene: &SiScene, tolerance: f64) -> bool {
        let sound = match &self.course {
            Course::Plain(trajectory) => {
                trajectory.is_sound() && trajectory.keeps_to(scene.limits, tolerance)
            }
            Course::Coupled(trajectory) => {
                trajectory.is_sound() && trajectory.keeps_to(scene.limits, tolerance)
            }
        };
        let positive = |number: f64| number > 0.0 && number.is_finite();
        let Scales {
            time,
            voltage,
            charge,
            energy,
            force,
            capacitance,
            length,
            field,
        } = self.scales;
        sound
            && self.tolerance == tolerance
            && self.clock.is_finite()
            && self.motion.is_plain() == matches!(self.course, Course::Plain(_))
            && [
                time.value(),
                voltage,
                charge,
                energy,
                force,
                capacitance,
                length,
                field,
            ]
            .into_iter()
            .all(positive)
            && self.charge.is_finite()
            && self.dashpots.into_iter().all(positive)
            && self.breakdown.is_none_or(|time| time.is_finite())
            && self.extremes().is_some() == scene.records_extremes()
            && self.earlier.is_none_or(|Extremes { lowest, highest }| {
                lowest <= highest && lowest.is_finite() && highest.is_finite()
            })
    }

    fn whereabouts(&self) -> String {
        format!("stretch {}", Shortest(self.state().motion.position))
    }
}
