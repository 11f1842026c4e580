//! An integrator that shares nothing with the library: Taylor series of Eq. 16
//! as it stands in the paper, the surface terms not folded.
//!
//! Origin of the step size: À. Jorba and M. Zou, "A software package for the
//! numerical integration of ODEs by means of high-order Taylor methods",
//! Experimental Mathematics 14 (2005) 99–117. The state is summed with its
//! rounding errors, so that some 1e3 steps lose no digit.

/// Terms of each series; the step is 0.2 of the radius of convergence.
const TERMS: usize = 26;

type Series = [f64; TERMS];

/// c, γ, τ, E.
#[derive(Clone, Copy, Debug)]
pub struct Actuator {
    pub aspect: f64,
    pub surface: [f64; 3],
}

/// φ + φ_a sin(ωt + ϑ) and S.
#[derive(Clone, Copy, Debug)]
pub struct Load {
    pub voltage: f64,
    pub prestress: f64,
    /// φ_a, ω, ϑ.
    pub harmonic: [f64; 3],
}

impl Load {
    pub fn constant(voltage: f64, prestress: f64) -> Load {
        Load {
            voltage,
            prestress,
            harmonic: [0.0; 3],
        }
    }
}

/// A number and what its roundings have lost.
#[derive(Clone, Copy)]
struct Sum(f64, f64);

impl Sum {
    fn add(&mut self, term: f64) {
        let term = term + self.1;
        let sum = self.0 + term;
        let shadow = sum - self.0;
        self.1 = (self.0 - (sum - shadow)) + (term - shadow);
        self.0 = sum;
    }
}

/// Stretch and rate at a time.
#[derive(Clone, Copy)]
pub struct Taylor {
    stretch: Sum,
    rate: Sum,
    time: Sum,
}

impl Taylor {
    pub fn new(stretch: f64, rate: f64) -> Taylor {
        Taylor {
            stretch: Sum(stretch, 0.0),
            rate: Sum(rate, 0.0),
            time: Sum(0.0, 0.0),
        }
    }

    pub fn state(&self) -> [f64; 2] {
        [self.stretch.0, self.rate.0]
    }

    /// Follows the motion for `duration`.
    pub fn advance(&mut self, actuator: &Actuator, load: &Load, duration: f64) {
        let mut rest = duration;
        while rest > 0.0 {
            let x = self.series(actuator, load);
            let radius = |k: usize| (x[0].abs() / x[k].abs()).powf(1.0 / k as f64);
            let longest = 0.2 * radius(TERMS - 1).min(radius(TERMS - 2));
            let h = longest.min(rest);
            assert!(h > 1e-9 * duration, "the independent integrator is stuck");
            let gain = |series: &[f64]| series.iter().rev().fold(0.0, |sum, c| (sum + c) * h);
            let mut slope = [0.0; TERMS];
            for k in 0..TERMS - 1 {
                slope[k] = (k + 1) as f64 * x[k + 1];
            }
            self.stretch.add(gain(&x[1..]));
            self.rate.add(gain(&slope[1..TERMS - 1]));
            self.time.add(h);
            rest -= h;
        }
    }

    /// Taylor coefficients of the stretch at the present time.
    fn series(&self, actuator: &Actuator, load: &Load) -> Series {
        let [gamma, tau, elasticity] = actuator.surface;
        let zero = [0.0; TERMS];
        let (mut x, mut v, mut s, mut q, mut q2, mut q3) = (zero, zero, zero, zero, zero, zero);
        let (mut r5, mut r7, mut w, mut x3, mut x5) = (zero, zero, zero, zero, zero);
        let (mut spin, mut acceleration) = (zero, zero);
        let voltage = self.voltage(load);
        let mut squared = zero;
        (x[0], x[1]) = (self.stretch.0, self.rate.0);
        for k in 0..TERMS - 2 {
            v[k] = (k + 1) as f64 * x[k + 1];
            squared[k] = product(&voltage, &voltage, k);
            s[k] = product(&x, &x, k);
            q[k] = quotient(if k == 0 { 1.0 } else { 0.0 }, &q, &s, k);
            q2[k] = product(&q, &q, k);
            q3[k] = product(&q2, &q, k);
            r5[k] = product(&q3, &x, k);
            r7[k] = product(&r5, &q, k);
            w[k] = product(&v, &v, k);
            spin[k] = product(&r7, &w, k);
            x3[k] = product(&s, &x, k);
            x5[k] = product(&s, &x3, k);
            let surface = gamma * x[k]
                + tau * (2.0 * x3[k] - x[k])
                + 0.5 * elasticity * (3.0 * x5[k] - 4.0 * x3[k] + x[k]);
            let prestress = if k == 0 { load.prestress } else { 0.0 };
            let force = 6.0 * spin[k] - x[k] + r5[k] + prestress + product(&squared, &x3, k)
                - 2.0 * surface;
            let mut mass = zero;
            for j in 0..=k {
                mass[j] = 2.0 * q3[j];
            }
            mass[0] += actuator.aspect;
            acceleration[k] = quotient(force, &acceleration, &mass, k);
            x[k + 2] = acceleration[k] / ((k + 1) * (k + 2)) as f64;
        }
        x
    }

    /// Taylor coefficients of the voltage at the present time.
    fn voltage(&self, load: &Load) -> Series {
        let [amplitude, frequency, phase] = load.harmonic;
        let (sine, cosine) = (frequency * self.time.0 + phase).sin_cos();
        let turned = [sine, cosine, -sine, -cosine];
        let mut factor = amplitude;
        let mut series = [0.0; TERMS];
        for k in 0..TERMS {
            series[k] = factor * turned[k % 4];
            factor *= frequency / (k + 1) as f64;
        }
        series[0] += load.voltage;
        series
    }
}

/// Coefficient k of a·b.
fn product(a: &Series, b: &Series, k: usize) -> f64 {
    (0..=k).map(|j| a[j] * b[k - j]).sum()
}

/// Coefficient k of n/d, `n` being that of n and `before` those found so far.
fn quotient(n: f64, before: &Series, d: &Series, k: usize) -> f64 {
    let known: f64 = (0..k).map(|j| before[j] * d[k - j]).sum();
    (n - known) / d[0]
}
