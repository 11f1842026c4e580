//! The motion by the variables of the table.

use super::host::{Host, row};
use dielectric_elastomer_actuator::instance::Saved;
use serde_json::Value;

fn read(name: &str) -> Value {
    let path = format!(
        "{}/tests/reference/device/{name}.json",
        env!("CARGO_MANIFEST_DIR")
    );
    serde_json::from_str(&std::fs::read_to_string(path).expect("a file")).expect("JSON")
}

fn number(value: &Value) -> f64 {
    value.as_str().expect("decimal").parse().expect("a number")
}

/// The settings of a reference scene, by the names of the table.
fn settings(file: &Value) -> Vec<(String, f64)> {
    const NAMES: [(&str, &str); 24] = [
        ("epsr", "eps_r"),
        ("n", "n_layers"),
        ("J", "J_m"),
        ("m", "m_load"),
        ("k", "k_load"),
        ("l_k", "l_load"),
        ("n_s", "n_surfaces"),
        ("E_c", "E_conduction"),
        ("V", "voltage"),
        ("Q", "charge_imposed"),
        ("I", "current"),
        ("P", "force"),
        ("f", "f_ac"),
        ("mu", "mu"),
        ("rho", "rho"),
        ("H", "H"),
        ("L", "L"),
        ("b", "b"),
        ("eta", "eta"),
        ("R_s", "R_s"),
        ("G_p", "G_p"),
        ("sigma", "sigma"),
        ("V_ac", "V_ac"),
        ("kappa2", "kappa2"),
    ];
    let given = file["parameters_SI"].as_object().expect("parameters");
    // The default device is the paper's, with surfaces.
    let mut all: Vec<(String, f64)> = ["gamma_s", "tau_s", "E_s", "voltage"]
        .iter()
        .map(|name| ((*name).into(), 0.0))
        .collect();
    for (key, value) in given {
        match key.as_str() {
            "mode" => {}
            "branches" => {
                for (k, branch) in value.as_array().expect("rows").iter().enumerate() {
                    all.push((format!("mu_{}", k + 1), number(&branch[0])));
                    all.push((format!("tau_{}", k + 1), number(&branch[1])));
                    if branch[2].is_string() {
                        all.push((format!("J_{}", k + 1), number(&branch[2])));
                    }
                }
            }
            key => {
                let name = NAMES.iter().find(|(short, _)| *short == key);
                let name = name.map_or(key, |(_, name)| name);
                all.push((name.into(), number(value)));
            }
        }
    }
    if given.contains_key("Q") {
        all.push(("source".into(), 3.0));
    }
    if given.contains_key("I") {
        all.push(("source_number".into(), 2.0));
    }
    all
}

fn begun(file: &Value, further: &[(&str, f64)]) -> Host {
    let given = settings(file);
    let mut values: Vec<(&str, f64)> = given.iter().map(|(k, v)| (k.as_str(), *v)).collect();
    values.extend(further);
    Host::begun(&values)
}

const SCENES: [&str; 14] = [
    "A_si_dc_step",
    "B_rc_step",
    "D_kv_step",
    "F_sls_creep_vhb",
    "G2_gent_sylgard",
    "H_ac_damped",
    "I_charge_step",
    "K_force_step_stack",
    "L_permittivity_step",
    "N_yeoh_step",
    "own_stiff_rc",
    "own_current",
    "own_everything",
    "own_overdamped",
];

