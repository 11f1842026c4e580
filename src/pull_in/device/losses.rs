//! The threshold of a step from rest of an actuator that loses energy.
//!
//! Under a constant voltage an actuator with damping or series resistance comes to rest. There is
//! a voltage at which it comes to rest on the saddle, the unstable equilibrium; below it comes
//! back, above it is pulled in. That voltage rises with the losses, and from some finite loss on
//! is the static threshold.
//!
//! Near that voltage the motion creeps along the saddle. There, with x = a e^(νt) + b e^(−µt), it
//! turns at a distance x ∝ |a|^(µ/(µ+ν)) or passes at a rate in proportion to it. What is found of
//! either gives a, which is smooth in the voltage and changes its sign at the threshold: some twenty
//! motions instead of the forty of a bisection. With a series resistance the charge decides as
//! well, the side on which the motion ends is all that is known, and it is a bisection.
//!
//! The stored energy less what the source and the prestress may still supply, L = stored − φ_s q −
//! 2Sλ, never grows. Once it is below its value at the saddle, the motion cannot pass any more,
//! and the side on which it is decides.

use super::search::bisect;
use super::{Curves, Fold, Point, RELAXED};
use crate::actuator::Drive;
use crate::actuator::device::equation::Load;
use crate::actuator::device::{Device, DeviceMotion, Port};
use crate::arithmetic::double_double::DoubleDouble;
use crate::arithmetic::jet::Dual;
use crate::arithmetic::number::Parameter;
use crate::solver::State;
use crate::solver::coupled::{
    CoupledEquation, Event, Failure, FullState, MOST_INTEGRALS, MOST_STATES, Progress, Stage,
    Trajectory,
};
use crate::solver::limits::{Limit, Limits};

/// How closely the motion is followed.
const TOLERANCE: f64 = 1e-14;

/// Relative width at which the search ends.
const RESOLUTION: f64 = 1e-13;

/// The largest number of times that a motion is interrupted to compute its energy.
const MOST_LOOKS: u32 = 1000;

/// Iterations of all motions of a search, at most: some seconds of work.
const MOST_WORK: u32 = 4_000_000;

/// By how much the time to the next look grows: beside the saddle and the fold it creeps.
const SELDOM: f64 = 1.05;

/// Time of charging in periods beyond which the motion follows the charge.
const SLOW_CHARGING: f64 = 100.0;

/// Between which stretches the motion is followed.
const LIMITS: Limits = Limits {
    lower: 1e-3,
    upper: super::LARGEST,
};

/// At rest at λ = 1, uncharged.
const REST: FullState = FullState {
    motion: State {
        position: 1.0,
        rate: 0.0,
    },
    internal: [0.0; MOST_STATES],
    integrals: [0.0; MOST_INTEGRALS],
};

/// The memory in which the motions are followed.
#[derive(Debug)]
pub struct Search {
    trajectory: Trajectory,
}

impl Default for Search {
    fn default() -> Search {
        Search {
            trajectory: Trajectory::new(REST, LIMITS, TOLERANCE),
        }
    }
}

