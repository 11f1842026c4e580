//! The actuator in nondimensional numbers, computed once after each change of its description.

use std::cell::Cell;

use super::SiScene;
use crate::actuator::device::{Device, Source};
use crate::actuator::scales::{Scales, SiDevice};

/// The description that the host gave: the device, J, κ2 and κ3, and the source.
pub(super) type Described = (SiDevice, [f64; 3], Source);

/// An actuator in nondimensional numbers and their units.
#[derive(Clone, Copy, Debug)]
pub(super) struct Folded {
    pub of: Described,
    pub device: Device,
    pub scales: Scales,
    /// The thickness of the stack before deformation, in m.
    pub stack: f64,
}

/// A memory of the last one. It follows from the scene and is not a part of it: any two memories are equal, and
/// none is saved.
#[derive(Clone, Debug, Default)]
pub struct Memory(Cell<Option<Folded>>);

impl PartialEq for Memory {
    fn eq(&self, _other: &Memory) -> bool {
        true
    }
}

impl SiScene {
    /// Whether this is still the description of the actuator.
    pub(super) fn is_still(&self, (device, stiffening, source): &Described) -> bool {
        self.device == *device && self.stiffening == *stiffening && self.source() == *source
    }

    /// The actuator in nondimensional numbers.
    #[inline]
    pub(super) fn folded(&self) -> Folded {
        match self.memory.0.get() {
            Some(known) if self.is_still(&known.of) => known,
            _ => self.folded_anew(),
        }
    }

    #[inline(never)]
    fn folded_anew(&self) -> Folded {
        let of = (self.device, self.stiffening, self.source());
        let described = self.described();
        let folded = Folded {
            of,
            device: described.nondimensional(),
            scales: Scales::of(&described),
            stack: described.layers * described.thickness,
        };
        self.memory.0.set(Some(folded));
        folded
    }
}