/// Every reference scene through the variables of the table, in seconds, volts and newtons.
#[test]
fn scenes_are_met_in_si_units() {
    for name in SCENES {
        let file = read(name);
        let mut host = begun(&file, &[("record_energy", 1.0), ("lambda_max", 5.0)]);
        let rows = file["rows"].as_array().expect("rows");
        let end = number(&rows[rows.len() - 1]["t_s"]);
        let largest = |key: &str| {
            let sizes = rows
                .iter()
                .filter_map(|row| row.get(key))
                .map(|v| number(v).abs());
            sizes.fold(1e-300, f64::max)
        };
        let at_start = stored(&host);
        let begin: Vec<f64> = EXCHANGED.iter().map(|(ours, _)| host.get(ours)).collect();
        let energy = [
            "E_electric_J",
            "E_elastic_J",
            "supplied_electric_J",
            "E_kinetic_J",
        ]
        .map(largest)
        .into_iter()
        .fold(0.0, f64::max);
        for row in rows {
            host.follow(number(&row["t_s"]), 0.013 * end);
            for (ours, key) in [
                ("lambda", "lambda"),
                ("lambda_dot", "lambda_dot_per_s"),
                ("charge", "charge_C"),
                ("supply_current", "supply_current_A"),
                ("membrane_voltage", "membrane_voltage_V"),
                ("electric_field", "field_V_per_m"),
                ("capacitance", "capacitance_F"),
                ("xi1", "xi1"),
                ("xi3", "xi3"),
            ] {
                if let Some(exact) = row.get(key) {
                    let error = (host.get(ours) - number(exact)).abs() / largest(key);
                    assert!(error < 1e-9, "{name}, {ours}: {error:e}");
                }
            }
            for ((ours, key), begin) in EXCHANGED.iter().zip(&begin) {
                let error = host.get(ours) - begin - number(&row[*key]);
                assert!(
                    error.abs() < 1e-9 * energy,
                    "{name}, {ours}: {error:e} of {energy:e}"
                );
            }
            let gained: f64 =
                gain(&host) - begin.iter().zip(SIGNS).map(|(e, s)| e * s).sum::<f64>();
            let residual = stored(&host) - at_start - gained;
            assert!(
                residual.abs() < 1e-10 * energy,
                "{name}: {residual:e} of {energy:e}"
            );
        }
    }
}

const EXCHANGED: [(&str, &str); 6] = [
    ("lost_damping", "lost_damping_J"),
    ("lost_branches", "lost_branches_J"),
    ("lost_resistance", "lost_series_resistance_J"),
    ("lost_leakage", "lost_leakage_J"),
    ("supplied_electrical", "supplied_electric_J"),
    ("supplied_mechanical", "supplied_mechanical_J"),
];

const SIGNS: [f64; 6] = [-1.0, -1.0, -1.0, -1.0, 1.0, 1.0];

pub fn gain(host: &Host) -> f64 {
    let sums = EXCHANGED.iter().map(|(ours, _)| host.get(ours));
    sums.zip(SIGNS).map(|(energy, sign)| energy * sign).sum()
}

pub fn stored(host: &Host) -> f64 {
    [
        "kinetic", "elastic", "surface", "spring", "branches", "electric",
    ]
    .iter()
    .map(|kind| host.get(&format!("energy_{kind}")))
    .sum()
}

/// The voltage moves at every step, the actuator's parameters once on the way: the balance of
/// energy holds but for what changing a parameter does itself.
#[test]
fn inputs_that_jump_are_booked() {
    for resistance in [0.0, 1e7] {
        let mut host = Host::begun(&[("record_energy", 1.0), ("R_s", resistance), ("eta", 0.01)]);
        let mut largest = 0.0_f64;
        for k in 0..60 {
            host.set("voltage", 300.0 + 40.0 * f64::from(k % 7))
                .expect("a voltage");
            host.set("force", 1e-5 * f64::from(k % 5)).expect("a force");
            host.step(3.3e-7);
            let sizes = EXCHANGED.iter().map(|(ours, _)| host.get(ours).abs());
            largest = sizes.fold(largest, f64::max);
            let residual = stored(&host) - gain(&host);
            assert!(
                residual.abs() < 1e-10 * largest,
                "{resistance} {k}: {residual:e}"
            );
        }
        // The start: a capacitance charged at once from nothing.
        assert!(host.get("lost_resistance") > 0.0);
    }
}

