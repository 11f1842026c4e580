//! Pull-in voltages. Each is computed when it is first read, and kept until the actuator or its prestress
//! changes. The pull-in voltage with losses is found by following at least twenty motions.

use std::cell::{Cell, RefCell};

use super::Si;
use crate::actuator::device::Device;
use crate::model::View;
use crate::pull_in::device::{Fold, Glassy, Search, dynamic, from_rest, quasi_static};
use crate::solver::coupled::LocalCoupledEquation;

/// A kind of pull-in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum PullIn {
    /// Under a slowly raised voltage; the Maxwell branches are relaxed.
    Static,
    /// After a step of the voltage, without losses.
    Dynamic,
    /// After a step of the voltage from rest, with losses.
    FromRest,
    /// Static, with branches that have not relaxed.
    GlassyStatic,
    /// Dynamic, with branches that have not relaxed.
    GlassyDynamic,
}

const COUNT: usize = PullIn::GlassyDynamic as usize + 1;

/// The thresholds that have been computed.
#[derive(Clone, Copy, Debug)]
struct Known {
    /// The actuator and its prestress.
    of: Option<(Device, f64)>,
    /// Each threshold that has been read; inside, none where there is no such pull-in.
    found: [Option<Option<Fold>>; COUNT],
}

const NOTHING: Known = Known {
    of: None,
    found: [None; COUNT],
};

/// A memory of computed thresholds. They follow from the scene and are not a part of it: any two memories
/// are equal, and none is saved.
#[derive(Debug)]
pub struct Thresholds {
    known: Cell<Known>,
    search: RefCell<Option<Search>>,
}

impl Default for Thresholds {
    fn default() -> Thresholds {
        Thresholds {
            known: Cell::new(NOTHING),
            search: RefCell::new(None),
        }
    }
}

impl Clone for Thresholds {
    fn clone(&self) -> Thresholds {
        Thresholds {
            known: self.known.clone(),
            search: RefCell::new(None),
        }
    }
}

impl PartialEq for Thresholds {
    fn eq(&self, _other: &Thresholds) -> bool {
        true
    }
}

impl Thresholds {
    /// Allocates what the searches need.
    pub(super) fn prepare(&self) {
        self.search.borrow_mut().get_or_insert_default();
    }

    fn fold(&self, which: PullIn, device: &Device, prestress: f64) -> Option<Fold> {
        let mut known = self.known.get();
        if known.of != Some((*device, prestress)) {
            known = Known {
                of: Some((*device, prestress)),
                ..NOTHING
            };
        }
        let place = &mut known.found[which as usize];
        let fold = *place.get_or_insert_with(|| match which {
            PullIn::Static => quasi_static(device, prestress),
            PullIn::Dynamic => dynamic(device, prestress),
            PullIn::FromRest => {
                let mut search = self.search.borrow_mut();
                from_rest(device, prestress, search.get_or_insert_default())
            }
            PullIn::GlassyStatic => Glassy(device).quasi_static(prestress),
            PullIn::GlassyDynamic => Glassy(device).dynamic(prestress),
        });
        self.known.set(known);
        fold
    }
}

impl View<'_, Si> {
    fn fold(&self, which: PullIn) -> (Option<Fold>, f64) {
        let (basis, _) = self.basis();
        let prestress = basis.local().load(0.0_f64).prestress;
        let fold = self.scene.thresholds.fold(which, &basis.device, prestress);
        (fold, basis.scales.voltage)
    }

    /// A pull-in voltage at the present force, in V; +∞ where there is none.
    #[must_use]
    pub(super) fn threshold(&self, which: PullIn) -> f64 {
        let (fold, volts) = self.fold(which);
        fold.map_or(f64::INFINITY, |fold| fold.voltage * volts)
    }

    /// The thickness stretch at a threshold; 0 where there is none.
    #[must_use]
    pub(super) fn thickness_at(&self, which: PullIn) -> f64 {
        let (fold, _) = self.fold(which);
        fold.map_or(0.0, |fold| 1.0 / (fold.stretch * fold.stretch))
    }

    /// The stretch to which the actuator snaps at the static pull-in voltage; 0 where it
    /// escapes or there is no such voltage.
    #[must_use]
    pub fn snaps_to(&self) -> f64 {
        let (fold, _) = self.fold(PullIn::Static);
        fold.and_then(|fold| fold.snaps_to).unwrap_or(0.0)
    }

    /// By how much the voltage may grow until a step from rest pulls in, or else a slow ramp, in
    /// V; +∞ where neither does.
    #[must_use]
    pub fn pull_in_margin(&self) -> f64 {
        let step = self.threshold(PullIn::FromRest);
        let limit = if step < f64::INFINITY {
            step
        } else {
            self.threshold(PullIn::Static)
        };
        limit - self.supply_voltage().abs()
    }
}
