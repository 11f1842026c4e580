//! Thresholds of a real actuator: with stiffening, permittivity, spring, surfaces, prestress and
//! losses.
//!
//! | threshold | meaning |
//! |---|---|
//! | [`quasi_static`] | the first fold of the equilibria under a slowly raised voltage, Maxwell branches relaxed |
//! | [`dynamic`] | a step from rest at λ = 1 without losses, branches relaxed |
//! | [`from_rest`] | a step from rest with damping and series resistance |
//! | [`Glassy`] | the actuator whose branches have had no time to relax, for either of the first two |
//!
//! With R(λ) = (λ − λ⁻⁵)h + F_surface + k̄(λ − l̄) − S, its integral 2∫R = U and the factor
//! d = λ³e + ¼λ⁴e' of the squared voltage in the force, the curves are
//!
//! > Ψ = R/d,  Φ = 2(U(λ) − U(1))/(λ⁴e − 1),  Φ' = 4d (Ψ − Φ)/(λ⁴e − 1).
//!
//! A first maximum is looked for on a grid, since with stiffening nothing is proved about the
//! shape of the curves: where the slope changes its sign, or dips below zero between two points
//! of the grid. Beyond a maximum the curve may rise again: then the actuator snaps to a second
//! equilibrium or orbit and does not escape.

use crate::actuator::Drive;
use crate::actuator::device::equation::Load;
use crate::actuator::device::parameters::MOST_BRANCHES;
use crate::actuator::device::{Branch, Damping, Device, Elasticity, LocalDevice, Port, Source};
use crate::arithmetic::double_double::DoubleDouble;
use crate::arithmetic::jet::Dual;
use crate::arithmetic::number::Number;
use crate::solver::coupled::{MOST_STATES, Stage};

mod losses;
mod search;

pub use losses::{Search, from_rest};
use search::bisect;

/// The largest stretch looked at, where the material does not lock.
const LARGEST: f64 = 1e4;

/// Ratio of neighbouring stretches of the grid.
const RATIO: f64 = 1.01;

/// From this part of the locking stretch on, the distance to it is what matters.
const NEAR_WALL: f64 = 0.8;

/// Ratio of neighbouring distances to the locking stretch; and where they are smaller than this part of it, so that the
/// curves are powers of the distance to every digit.
const APPROACH: f64 = 0.8;
const AT_WALL: f64 = 1e-18;
const APPROACH_AT_WALL: f64 = 1e-3;

/// A maximum of a curve of squared voltage over stretch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fold {
    /// The supply voltage, nondimensional.
    pub voltage: f64,
    /// The stretch there.
    pub stretch: f64,
    /// Where a slightly larger voltage leads to: the next stretch at which the curve is as high.
    /// Nothing where the actuator escapes.
    pub snaps_to: Option<f64>,
}

/// The actuator whose Maxwell branches act as springs only, so fast that they do not relax.
/// Its thresholds are those of a voltage that comes and goes faster than the branches relax.
#[derive(Clone, Copy, Debug)]
pub struct Glassy<'a>(pub &'a Device);

impl Glassy<'_> {
    /// [`quasi_static`] of it.
    #[must_use]
    pub fn quasi_static(&self, prestress: f64) -> Option<Fold> {
        Curves::new(self.0, self.0.branches, prestress)?.quasi_static()
    }

    /// [`dynamic`] of it.
    #[must_use]
    pub fn dynamic(&self, prestress: f64) -> Option<Fold> {
        Curves::new(self.0, self.0.branches, prestress)?.dynamic()
    }
}

/// The first fold of the equilibria, reached by a slow rise of the voltage from the rest under
/// the prestress. A leak together with a series resistance divides the supply voltage. `None`
/// where there is no fold, or where the source does not impose the voltage: at imposed charge
/// every equilibrium is stable.
#[must_use]
pub fn quasi_static(device: &Device, prestress: f64) -> Option<Fold> {
    Curves::new(device, RELAXED, prestress)?.quasi_static()
}

