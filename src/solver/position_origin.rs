//! Where positions are counted from: always 0, or a number near a singularity of f.

use std::fmt::Debug;

use serde::Serialize;
use serde::de::DeserializeOwned;

use crate::arithmetic::double_double::DoubleDouble;

/// Where positions are counted from.
pub trait PositionOrigin: Copy + Debug + PartialEq + Serialize + DeserializeOwned {
    /// The position 0.
    const ZERO: Self;

    /// A position counted from 0.
    fn absolute(self, position: f64) -> f64;

    /// A position counted from here.
    fn relative(self, position: f64) -> f64;

    /// Whether it is finite.
    fn is_finite(&self) -> bool;
}

/// Always 0.
impl PositionOrigin for () {
    const ZERO: () = ();

    #[inline(always)]
    fn absolute(self, position: f64) -> f64 {
        position
    }

    #[inline(always)]
    fn relative(self, position: f64) -> f64 {
        position
    }

    fn is_finite(&self) -> bool {
        true
    }
}

/// A number that no step changes much.
impl PositionOrigin for DoubleDouble {
    const ZERO: DoubleDouble = DoubleDouble::ZERO;

    fn absolute(self, position: f64) -> f64 {
        self.plus(position).value()
    }

    fn relative(self, position: f64) -> f64 {
        -self.plus(-position).value()
    }

    fn is_finite(&self) -> bool {
        DoubleDouble::is_finite(self)
    }
}