/// Parameters that change during the motion leave stretch, rate and charge where they are.
#[test]
fn a_changed_parameter_keeps_the_state() {
    let mut host = Host::begun(&[("R_s", 1e7)]);
    host.follow(5e-6, 1e-7);
    let before = ["lambda", "lambda_dot", "charge"].map(|name| host.get(name));
    for (name, value) in [
        ("R_s", 0.0),
        ("eta", 0.02),
        ("mu_2", 1e5),
        ("R_s", 2e6),
        ("mu", 250e3),
    ] {
        host.set(name, value).expect(name);
        // Of an ideal source the charge follows.
        if value == 0.0 {
            host.set("voltage", before[2] / host.get("capacitance"))
                .expect("a voltage");
        }
        let at_once = ["lambda", "lambda_dot", "charge"].map(|name| host.get(name));
        host.step(1e-16);
        let after = ["lambda", "lambda_dot", "charge"].map(|name| host.get(name));
        for (old, new) in before.iter().zip(at_once).chain(before.iter().zip(after)) {
            assert!((new / old - 1.0).abs() < 1e-6, "{name}: {old} to {new}");
        }
    }
    host.follow(6e-6, 1e-7);
    assert!(host.get("lambda") > 1.0);
}

/// Saved in the middle and gone on with in another instance: the same bits.
#[test]
fn saved_instances_go_on_bit_for_bit() {
    for (name, recorded) in SCENES.iter().flat_map(|name| [(name, 1.0), (name, 0.0)]) {
        let file = read(name);
        let settings = [("record_extremes", recorded), ("lambda_max", 5.0)];
        let mut host = begun(&file, &settings);
        let end = number(&file["rows"][10]["t_s"]);
        host.follow(0.31 * end, 0.07 * end);
        let saved = host.instance.save(Saved::default()).expect("a state");
        let mut other = begun(&file, &settings);
        other.instance.restore(&saved).expect("the same kind");
        other.time = host.time;
        for _ in 0..7 {
            host.step(0.031 * end);
            other.step(0.031 * end);
            for quantity in ["lambda", "lambda_dot", "charge", "xi1", "lambda_highest"] {
                let [ours, theirs] = [host.get(quantity), other.get(quantity)];
                assert_eq!(ours.to_bits(), theirs.to_bits(), "{name}, {quantity}");
            }
        }
    }
}

/// Where a material locks, a motion can come so near to its locking stretch that its steps become the shortest.
#[test]
fn an_instance_saved_after_a_step_that_ended_early_is_restored() {
    let mut ended = 0;
    for locking in [0.01, 0.1, 1.0, 10.0] {
        let settings = [("J_m", locking)];
        let [mut host, mut other] = [Host::begun(&settings), Host::begun(&settings)];
        host.step(1e-6);
        host.set("voltage", 3e4).expect("a voltage");
        ended += usize::from(host.instance.do_step(1e-6, 1e-6).is_err());
        let saved = host.instance.save(Saved::default()).expect("a state");
        let read = other.instance.saved(saved.bytes()).expect("sound bytes");
        other.instance.restore(&read).expect("the same kind");
        assert_eq!(host.get("lambda").to_bits(), other.get("lambda").to_bits());
        assert_eq!(other.instance.save(Saved::default()), Ok(saved));
    }
    assert!(ended > 1, "{ended}");
}

/// The charge of an actuator without a resistance is no state: what stands for it is the start value.
#[test]
fn a_charge_that_is_no_state_is_the_one_of_the_start() {
    let mut host = Host::begun(&[("charge_start", 5e-12)]);
    for (name, value) in [("rho", 1101.0), ("R_s", 1e6), ("R_s", 0.0)] {
        host.step(1e-6);
        host.set(name, value).expect(name);
        host.step(1e-6);
        let charge = host.get("charge_state");
        assert_eq!(charge == 5e-12, host.get("R_s") == 0.0, "{name}: {charge}");
    }
}

/// A parameter that has no effect is tuned after a state was restored: the motion goes on as the saved one does.
#[test]
fn a_parameter_without_effect_does_not_tell_a_restored_instance() {
    let settings = [("J_m", 60.0), ("eta", 0.01)];
    for (name, value) in [
        ("J_2", 60.0),
        ("tau_2", 3.0),
        ("n_breakdown", 1.0),
        ("voltage", 500.0),
    ] {
        let [mut host, mut other] = [Host::begun(&settings), Host::begun(&settings)];
        host.step(3.3e-6);
        other
            .instance
            .restore(&host.instance.save(Saved::default()).expect("a state"))
            .expect("a state");
        other.time = host.time;
        for host in [&mut host, &mut other] {
            host.set(name, value).expect(name);
            host.step(1e-9);
            host.step(2.7e-6);
        }
        let [ours, theirs] = [&host, &other].map(|host| host.get("lambda").to_bits());
        assert_eq!(ours, theirs, "{name}");
    }
}

