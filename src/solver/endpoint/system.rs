//! An equation as endpoint-only steps see it: one of second order, with first-order states or without.

use fearless_simd::{Simd, SimdBase, f64x4};

use crate::arithmetic::double_double::DoubleDouble;
use crate::arithmetic::number::Number;
use crate::solver::coupled::{CoupledEquation, LocalCoupledEquation, MOST_STATES, Slope, Stage};
use crate::solver::{Equation, LocalEquation, State};

/// A system x'' = f(t, x, x', z), z' = g(t, x, x', z) with no more than K states z.
pub trait System<const K: usize> {
    /// The system seen from a time.
    type Local<'a>: LocalSystem<K>
    where
        Self: 'a;

    /// The system with the origin of time moved to `time`, positions counted from 0.
    fn at(&self, time: &DoubleDouble) -> Self::Local<'_>;
}

/// A [`System`] with its origin of time moved. What is not said here is said at [`LocalEquation`] and
/// [`LocalCoupledEquation`].
pub trait LocalSystem<const K: usize> {
    /// What the derivatives need to know of the time.
    type Load<N: Number>: Copy;
    /// What they need to know of the position.
    type Geometry<N: Number>: Copy;

    fn harmonic(&self) -> Option<[f64; 2]>;

    fn load_with_sine<N: Number>(&self, offset: N, sine: N) -> Self::Load<N>;

    fn longest_substep(&self) -> f64;

    fn natural_frequency(&self, stage: &Stage<f64, K>) -> f64;

    fn geometry<N: Number>(&self, position: N) -> Self::Geometry<N>;

    /// x''.
    fn acceleration<N: Number>(
        &self,
        load: Self::Load<N>,
        geometry: &Self::Geometry<N>,
        stage: &Stage<N, K>,
    ) -> N;

    /// x'' + `addend`.
    #[inline(always)]
    fn acceleration_and<N: Number>(
        &self,
        load: Self::Load<N>,
        geometry: &Self::Geometry<N>,
        stage: &Stage<N, K>,
        addend: N,
    ) -> N {
        self.acceleration(load, geometry, stage) + addend
    }

    /// The number of first-order states.
    fn states(&self) -> usize;

    /// z' of the k-th of them.
    fn slope<N: Number>(
        &self,
        k: usize,
        load: Self::Load<N>,
        geometry: &Self::Geometry<N>,
        stage: &Stage<N, K>,
    ) -> Slope<N>;

    /// Their typical sizes, where the motion has this natural frequency.
    fn sizes(&self, stage: &Stage<f64, K>, frequency: f64) -> [f64; K];

    /// −∂f/∂x' that only relaxes, as far as it is no part of a [`LocalEquation`].
    fn damping(&self, stage: &Stage<f64, K>) -> f64;

    /// Whether the system is defined here.
    fn admits(&self, stage: &Stage<f64, K>) -> bool;
}

/// The same stage in each lane.
#[inline(always)]
pub fn in_lanes<S: Simd, const K: usize>(simd: S, stage: &Stage<f64, K>) -> Stage<f64x4<S>, K> {
    let mut internal = [f64x4::splat(simd, 0.0); K];
    for k in 0..K {
        internal[k] = f64x4::splat(simd, stage.internal[k]);
    }
    Stage {
        position: f64x4::splat(simd, stage.position),
        rate: f64x4::splat(simd, stage.rate),
        internal,
    }
}

impl<E: Equation> System<0> for E {
    type Local<'a>
        = E::Local<'a>
    where
        E: 'a;

    #[inline(always)]
    fn at(&self, time: &DoubleDouble) -> E::Local<'_> {
        Equation::at(self, time)
    }
}

impl<L: LocalEquation> LocalSystem<0> for L {
    type Load<N: Number> = L::Load<N>;
    type Geometry<N: Number> = ();

    #[inline(always)]
    fn harmonic(&self) -> Option<[f64; 2]> {
        LocalEquation::harmonic(self)
    }

    #[inline(always)]
    fn load_with_sine<N: Number>(&self, offset: N, sine: N) -> L::Load<N> {
        LocalEquation::load_with_sine(self, offset, sine)
    }

    #[inline(always)]
    fn longest_substep(&self) -> f64 {
        LocalEquation::longest_substep(self)
    }

