//! What is read between a change and the next step is that of the present.

use super::host::Host;
use super::motion::{gain, stored};

/// Current and charge behind a resistance.
#[test]
fn currents_and_charges_follow_a_change_at_once() {
    let mut host = Host::begun(&[("R_s", 1e6), ("G_p", 1e-9)]);
    host.step(1e-7);
    let law = |host: &Host, resistance: f64| {
        let [supply, membrane, current] =
            ["supply_voltage", "membrane_voltage", "supply_current"].map(|name| host.get(name));
        let exact = (supply - membrane) / resistance;
        assert!(
            (current / exact - 1.0).abs() < 1e-9,
            "{current} A for {exact} A"
        );
        assert!((host.get("electrical_power") / (supply * exact) - 1.0).abs() < 1e-9);
        current
    };
    let before = law(&host, 1e6);
    host.set("force", 1e-6).expect("a force");
    assert_eq!(law(&host, 1e6), before);
    host.set("voltage", 300.0).expect("a voltage");
    assert!(law(&host, 1e6) < 0.0);
    host.set("R_s", 2e6).expect("a resistance");
    law(&host, 2e6);
    host.set("G_p", 1e-7).expect("a conductance");
    law(&host, 2e6);
    host.step(1e-9);
    law(&host, 2e6);
    // An ideal source has charged the membrane; the resistance that is switched on finds it so.
    let mut host = Host::begun(&[]);
    host.step(1e-6);
    let before = ["charge", "membrane_voltage"].map(|name| host.get(name));
    host.set("R_s", 1e6).expect("a resistance");
    let after = ["charge", "membrane_voltage"].map(|name| host.get(name));
    for (before, after) in before.iter().zip(after) {
        assert!((after / before - 1.0).abs() < 1e-14, "{before} to {after}");
    }
    assert!(host.get("supply_current").abs() < 1e-12);
}

/// The balance of energy, where an ideal source is stepped, with and without a parameter that changes at the same time,
/// and where it comes back in the place of a resistance: at once and after the next step.
#[test]
fn energies_exchanged_follow_a_change_at_once() {
    let mut host = Host::begun(&[("record_energy", 1.0), ("R_s", 0.0)]);
    host.step(1e-6);
    let residual = |host: &Host| stored(host) - gain(host);
    let (begin, size) = (residual(&host), stored(&host));
    for change in [
        vec![("voltage", 300.0)],
        vec![("voltage", 500.0), ("eta", 0.01)],
        vec![("R_s", 1e6)],
        vec![("voltage", 200.0)],
        vec![("R_s", 0.0)],
    ] {
        for (name, value) in &change {
            host.set(name, *value).expect(name);
        }
        assert!((residual(&host) - begin).abs() < 1e-12 * size, "{change:?}");
        host.step(3e-7);
        let error = (residual(&host) - begin).abs() / size;
        assert!(error < 1e-10, "{change:?}: {error:e}");
    }
}
