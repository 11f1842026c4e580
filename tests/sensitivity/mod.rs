//! Derivatives of the motion by its parameters against difference quotients of a plain
//! trajectory, and against a redundancy of the equation that is exact.

use crate::clocked::Clocked;
use dielectric_elastomer_actuator::actuator::drive::Polynomial;
use dielectric_elastomer_actuator::nondimensional::scene::Scene;
use dielectric_elastomer_actuator::sensitivity::{
    Experiment, Interruption, Known, Prediction, Ramp, follow,
};
use dielectric_elastomer_actuator::solver::limits::Limit;
use dielectric_elastomer_actuator::solver::trajectory::Trajectory;

const TOLERANCE: f64 = 1e-13;

/// A voltage that is held, rises, falls and jumps.
const VOLTAGE: [Ramp; 4] = [
    Ramp {
        time: 0.0,
        voltage: 0.3,
        slope: 0.0,
    },
    Ramp {
        time: 7.3,
        voltage: 0.3,
        slope: 0.02,
    },
    Ramp {
        time: 19.1,
        voltage: 0.1,
        slope: -0.004,
    },
    Ramp {
        time: 31.7,
        voltage: 0.45,
        slope: 0.0,
    },
];

const TIMES: [f64; 9] = [0.0, 0.4, 3.77, 7.3, 12.9, 19.2, 30.3, 33.3, 61.9];

fn scene() -> Scene {
    let mut scene = Scene::at_start();
    scene.parameters.surface_energy = 0.05;
    scene.parameters.surface_tension = 0.03;
    scene.parameters.surface_elasticity = 0.1;
    scene.drive.prestress = Polynomial::constant(0.2);
    scene.start.position = 1.05;
    scene.start.rate = -0.002;
    scene
}

/// The experiment with one of its parameters changed by a number.
fn changed(known: Known, by: f64) -> Vec<f64> {
    let mut scene = scene();
    let (mut voltage_scale, mut time_scale) = (1.1, 0.9);
    match known {
        Known::Aspect => scene.parameters.aspect += by,
        Known::SurfaceEnergy => scene.parameters.surface_energy += by,
        Known::SurfaceTension => scene.parameters.surface_tension += by,
        Known::SurfaceElasticity => scene.parameters.surface_elasticity += by,
        Known::Prestress => {
            scene.drive.prestress = Polynomial::constant(scene.drive.prestress.value() + by);
        }
        Known::VoltageScale => voltage_scale += by,
        Known::TimeScale => time_scale += by,
        Known::Stretch => scene.start.position += by,
        Known::StretchRate => scene.start.rate += by,
    }
    plain(&scene, voltage_scale, time_scale)
}

/// The stretch at `TIMES` from a trajectory that steps from one time or border to the next.
fn plain(scene: &Scene, voltage_scale: f64, time_scale: f64) -> Vec<f64> {
    let mut scene = *scene;
    let mut trajectory = Clocked::from(Trajectory::new(scene.start, scene.limits, TOLERANCE));
    let mut borders: Vec<f64> = VOLTAGE.iter().map(|ramp| ramp.time).chain(TIMES).collect();
    borders.sort_by(f64::total_cmp);
    borders.dedup();
    let mut now = 0.0;
    let mut stretches = Vec::new();
    for border in borders {
        if border > now {
            let step = time_scale * (border - now);
            trajectory
                .advance(&scene, step)
                .expect("it can be followed");
            now = border;
        }
        if let Some(ramp) = VOLTAGE.iter().find(|ramp| ramp.time == border) {
            let mut voltage = Polynomial::constant(voltage_scale * ramp.voltage);
            voltage.set_derivative(1, voltage_scale * ramp.slope / time_scale);
            scene.drive.voltage = voltage;
            scene.drive.since = trajectory.clock;
            trajectory.restart();
        }
        if TIMES.contains(&border) {
            stretches.push(trajectory.position());
        }
    }
    stretches
}