/// The supply voltage above which a step from rest at λ = 1, with the membrane uncharged where
/// there is a series resistance, pulls the actuator in.
///
/// * Without losses it is [`super::dynamic`].
/// * With Maxwell branches it is [`super::quasi_static`] of the relaxed actuator: above it pull-in
///   comes, sooner or later.
/// * Where there is no dynamic threshold but a static one, it is the static one: a damped motion
///   may end in either well then, alternately with the voltage.
/// * Where the membrane charges more slowly than in a hundred periods, it is the static one too: the motion follows the
///   charge (in the paper's device from a twentieth of a period on). The same is given where a motion is too much work to be
///   followed.
/// * A leak enters by the division of the voltage that it makes: exactly if it is a fixed
///   resistor, at the static fold if it is the material.
///
/// `None` where the source does not impose the voltage, and where there is no threshold. The
/// computation follows some twenty motions, forty with a series resistance, in the memory of `search`.
#[must_use]
pub fn from_rest(device: &Device, prestress: f64, search: &mut Search) -> Option<Fold> {
    let curves = Curves::new(device, RELAXED, prestress)?;
    let fold = curves.quasi_static();
    let has_branches = device.present_branches().next().is_some();
    let lossless = device.damping.is_none() && device.port.resistance == 0.0;
    let dynamic = curves.dynamic();
    if has_branches {
        return fold;
    }
    if lossless {
        return dynamic;
    }
    let (Some(fold), Some(dynamic)) = (fold, dynamic) else {
        return fold;
    };
    // What the supply voltage is divided by.
    let point = curves.point(fold.stretch);
    let membrane = curves.equilibrium(point).term[0].max(0.0).sqrt();
    if membrane == 0.0 {
        return Some(fold);
    }
    let divider = fold.voltage / membrane;
    let port = Port {
        resistance: device.port.resistance / divider,
        conductance: 0.0,
        conductivity: 0.0,
        ..device.port
    };
    let lossy = Device {
        port,
        branches: RELAXED,
        breakdown: None,
        ..*device
    };
    let period = std::f64::consts::TAU * ((device.sheet.aspect + 2.0) / 6.0).sqrt();
    if lossy.port.resistance > SLOW_CHARGING * period {
        return Some(fold);
    }
    let (mut is_followed, mut work) = (true, MOST_WORK);
    let mut excess = |voltage: f64| {
        let trajectory = &mut search.trajectory;
        let excess = is_followed
            .then(|| {
                excess_of(
                    trajectory,
                    &lossy,
                    &curves,
                    [voltage, fold.stretch],
                    &mut work,
                )
            })
            .flatten();
        is_followed = excess.is_some();
        excess.unwrap_or(-1.0)
    };
    let (low, high) = (dynamic.voltage.min(membrane), membrane);
    let above = excess(high * (1.0 - 1e-12));
    if above <= 0.0 {
        return Some(fold);
    }
    let high = sign_change([low, high], [excess(low), above], excess);
    if !is_followed {
        return Some(fold);
    }
    let saddle = curves.saddle(high * high, fold.stretch)?;
    Some(Fold {
        voltage: divider * high,
        stretch: curves.stretch(saddle),
        snaps_to: dynamic.snaps_to,
    })
}

/// The upper end of the interval in which a function that grows from below to above zero does so,
/// within the [`RESOLUTION`]: by the method of the false position, which halves the value at an end
/// that stays, and by bisection where that is too slow.
fn sign_change(
    [mut low, mut high]: [f64; 2],
    [mut below, mut above]: [f64; 2],
    mut of: impl FnMut(f64) -> f64,
) -> f64 {
    let mut stays = 0;
    let mut earlier = f64::INFINITY;
    for round in 1..=200 {
        let width = high - low;
        let finest = RESOLUTION * high;
        if width <= finest || below > 0.0 {
            break;
        }
        let mut is_slow = [below, above] == [-1.0, 1.0];
        if round % 3 == 0 {
            is_slow |= width > 0.25 * earlier;
            earlier = width;
        }
        let middle = if is_slow {
            low.midpoint(high)
        } else {
            high - above * width / (above - below)
        };
        // Beside an end the other one closes up.
        let middle = middle.clamp(low + 0.4 * finest, high - 0.4 * finest);
        let value = of(middle);
        if value > 0.0 {
            (high, above) = (middle, value);
            if stays == 1 && !is_slow {
                below *= 0.5;
            }
            stays = 1;
        } else {
            (low, below) = (middle, value);
            if stays == -1 && !is_slow {
                above *= 0.5;
            }
            stays = -1;
        }
    }
    high
}

