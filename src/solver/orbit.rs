//! A motion that repeats: between two turning points it runs there and back.

use serde::{Deserialize, Serialize};

use super::dense_output::VALIDATION_TOLERANCE;
use crate::arithmetic::double_double::DoubleDouble;

/// The motion between two turning points of an autonomous, time-reversible equation.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub struct Orbit {
    first_turn: DoubleDouble,
    second_turn: DoubleDouble,
    period: DoubleDouble,
}

impl Orbit {
    /// The orbit between two turning points, the first one before the second.
    pub fn between(first_turn: DoubleDouble, second_turn: DoubleDouble) -> Orbit {
        Orbit {
            first_turn,
            second_turn,
            period: second_turn.sub(first_turn).scale_exactly(2.0),
        }
    }

    /// Whether the numbers can be those of an orbit.
    pub fn is_valid(&self) -> bool {
        let [first, second] = self.turns();
        second.since(first) > 0.0 && self.period == Orbit::between(first, second).period
    }

    /// Whether `time` lies between the turning points, to rounding.
    pub fn holds(&self, time: DoubleDouble) -> bool {
        let rounding = VALIDATION_TOLERANCE * self.period.high;
        time.since(self.first_turn) >= -rounding && self.second_turn.since(time) >= -rounding
    }

    /// Both turning points, the earlier one first.
    pub fn turns(&self) -> [DoubleDouble; 2] {
        [self.first_turn, self.second_turn]
    }

    /// The turning points that are met within the time `step`.
    pub fn turns_within(
        &self,
        now: DoubleDouble,
        direction: f64,
        step: f64,
    ) -> impl Iterator<Item = DoubleDouble> {
        let mut turns = self.turns();
        if direction > 0.0 {
            turns.reverse();
        }
        let to_first = self.time_to_turn(now, direction);
        let half_period = 0.5 * self.period.high;
        let met = [step >= to_first, step >= to_first + half_period];
        turns
            .into_iter()
            .zip(met)
            .filter_map(|(turn, met)| met.then_some(turn))
    }

    /// The later turning point.
    pub fn second_turn(&self) -> DoubleDouble {
        self.second_turn
    }

    /// The time from `now` to the next turning point.
    pub fn time_to_turn(&self, now: DoubleDouble, direction: f64) -> f64 {
        if direction > 0.0 {
            self.second_turn.since(now)
        } else {
            now.since(self.first_turn)
        }
    }

    /// What is left of a time after whole periods, 0 to a period.
    #[inline]
    fn remainder(&self, time: f64) -> DoubleDouble {
        if time < self.period.high {
            return DoubleDouble::new(time);
        }
        let mut rest = self.less_whole_periods(time);
        // The low part of the period enters once for each whole period: of the longest times that is
        // many periods again.
        while rest.high.abs() >= self.period.high {
            rest = self.less_whole_periods(rest.high).plus(rest.low);
        }
        if rest.high < 0.0 {
            rest = rest.add(self.period);
        }
        rest
    }

    /// A time less as many periods as it seems to hold by the high part of the period.
    #[inline]
    fn less_whole_periods(&self, time: f64) -> DoubleDouble {
        let period = self.period.high;
        let quotient = time / period;
        // The remainder of two f64 is exact.
        let (whole, rest) = if (1.0..MANY).contains(&quotient) {
            let whole = whole_part(quotient);
            (whole, remainder_of_few(time, whole, period))
        } else {
            (quotient.trunc(), time % period)
        };
        DoubleDouble::new(rest).plus(-(whole * self.period.low))
    }

    /// Where between the turning points, and in which direction, the motion is
    /// after the time `step`.
    pub fn run(&self, now: DoubleDouble, mut direction: f64, step: f64) -> (DoubleDouble, f64) {
        let rest = self.remainder(step);
        let mut now = now.add(rest.scale_exactly(direction));
        // Two reflections come back to the first direction; a third and fourth
        // happen where rounding left a little more than a period.
        for _ in 0..4 {
            let turn = if now.since(self.second_turn) > 0.0 {
                self.second_turn
            } else if direction < 0.0 && now.since(self.first_turn) < 0.0 {
                self.first_turn
            } else {
                break;
            };
            now = turn.scale_exactly(2.0).sub(now);
            direction = -direction;
        }
        (now, direction)
    }
}

/// Fewer periods than this in a time are counted without the C library, whose `trunc` and `fmod` take 100
/// instructions: a count of 26 bits times half of the digits of a period is exact.
const MANY: f64 = (1_u64 << 26) as f64;

