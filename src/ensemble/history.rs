//! The values of f of a motion at places of another distance, by interpolation between its last
//! steps: a motion changes its step by this without a start.

use super::multistep::HISTORY;

/// Values through which each polynomial goes.
const POINTS: usize = 14;

/// Weights of Lagrange's formula in barycentric form at equal distances: (−1)ⁱ (n choose i).
const fn weights(points: usize) -> [f64; POINTS] {
    let mut weights = [0.0; POINTS];
    let mut weight = 1;
    let mut i = 0;
    while i < points {
        weights[i] = weight as f64;
        weight = -weight * (points as i64 - 1 - i as i64) / (i as i64 + 1);
        i += 1;
    }
    weights
}

/// For each number of values.
static WEIGHTS: [[f64; POINTS]; POINTS + 1] = {
    let mut all = [[0.0; POINTS]; POINTS + 1];
    let mut points = 1;
    while points <= POINTS {
        all[points] = weights(points);
        points += 1;
    }
    all
};

/// The values of h²f at every `ratio` of a step back, the present first, and how many they are: by
/// the `known` values of `f` at every step back, for steps that are longer by the `ratio`.
pub fn resampled(f: impl Fn(usize) -> f64, known: usize, ratio: f64) -> ([f64; HISTORY], usize) {
    let points = POINTS.min(known);
    let weights = &WEIGHTS[points];
    let mut values = [0.0; HISTORY];
    for (k, value) in values.iter_mut().enumerate() {
        let back = k as f64 * ratio;
        if back > (known - 1) as f64 {
            return (values, k);
        }
        let middle = (back.ceil() as usize).saturating_sub(points / 2);
        let first = middle.min(known - points);
        let (mut above, mut below) = (0.0, 0.0);
        for (i, weight) in weights[..points].iter().enumerate() {
            let distance = back - (first + i) as f64;
            if distance == 0.0 {
                (above, below) = (f(first + i), 1.0);
                break;
            }
            let part = weight / distance;
            above += part * f(first + i);
            below += part;
        }
        *value = ratio * ratio * (above / below);
    }
    (values, HISTORY)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// f = cos t at steps of 0.1, 27 of them: shorter steps, longer ones, and too long ones.
    #[test]
    fn a_cosine_is_met_between_its_values() {
        let f = |k: usize| (0.1 * k as f64).cos();
        for (ratio, count) in [(0.3, 16), (0.71, 16), (1.0, 16), (1.6, 16), (2.0, 14)] {
            let (values, known) = resampled(f, 27, ratio);
            assert_eq!(known, count);
            for (k, value) in values[..known].iter().enumerate() {
                let exact = ratio * ratio * (0.1 * ratio * k as f64).cos();
                assert!(
                    (value - exact).abs() < 2e-14 * ratio * ratio,
                    "{ratio} {k}: {value} {exact}"
                );
            }
        }
    }

    #[test]
    fn few_values_are_enough() {
        let (values, known) = resampled(|k| (0.1 * k as f64).cos(), 9, 0.5);
        assert_eq!(known, 16);
        assert!((values[15] - 0.25 * 0.75_f64.cos()).abs() < 1e-10);
    }
}