/// The threshold of a step from rest at λ = 1, without any losses. `None` where the turning
/// stretch grows steadily with the voltage: there is no jump then, though a slow ramp may have
/// one.
#[must_use]
pub fn dynamic(device: &Device, prestress: f64) -> Option<Fold> {
    Curves::new(device, RELAXED, prestress)?.dynamic()
}

/// Branches that carry nothing.
const RELAXED: [Branch; MOST_BRANCHES] = [Branch::NONE; MOST_BRANCHES];

/// A point of a grid: the position, counted from an origin.
#[derive(Clone, Copy, Debug)]
struct Point {
    near_wall: bool,
    position: f64,
}

/// What the curves are made of.
struct Curves {
    /// The actuator without losses under an ideal source.
    still: Device,
    /// Its port as it is.
    port: Port,
    prestress: f64,
    wall: Option<DoubleDouble>,
}

impl Curves {
    fn new(device: &Device, branches: [Branch; MOST_BRANCHES], prestress: f64) -> Option<Curves> {
        if device.port.source != Source::Voltage {
            return None;
        }
        let still = Device {
            branches,
            damping: Damping::NONE,
            port: Port {
                resistance: 0.0,
                ..device.port
            },
            ..*device
        };
        let wall = match &device.elasticity {
            Elasticity::Gent(locking) => Some(locking.largest()),
            _ => None,
        };
        Some(Curves {
            still,
            port: device.port,
            prestress,
            wall,
        })
    }

    /// Points from the stretch 1 on, upwards.
    fn grid(&self) -> impl Iterator<Item = Point> {
        let wall = self.wall.map(|wall| wall.value());
        let far = wall.map_or(LARGEST, |wall| NEAR_WALL * wall).max(1.0);
        let outer = std::iter::successors(Some(1.0), |stretch| Some(stretch * RATIO))
            .skip(1)
            .take_while(move |stretch| *stretch < far)
            .map(|position| Point {
                near_wall: false,
                position,
            });
        let nearest = wall.map(|wall| (wall - far).min(wall - 1.0) * (1.0 - 1e-6));
        let closer = move |distance: &f64| {
            let at_wall = *distance < AT_WALL * far;
            Some(distance * if at_wall { APPROACH_AT_WALL } else { APPROACH })
        };
        let inner = std::iter::successors(nearest, closer)
            .take_while(|distance| *distance > 1e-300)
            .map(|distance| Point {
                near_wall: true,
                position: -distance,
            });
        outer.chain(inner)
    }

    fn origin(&self, point: Point) -> DoubleDouble {
        match self.wall {
            Some(wall) if point.near_wall => wall,
            _ => DoubleDouble::ZERO,
        }
    }

    fn at<T>(&self, point: Point, f: impl FnOnce(&LocalDevice) -> T) -> T {
        let drive = Drive::constant(0.0, self.prestress);
        f(&LocalDevice::new(
            &self.still,
            &drive,
            &DoubleDouble::ZERO,
            &self.origin(point),
        ))
    }

    fn stretch(&self, point: Point) -> f64 {
        self.origin(point).plus(point.position).value()
    }

    /// Ψ at a point, as a number and its slope.
    fn equilibrium(&self, point: Point) -> Dual {
        self.at(point, |local| {
            let position = Dual::new(point.position, 1.0);
            let zero = Dual::constant(0.0);
            let load = Load {
                source: zero,
                prestress: Dual::constant(self.prestress),
            };
            let stage = Stage {
                position,
                rate: zero,
                internal: [Dual::constant(1.0); MOST_STATES],
            };
            let stretch = local.stretch(position);
            let [force, ..] = local.forces(&load, &stage);
            (zero - force) / self.still.permittivity.pull(stretch)
        })
    }

    /// The squared supply voltage that holds the actuator at a point, and its slope.
    fn supply(&self, point: Point) -> Dual {
        let psi = self.equilibrium(point);
        let leaks = self.port.conductance > 0.0 || self.port.conductivity > 0.0;
        if self.port.resistance == 0.0 || !leaks || psi.term[0] <= 0.0 {
            return psi;
        }
        self.at(point, |local| {
            let stretch = local.stretch(Dual::new(point.position, 1.0));
            let conductance = local.conductance(psi.sqrt(), stretch * stretch)[0];
            let divider = Dual::constant(self.port.resistance) * conductance + Dual::constant(1.0);
            psi * divider * divider
        })
    }

