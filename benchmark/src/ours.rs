//! The actuator's own integrator, called from Rust.

use dielectric_elastomer_actuator::actuator::drive::Harmonic;
use dielectric_elastomer_actuator::actuator::{Coefficients, Drive, Motion, Parameters};
use dielectric_elastomer_actuator::arithmetic::double_double::DoubleDouble;
use dielectric_elastomer_actuator::solver::State;
use dielectric_elastomer_actuator::solver::limits::Limits;
use dielectric_elastomer_actuator::solver::trajectory::{Progress, Trajectory};
use fearless_simd::Level;

use crate::case::{Case, Pair};
use crate::free::Method;
use crate::host::Host;

/// The tolerances of `fmi2SetupExperiment`, and the promise to stay within ten of them.
const fn method(name: &'static str, solve: crate::free::Solve) -> Method {
    Method {
        name,
        solve,
        idle: None,
        exponents: [3, 14],
        allowed: 10.0,
    }
}

pub const METHODS: &[Method] = &[
    Method {
        // An instance from the first call to the last, as for heyoka a call that goes nowhere.
        idle: Some(|case, tolerance, _| {
            Host::new(case, tolerance, true);
            Ok(())
        }),
        ..method("ours, packed FMU", |case, tolerance, states| {
            let host = Host::new(case, tolerance, true);
            let mut before = 0.0;
            for &time in &case.times {
                host.step(before, time - before);
                states.push(host.state());
                before = time;
            }
            Ok(())
        })
    },
    method("ours", |case, tolerance, states| {
        follow(case, start(tolerance), states)
    }),
    method("ours without orbit reuse", |case, tolerance, states| {
        follow(case, start(tolerance).without_orbits(), states)
    }),
    #[cfg(target_arch = "x86_64")]
    method("ours AVX2", |case, tolerance, states| {
        let avx2 = Level::new().as_avx2().ok_or("no AVX2 here")?;
        follow(case, start(tolerance).with_level(Level::Avx2(avx2)), states)
    }),
    method("ours baseline SIMD", |case, tolerance, states| {
        follow(case, start(tolerance).with_level(Level::baseline()), states)
    }),
    method(
        "ours baseline SIMD without orbit reuse",
        |case, tolerance, states| {
            let trajectory = start(tolerance).with_level(Level::baseline());
            follow(case, trajectory.without_orbits(), states)
        },
    ),
];

pub fn start(tolerance: f64) -> Trajectory {
    let rest = State {
        position: 1.0,
        rate: 0.0,
    };
    let limits = Limits {
        lower: 0.05,
        upper: 10.0,
    };
    Trajectory::new(rest, limits, tolerance)
}

pub fn motion(case: &Case) -> Motion {
    let [surface_energy, surface_tension, surface_elasticity] = case.surface;
    let mut drive = Drive::constant(case.voltage, case.prestress);
    drive.harmonic = Harmonic {
        amplitude: case.amplitude,
        frequency: case.frequency,
        frequency_rest: 0.0,
        phase: 0.0,
    };
    Motion {
        coefficients: Coefficients::fold(&Parameters {
            aspect: case.aspect,
            surface_energy,
            surface_tension,
            surface_elasticity,
        }),
        drive,
    }
}

fn follow(case: &Case, mut trajectory: Trajectory, states: &mut Vec<Pair>) -> Result<(), String> {
    let motion = motion(case);
    let (mut before, mut clock) = (0.0, DoubleDouble::ZERO);
    for &time in &case.times {
        match trajectory.advance(&motion, &mut clock, time - before) {
            Ok(Progress::Whole) => {}
            other => return Err(format!("{other:?}")),
        }
        states.push([trajectory.position(), trajectory.rate()]);
        before = time;
    }
    Ok(())
}
