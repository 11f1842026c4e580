//! Each reference scene, at times that are no ends of our steps.

use super::scene::{Present, Scene, follow, number, read, start};
use dielectric_elastomer_actuator::arithmetic::double_double::DoubleDouble;

/// The largest errors of a scene: of the stretch, of the rate (in units of its largest value),
/// of the charge, of the current, of voltage, field and capacitance, of the dashpots, of each energy in
/// units of the largest one, and of the balance of energy.
#[derive(Debug, Default)]
struct Errors {
    stretch: f64,
    rate: f64,
    charge: f64,
    current: f64,
    field: f64,
    dashpots: f64,
    energy: f64,
    balance: f64,
}

fn errors(name: &str, tolerance: f64, step: f64, records_energy: bool) -> Errors {
    let file = read(name);
    let scene = Scene::of(&file);
    let scales = scene.scales();
    let motion = scene.motion(records_energy);
    let mut trajectory = start(&motion, scene.charge, tolerance);
    let rows = file["rows"].as_array().expect("rows");
    // A column that a file does not have is not compared.
    let cell = |row: &serde_json::Value, key: &str| row.get(key).map(number);
    let largest = |key: &str| {
        let sizes = rows.iter().filter_map(|row| cell(row, key)).map(f64::abs);
        sizes.fold(0.0, f64::max)
    };
    let energies = [
        "E_kinetic_J",
        "E_elastic_J",
        "E_electric_J",
        "supplied_electric_J",
    ];
    let energy = energies.map(largest).into_iter().fold(0.0, f64::max);
    let at_start = Present::of(&motion, &trajectory).stored.total();
    let [rate, charge, current] =
        ["lambda_dot_per_s", "charge_C", "supply_current_A"].map(|key| largest(key).max(1e-300));
    let mut worst = Errors::default();
    let mut see = |place: fn(&mut Errors) -> &mut f64, error: f64| {
        let place = place(&mut worst);
        *place = crate::largest::largest([*place, error]);
    };
    for row in rows {
        let time = scales.time(DoubleDouble::new(number(&row["t_s"])));
        follow(&mut trajectory, &motion, time, step);
        let get = |key: &str| number(&row[key]);
        let present = Present::of(&motion, &trajectory);
        see(
            |e| &mut e.stretch,
            (trajectory.position() - get("lambda")).abs(),
        );
        see(
            |e| &mut e.rate,
            (trajectory.rate() / scales.time - get("lambda_dot_per_s")).abs() / rate,
        );
        see(
            |e| &mut e.charge,
            (present.charge * scales.charge - get("charge_C")).abs() / charge,
        );
        let supply = present.current * scales.current();
        see(
            |e| &mut e.current,
            (supply - get("supply_current_A")).abs() / current,
        );
        for (value, key) in [
            (
                present.membrane_voltage * scales.voltage,
                "membrane_voltage_V",
            ),
            (present.field * scales.field, "field_V_per_m"),
            (present.capacitance * scales.capacitance, "capacitance_F"),
        ] {
            if let Some(exact) = cell(row, key) {
                let size = largest(key).max(1e-300);
                see(|e| &mut e.field, (value - exact).abs() / size);
            }
        }
        let states = trajectory.internal();
        let first = usize::from(motion.device.has_charge_state());
        for k in 0..scene.branches {
            let stretch = states[first + k].sqrt();
            see(
                |e| &mut e.dashpots,
                (stretch - get(&format!("xi{}", k + 1))).abs(),
            );
        }
        let (stored, exchanged) = (present.stored, present.exchanged);
        let mut energies = vec![
            (stored.kinetic, "E_kinetic_J"),
            (stored.elastic, "E_elastic_J"),
            (stored.surface, "E_surface_J"),
            (stored.spring, "E_spring_J"),
            (stored.branches, "E_branches_J"),
            (stored.electric, "E_electric_J"),
        ];
        if records_energy {
            energies.extend([
                (exchanged.damping, "lost_damping_J"),
                (exchanged.branches, "lost_branches_J"),
                (exchanged.series, "lost_series_resistance_J"),
                (exchanged.leakage, "lost_leakage_J"),
                (exchanged.electrical, "supplied_electric_J"),
                (exchanged.mechanical, "supplied_mechanical_J"),
            ]);
        }
        if records_energy {
            let balance = stored.total() - at_start - exchanged.gain();
            see(|e| &mut e.balance, balance.abs() * scales.energy / energy);
        }
        for (value, key) in energies {
            if let Some(exact) = cell(row, key) {
                let error = value * scales.energy - exact;
                see(|e| &mut e.energy, error.abs() / energy);
            }
        }
    }
    worst
}

impl Errors {
    fn largest(&self) -> f64 {
        let Errors {
            stretch,
            rate,
            charge,
            current,
            field,
            dashpots,
            energy,
            balance,
        } = *self;
        let motion = [stretch, rate, dashpots];
        let port = [charge, current, field];
        let all = motion.into_iter().chain(port).chain([energy, balance]);
        crate::largest::largest(all)
    }
}

/// Relative errors below 1e-9 at the tolerance that a host gets without asking for one, whether
/// the communication steps are long or short, and whether energies are summed up or not.
#[test]
fn scenes_are_met_to_nine_digits() {
    for name in [
        "A_si_dc_step",
        "B_rc_step",
        "D_kv_step",
        "F_sls_creep_vhb",
        "H_ac_damped",
        "I_charge_step",
        "K_force_step_stack",
        "L_permittivity_step",
        "N_yeoh_step",
        "G2_gent_sylgard",
    ] {
        for (step, records) in [(f64::INFINITY, false), (f64::INFINITY, true), (7.3, true)] {
            let errors = errors(name, 1e-10, step, records);
            assert!(
                errors.largest() < 1e-9,
                "{name}, steps of {step}: {errors:?}"
            );
        }
    }
}

/// The motion turns where 1 − I/J = 6e-7: half an ulp of the stretch would move the energy there
/// by 1e-8. On the orbit one bounce counts; summed up, all twelve do.
#[test]
fn a_snap_that_almost_locks_is_met_to_its_floor() {
    let orbit = errors("G_gent_snap", 1e-10, f64::INFINITY, false);
    assert!(orbit.largest() < 1e-9, "{orbit:?}");
    let summed = errors("G_gent_snap", 1e-12, f64::INFINITY, true);
    assert!(summed.largest() < 6e-9, "{summed:?}");
}

/// At a tight tolerance what is left is rounding.
#[test]
fn errors_follow_the_tolerance() {
    for name in [
        "A_si_dc_step",
        "B_rc_step",
        "D_kv_step",
        "H_ac_damped",
        "N_yeoh_step",
    ] {
        let errors = errors(name, 1e-13, 7.3, true);
        assert!(errors.largest() < 2e-12, "{name}: {errors:?}");
    }
}

/// Scenes that an independent program in 80-bit arithmetic follows (`derive_scenes.py`): stiff
/// electrodes, dashpots, an imposed current, overdamping, ramps, and everything at once.
#[test]
fn scenes_of_another_integrator_are_met() {
    for name in [
        "own_stiff_rc",
        "own_linear_damping",
        "own_current",
        "own_overdamped",
        "own_ramp",
        "own_everything",
        "own_yeoh_gravity",
    ] {
        for step in [f64::INFINITY, 31.0] {
            let errors = errors(name, 1e-10, step, true);
            assert!(
                errors.largest() < 1e-9,
                "{name}, steps of {step}: {errors:?}"
            );
            assert!(
                errors.balance < 1e-10,
                "{name}, steps of {step}: {errors:?}"
            );
        }
    }
}
