//! The presets in SI units: each sets variables of the table, and its device moves.

use super::host::Host;
use serde_json::Value;
use std::fs;

/// Five periods from rest, with energies: the stretch swings out, a material stays below pull-in and its
/// field below breakdown, and energy is balanced.
#[test]
fn every_preset_moves() {
    let folder = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/python/dielectric_actuator/presets"
    );
    let mut materials = 0;
    for entry in fs::read_dir(folder).expect("the presets") {
        let path = entry.expect("an entry").path();
        let preset: Value =
            serde_json::from_str(&fs::read_to_string(&path).expect("a text")).expect("JSON");
        let name = path.file_stem().expect("a name").to_string_lossy();
        if preset["model"] != "si" {
            continue;
        }
        let given = preset["start_values"].as_object().expect("start values");
        let mut given: Vec<(&str, f64)> = given
            .iter()
            .map(|(name, value)| (name.as_str(), value.as_f64().expect("a number")))
            .collect();
        given.extend([("record_energy", 1.0), ("record_extremes", 1.0)]);
        let mut host = Host::begun(&given);
        let period = 1.0 / host.get("frequency");
        let end = (5.0 * period).min(preset["stop_time"].as_f64().expect("a number"));
        host.follow(end, 0.02 * period);
        assert!(host.get("lambda_highest") > 1.005, "{name}");
        if preset["source"].is_null() {
            continue;
        }
        materials += 1;
        let unsure = preset["not_verified"]
            .as_str()
            .expect("what is not verified");
        assert!(!unsure.is_empty(), "{name}");
        assert_eq!(host.get("pulled_in"), 0.0, "{name}");
        assert_eq!(host.get("broken_down"), 0.0, "{name}");
        assert!(host.get("pull_in_margin") > 0.0, "{name}");
        let sum = |names: &[&str]| names.iter().map(|name| host.get(name)).sum::<f64>();
        let stored = sum(&[
            "energy_kinetic",
            "energy_elastic",
            "energy_surface",
            "energy_branches",
            "energy_electric",
        ]);
        let lost = sum(&["lost_branches", "lost_resistance"]);
        let residual = stored + lost - host.get("supplied_electrical");
        assert!(
            residual.abs() < 1e-10 * stored,
            "{name}: {residual:e} of {stored:e}"
        );
    }
    assert_eq!(materials, 7);
}
