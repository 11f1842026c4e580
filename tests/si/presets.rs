//! The materials beside the FMU: each file sets variables of the table, and its device moves.

use crate::host::Host;
use std::fs;

/// Names and values of a file in the format of SSP for parameter values.
fn values(text: &str) -> Vec<(&str, f64)> {
    let after = |text: &'_ str, mark: &str| text.find(mark).map(|at| at + mark.len());
    let parameters = text.split("<ssv:Parameter ").skip(1);
    let values = parameters.map(|part| {
        let name = &part[after(part, "name=\"").expect("a name")..];
        let value = &part[after(part, "<ssv:Real value=\"").expect("a value")..];
        let end = |text: &str| text.find('"').expect("a quote");
        let number = value[..end(value)].parse().expect("a number");
        (&name[..end(name)], number)
    });
    values.collect()
}

/// Five periods from rest, with energies: the stretch swings out and stays below pull-in, the
/// field below breakdown, and energy is balanced.
#[test]
fn every_material_moves() {
    let folder = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/fmus/DielectricElastomerActuatorSI/presets"
    );
    let mut count = 0;
    for entry in fs::read_dir(folder).expect("the presets") {
        let path = entry.expect("an entry").path();
        let text = fs::read_to_string(&path).expect("a text");
        let name = path.file_stem().expect("a name").to_string_lossy();
        assert!(
            text.contains("Source: ") && text.contains("Not verified: "),
            "{name}"
        );
        assert!(text.contains(&format!("name=\"{name}\"")), "{name}");
        let mut given = values(&text);
        assert!(given.len() > 10, "{name}: {given:?}");
        given.extend([("record_energy", 1.0), ("record_extremes", 1.0)]);
        let mut host = Host::begun(&given);
        let period = 1.0 / host.get("frequency");
        host.follow(5.0 * period, 0.02 * period);
        assert!(host.get("lambda_highest") > 1.005, "{name}");
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
        count += 1;
    }
    assert_eq!(count, 6);
}
