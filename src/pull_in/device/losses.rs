//! The threshold of a step from rest of an actuator that loses energy.
//!
//! Under a constant voltage an actuator with damping or series resistance comes to rest. There is
//! a voltage at which it comes to rest on the saddle, the unstable equilibrium; below it comes
//! back, above it is pulled in. That voltage rises with the losses, and from some finite loss on
//! is the static threshold. It is found by bisection on the motion.
//!
//! The stored energy less what the source and the prestress may still supply, L = stored − φ_s q −
//! 2Sλ, never grows. Once it is below its value at the saddle, the motion cannot pass any more,
//! and the side on which it is decides.

use super::search::bisect;
use super::{Curves, Fold, Point, RELAXED};
use crate::actuator::Drive;
use crate::actuator::device::{Device, DeviceMotion, Port};
use crate::solver::State;
use crate::solver::coupled::{
    CoupledEquation, FullState, MOST_INTEGRALS, MOST_STATES, Progress, Stage, Trajectory,
};
use crate::solver::double::Double;
use crate::solver::limits::Limits;

/// How closely the motion is followed.
const TOLERANCE: f64 = 1e-14;

/// Relative width at which the bisection ends.
const RESOLUTION: f64 = 1e-13;

/// Looks at the motion in each of which it is asked for its energy, at most.
const MOST_LOOKS: u32 = 100_000;

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
            trajectory: Trajectory::new(REST, Double::ZERO, LIMITS, TOLERANCE),
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
/// * A leak enters by the division of the voltage that it makes: exactly if it is a fixed
///   resistor, at the static fold if it is the material.
///
/// `None` where the source does not impose the voltage, and where there is no threshold. The
/// computation follows some forty motions, in the memory of `search`: a tenth of a second.
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
    let mut is_pulled_in = |voltage: f64| {
        let trajectory = &mut search.trajectory;
        pulls_in(trajectory, &lossy, &curves, voltage, fold.stretch)
    };
    let (mut low, mut high) = (dynamic.voltage.min(membrane), membrane);
    if !is_pulled_in(high * (1.0 - 1e-12)) {
        return Some(fold);
    }
    while high - low > RESOLUTION * high {
        let middle = low.midpoint(high);
        if is_pulled_in(middle) {
            high = middle;
        } else {
            low = middle;
        }
    }
    let saddle = curves.saddle(high * high, fold.stretch)?;
    Some(Fold {
        voltage: divider * high,
        stretch: curves.stretch(saddle),
        snaps_to: dynamic.snaps_to,
    })
}

/// Whether a step to a voltage below the static threshold pulls in, whose fold is at this
/// stretch.
fn pulls_in(
    trajectory: &mut Trajectory,
    device: &Device,
    curves: &Curves,
    voltage: f64,
    fold: f64,
) -> bool {
    let prestress = curves.prestress;
    let Some(saddle) = curves.saddle(voltage * voltage, fold) else {
        return false;
    };
    let barrier = curves.potential(saddle) - 0.5 * voltage * voltage * curves.capacitance(saddle);
    let saddle = curves.stretch(saddle);
    let motion = DeviceMotion {
        device: *device,
        drive: Drive::constant(voltage, prestress),
        records_energy: false,
    };
    trajectory.begin_anew(REST, Double::ZERO, LIMITS, TOLERANCE);
    let period = ((device.sheet.aspect + 2.0) / 6.0).sqrt();
    let slowness = 1.0 + (device.damping.linear + 6.0 * device.damping.viscosity) / period;
    let look = 0.5 * period * slowness;
    for _ in 0..MOST_LOOKS {
        if trajectory.advance(&motion, look) != Ok(Progress::Whole) {
            break;
        }
        let (origin, position) = trajectory.position_from_origin();
        let stage = Stage {
            position,
            rate: trajectory.rate(),
            internal: trajectory.internal(),
        };
        let local = motion.at(trajectory.time(), &origin);
        let stored = local.stored(0.0, &stage);
        let supplied = if device.has_charge_state() {
            voltage * stage.internal[0]
        } else {
            2.0 * stored.electric
        };
        let left = stored.total() - supplied - 2.0 * prestress * trajectory.position();
        if left < barrier {
            break;
        }
    }
    trajectory.position() > saddle
}

impl Curves {
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
