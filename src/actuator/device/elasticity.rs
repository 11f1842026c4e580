//! The law of the elastic stiffness in equal-biaxial stretch: the factor h(I) by which the
//! neo-Hookean force λ − λ⁻⁵ is multiplied, with I = 2λ² + λ⁻⁴ − 3.
//!
//! | law | h | energy, over µ times the volume |
//! |---|---|---|
//! | neo-Hookean | 1 | I/2 |
//! | Gent | 1/(1 − I/J) | −(J/2) ln(1 − I/J) |
//! | Yeoh | 1 + 2κ2 I + 3κ3 I² | (I + κ2 I² + κ3 I³)/2 |
//!
//! Sources: A. N. Gent, Rubber Chem. Technol. 69 (1996) 59–61; O. H. Yeoh, Rubber Chem. Technol.
//! 66 (1993) 754–771.

use serde::{Deserialize, Serialize};

use crate::arithmetic::double_double::DoubleDouble;
use crate::arithmetic::jet::Dual;
use crate::arithmetic::number::{Number, Parameter, ParameterOf};

/// The law of the elastic stiffness.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum Elasticity<P = f64> {
    /// No stiffening.
    NeoHookean,
    /// The stretch is limited.
    Gent(Locking<P>),
    /// A polynomial in I; κ_j = C_j0/C10.
    Yeoh {
        /// κ2.
        second: P,
        /// κ3.
        third: P,
    },
}

/// Where a Gent material locks: 1 − I/J = 0.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Locking<P = f64> {
    limit: P,
    largest: DoubleDouble,
    smallest: DoubleDouble,
    /// Both as parameters.
    ends: [P; 2],
    third: P,
}

impl Locking {
    /// The locking of a material with the `limit` J > 0.
    ///
    /// With x = λ², J x² (1 − I/J) = −(2x³ − (J+3)x² + 1), whose roots are x = λ² at the largest
    /// and the smallest stretch, and a negative one. They start from the trigonometric solution
    /// and are refined by Newton's method in double length.
    #[must_use]
    pub fn new(limit: f64) -> Locking {
        Locking::of(limit, |x| x.value())
    }

    /// The roots and their derivatives where J changes in a direction.
    #[must_use]
    pub fn along(limit: Dual) -> Locking<Dual> {
        let j = limit.value();
        Locking::of(limit, |x| {
            // The slope of the root: x' (6x² − 2(J+3)x) = J' x².
            let x = x.value();
            Dual::new(x, limit.slope() * x / (6.0 * x - 2.0 * (j + 3.0)))
        })
    }
}

impl<P: Parameter> Locking<P> {
    fn of(limit: P, parameter: impl Fn(DoubleDouble) -> P) -> Locking<P> {
        let j = limit.value();
        let a = 0.5 * (j + 3.0);
        // cos θ = 1 − 27/(4a³), without the loss where θ is small.
        let angle = 2.0 * (27.0 / (8.0 * a.powi(3))).sqrt().min(1.0).asin();
        let root = |turn: f64| {
            let start = a / 3.0 * (1.0 + 2.0 * ((angle + turn) / 3.0).cos());
            refined(j, start)
        };
        let roots = [root(0.0), root(4.0 * std::f64::consts::PI)];
        let [largest, smallest] = roots.map(|x| x.sqrt());
        let squares = roots.map(parameter);
        Locking {
            limit,
            largest,
            smallest,
            ends: [
                squares[0].sqrt().with_value(largest.high),
                squares[1].sqrt().with_value(smallest.high),
            ],
            third: limit.same(0.5) / (squares[0] * squares[1]),
        }
    }

    /// Both locking stretches, counted from an origin.
    #[must_use]
    pub fn walls(&self, origin: DoubleDouble) -> [P; 2] {
        let [largest, smallest] = self.ends;
        [
            largest.with_value(self.largest.sub(origin).value()),
            smallest.with_value(self.smallest.sub(origin).value()),
        ]
    }

    /// J.
    #[must_use]
    pub fn limit(&self) -> P {
        self.limit
    }

    /// The stretch at which it locks.
    #[must_use]
    pub fn largest(&self) -> DoubleDouble {
        self.largest
    }

    /// The stretch at which it locks in contraction.
    #[must_use]
    pub fn smallest(&self) -> DoubleDouble {
        self.smallest
    }

    /// 1 − I/J from the stretch and its distances to both locking stretches: no digits are lost
    /// near them.
    #[inline(always)]
    pub fn gap<N: Number>(&self, stretch: N, to_largest: N, from_smallest: N) -> N
    where
        P: ParameterOf<N>,
    {
        let lift = |parameter: P| parameter.lift(stretch);
        let square = stretch * stretch;
        let above = to_largest * (stretch + lift(self.ends[0]));
        let below = from_smallest * (stretch + lift(self.ends[1]));
        let factor = lift(self.limit.same(2.0) / self.limit);
        factor * above * below * (square + lift(self.third)) / (square * square)
    }
}

/// The root near `x` of 2x³ − (J+3)x² + 1 in double length.
fn refined(limit: f64, x: f64) -> DoubleDouble {
    let mut x = DoubleDouble::new(x);
    for _ in 0..6 {
        let square = x.mul(x);
        let a = DoubleDouble::new(limit).plus(3.0);
        let value = x.scale(2.0).sub(a).mul(square).add(DoubleDouble::ONE);
        let slope = x.value() * (6.0 * x.value() - 2.0 * a.value());
        if slope != 0.0 {
            x = x.sub(value.div(DoubleDouble::new(slope)));
        }
    }
    x
}

/// I = 2λ² + λ⁻⁴ − 3 = (λ² − 1)² (2λ² + 1)/λ⁴, without cancellation near 1.
#[inline(always)]
pub fn invariant<N: Number>(square: N) -> N {
    let one = square.same(1.0);
    let growth = square - one;
    growth * growth * (square + square + one) / (square * square)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    #[allow(clippy::excessive_precision)]
    fn locking_stretches_are_those_of_thirty_digits() {
        let locking = Locking::new(110.0);
        for (found, exact) in [
            (locking.largest(), 7.516_637_770_292_971_95),
            (locking.smallest(), 0.306_839_640_421_347_144),
        ] {
            assert!(
                (found.value() / exact - 1.0).abs() <= f64::EPSILON,
                "{found:?}"
            );
            // The low parts make the gap vanish to thirty digits.
            let x = found.mul(found);
            let a = DoubleDouble::new(113.0);
            let rest = x.scale(2.0).sub(a).mul(x).mul(x).add(DoubleDouble::ONE);
            assert!(rest.value().abs() < 1e-25, "{rest:?}");
        }
    }

    /// The products against 1 − I/J as it is defined, from soft to almost rigid.
    #[test]
    fn the_gap_is_what_the_definition_says() {
        for limit in [1e-3, 1.0, 30.0, 110.0, 1e6] {
            let locking = Locking::new(limit);
            let [low, high] = [locking.smallest(), locking.largest()];
            for part in [0.01, 0.3, 0.7, 0.99] {
                let x = low.value() + part * (high.value() - low.value());
                let gap = locking.gap(x, high.plus(-x).value(), x - low.value());
                let definition = 1.0 - invariant(x * x) / limit;
                assert!(
                    (gap - definition).abs() < 1e-11,
                    "{limit} {x} {gap} {definition}"
                );
            }
        }
    }
}