/// Breakdown as a flag cuts a step of the motion in the middle of a communication step: what is saved
/// at its end goes on, with and without a charge as a state, whether the motion had gone on before.
#[test]
fn an_instance_saved_after_breakdown_goes_on_bit_for_bit() {
    for (resistance, before) in [(0.0, 0.0), (1e6, 0.0), (0.0, 3e-7), (1e6, 3e-7)] {
        let settings = [
            ("E_breakdown", 62e6),
            ("lambda_max", 3.0),
            ("R_s", resistance),
        ];
        let [mut host, mut other] = [Host::begun(&settings), Host::begun(&settings)];
        if before > 0.0 {
            host.step(before);
        }
        assert_eq!(host.get("broken_down"), 0.0);
        host.step(1e-5);
        assert_eq!(host.get("broken_down"), 1.0);
        let saved = host.instance.save(Saved::default()).expect("a state");
        let read = other.instance.saved(saved.bytes()).expect("sound bytes");
        other.instance.restore(&read).expect("the same kind");
        other.time = host.time;
        for host in [&mut host, &mut other] {
            host.step(2e-6);
            host.step(1e-8);
        }
        let [ours, theirs] = [&host, &other].map(|host| host.get("lambda").to_bits());
        assert_eq!(ours, theirs);
    }
}

/// A supply voltage that ramps through zero within each step, behind a small resistance: the charge is as accurate as
/// the ramp is high, not relative to what it is next to zero.
#[test]
fn a_supply_may_ramp_through_zero_in_each_step() {
    for (resistance, energy, periods) in [(20.0, 0.0, 30.0), (20.0, 1.0, 3.0), (100.0, 1.0, 7.0)] {
        let settings = [
            ("R_s", resistance),
            ("voltage", 400.0),
            ("record_energy", energy),
        ];
        let [mut host, mut finer] = [Host::begun(&settings), Host::begun(&settings)];
        let step = periods * 4.6e-6;
        for voltage in [400.0, -400.0, 400.0, -400.0] {
            for (host, parts) in [(&mut host, 1), (&mut finer, 40)] {
                host.set("voltage", voltage).expect("a voltage");
                host.instance
                    .set_input_derivatives(&[row("voltage").0], &[1], &[-2.0 * voltage / step])
                    .expect("a ramp");
                for _ in 0..parts {
                    host.step(step / f64::from(parts));
                }
            }
            for (quantity, size) in [("lambda", 1.0), ("charge", 1e-11)] {
                let [ours, theirs] = [&host, &finer].map(|host| host.get(quantity));
                let error = (ours - theirs).abs() / size;
                assert!(error < 1e-8, "{quantity} of {resistance} Ohm: {error:e}");
            }
        }
    }
}

/// Derivatives in time against differences along the motion.
#[test]
fn output_derivatives_are_those_of_the_motion() {
    for resistance in [0.0, 1e6] {
        let mut host = Host::begun(&[
            ("R_s", resistance),
            ("eta", 0.02),
            ("mu_1", 1e5),
            ("tau_1", 1e-6),
            ("V_ac", 100.0),
            ("f_ac", 2e5),
            ("G_p", 1e-10),
        ]);
        host.follow(2e-6, 1e-7);
        let names = [
            "lambda",
            "edge_velocity",
            "charge",
            "supply_current",
            "electrical_power",
        ];
        let references = names.map(|name| row(name).0);
        let mut slopes = [0.0; 5];
        host.instance
            .output_derivatives(&references, &[1; 5], |k, v| slopes[k] = v)
            .expect("derivatives");
        let step = 1e-10;
        let before = names.map(|name| host.get(name));
        host.step(step);
        let middle = names.map(|name| host.get(name));
        host.step(step);
        let after = names.map(|name| host.get(name));
        for k in 0..5 {
            // Of second order at the begin.
            let difference = (4.0 * middle[k] - 3.0 * before[k] - after[k]) / (2.0 * step);
            let error = (slopes[k] - difference).abs();
            assert!(
                error < 1e-4 * difference.abs(),
                "{}: {} {difference}",
                names[k],
                slopes[k]
            );
        }
    }
}
