//! Zeros and minima of a function of one number.

/// The offset between `from` and `to` at which `f` crosses zero, where it has opposite signs at the two ends: to
/// the last bit of the offset or to an exact zero.
///
/// By inverse quadratic interpolation where the last three points bend little enough for it, else by bisection:
/// T. R. Chandrupatla, "A new hybrid quadratic/bisection algorithm for finding the zero of a nonlinear function
/// without using derivatives", Adv. Eng. Softw. 28 (1997) 145–149. It begins with a secant, since a motion bends
/// little near its turning point.
#[must_use]
#[inline]
pub fn crossing(from: f64, to: f64, f: impl Fn(f64) -> f64) -> f64 {
    crossing_of(from, to, &f)
}

/// [`crossing`], compiled once for all functions.
#[inline(never)]
fn crossing_of(from: f64, to: f64, f: &dyn Fn(f64) -> f64) -> f64 {
    // The zero lies between `a`, the last point, and `b`.
    let (mut a, mut b) = (to, from);
    let (mut f_a, mut f_b) = (f(a), f(b));
    if f_b == 0.0 {
        return b;
    }
    let mut part = f_a / (f_a - f_b);
    // Each bisection halves the bracket: 53 bits take far fewer rounds.
    for _ in 0..200 {
        let nearest = if f_a.abs() < f_b.abs() { a } else { b };
        let width = (b - a).abs();
        let last_bit = f64::EPSILON * nearest.abs();
        if f_a == 0.0 || width <= last_bit {
            return nearest;
        }
        if !(0.0..=1.0).contains(&part) {
            part = 0.5;
        }
        // Not too near to an end, or the other one would not be moved at all.
        let least = 0.75 * last_bit / width;
        let x = a + part.max(least).min(1.0 - least) * (b - a);
        if x == a || x == b {
            return nearest;
        }
        let f_x = f(x);
        let (c, f_c) = if f_x * f_a > 0.0 {
            (a, f_a)
        } else {
            let passed = (b, f_b);
            (b, f_b) = (a, f_a);
            passed
        };
        (a, f_a) = (x, f_x);
        let xi = (a - b) / (c - b);
        let phi = (f_a - f_b) / (f_c - f_b);
        part = if phi * phi < xi && (1.0 - phi) * (1.0 - phi) < 1.0 - xi {
            let by_b = f_a / (f_b - f_a) * (f_c / (f_b - f_c));
            by_b + (c - a) / (b - a) * (f_a / (f_c - f_a)) * (f_b / (f_c - f_b))
        } else {
            0.5
        };
    }
    a
}

/// The lowest point of a dip between two offsets, by golden sections.
#[must_use]
pub fn lowest_between(mut from: f64, mut to: f64, f: impl Fn(f64) -> f64) -> f64 {
    const GOLDEN: f64 = 0.618_033_988_749_894_9;
    let inner = |from: f64, to: f64| [to - GOLDEN * (to - from), from + GOLDEN * (to - from)];
    // 0.618⁴⁰ of the bracket is the width at which rounding hides the dip.
    for _ in 0..40 {
        let [low, high] = inner(from, to);
        if f(low) < f(high) {
            to = high;
        } else {
            from = low;
        }
    }
    0.5 * (from + to)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::cell::Cell;

    /// The zero of `f` between 0 and 1 from both sides, with how often `f` was asked at most.
    fn zeros(f: impl Fn(f64) -> f64) -> ([f64; 2], u32) {
        let most = Cell::new(0);
        let found = [(0.0, 1.0), (1.0, 0.0)].map(|(from, to)| {
            let asked = Cell::new(0);
            let zero = crossing(from, to, |x| {
                asked.set(asked.get() + 1);
                f(x)
            });
            most.set(most.get().max(asked.get()));
            zero
        });
        (found, most.get())
    }

    fn assert_found(f: impl Fn(f64) -> f64, exact: f64, most: u32) {
        let (found, asked) = zeros(f);
        for zero in found {
            assert!(
                (zero - exact).abs() <= 1.5 * f64::EPSILON * exact,
                "{zero} {exact}"
            );
        }
        assert!(asked <= most, "{asked} evaluations");
    }

    /// The zero lies between two numbers, at neither of which these vanish: the last bits cost no bisection of
    /// the whole bracket.
    #[test]
    fn a_smooth_crossing_takes_few_evaluations() {
        for k in 1..100 {
            let exact = f64::from(k) / 101.0;
            assert_found(|x| (3.0 * (x - exact)).sin() + 1e-18, exact, 15);
            assert_found(|x| (x - exact) * (1.0 + x * x) - 1e-18, exact, 15);
            assert_found(|x| (2.0 * (x - exact)).exp_m1() - 1e-18, exact, 15);
        }
    }

    #[test]
    fn no_crossing_takes_much_longer_than_bisection() {
        assert_found(|x| (x - 0.3).signum(), 0.3, 60);
        assert_found(|x| (x - 0.3).powi(9), 0.3, 60);
        assert_found(|x| (x - 0.3).cbrt(), 0.3, 60);
        assert_found(|x| 1.0 / (x - 0.3), 0.3, 60);
        assert_found(|x| (50.0 * (x - 0.3)).exp() - 1.0, 0.3, 60);
        assert_found(|x| (1e6 * (x - 0.3)).atan(), 0.3, 60);
    }

    #[test]
    fn a_zero_at_an_end_is_the_crossing() {
        assert_eq!(crossing(0.0, 1.0, |x| x), 0.0);
        assert_eq!(crossing(0.0, 1.0, |x| x - 1.0), 1.0);
    }
}
