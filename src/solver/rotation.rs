//! The sine of a load that alternates, over equal short steps one after another: at their nodes by rotation.
//!
//! All of a short step waits for the sines at its nodes, as long as for half of the rest. Where the step is as long
//! as the one before, they follow by the addition theorem from sine and cosine at its begin, which follow so from
//! those at the begin of the step before. Before rounding adds up, they are worked out anew.

use std::f64::consts::TAU;

use fearless_simd::{Simd, f64x4};
use serde::{Deserialize, Serialize};

use super::dense_output::VALIDATION_TOLERANCE;
use super::tables::GAUSS_4;
use crate::arithmetic::lanes::Lanes;
use crate::arithmetic::number::Number;
use crate::arithmetic::sine::{sine_of_sum, turned};

/// Sine and cosine are worked out anew after so many steps: each one rounds by some 2e-16.
const MOST_ROTATIONS: u32 = 32;

/// An angle that is nearer than this to the one that was expected is the same, in other roundings.
const SAME: f64 = 1e-14;

/// Sine and cosine of the turn from the begin of a step to its nodes, and to its end.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
struct Turns {
    to_nodes: [[f64; 4]; 2],
    to_end: [f64; 2],
}

/// The load at the begin of the next step, where that is as long as the last one.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub struct Rotation {
    /// The angle by which the load turned in the last step.
    turn: f64,
    /// Nothing before the second equal step.
    turns: Option<Turns>,
    /// The angle at the end of the last step.
    angle: f64,
    /// Its sine and cosine.
    point: [f64; 2],
    /// Further steps that may follow from these.
    left: u32,
}

impl Rotation {
    /// Nothing is known.
    pub const UNKNOWN: Rotation = Rotation {
        turn: f64::NAN,
        turns: None,
        angle: 0.0,
        point: [0.0, 1.0],
        left: 0,
    };

    /// Whether the numbers can be sines and cosines.
    pub fn is_valid(&self) -> bool {
        let is_point = |sine: f64, cosine: f64| {
            (sine * sine + cosine * cosine - 1.0).abs() < VALIDATION_TOLERANCE
        };
        let [sine, cosine] = self.point;
        let turns = |turns: Turns| {
            let [sines, cosines] = turns.to_nodes;
            let [sine, cosine] = turns.to_end;
            is_point(sine, cosine) && (0..4).all(|i| is_point(sines[i], cosines[i]))
        };
        is_point(sine, cosine) && self.turns.is_none_or(turns)
    }

    /// The sines at the nodes of a step of this `length`, and the one at its end, where the step before was as long.
    /// The load turns with this frequency and begins at this angle.
    #[inline(always)]
    pub fn sines<S: Simd>(
        &mut self,
        simd: S,
        [frequency, angle]: [f64; 2],
        length: f64,
    ) -> (f64x4<S>, Option<f64>) {
        let fill = |value: f64| <f64x4<S> as Lanes<S, 4>>::fill(simd, value);
        let turn = frequency * length;
        // By whole turns they differ where one of them was reduced.
        let off = angle - self.angle;
        let off = off - TAU * (off * (1.0 / TAU)).whole();
        if let Some(turns) = &self.turns
            && turn == self.turn
            && self.left > 0
            && off.abs() <= SAME
        {
            let begin = self.point.map(fill);
            let to_nodes = turns
                .to_nodes
                .each_ref()
                .map(|values| Lanes::load(simd, values));
            let at_nodes = sine_of_sum(begin, to_nodes);
            self.point = turned(self.point, turns.to_end);
            self.angle += turn;
            self.left -= 1;
            return (at_nodes, Some(self.point[0]));
        }
        let place: f64x4<S> = Lanes::load(simd, &GAUSS_4.place);
        let at_nodes = place.mul_add(fill(0.5 * turn), fill(angle)).sin();
        if turn != self.turn {
            (self.turn, self.turns) = (turn, None);
            return (at_nodes, None);
        }
        self.begin_anew(angle);
        (at_nodes, Some(self.point[0]))
    }

