//! Numbers of about 31 digits, for the independent integrator: pairs of `f64`, each sum
//! and product with its rounding error (T. J. Dekker, Numer. Math. 18 (1971) 224–242).

use std::ops::{Add, Div, Mul, Neg, Sub};

/// `high + low`, `low` at most half an ulp of `high`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Doubled {
    pub high: f64,
    pub low: f64,
}

fn two_sum(a: f64, b: f64) -> Doubled {
    let high = a + b;
    let shadow = high - a;
    Doubled {
        high,
        low: (a - (high - shadow)) + (b - shadow),
    }
}

/// The exact sum where `a` is the larger one.
fn quick_sum(a: f64, b: f64) -> Doubled {
    let high = a + b;
    Doubled {
        high,
        low: b - (high - a),
    }
}

impl From<f64> for Doubled {
    fn from(high: f64) -> Doubled {
        Doubled { high, low: 0.0 }
    }
}

impl Add for Doubled {
    type Output = Doubled;

    fn add(self, other: Doubled) -> Doubled {
        let sum = two_sum(self.high, other.high);
        quick_sum(sum.high, sum.low + (self.low + other.low))
    }
}

impl Neg for Doubled {
    type Output = Doubled;

    fn neg(self) -> Doubled {
        Doubled {
            high: -self.high,
            low: -self.low,
        }
    }
}

impl Sub for Doubled {
    type Output = Doubled;

    fn sub(self, other: Doubled) -> Doubled {
        self + -other
    }
}

impl Mul for Doubled {
    type Output = Doubled;

    fn mul(self, other: Doubled) -> Doubled {
        let high = self.high * other.high;
        let rest = self.high.mul_add(other.high, -high);
        quick_sum(high, rest + (self.high * other.low + self.low * other.high))
    }
}

impl Div for Doubled {
    type Output = Doubled;

    fn div(self, other: Doubled) -> Doubled {
        let by = |q: f64| other * Doubled::from(q);
        let first = self.high / other.high;
        let rest = self - by(first);
        let second = rest.high / other.high;
        let third = (rest - by(second)).high / other.high;
        quick_sum(first, second) + third.into()
    }
}

impl Doubled {
    /// Rounded to `f64`.
    pub fn value(self) -> f64 {
        self.high + self.low
    }

    /// Σ a·b, the low parts added up by themselves.
    pub fn sum_of_products(pairs: impl Iterator<Item = (Doubled, Doubled)>) -> Doubled {
        let (mut high, mut low) = (0.0, 0.0);
        for (a, b) in pairs {
            let product = a.high * b.high;
            let rest = a.high.mul_add(b.high, -product);
            let sum = two_sum(high, product);
            high = sum.high;
            low += sum.low + (rest + (a.high * b.low + a.low * b.high));
        }
        quick_sum(high, low)
    }

    /// Sine and cosine: turned into the first octant by quarter turns, then Taylor series.
    pub fn sin_cos(self) -> [Doubled; 2] {
        let quarter = Doubled {
            high: std::f64::consts::FRAC_PI_2,
            low: 6.123_233_995_736_766e-17,
        };
        let turns = (self.high / quarter.high).round();
        // The third part of π/2, for angles of up to 1e9.
        let rest = self - quarter * turns.into() - (turns * -1.497_384_904_859_169_8e-33).into();
        let square = rest * rest;
        let mut sine = Doubled::from(0.0);
        let mut cosine = Doubled::from(0.0);
        for k in (0..14).rev() {
            let k = f64::from(k);
            let one = Doubled::from(1.0);
            sine = one - square * sine / ((2.0 * k + 2.0) * (2.0 * k + 3.0)).into();
            cosine = one - square * cosine / ((2.0 * k + 1.0) * (2.0 * k + 2.0)).into();
        }
        let sine = rest * sine;
        match turns.rem_euclid(4.0) as u8 {
            0 => [sine, cosine],
            1 => [cosine, -sine],
            2 => [-sine, -cosine],
            _ => [-cosine, sine],
        }
    }
}

#[test]
fn thirty_digits_are_kept() {
    let third = Doubled::from(1.0) / 3.0.into();
    assert!((third * 3.0.into() - 1.0.into()).value().abs() < 1e-31);
    for angle in [0.3, 2.9, -14.7, 1e3, 1e9 + 0.1] {
        let [sine, cosine] = Doubled::from(angle).sin_cos();
        assert!((sine * sine + cosine * cosine - 1.0.into()).value().abs() < 1e-30);
        let (expected, _) = angle.sin_cos();
        assert!((sine.value() - expected).abs() < 1e-15, "{angle}");
    }
    // sin 1, summed in 60 digits.
    let [sine, _] = Doubled::from(1.0).sin_cos();
    let exact = Doubled {
        high: 0.841_470_984_807_896_5,
        low: 1.776_845_092_935_536e-18,
    };
    assert!((sine - exact).value().abs() < 1e-24, "{sine:?}");
}