/// The whole part of a quotient from 1 to [`MANY`]. Processors without SSE4.1 have no instruction for it.
#[inline]
fn whole_part(quotient: f64) -> f64 {
    // From here on neighbouring numbers differ by 1, so that adding it rounds to a whole number.
    const WHOLE: f64 = (1_u64 << 52) as f64;
    let rounded = (quotient + WHOLE) - WHOLE;
    if rounded > quotient {
        rounded - 1.0
    } else {
        rounded
    }
}

/// `time % period`, to the bit, where the rounded quotient of both has this whole part, less than [`MANY`].
#[inline]
fn remainder_of_few(time: f64, whole: f64, period: f64) -> f64 {
    const LOWER_DIGITS: u64 = (1 << 27) - 1;
    let upper = f64::from_bits(period.to_bits() & !LOWER_DIGITS);
    // Both products and both differences are exact: multiples of the last digit of the period, below 2^53 of them,
    // or of twice that digit where the time is longer than two periods.
    let rest = (time - whole * upper) - whole * (period - upper);
    // The quotient was rounded up to a whole number.
    if rest < 0.0 { rest + period } else { rest }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Turning points 1 and 4: period 6.
    #[test]
    fn time_is_folded_between_the_turning_points() {
        let orbit = Orbit::between(DoubleDouble::new(1.0), DoubleDouble::new(4.0));
        let from = DoubleDouble::new(3.0);
        for (step, place, direction) in [
            (0.5, 3.5, 1.0),
            (2.0, 3.0, -1.0),
            (5.0, 2.0, 1.0),
            (6.0, 3.0, 1.0),
            (6e6 + 2.5, 2.5, -1.0),
        ] {
            let (now, along) = orbit.run(from, 1.0, step);
            assert_eq!((now.value(), along), (place, direction), "step {step}");
        }
    }

    /// Of a period that is no `f64`, the longest steps hold more periods than there are digits.
    #[test]
    fn no_step_leaves_the_orbit() {
        let second_turn = DoubleDouble::new(1.0)
            .div(DoubleDouble::new(3.0))
            .add(DoubleDouble::new(1.0));
        let orbit = Orbit::between(DoubleDouble::new(1.0), second_turn);
        let from = DoubleDouble::new(1.1);
        for exponent in 0..=50 {
            for part in [1.0, 3.7, 9.1] {
                let step = part * 10_f64.powi(exponent);
                let (now, along) = orbit.run(from, 1.0, step);
                let inside =
                    now.since(orbit.turns()[0]) >= 0.0 && orbit.second_turn.since(now) >= 0.0;
                assert!(inside && along.abs() == 1.0, "step {step:e}: {now:?}");
            }
        }
    }

    /// Against `fmod` and `trunc`, to the bit: of random times, of whole multiples of the period and their
    /// neighbours, and from a single period to more than there are digits.
    #[test]
    fn whole_periods_are_taken_off_exactly() {
        let mut seed = 1_u64;
        let mut random = || {
            seed ^= seed << 13;
            seed ^= seed >> 7;
            seed ^= seed << 17;
            seed
        };
        let mut few = 0;
        for _ in 0..400_000 {
            let digits = random() >> 12;
            let exponent = 1023 - 100 + random() % 200;
            let high = f64::from_bits(digits | exponent << 52);
            let low = high * f64::EPSILON * ((random() % 1000) as f64 / 2001.0 - 0.25);
            let turn = DoubleDouble { high, low }.scale_exactly(0.5);
            let orbit = Orbit::between(DoubleDouble::ZERO, turn);
            let count = (random() >> (random() % 64)) as f64;
            let time = match random() % 3 {
                0 => count * high,
                1 => (count * high).next_down(),
                _ => (count + (random() >> 11) as f64 / (1_u64 << 53) as f64) * high,
            };
            let period = orbit.period.high;
            let whole = (time / period).trunc();
            let exact = DoubleDouble::new(time % period).plus(-(whole * orbit.period.low));
            let found = orbit.less_whole_periods(time);
            assert_eq!(
                [found.high.to_bits(), found.low.to_bits()],
                [exact.high.to_bits(), exact.low.to_bits()],
                "{time:e} of {period:e}"
            );
            few += u32::from(whole < MANY);
        }
        assert!((100_000..300_000).contains(&few), "{few}");
    }
}