    /// Works out sine and cosine at the end of a step that begins at this angle. A call, since it is seldom made.
    #[inline(never)]
    fn begin_anew(&mut self, angle: f64) {
        let point = |angle: f64| <[f64; 2]>::from(angle.sin_cos());
        self.angle = angle + self.turn;
        self.point = point(self.angle);
        self.left = MOST_ROTATIONS;
        if self.turns.is_none() {
            let to_nodes = GAUSS_4.place.map(|place| point(0.5 * place * self.turn));
            self.turns = Some(Turns {
                to_nodes: [0, 1].map(|k| to_nodes.map(|point| point[k])),
                to_end: point(self.turn),
            });
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::arithmetic::double_double::DoubleDouble;
    use fearless_simd::{Level, dispatch};

    /// The largest error of the sines in a step from this angle, at its nodes and, where that is known, at its end.
    fn error(rotation: &mut Rotation, angle: f64, frequency: f64, length: f64) -> f64 {
        let (at_nodes, at_end) = dispatch!(Level::new(), simd => {
            let (at_nodes, at_end) = rotation.sines(simd, [frequency, angle], length);
            let at_nodes: [f64; 4] = at_nodes.store();
            (at_nodes, at_end)
        });
        let off = |sine: f64, place: f64| {
            (sine - (0.5 * place * frequency).mul_add(length, angle).sin()).abs()
        };
        let nodes = (0..4).map(|i| off(at_nodes[i], GAUSS_4.place[i]));
        let end = at_end.map_or(0.0, |sine| off(sine, 2.0));
        nodes.fold(end, f64::max)
    }

    /// The angle after so many turns of a step, less whole turns, as accurate as the drive's.
    fn angle_after(steps: i32, turn: f64) -> f64 {
        let whole = DoubleDouble {
            high: TAU,
            low: 2.449_293_598_294_706_4e-16,
        };
        let angle = DoubleDouble::new(turn).scale(f64::from(steps)).plus(0.7);
        let turns = (angle.high / TAU).round();
        angle.sub(whole.scale(turns)).value()
    }

    #[test]
    fn equal_steps_have_the_sines_of_their_angles() {
        for (frequency, length) in [(0.1471, 0.01), (2.0, 0.3), (50.0, 0.06)] {
            let mut rotation = Rotation::UNKNOWN;
            let mut rotated = 0;
            for step in 0..1000 {
                let angle = angle_after(step, frequency * length);
                let was_left = rotation.left;
                let error = error(&mut rotation, angle, frequency, length);
                assert!(error < 3e-14, "step {step} of {length}: {error}");
                rotated += u32::from(rotation.left < was_left);
                assert!(rotation.is_valid());
            }
            assert!(rotated > 900, "{rotated} of 1000 by rotation");
        }
    }

    #[test]
    fn another_angle_or_length_is_not_taken_for_the_next_one() {
        let mut rotation = Rotation::UNKNOWN;
        let mut angle = 0.0;
        for step in 0..300 {
            // The phase jumps, the step changes, the frequency changes.
            angle += if step % 7 == 0 { 1e-9 } else { 0.0 };
            let length = if step % 11 < 9 { 0.1 } else { 0.2 };
            let frequency = if step % 50 < 40 { 0.3 } else { 0.5 };
            let error = error(&mut rotation, angle, frequency, length);
            assert!(error < 3e-14, "step {step}: {error}");
            angle += frequency * length;
        }
    }

    #[test]
    fn other_numbers_than_sines_and_cosines_are_not_valid() {
        let mut rotation = Rotation::UNKNOWN;
        for step in 0..3 {
            error(&mut rotation, 0.1 * f64::from(step), 1.0, 0.1);
        }
        assert!(rotation.is_valid() && rotation.turns.is_some());
        for forged in [2.0, f64::NAN, f64::INFINITY] {
            let point = Rotation {
                point: [forged, 0.5],
                ..rotation
            };
            assert!(!point.is_valid(), "{forged}");
            let mut turns = rotation;
            if let Some(turns) = &mut turns.turns {
                turns.to_nodes[1][2] = forged;
            }
            assert!(!turns.is_valid(), "{forged}");
        }
    }
}
