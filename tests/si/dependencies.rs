//! What the model structure says of dependencies, against what happens.

use std::collections::BTreeSet;

use super::host::{Host, RICH};
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

/// Each output and derivative, and on what it declares to depend.
fn declarations(
    declared: fn(&Dependencies) -> &'static [&'static str],
) -> impl Iterator<Item = (&'static str, &'static [&'static str])> {
    Si::VARIABLES.iter().filter_map(move |row| {
        let Access::Result { dependencies, .. } = &row.access else {
            return None;
        };
        let listed = row.causality == Causality::Output || row.derivative_of.is_some();
        listed.then(|| (row.name, declared(dependencies)))
    })
}

/// Pairs of an output or derivative and a number on which it depends.
type Pairs = BTreeSet<(&'static str, &'static str)>;

/// Sees which outputs and derivatives are others than `before`, since the number `known` was changed.
fn see(pairs: &mut Pairs, host: &Host, before: &[f64], known: &'static str) {
    for (row, before) in Si::VARIABLES.iter().zip(before) {
        let after = host.get(row.name);
        if (after - before).abs() > 1e-12 * before.abs() {
            pairs.insert((row.name, known));
        }
    }
}

/// One list is declared for supply current, power, supply voltage and the rate of the charge. Of two of them it has
/// more than they depend on; a host may be told more than there is.
const SHARED: [(&str, &str); 5] = [
    ("charge_state_dot", "charge_imposed"),
    ("charge_state_dot", "lambda_dot"),
    ("charge_state_dot", "lambda_dot_start"),
    ("supply_voltage", "lambda_dot"),
    ("supply_voltage", "lambda_dot_start"),
];

/// Whether no scene can show that this depends on that. A flag changes at a threshold only; choices are not varied;
/// a frequency turns nothing before time has passed; a branch is one only where its modulus is not 0.
fn cannot_be_seen((unknown, known): (&str, &str)) -> bool {
    unknown == "breakdown"
        || ["source", "source_number", "f_ac"].contains(&known)
        || [
            ("xi1_dot", "mu_1"),
            ("xi2_dot", "mu_2"),
            ("xi3_dot", "mu_3"),
        ]
        .contains(&(unknown, known))
}

/// What was seen is declared, and what is declared was seen, but for what is in a list that is [`SHARED`].
fn assert_declared(seen: &Pairs, declared: fn(&Dependencies) -> &'static [&'static str]) {
    let (mut missing, mut too_many) = (Pairs::new(), Pairs::new());
    for (name, declared) in declarations(declared) {
        let depends = seen.iter().filter(|(unknown, _)| *unknown == name);
        missing.extend(depends.filter(|(_, known)| !declared.contains(known)));
        let pairs = declared.iter().map(|known| (name, *known));
        too_many.extend(pairs.filter(|pair| !seen.contains(pair) && !cannot_be_seen(*pair)));
    }
    assert!(missing.is_empty(), "not declared: {missing:?}");
    let mut shared = Pairs::from(SHARED);
    shared.retain(|(unknown, known)| {
        declarations(declared).any(|(name, list)| name == *unknown && list.contains(known))
    });
    assert_eq!(too_many, shared, "declared, and not seen in any scene");
}

/// Each output and derivative, at the start: what changes with a number is declared, and no more.
#[test]
fn what_an_output_depends_on_is_declared() {
    let mut seen = Pairs::new();
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
            let Kind::Real { nominal, .. } = known.kind else {
                continue;
            };
            if !set || known.name == "source_number" {
                continue;
            }
            let value = host.get(known.name);
            let other = match known.meant {
                Meant::Whole => value + 1.0,
                // What is left out is put in.
                _ if value == 0.0 || value.is_infinite() => nominal,
                _ => value * (1.0 + 1e-4),
            };
            let before = everything(&host);
            if host.set(known.name, other).is_err() {
                continue;
            }
            see(&mut seen, &host, &before, known.name);
            host.set(known.name, value).expect(known.name);
        }
    }
    assert_declared(&seen, |dependencies| dependencies.at_start);
}

/// What changes with an input or a state during the motion is declared, and no more.
#[test]
fn what_an_output_depends_on_during_the_motion_is_declared() {
    let mut seen = Pairs::new();
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
            see(&mut seen, &host, &before, known.name);
            host.set(known.name, value).expect(known.name);
        }
    }
    assert_declared(&seen, |dependencies| dependencies.now);
}
