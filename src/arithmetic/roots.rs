//! Zeros and minima of a function of one number.

/// The offset in (`from`, `to`] at which `f` crosses zero, where it has
/// opposite signs at the two ends. Bisection with secant steps (the
/// "Illinois" rule of M. Dowell and P. Jarratt, BIT 11 (1971) 168–174), to
/// the last bit of the offset or to an exact zero.
#[must_use]
#[inline]
pub fn crossing(from: f64, to: f64, f: impl Fn(f64) -> f64) -> f64 {
    crossing_of(from, to, &f)
}

/// [`crossing`], compiled once for all functions.
#[inline(never)]
fn crossing_of(from: f64, to: f64, f: &dyn Fn(f64) -> f64) -> f64 {
    let (mut a, mut b) = (from, to);
    let (mut f_a, mut f_b) = (f(a), f(b));
    if f_a == 0.0 {
        return a;
    }
    // Each round at least halves a bracket every second time; 200 rounds
    // are far beyond what 53 bits can take.
    for _ in 0..200 {
        if f_b == 0.0 || (b - a).abs() <= f64::EPSILON * b.abs() {
            break;
        }
        let secant = b - f_b * (b - a) / (f_b - f_a);
        let inside = (secant - a) * (secant - b) < 0.0;
        let c = if inside { secant } else { 0.5 * (a + b) };
        if c == a || c == b {
            break;
        }
        let f_c = f(c);
        if f_c * f_b < 0.0 {
            (a, f_a) = (b, f_b);
        } else {
            f_a *= 0.5;
        }
        (b, f_b) = (c, f_c);
    }
    b
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
