//! What the model structure says of dependencies, against what happens.

use crate::host::Host;
use dielectric_elastomer_actuator::instance::Interface;
use dielectric_elastomer_actuator::model::Model;
use dielectric_elastomer_actuator::model::variables::{Access, Causality, Kind};
use dielectric_elastomer_actuator::si::Si;

/// Scenes that differ in what is a state and what is imposed.
const SCENES: [&[(&str, f64)]; 4] = [
    &[],
    &[("R_s", 1e7), ("E_conduction", 4e7)],
    &[("source", 2.0), ("current", 1e-6), ("R_s", 1e6)],
    &[("source", 3.0), ("charge_imposed", 5e-12), ("R_s", 1e6)],
];

/// Everything beyond the paper, so that every parameter has an effect.
const RICH: [(&str, f64); 22] = [
    ("lambda_max", 4.0),
    ("lambda_start", 1.1),
    ("lambda_dot_start", 1e4),
    ("charge_start", 3e-12),
    ("k1", -0.1),
    ("k2", 0.05),
    ("k3", 0.01),
    ("m_load", 1e-12),
    ("k_load", 1.0),
    ("eta", 0.02),
    ("b", 1e-8),
    ("mu_1", 1e5),
    ("mu_2", 1e5),
    ("mu_3", 1e5),
    ("J_1", 40.0),
    ("xi1_start", 1.02),
    ("xi2_start", 1.03),
    ("xi3_start", 1.04),
    ("G_p", 1e-9),
    ("sigma", 1e-7),
    ("force", 1e-5),
    ("V_ac", 0.0),
];

/// Each output and derivative, at the start: what changes with a number is declared.
#[test]
fn what_an_output_depends_on_is_declared() {
    for (scene, law) in
        SCENES
            .iter()
            .zip([("J_m", 60.0), ("kappa2", 0.05), ("J_m", 0.0), ("J_m", 0.0)])
    {
        let mut values = RICH.to_vec();
        values.extend(*scene);
        values.push(law);
        if values.iter().all(|(name, _)| *name != "source") {
            values.extend([("V_ac", 50.0), ("f_ac", 2e5), ("phase_ac", 0.4)]);
        }
        let mut host = Host::initializing(Interface::CoSimulation, &values);
        for known in Si::VARIABLES {
            let set = matches!(known.access, Access::Setting { .. } | Access::Input { .. });
            if !set || !matches!(known.kind, Kind::Real { .. }) || known.name == "source_number" {
                continue;
            }
            let value = host.get(known.name);
            let other = match known.meant {
                dielectric_elastomer_actuator::model::variables::Meant::Whole => value + 1.0,
                _ => {
                    value * (1.0 + 1e-4)
                        + if value == 0.0 {
                            known.start.unwrap_or_default()
                        } else {
                            0.0
                        }
                }
            };
            let before: Vec<f64> = Si::VARIABLES.iter().map(|row| host.get(row.name)).collect();
            if host.set(known.name, other).is_err() {
                continue;
            }
            for (row, before) in Si::VARIABLES.iter().zip(before) {
                let Access::Result { dependencies, .. } = row.access else {
                    continue;
                };
                let listed = row.causality == Causality::Output || row.derivative_of.is_some();
                let after = host.get(row.name);
                let changed = (after - before).abs() > 1e-12 * before.abs();
                if listed && changed {
                    assert!(
                        dependencies.at_start.contains(&known.name),
                        "{} depends on {}: {before} {after}",
                        row.name,
                        known.name
                    );
                }
            }
            host.set(known.name, value).expect(known.name);
        }
    }
}

/// The same of inputs during the motion, and states.
#[test]
fn what_an_output_depends_on_during_the_motion_is_declared() {
    for scene in SCENES {
        let mut values = RICH.to_vec();
        values.extend(scene);
        let mut host = Host::initializing(Interface::ModelExchange, &values);
        host.instance.exit_initialization().expect("a start");
        host.instance.new_discrete_states().expect("an update");
        host.instance.enter_continuous_time();
        let states = Si::STATES.iter().map(|&row| &Si::VARIABLES[row as usize]);
        let inputs = Si::VARIABLES.iter().filter(|row| row.is_input());
        for known in states.chain(inputs) {
            let value = host.get(known.name);
            let nominal = match known.kind {
                Kind::Real { nominal, .. } => nominal,
                _ => 1.0,
            };
            let before: Vec<f64> = Si::VARIABLES.iter().map(|row| host.get(row.name)).collect();
            host.set(known.name, value + 1e-3 * nominal)
                .expect(known.name);
            for (row, before) in Si::VARIABLES.iter().zip(before) {
                let Access::Result { dependencies, .. } = row.access else {
                    continue;
                };
                let listed = row.causality == Causality::Output || row.derivative_of.is_some();
                let after = host.get(row.name);
                if listed && (after - before).abs() > 1e-12 * before.abs() {
                    assert!(
                        dependencies.now.contains(&known.name),
                        "{} depends on {}: {before} {after}",
                        row.name,
                        known.name
                    );
                }
            }
            host.set(known.name, value).expect(known.name);
        }
    }
}
