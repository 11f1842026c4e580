//! Where a load holds the actuator, and how fast it swings about that.

use dielectric_elastomer_actuator::actuator::Coefficients;
use dielectric_elastomer_actuator::actuator::motion::{Load, acceleration};
use dielectric_elastomer_actuator::arithmetic::jet::Dual;
use dielectric_elastomer_actuator::arithmetic::roots::crossing;

/// The factor between the stretches at which an equilibrium is looked for.
const STRIDE: f64 = 1.01;

/// The angular frequency of small oscillations about the equilibrium under a load; NaN where there is none.
pub fn frequency(coefficients: &Coefficients, load: Load<f64>, limits: [f64; 2]) -> f64 {
    first(coefficients, load, limits).map_or(f64::NAN, |stretch| {
        small_frequency(coefficients, load, stretch)
    })
}

/// The same about a given equilibrium; NaN where it is unstable.
pub fn small_frequency(coefficients: &Coefficients, load: Load<f64>, equilibrium: f64) -> f64 {
    let stretch = Dual::new(equilibrium, 1.0);
    let load = Load {
        voltage_squared: Dual::constant(load.voltage_squared),
        prestress: Dual::constant(load.prestress),
    };
    let still = Dual::constant(0.0);
    let response = acceleration(&coefficients.same(stretch), load, stretch, still);
    (-response.slope()).sqrt()
}

/// The first equilibrium on the way on which the load leads from λ = 1.
fn first(coefficients: &Coefficients, load: Load<f64>, [lowest, highest]: [f64; 2]) -> Option<f64> {
    let force = |stretch| acceleration(coefficients, load, stretch, 0.0);
    let (way, stride) = if force(1.0) < 0.0 {
        (-1.0, 1.0 / STRIDE)
    } else {
        (1.0, STRIDE)
    };
    let (mut before, mut behind) = (1.0, stride);
    while way * force(behind) > 0.0 {
        (before, behind) = (behind, behind * stride);
        if !(lowest..highest).contains(&behind) {
            return None;
        }
    }
    Some(crossing(before, behind, force))
}
