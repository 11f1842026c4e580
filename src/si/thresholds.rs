//! Pull-in voltages: each is computed when it is first read, and kept until the actuator or its
//! prestress changes. That with losses follows twenty motions and more.

use std::cell::{Cell, RefCell};

use super::Si;
use crate::actuator::device::Device;
use crate::model::View;
use crate::pull_in::device::{Fold, Glassy, Search, dynamic, from_rest, quasi_static};
use crate::solver::coupled::LocalCoupledEquation;

/// Which threshold.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Threshold {
    /// Of a slowly raised voltage, branches relaxed.
    Static,
    /// Of a step without losses.
    Dynamic,
    /// Of a step with them.
    FromRest,
    /// The static one of the actuator whose branches have not relaxed.
    GlassyStatic,
    /// That of a step of it.
    GlassyDynamic,
}

const COUNT: usize = Threshold::GlassyDynamic as usize + 1;

/// What has been computed.
#[derive(Clone, Copy, Debug)]
struct Known {
    /// Of which actuator, under which prestress.
    of: Option<(Device, f64)>,
    /// Each threshold that has been asked for.
    found: [Option<Option<Fold>>; COUNT],
}

const NOTHING: Known = Known {
    of: None,
    found: [None; COUNT],
};

/// The thresholds that are known. They follow from the scene and are no part of what it is: all
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

    fn fold(&self, which: Threshold, device: &Device, prestress: f64) -> Option<Fold> {
        let mut known = self.known.get();
        if known.of != Some((*device, prestress)) {
            known = Known {
                of: Some((*device, prestress)),
                ..NOTHING
            };
        }
        let place = &mut known.found[which as usize];
        let fold = *place.get_or_insert_with(|| match which {
            Threshold::Static => quasi_static(device, prestress),
            Threshold::Dynamic => dynamic(device, prestress),
            Threshold::FromRest => {
                let mut search = self.search.borrow_mut();
                from_rest(device, prestress, search.get_or_insert_default())
            }
            Threshold::GlassyStatic => Glassy(device).quasi_static(prestress),
            Threshold::GlassyDynamic => Glassy(device).dynamic(prestress),
        });
        self.known.set(known);
        fold
    }
}

impl View<'_, Si> {
    fn fold(&self, which: Threshold) -> (Option<Fold>, f64) {
        let (basis, _) = self.basis();
        let prestress = basis.local().load(0.0_f64).prestress;
        let fold = self.scene.thresholds.fold(which, &basis.device, prestress);
        (fold, basis.scales.voltage)
    }

    /// A pull-in voltage at the present force, in V; +∞ where there is none.
    #[must_use]
    pub(super) fn threshold(&self, which: Threshold) -> f64 {
        let (fold, volts) = self.fold(which);
        fold.map_or(f64::INFINITY, |fold| fold.voltage * volts)
    }

    /// The thickness stretch at a threshold; 0 where there is none.
    #[must_use]
    pub(super) fn thickness_at(&self, which: Threshold) -> f64 {
        let (fold, _) = self.fold(which);
        fold.map_or(0.0, |fold| 1.0 / (fold.stretch * fold.stretch))
    }

    /// The stretch to which the actuator snaps at the static pull-in voltage; 0 where it
    /// escapes or there is no such voltage.
    #[must_use]
    pub fn snaps_to(&self) -> f64 {
        let (fold, _) = self.fold(Threshold::Static);
        fold.and_then(|fold| fold.snaps_to).unwrap_or(0.0)
    }

    /// By how much the voltage may grow until a step from rest pulls in, or else a slow ramp, in
    /// V; +∞ where neither does.
    #[must_use]
    pub fn pull_in_margin(&self) -> f64 {
        let step = self.threshold(Threshold::FromRest);
        let limit = if step < f64::INFINITY {
            step
        } else {
            self.threshold(Threshold::Static)
        };
        limit - self.supply_voltage().abs()
    }
}
