//! The matrices of Newton's method for the stages of a step where something is stiff.
//!
//! With hA for the integration over the step, D for a diagonal matrix of derivatives at the nodes, and z_k
//! the first-order states, each of which acts on itself and on x'', and on which x acts:
//!
//! ```text
//! B_k = 1 − D(∂z_k'/∂z_k) hA
//! S   = 1 − D(∂x''/∂x) (hA)² − D(∂x''/∂x') hA − Σ D(∂x''/∂z_k) hA B_k⁻¹ D(∂z_k'/∂x) (hA)²
//! ```
//!
//! What a state does to itself is given by the equation; the other derivatives are differences, whose error of 1e-7
//! only slows the iteration down by as much.

use fearless_simd::Simd;

use super::nodes::Nodes;
use super::{LocalCoupledEquation, MOST_STATES, Sizes, Stage};
use crate::arithmetic::number::Number;
use crate::solver::iteration::Diverged;
use crate::solver::tables::{Columns, Rule};

/// By which part of its size a variable is changed to see what it acts on.
const DIFFERENCE: f64 = 1e-7;

/// The inverses of the matrices of the first-order states.
pub(super) struct Newton<S: Simd, const R: usize, const N: usize> {
    /// B_k⁻¹.
    pub internal: [Columns<N>; MOST_STATES],
    /// What takes x along.
    pub whole: Option<Whole<S, R, N>>,
}

/// The inverse of the matrix of x'', and how the first-order states answer to x.
pub(super) struct Whole<S: Simd, const R: usize, const N: usize> {
    /// S⁻¹.
    pub motion: Columns<N>,
    /// ∂z_k'/∂x.
    pub response: [Nodes<S, R>; MOST_STATES],
}

impl<S: Simd, const R: usize, const N: usize> Newton<S, R, N> {
    /// Room for the matrices.
    pub const NONE: Self = Newton {
        internal: [[[0.0; N]; N]; MOST_STATES],
        whole: None,
    };

    /// Makes the matrices at these stages of a step, `half` of which is given; those of the first-order
    /// states alone, or else the `whole`.
    ///
    /// In a function of its own for each set of instructions, which is compiled in much less time than as a part of
    /// the iteration.
    ///
    /// # Errors
    /// [`Diverged`] where one is singular.
    #[inline(never)]
    pub fn make<L: LocalCoupledEquation>(
        &mut self,
        simd: S,
        step: (&Rule<N>, f64),
        equation: (&L, L::Load<Nodes<S, R>>, usize),
        at: &Stage<Nodes<S, R>>,
        sizes: &Sizes,
        whole: bool,
    ) -> Result<(), Diverged> {
        simd.vectorize(
            #[inline(always)]
            || self.make_by(simd, step, equation, at, sizes, whole),
        )
    }

