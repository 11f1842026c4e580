//! The built-in alternating voltage (Eq. 21) and its angle, which keeps its digits at late times.

use serde::{Deserialize, Serialize};

use crate::arithmetic::double_double::{DoubleDouble, veltkamp_split};
use crate::arithmetic::number::Number;

/// 2π.
pub(crate) const TURN: DoubleDouble = DoubleDouble {
    high: std::f64::consts::TAU,
    low: 2.449_293_598_294_706_4e-16,
};

/// The built-in alternating voltage φ_a sin(ωt + ϑ), t being the time of the model.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Harmonic {
    /// φ_a, nondimensional voltage.
    pub amplitude: f64,
    /// ω in radians per unit of time.
    pub frequency: f64,
    /// What rounding has left of ω, where it is not exactly `frequency`: it counts after many turns.
    pub frequency_rest: f64,
    /// ϑ in radians.
    pub phase: f64,
}

impl Harmonic {
    /// No alternating voltage.
    pub const OFF: Harmonic = Harmonic {
        amplitude: 0.0,
        frequency: 0.0,
        frequency_rest: 0.0,
        phase: 0.0,
    };

    /// The same voltage with another ω.
    #[must_use]
    pub fn with_frequency(self, frequency: DoubleDouble) -> Harmonic {
        Harmonic {
            frequency: frequency.high,
            frequency_rest: frequency.low,
            ..self
        }
    }

    /// The angle ωt + ϑ at `time`, less whole turns before it is rounded: at
    /// t = 1e9 an f64 angle would have lost half its digits.
    #[inline(always)]
    pub(crate) fn angle(&self, time: DoubleDouble) -> f64 {
        /// 2π in 33 bits, so that its small multiples are exact, and the rest.
        const PARTS: [f64; 2] = [6.283_185_306_936_502_4, 2.430_840_202_602_477e-10];
        const EXACT_TURNS: f64 = 1_048_576.0; // 2^20
        let turns = (time.high * self.frequency) * (1.0 / std::f64::consts::TAU);
        if turns.abs() < EXACT_TURNS {
            let turns = turns.whole();
            let [time_head, time_tail] = veltkamp_split(time.high);
            let [head, tail] = veltkamp_split(self.frequency);
            let rest = (time_head * tail + (time_tail + time.low) * self.frequency)
                + (time.high * self.frequency_rest + self.phase);
            ((time_head * head - turns * PARTS[0]) - turns * PARTS[1]) + rest
        } else {
            self.late_angle(time)
        }
    }

    /// The angle after more turns than the fast way can reduce.
    #[inline(never)]
    fn late_angle(&self, time: DoubleDouble) -> f64 {
        let angle = time.mul(DoubleDouble {
            high: self.frequency,
            low: self.frequency_rest,
        });
        let turns = (angle.high * (1.0 / TURN.high)).round();
        angle.sub(TURN.scale(turns)).value() + self.phase
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_angle_keeps_its_digits_at_late_times() {
        let harmonic = Harmonic {
            amplitude: 1.0,
            frequency: 0.1471,
            frequency_rest: 0.0,
            phase: 0.3,
        };
        // A million turns later, to the rounding of the time itself.
        let turns = 1e6;
        let late = TURN.scale(turns).div(DoubleDouble::new(0.1471));
        assert!((harmonic.angle(late) - 0.3).abs() < 1e-15);
    }
}