/// By how much a step to a voltage below the static threshold, whose fold is at this stretch,
/// passes the saddle; negative where it comes back. With a series resistance 1 or −1. `None` where
/// the motion is too much work.
fn excess_of(
    trajectory: &mut Trajectory,
    device: &Device,
    curves: &Curves,
    [voltage, fold]: [f64; 2],
    work: &mut u32,
) -> Option<f64> {
    let prestress = curves.prestress;
    let Some(point) = curves.saddle(voltage * voltage, fold) else {
        return Some(-1.0);
    };
    let barrier = curves.potential(point) - 0.5 * voltage * voltage * curves.capacitance(point);
    let saddle = curves.stretch(point);
    let motion = DeviceMotion {
        device: *device,
        drive: Drive::constant(voltage, prestress),
        records_energy: false,
    };
    let [growth, decay] = curves.exponents(device, voltage, point);
    let sum = growth + decay;
    let charges = device.has_charge_state();
    let limits = Limits {
        upper: if charges { LIMITS.upper } else { saddle },
        ..LIMITS
    };
    let mut clock = DoubleDouble::ZERO;
    trajectory.begin_anew(REST, limits, TOLERANCE);
    trajectory.record_extremes_anew(!charges);
    let period = ((device.sheet.aspect + 2.0) / 6.0).sqrt();
    let slowness = 1.0 + device.damping.coefficient(1.0) / period;
    let mut look = 0.5 * period * slowness;
    for _ in 0..MOST_LOOKS {
        match trajectory.advance(&motion, &mut clock, look, work) {
            Ok(Progress::Whole) => {}
            Ok(Progress::Stopped {
                limit: Event::Limit(Limit::Upper),
                ..
            }) if !charges => {
                let distance = trajectory.rate() / (decay * (growth / decay).powf(growth / sum));
                return Some(distance.max(0.0).powf(sum / decay).max(f64::MIN_POSITIVE));
            }
            Err(Failure::TooManySubsteps { .. }) => return None,
            _ => break,
        }
        look *= SELDOM;
        let (origin, position) = trajectory.position_from_origin();
        let stage = Stage {
            position,
            rate: trajectory.rate(),
            internal: trajectory.internal(),
        };
        let local = motion.at(&clock, &origin);
        let stored = local.stored(0.0, &stage);
        let supplied = if charges {
            voltage * stage.internal[0]
        } else {
            2.0 * stored.electric
        };
        let left = stored.total() - supplied - 2.0 * prestress * trajectory.position();
        // Without a charge of its own it also has to turn, for the distance at which it does.
        if left < barrier && (charges || stage.rate <= 0.0) {
            break;
        }
    }
    Some(match trajectory.extremes() {
        Some(extremes) => -(saddle - extremes.highest).max(0.0).powf(sum / decay),
        None if trajectory.position() > saddle => 1.0,
        None => -1.0,
    })
}

impl Curves {
    /// How fast a small distance from the saddle grows and decays under this voltage. A series
    /// resistance acts as damping, as long as the charge follows fast.
    fn exponents(&self, device: &Device, voltage: f64, saddle: Point) -> [f64; 2] {
        let [force, inertia] = self.at(saddle, |local| {
            let fixed = |value: f64| Dual::constant(value);
            let load = Load {
                source: fixed(voltage),
                prestress: fixed(self.prestress),
            };
            let stage = Stage {
                position: Dual::new(saddle.position, 1.0),
                rate: fixed(0.0),
                internal: [fixed(1.0); MOST_STATES],
            };
            let [force, inertia, _] = local.forces(&load, &stage);
            [force, inertia]
        });
        let stiffness = (force.slope() / inertia.value()).max(0.0);
        let stretch = self.stretch(saddle);
        let resistive = 8.0 * device.port.resistance * voltage * voltage * stretch.powi(2).powi(3);
        let viscous = device.damping.coefficient(stretch);
        let half = 0.5 * (viscous + resistive) / inertia.value();
        let root = (half * half + stiffness).sqrt();
        // Without the loss where the damping is strong.
        let decay = half + root;
        [(stiffness / decay).max(f64::MIN_POSITIVE), decay]
    }

    fn point(&self, stretch: f64) -> Point {
        Point {
            near_wall: false,
            position: stretch,
        }
    }

    /// The unstable equilibrium beyond the fold at this squared voltage.
    fn saddle(&self, squared: f64, fold: f64) -> Option<Point> {
        let holds = |point: Point| self.equilibrium(point).term[0] > squared;
        let mut last = self.point(fold);
        for point in self.grid().filter(|point| self.stretch(*point) > fold) {
            if !self.pulls(point) {
                return None;
            }
            if !holds(point) {
                let from = self.seen_as(last, point);
                let position = bisect(from.position, point.position, |position| {
                    holds(Point { position, ..point })
                });
                return Some(Point { position, ..point });
            }
            last = point;
        }
        None
    }
}