    #[inline(always)]
    #[allow(
        clippy::needless_range_loop,
        reason = "rows and columns of matrices, and states"
    )]
    fn make_by<L: LocalCoupledEquation>(
        &mut self,
        simd: S,
        (rule, half): (&Rule<N>, f64),
        (local, load, states): (&L, L::Load<Nodes<S, R>>, usize),
        at: &Stage<Nodes<S, R>>,
        sizes: &Sizes,
        whole: bool,
    ) -> Result<(), Diverged> {
        let fill = |value: f64| Nodes::<S, R>::fill(simd, value);
        let geometry = local.geometry(at.position);
        for k in 0..states {
            let relaxation = local.slope(k, load, &geometry, at).relaxation * fill(half);
            let inverse = &mut self.internal[k];
            for j in 0..N {
                let once = Nodes::load(simd, &rule.once[j]);
                inverse[j] = relaxation.mul_add(once, Nodes::unit(simd, j)).store();
            }
            invert::<S, R, N>(simd, inverse)?;
        }
        if !whole {
            return Ok(());
        }
        let force = local.acceleration(load, &geometry, at);
        let [aside, per_aside] = difference(sizes.position);
        let moved_aside = Stage {
            position: at.position + fill(aside),
            ..*at
        };
        let geometry_aside = local.geometry(moved_aside.position);
        let steepness = local
            .acceleration(load, &geometry_aside, &moved_aside)
            .value
            - force.value;
        let stiffness = fill(0.0) - steepness * fill(per_aside * half * half);
        let damping = force.relaxation * fill(half);
        let mut motion = [[0.0; N]; N];
        for j in 0..N {
            let [once, twice] = [&rule.once[j], &rule.twice[j]].map(|row| Nodes::load(simd, row));
            let both = stiffness.mul_add(twice, Nodes::unit(simd, j));
            motion[j] = damping.mul_add(once, both).store();
        }
        let mut response = [fill(0.0); MOST_STATES];
        for k in 0..states {
            let here = local.slope(k, load, &geometry, at).value;
            let there = local.slope(k, load, &geometry_aside, &moved_aside).value;
            response[k] = (there - here) * fill(per_aside);
            let [more, per_more] = difference(sizes.internal[k]);
            let mut moved = *at;
            moved.internal[k] = moved.internal[k] + fill(more);
            let push = local.acceleration(load, &geometry, &moved).value - force.value;
            let push = push * fill(per_more * half * half * half);
            for j in 0..N {
                let answer = (response[k] * Nodes::load(simd, &rule.twice[j])).store();
                let slopes = Nodes::<S, R>::product(simd, &self.internal[k], &answer).store();
                let back: [f64; N] = (push * Nodes::product(simd, &rule.once, &slopes)).store();
                for i in 0..N {
                    motion[j][i] -= back[i];
                }
            }
        }
        invert::<S, R, N>(simd, &mut motion)?;
        self.whole = Some(Whole { motion, response });
        Ok(())
    }
}

/// By how much to change a variable of this size, and its inverse.
fn difference(size: f64) -> [f64; 2] {
    [DIFFERENCE * size, 1.0 / (DIFFERENCE * size)]
}

/// Replaces a matrix by its inverse, by the method of Gauss and Jordan. The pivots are taken as they come, on the
/// diagonal: what a small one costs of the digits only slows the iteration down, or it diverges and the
/// step is halved. With the width known it takes a tenth of the time of the general solver of a library.
///
/// # Errors
/// [`Diverged`] where a pivot vanishes or is not finite.
#[inline(always)]
fn invert<S: Simd, const R: usize, const N: usize>(
    simd: S,
    columns: &mut Columns<N>,
) -> Result<(), Diverged> {
    let fill = |value: f64| Nodes::<S, R>::fill(simd, value);
    for p in 0..N {
        let pivot = columns[p][p];
        if pivot == 0.0 || !pivot.is_finite() {
            return Err(Diverged);
        }
        let unit = Nodes::<S, R>::unit(simd, p);
        let column = unit.mul_add(fill(1.0 - pivot), Nodes::load(simd, &columns[p]));
        let column = column * fill(1.0 / pivot);
        // Takes the place of the pivot's row along.
        let taken = column + unit;
        for other in columns.iter_mut() {
            let factor = fill(-other[p]);
            *other = taken.mul_add(factor, Nodes::load(simd, other)).store();
        }
        columns[p] = column.store();
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Of a matrix that is not symmetric, and of none.
    #[test]
    fn an_inverse_gives_the_unit_matrix() {
        fearless_simd::dispatch!(fearless_simd::Level::new(), simd => check(simd));
    }

    #[inline(always)]
    fn check<S: Simd>(simd: S) {
        let mut columns = [[0.0; 8]; 8];
        for (j, column) in columns.iter_mut().enumerate() {
            for (i, entry) in column.iter_mut().enumerate() {
                *entry = ((3 * i + 5 * j + i * j) % 11) as f64 + if i == j { 20.0 } else { 0.0 };
            }
        }
        let mut inverse = columns;
        invert::<S, 1, 8>(simd, &mut inverse).expect("it is regular");
        for (j, solution) in inverse.iter().enumerate() {
            for i in 0..8 {
                let entry: f64 = columns.iter().zip(solution).map(|(c, s)| c[i] * s).sum();
                let unit = if i == j { 1.0 } else { 0.0 };
                assert!((entry - unit).abs() < 1e-14, "{i} {j}: {entry}");
            }
        }
        assert_eq!(invert::<S, 1, 8>(simd, &mut [[1.0; 8]; 8]), Err(Diverged));
    }
}
