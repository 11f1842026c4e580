//! The motion beside a motion: y'' = a(t) y + b(t) y' + g(t) over a substep.
//!
//! It is solved by the collocation that has solved the substep itself. Its stages
//! are then a linear system of 16 unknowns, one for all right sides, so that y is the
//! exact derivative of the discrete motion.
//!
//! Source: E. Hairer, S. P. Nørsett, G. Wanner, "Solving Ordinary Differential
//! Equations I", 2nd ed., section I.14 (the variational equation).

use nalgebra::{Const, LU, SMatrix, SVector};

use super::State;
use super::collocation::Series;
use super::dense_output::{PAIRS, Segment};
use super::tables::GAUSS_16;
use super::tables::product::product;

/// Number of stages.
pub const NODES: usize = 2 * PAIRS;

/// A number at each stage.
pub type StageVector = SVector<f64, NODES>;

/// The times of the stages, counted from the begin of a substep of this length.
pub fn offsets(length: f64) -> [f64; NODES] {
    GAUSS_16.place.map(|place| 0.5 * length * place)
}

/// The linear equation over one substep, ready to be solved for any start and any g.
pub struct Linearized {
    half: f64,
    by_position: StageVector,
    by_rate: StageVector,
    system: LU<f64, Const<NODES>, Const<NODES>>,
}

impl Linearized {
    /// The equation with a and b given at the stages of a substep of this length.
    pub fn new(length: f64, by_position: StageVector, by_rate: StageVector) -> Linearized {
        let half = 0.5 * length;
        let system = SMatrix::<f64, NODES, NODES>::from_fn(|row, column| {
            let [once, twice] = [GAUSS_16.once[column][row], GAUSS_16.twice[column][row]];
            let identity = if row == column { 1.0 } else { 0.0 };
            identity - half * (half * by_position[row] * twice + by_rate[row] * once)
        });
        Linearized {
            half,
            by_position,
            by_rate,
            system: system.lu(),
        }
    }

    /// y from `start` on, with g given at the stages; nothing where the stages have no
    /// unique solution.
    pub fn solve(&self, start: State, g: StageVector) -> Option<Segment> {
        let times = offsets(2.0 * self.half);
        let free = StageVector::from_fn(|i, _| {
            let drift = start.position + times[i] * start.rate;
            self.by_position[i] * drift + self.by_rate[i] * start.rate + g[i]
        });
        let f = self.system.solve(&free)?;
        let series = product(&GAUSS_16.series, &f.into());
        let end = start.after(self.half, [series[0], series[1] / 3.0]);
        let series = Series::new(self.half, &series.into());
        Some(Segment::new(start, end, &series))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// y'' = −y + ½ y' + cos t in closed form: the particular solution is −2 sin t.
    #[test]
    fn a_forced_and_driven_oscillator_is_solved_to_rounding() {
        let length = 1.3;
        let g = StageVector::from_fn(|i, _| offsets(length)[i].cos());
        let linearized =
            Linearized::new(length, StageVector::repeat(-1.0), StageVector::repeat(0.5));
        let start = State {
            position: 0.7,
            rate: -0.4,
        };
        let mut solved = linearized.solve(start, g).expect("a unique solution");
        solved.expand();
        let frequency = (1.0_f64 - 0.0625).sqrt();
        let homogeneous = start.rate + 2.0;
        let (cosine, sine) = (0.7, (homogeneous - 0.25 * 0.7) / frequency);
        for time in [0.0, 0.31, 0.9, length] {
            let angle = frequency * time;
            let exact = (0.25 * time).exp() * (cosine * angle.cos() + sine * angle.sin())
                - 2.0 * time.sin();
            assert!(
                (solved.position(time) - exact).abs() < 1e-15 * 8.0,
                "{time}"
            );
        }
        assert!((solved.end().position - solved.position(length)).abs() < 8e-15);
    }
}