    /// U − 2Sλ at a point.
    fn potential(&self, point: Point) -> f64 {
        self.at(point, |local| {
            let stage = Stage {
                position: point.position,
                rate: 0.0,
                internal: [1.0; MOST_STATES],
            };
            local.stored(0.0, &stage).total() - 2.0 * self.prestress * self.stretch(point)
        })
    }

    /// λ⁴e at a point.
    fn capacitance(&self, point: Point) -> f64 {
        let stretch = self.stretch(point);
        stretch.powi(4) * self.still.permittivity.at(stretch)[0]
    }

    /// Φ at a point above λ = 1.
    fn stagnation(&self, point: Point) -> f64 {
        2.0 * (self.potential(point) - self.potential(REST)) / (self.capacitance(point) - 1.0)
    }

    fn quasi_static(&self) -> Option<Fold> {
        let rest = self.rest()?;
        let points = self
            .below_rest(rest)
            .chain(self.grid().filter(|point| self.stretch(*point) > rest));
        let slope = |point: Point| self.supply(point).slope();
        let value = |point: Point| self.supply(point).term[0];
        self.first_fold(points, slope, value)
    }

    fn dynamic(&self) -> Option<Fold> {
        let slope = |point: Point| self.equilibrium(point).term[0] - self.stagnation(point);
        let value = |point: Point| {
            if point.position == REST.position && !point.near_wall {
                self.equilibrium(point).term[0]
            } else {
                self.stagnation(point)
            }
        };
        let first = self.grid().next()?;
        if slope(first) < 0.0 {
            // The curve falls from λ = 1 on: an unstable equilibrium there.
            return Some(self.fold_at(REST, value(REST), self.grid(), value));
        }
        self.first_fold(self.grid(), slope, value)
    }

    /// The stretch at rest without voltage, led to from λ = 1 by the force.
    fn rest(&self) -> Option<f64> {
        let force = |stretch: f64| {
            let point = Point {
                near_wall: false,
                position: stretch,
            };
            self.equilibrium(point).term[0]
        };
        let at_one = force(1.0);
        if at_one == 0.0 {
            return Some(1.0);
        }
        let holds = |stretch: f64| force(stretch) * at_one > 0.0;
        if at_one < 0.0 {
            first_change(self.grid().map(|point| self.stretch(point)), holds)
        } else {
            first_change(self.contracted(), holds)
        }
    }

    /// Stretches below 1, downwards.
    fn contracted(&self) -> impl Iterator<Item = f64> {
        let lowest = match &self.still.elasticity {
            Elasticity::Gent(locking) => locking.smallest().value() * (1.0 + 1e-12),
            _ => 1.0 / LARGEST,
        };
        std::iter::successors(Some(1.0), |stretch| Some(stretch / RATIO))
            .skip(1)
            .take_while(move |stretch| *stretch > lowest)
    }

    /// The points between the stretch at rest and 1, where it is contracted at rest.
    fn below_rest(&self, rest: f64) -> impl Iterator<Item = Point> {
        let steps = ((1.0 / rest).ln() / RATIO.ln()).ceil().max(0.0) as usize;
        (1..=steps).map(move |k| Point {
            near_wall: false,
            position: rest * (k as f64 / steps as f64 * (1.0 / rest).ln()).exp(),
        })
    }
}

/// λ = 1.
const REST: Point = Point {
    near_wall: false,
    position: 1.0,
};

/// Where a condition that holds at 1 first ceases to hold along these stretches.
fn first_change(stretches: impl Iterator<Item = f64>, holds: impl Fn(f64) -> bool) -> Option<f64> {
    let mut last = 1.0;
    for stretch in stretches {
        if !holds(stretch) {
            return Some(bisect(last, stretch, holds));
        }
        last = stretch;
    }
    None
}
