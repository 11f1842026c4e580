//! Directional derivatives by inputs, states and parameters.

use super::host::{Host, RICH, row};
use dielectric_elastomer_actuator::instance::Interface;
use dielectric_elastomer_actuator::model::Model;
use dielectric_elastomer_actuator::model::variables::{Access, Kind, Meant};
use dielectric_elastomer_actuator::si::Si;

/// Scenes that differ in what is a state and what is imposed, and in the law of elasticity.
const SCENES: [&[(&str, f64)]; 4] = [
    &[
        ("J_m", 60.0),
        ("V_ac", 50.0),
        ("f_ac", 2e5),
        ("phase_ac", 0.4),
    ],
    &[("R_s", 1e7), ("kappa2", 0.05), ("kappa3", 0.02)],
    &[
        ("source", 2.0),
        ("current", 1e-6),
        ("R_s", 1e6),
        ("J_m", 30.0),
    ],
    &[("source", 3.0), ("charge_imposed", 5e-12), ("R_s", 1e6)],
];

/// The derivatives of all that has any by one number, against differences of fourth order: each
/// number of the table in each scene.
#[test]
fn directional_derivatives_are_slopes() {
    let offered: Vec<u32> = (0..)
        .zip(Si::VARIABLES)
        .filter(|(_, row)| match row.access {
            Access::Result { derivatives, .. } => derivatives.is_some(),
            _ => false,
        })
        .map(|(reference, _)| reference)
        .collect();
    assert!(offered.len() > 25);
    let mut count = 0;
    for scene in SCENES {
        let mut values = RICH.to_vec();
        values.extend(scene);
        let mut host = Host::initializing(Interface::CoSimulation, &values);
        for known in Si::VARIABLES {
            let set = matches!(known.access, Access::Setting { .. } | Access::Input { .. });
            let value = host.get(known.name);
            let number = matches!(known.kind, Kind::Real { .. }) && known.meant != Meant::Whole;
            if !set || !number || value == 0.0 {
                continue;
            }
            let mut slopes = vec![f64::NAN; offered.len()];
            host.instance
                .directional_derivative(&offered, &[row(known.name).0], &[1.0], |k, v| {
                    slopes[k] = v
                })
                .expect("derivatives");
            let step = 2e-4 * value;
            let mut at = |part: f64| -> Option<Vec<f64>> {
                host.set(known.name, value + part * step).ok()?;
                Some(
                    offered
                        .iter()
                        .map(|&place| host.get(Si::VARIABLES[place as usize].name))
                        .collect(),
                )
            };
            let Some([far, near, up, high]) = [-2.0, -1.0, 1.0, 2.0]
                .map(&mut at)
                .into_iter()
                .collect::<Option<Vec<_>>>()
                .and_then(|all| <[Vec<f64>; 4]>::try_from(all).ok())
            else {
                host.set(known.name, value).expect("a value");
                continue;
            };
            host.set(known.name, value).expect("a value");
            for (k, &place) in offered.iter().enumerate() {
                let difference = (8.0 * (up[k] - near[k]) - (high[k] - far[k])) / (12.0 * step);
                // Of what rounding leaves of the difference, and of its next order.
                let size = 1e-11 * (up[k].abs() / step.abs()).max(difference.abs());
                let error = (slopes[k] - difference).abs();
                assert!(
                    error <= 10.0 * size,
                    "{} by {}: {} {difference}",
                    Si::VARIABLES[place as usize].name,
                    known.name,
                    slopes[k]
                );
                count += usize::from(difference != 0.0);
            }
        }
    }
    assert!(count > 600, "{count}");
}

/// What is 0, and might not be: a load mass, a spring, a viscosity, a stiffening and a leak have
/// slopes of their own there; a resistance that is none has none.
#[test]
fn derivatives_where_a_parameter_is_zero() {
    let values = [
        ("lambda_start", 1.1),
        ("lambda_dot_start", 1e4),
        ("voltage", 500.0),
    ];
    let host = Host::initializing(Interface::CoSimulation, &values);
    let slope = |unknown: &str, known: &str| {
        let mut slope = f64::NAN;
        host.instance
            .directional_derivative(&[row(unknown).0], &[row(known).0], &[1.0], |_, v| slope = v)
            .expect("a derivative");
        slope
    };
    let [stretch, rate, side, height] = [1.1_f64, 1e4, 100e-6, 10e-6];
    let acceleration = host.get("lambda_ddot");
    // M = c + 2/λ⁶ in units of ρT³/12.
    let unit = 1100.0 * height.powi(3) / 12.0;
    let inertia = (side / height).powi(2) + 2.0 / stretch.powi(6);
    let close = |found: f64, exact: f64| {
        assert!((found / exact - 1.0).abs() < 1e-12, "{found} {exact}");
    };
    close(
        slope("lambda_ddot", "m_load"),
        -acceleration / (unit * inertia),
    );
    // A force on the edges moves them by force/(L·unit·M); of these:
    let mobility = 1.0 / (side * unit * inertia);
    close(slope("lambda_ddot", "force"), mobility);
    close(
        slope("lambda_ddot", "k_load"),
        -side * (stretch - 1.0) * mobility,
    );
    close(slope("lambda_ddot", "b"), -side * rate * mobility);
    let viscous = 6.0 * height * side * rate / stretch.powi(2);
    close(slope("lambda_ddot", "eta"), -viscous * mobility);
    let i = 2.0 * stretch.powi(2) + stretch.powi(-4) - 3.0;
    let elastic = 303e3 * height * side * (stretch - stretch.powi(-5));
    close(
        slope("lambda_ddot", "kappa2"),
        -elastic * 2.0 * i * mobility,
    );
    close(slope("supply_current", "G_p"), 500.0);
    assert_eq!(slope("lambda_ddot", "R_s"), 0.0);
    assert_eq!(slope("lambda_ddot", "J_m"), 0.0);
}

/// After initialization a frequency changes from now on, and an amplitude of 0 has the phase of the drive, at late
/// times too.
#[test]
fn derivatives_by_the_drive_during_the_motion() {
    const UNKNOWNS: [&str; 3] = ["supply_voltage", "supply_current", "lambda_ddot"];
    for (amplitude, frequency, time) in [
        (100.0, 1e5, 1e-6),
        (0.0, 1.234567e6, 1e6),
        (100.0, 1.234567e6, 1e6),
    ] {
        let mut host = Host::begun(&[("f_ac", frequency)]);
        host.step(time);
        host.set("V_ac", amplitude).expect("an amplitude");
        host.step(1e-6);
        for (known, change) in [("V_ac", 1.0), ("f_ac", 1e-3 * frequency)] {
            let mut slopes = [f64::NAN; 3];
            let unknowns = UNKNOWNS.map(|name| row(name).0);
            host.instance
                .directional_derivative(&unknowns, &[row(known).0], &[change], |k, v| slopes[k] = v)
                .expect("derivatives");
            let value = host.get(known);
            let mut at = |part: f64| {
                host.set(known, value + part * change).expect(known);
                UNKNOWNS.map(|name| host.get(name))
            };
            let [above, below] = [at(1.0), at(-1.0)];
            at(0.0);
            for k in 0..3 {
                let difference = 0.5 * (above[k] - below[k]);
                let size = above[k].abs();
                assert!(
                    (slopes[k] - difference).abs() < 1e-10 * size,
                    "{} by {known} at {time}: {} for {difference}",
                    UNKNOWNS[k],
                    slopes[k]
                );
            }
        }
    }
}