    #[inline(always)]
    fn natural_frequency(&self, stage: &Stage<f64, 0>) -> f64 {
        let &Stage { position, rate, .. } = stage;
        LocalEquation::natural_frequency(self, State { position, rate })
    }

    #[inline(always)]
    fn geometry<N: Number>(&self, _position: N) {}

    #[inline(always)]
    fn acceleration<N: Number>(&self, load: L::Load<N>, _: &(), stage: &Stage<N, 0>) -> N {
        LocalEquation::acceleration(self, load, stage.position, stage.rate)
    }

    #[inline(always)]
    fn acceleration_and<N: Number>(
        &self,
        load: L::Load<N>,
        _: &(),
        stage: &Stage<N, 0>,
        addend: N,
    ) -> N {
        LocalEquation::acceleration_and(self, load, stage.position, stage.rate, addend)
    }

    #[inline(always)]
    fn states(&self) -> usize {
        0
    }

    #[inline(always)]
    fn slope<N: Number>(
        &self,
        _k: usize,
        _load: L::Load<N>,
        _: &(),
        stage: &Stage<N, 0>,
    ) -> Slope<N> {
        let zero = stage.position.same(0.0);
        Slope {
            value: zero,
            relaxation: zero,
        }
    }

    #[inline(always)]
    fn sizes(&self, _stage: &Stage<f64, 0>, _frequency: f64) -> [f64; 0] {
        []
    }

    #[inline(always)]
    fn damping(&self, _stage: &Stage<f64, 0>) -> f64 {
        0.0
    }

    #[inline(always)]
    fn admits(&self, _stage: &Stage<f64, 0>) -> bool {
        true
    }
}

/// A coupled system whose positions are counted from 0.
#[derive(Debug)]
pub struct Coupled<'e, E>(pub &'e E);

/// A [`Coupled`] with its origin of time moved.
#[derive(Debug)]
pub struct LocalCoupled<L> {
    local: L,
    states: usize,
}

impl<E: CoupledEquation> System<MOST_STATES> for Coupled<'_, E> {
    type Local<'a>
        = LocalCoupled<E::Local<'a>>
    where
        Self: 'a;

    #[inline(always)]
    fn at(&self, time: &DoubleDouble) -> LocalCoupled<E::Local<'_>> {
        LocalCoupled {
            local: self.0.at(time, &DoubleDouble::ZERO),
            states: self.0.states(),
        }
    }
}

impl<L: LocalCoupledEquation> LocalSystem<MOST_STATES> for LocalCoupled<L> {
    type Load<N: Number> = L::Load<N>;
    type Geometry<N: Number> = L::Geometry<N>;

    #[inline(always)]
    fn harmonic(&self) -> Option<[f64; 2]> {
        self.local.harmonic()
    }

    #[inline(always)]
    fn load_with_sine<N: Number>(&self, offset: N, sine: N) -> L::Load<N> {
        self.local.load_with_sine(offset, sine)
    }

    fn longest_substep(&self) -> f64 {
        self.local.longest_substep()
    }

    fn natural_frequency(&self, stage: &Stage) -> f64 {
        self.local.natural_frequency(stage)
    }

    #[inline(always)]
    fn geometry<N: Number>(&self, position: N) -> L::Geometry<N> {
        self.local.geometry(position)
    }

    #[inline(always)]
    fn acceleration<N: Number>(
        &self,
        load: L::Load<N>,
        geometry: &L::Geometry<N>,
        stage: &Stage<N>,
    ) -> N {
        self.local.acceleration(load, geometry, stage).value
    }

    #[inline(always)]
    fn states(&self) -> usize {
        self.states
    }

    #[inline(always)]
    fn slope<N: Number>(
        &self,
        k: usize,
        load: L::Load<N>,
        geometry: &L::Geometry<N>,
        stage: &Stage<N>,
    ) -> Slope<N> {
        self.local.slope(k, load, geometry, stage)
    }

    fn sizes(&self, stage: &Stage, frequency: f64) -> [f64; MOST_STATES] {
        self.local.state_sizes(stage, frequency)
    }

    fn damping(&self, stage: &Stage) -> f64 {
        let (_, force) = self.local.derivatives(0, self.local.load(0.0), stage);
        force.relaxation
    }

    fn admits(&self, stage: &Stage) -> bool {
        self.local.admits(stage)
    }
}
