//! What the model structure says of dependencies, against what happens.

use crate::host::{Host, RICH};
use dielectric_elastomer_actuator::instance::Interface;
use dielectric_elastomer_actuator::model::Model;
use dielectric_elastomer_actuator::model::variables::{
    Access, Causality, Dependencies, Kind, Meant,
};
use dielectric_elastomer_actuator::si::Si;

/// Scenes that differ in what is a state and what is imposed.
const SCENES: [&[(&str, f64)]; 4] = [
    &[],
    &[("R_s", 1e7), ("E_conduction", 4e7)],
    &[("source", 2.0), ("current", 1e-6), ("R_s", 1e6)],
    &[("source", 3.0), ("charge_imposed", 5e-12), ("R_s", 1e6)],
];

/// The value of each variable.
fn everything(host: &Host) -> Vec<f64> {
    Si::VARIABLES.iter().map(|row| host.get(row.name)).collect()
}

/// Each output and derivative that is another than `before`, since the number `known` was changed,
/// declares that it depends on it.
fn assert_declared(
    host: &Host,
    before: &[f64],
    known: &str,
    declared: fn(&Dependencies) -> &'static [&'static str],
) {
    for (row, before) in Si::VARIABLES.iter().zip(before) {
        let Access::Result { dependencies, .. } = &row.access else {
            continue;
        };
        let listed = row.causality == Causality::Output || row.derivative_of.is_some();
        let after = host.get(row.name);
        if listed && (after - before).abs() > 1e-12 * before.abs() {
            assert!(
                declared(dependencies).contains(&known),
                "{} depends on {known}: {before} {after}",
                row.name
            );
        }
    }
}

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
                Meant::Whole => value + 1.0,
                _ => {
                    value * (1.0 + 1e-4)
                        + if value == 0.0 {
                            known.start.unwrap_or_default()
                        } else {
                            0.0
                        }
                }
            };
            let before = everything(&host);
            if host.set(known.name, other).is_err() {
                continue;
            }
            assert_declared(&host, &before, known.name, |dependencies| {
                dependencies.at_start
            });
            host.set(known.name, value).expect(known.name);
        }
    }
}

/// What changes with an input or a state during the motion is declared.
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
            let before = everything(&host);
            host.set(known.name, value + 1e-3 * nominal)
                .expect(known.name);
            assert_declared(&host, &before, known.name, |dependencies| dependencies.now);
            host.set(known.name, value).expect(known.name);
        }
    }
}