fn followed(scene: Scene, voltage: &[Ramp], times: &[f64]) -> Vec<Prediction> {
    let experiment = Experiment {
        scene,
        voltage_scale: 1.1,
        time_scale: 0.9,
        voltage,
        times,
        tolerance: TOLERANCE,
    };
    follow(&experiment).expect("it can be followed")
}

#[test]
fn the_stretch_is_that_of_a_plain_trajectory() {
    let samples = followed(scene(), &VOLTAGE, &TIMES);
    let expected = changed(Known::Aspect, 0.0);
    assert_eq!(samples.len(), TIMES.len());
    assert_eq!(expected.len(), TIMES.len());
    for (sample, stretch) in samples.iter().zip(&expected) {
        assert!((sample.stretch - stretch).abs() < 1e-12, "{sample:?}");
    }
}

#[test]
fn each_slope_is_the_limit_of_difference_quotients() {
    let samples = followed(scene(), &VOLTAGE, &TIMES);
    for (index, known) in Known::ALL.into_iter().enumerate() {
        // Small beside the parameter, so that the fourth order is not seen; the rounding of
        // the stretch becomes 1e-14/h.
        let h = match known {
            Known::Aspect => 0.1,
            Known::StretchRate => 1e-4,
            _ => 3e-4,
        };
        let [one, two] = [h, 2.0 * h].map(|h| [changed(known, h), changed(known, -h)]);
        for (k, sample) in samples.iter().enumerate() {
            let narrow = (one[0][k] - one[1][k]) / (2.0 * h);
            let wide = (two[0][k] - two[1][k]) / (4.0 * h);
            let quotient = narrow + (narrow - wide) / 3.0;
            let difference = (sample.slopes[index] - quotient).abs();
            assert!(
                difference < 1e-8 * quotient.abs().max(1.0),
                "{known:?} at {}: {} instead of {quotient}",
                TIMES[k],
                sample.slopes[index]
            );
        }
    }
}

/// (γ, τ, φ²) and (γ + s, τ + s, φ² + 4s) move alike, so that the derivatives along this
/// direction vanish, as long as the voltage is constant.
#[test]
fn the_redundancy_of_the_surface_parameters_is_exact() {
    let voltage = [Ramp {
        time: 0.0,
        voltage: 0.4,
        slope: 0.0,
    }];
    let times: Vec<f64> = (1..40).map(|k| 1.37 * f64::from(k)).collect();
    let samples = followed(scene(), &voltage, &times);
    let by_squared = 1.0 / (2.0 * 1.1 * 0.4 * 0.4);
    for sample in samples {
        let slope = |known: Known| sample.slopes[known as usize];
        let terms = [
            slope(Known::SurfaceEnergy),
            slope(Known::SurfaceTension),
            4.0 * by_squared * slope(Known::VoltageScale),
        ];
        let size = terms
            .iter()
            .fold(0.0_f64, |size, term| size.max(term.abs()));
        assert!(
            terms.iter().sum::<f64>().abs() < 1e-12 * size.max(1.0),
            "{terms:?}"
        );
    }
}

#[test]
fn a_collapse_is_told_with_its_time() {
    let voltage = [Ramp {
        time: 2.0,
        voltage: 0.9,
        slope: 0.0,
    }];
    let mut scene = Scene::at_start();
    scene.start.position = 1.1;
    let experiment = Experiment {
        scene,
        voltage_scale: 1.0,
        time_scale: 0.5,
        voltage: &voltage,
        times: &[2.0, 1000.0],
        tolerance: 1e-10,
    };
    let Err(Interruption::Collapse(Limit::Upper, time)) = follow(&experiment) else {
        panic!("the actuator survives");
    };
    let mut trajectory = Clocked::from(Trajectory::new(scene.start, scene.limits, 1e-10));
    scene.drive.voltage = Polynomial::constant(0.9);
    let progress = trajectory
        .advance(&scene, 500.0)
        .expect("it can be followed");
    let expected = format!("{progress:?}");
    assert!(expected.starts_with("Stopped"), "{expected}");
    assert!(((time - 2.0) * 0.5 - trajectory.clock.value()).abs() < 1e-7);
}
