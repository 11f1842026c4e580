//! What the equation of a real actuator needs to know of the stretch alone.

use super::LocalDevice;
use super::elasticity::{Elasticity, Locking, invariant};
use super::parameters::Permittivity;
use crate::arithmetic::number::{Number, Parameter, ParameterOf};

/// The elastic state at a stretch.
#[derive(Clone, Copy)]
pub(super) struct Powers<N> {
    pub stretch: N,
    pub square: N,
    pub inverse: N,
    /// λ⁻², λ⁻⁴, λ⁻⁵.
    pub inverse_square: N,
    pub inverse_fourth: N,
    pub inverse_fifth: N,
}

/// What the derivatives need to know of a stretch.
#[derive(Clone, Copy)]
pub struct Geometry<N> {
    pub(super) powers: Powers<N>,
    /// The elastic force and those of surfaces and spring, which pull back.
    pub(super) restoring: N,
    /// M.
    pub(super) inertia: N,
    /// λ³e + ¼λ⁴e', and 1/(λ⁴e).
    pub(super) pull: N,
    pub(super) elastance: N,
}

impl<N: Number> Powers<N> {
    #[inline(always)]
    pub fn of(stretch: N) -> Powers<N> {
        let inverse = stretch.same(1.0) / stretch;
        let inverse_square = inverse * inverse;
        let inverse_fourth = inverse_square * inverse_square;
        Powers {
            stretch,
            square: stretch * stretch,
            inverse,
            inverse_square,
            inverse_fourth,
            inverse_fifth: inverse_fourth * inverse,
        }
    }
}

impl<P: Parameter> Permittivity<P> {
    /// e and e' at a stretch.
    #[inline(always)]
    pub fn at<N: Number>(&self, stretch: N) -> [N; 2]
    where
        P: ParameterOf<N>,
    {
        let number = |value: f64| stretch.same(value);
        let [k1, k2, k3] = self.terms;
        let [k1, k2, k3] = [k1.lift(stretch), k2.lift(stretch), k3.lift(stretch)];
        let x = stretch - number(1.0);
        let value = k3.mul_add(x, k2).mul_add(x, k1).mul_add(x, number(1.0));
        let slope = (number(3.0) * k3)
            .mul_add(x, number(2.0) * k2)
            .mul_add(x, k1);
        [value, slope]
    }

    /// λ³e + ¼λ⁴e', the factor of the squared voltage in the force.
    #[inline(always)]
    pub fn pull<N: Number>(&self, stretch: N) -> N
    where
        P: ParameterOf<N>,
    {
        let cube = stretch * stretch * stretch;
        if self.is_constant() {
            return cube;
        }
        let [value, slope] = self.at(stretch);
        cube * (stretch * slope).mul_add(stretch.same(0.25), value)
    }
}

impl<P: Parameter> LocalDevice<'_, P> {
    /// The stretch at a position.
    #[inline(always)]
    pub fn stretch<N: Number>(&self, position: N) -> N {
        position + position.same(self.origin)
    }

    /// 1 − I/J of a Gent material at a position.
    #[inline(always)]
    pub(super) fn gap<N: Number>(&self, locking: &Locking<P>, position: N) -> N
    where
        P: ParameterOf<N>,
    {
        let [largest, smallest] = self.walls.map(|wall| wall.lift(position));
        locking.gap(
            self.stretch(position),
            largest - position,
            position - smallest,
        )
    }

    /// The elastic factor h at a position.
    #[inline(always)]
    fn stiffening<N: Number>(&self, position: N, square: N) -> N
    where
        P: ParameterOf<N>,
    {
        let one = position.same(1.0);
        match &self.device.elasticity {
            Elasticity::NeoHookean => one,
            Elasticity::Gent(locking) => one / self.gap(locking, position),
            Elasticity::Yeoh { second, third } => {
                let number = |value: f64| position.same(value);
                let i = invariant(square);
                let [second, third] = [*second, *third].map(|factor| factor.lift(position));
                (number(3.0) * third)
                    .mul_add(i, number(2.0) * second)
                    .mul_add(i, one)
            }
        }
    }

    /// What the derivatives need to know of a position.
    #[inline(always)]
    pub(super) fn geometry_at<N: Number>(&self, position: N) -> Geometry<N>
    where
        P: ParameterOf<N>,
    {
        let device = self.device;
        let powers = Powers::of(self.stretch(position));
        let lift = |parameter: P| parameter.lift(position);
        let mut elastic = powers.stretch - powers.inverse_fifth;
        if !matches!(device.elasticity, Elasticity::NeoHookean) {
            elastic = elastic * self.stiffening(position, powers.square);
        }
        let surface = powers.stretch
            * lift(self.quintic)
                .mul_add(powers.square, lift(self.cubic))
                .mul_add(powers.square, lift(self.linear));
        let inverse_sixth = powers.inverse_fourth * powers.inverse_square;
        Geometry {
            restoring: elastic + surface - lift(self.preload),
            inertia: position
                .same(2.0)
                .mul_add(inverse_sixth, lift(device.sheet.aspect)),
            pull: device.permittivity.pull(powers.stretch),
            elastance: self.elastance(&powers),
            powers,
        }
    }

    /// 1/(λ⁴e), the inverse of the capacitance.
    #[inline(always)]
    pub(super) fn elastance<N: Number>(&self, powers: &Powers<N>) -> N
    where
        P: ParameterOf<N>,
    {
        if self.device.permittivity.is_constant() {
            return powers.inverse_fourth;
        }
        powers.inverse_fourth / self.device.permittivity.at(powers.stretch)[0]
    }

    /// λ⁴e, the capacitance.
    #[inline(always)]
    pub fn capacitance<N: Number>(&self, stretch: N) -> N
    where
        P: ParameterOf<N>,
    {
        let square = stretch * stretch;
        let fourth = square * square;
        if self.device.permittivity.is_constant() {
            return fourth;
        }
        fourth * self.device.permittivity.at(stretch)[0]
    }
}
