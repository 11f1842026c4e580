//! The built-in alternating voltage.

use super::host::Host;
use dielectric_elastomer_actuator::instance::Interface;

/// A built-in voltage of frequency 0 adds its sine, in steps of all kinds.
#[test]
fn a_drive_of_0_hertz_adds_its_sine() {
    let branch = [("mu_1", 1e5), ("tau_1", 1e-5)];
    for (parts, energy) in [(0, 0.0), (0, 1.0), (2, 0.0), (2, 1.0)] {
        let common = [&branch[..parts], &[("record_energy", energy)]].concat();
        let driven = [
            ("voltage", 300.0),
            ("V_ac", 400.0),
            ("f_ac", 0.0),
            ("phase_ac", 1.0),
        ];
        let plain = [("voltage", 300.0 + 400.0 * 1.0_f64.sin())];
        let [driven, plain] = [&driven[..], &plain[..]].map(|values| {
            let mut host = Host::begun(&[&common, values].concat());
            host.follow(30e-6, 30e-6);
            host.get("lambda")
        });
        assert!(
            (driven - plain).abs() < 1e-8,
            "{parts} {energy}: {driven} {plain}"
        );
    }
}

/// A start at a whole number of periods is a start at 0, however late, to a tenth of the tolerance; and no change of the
/// frequency makes the voltage jump.
#[test]
fn a_late_drive_keeps_its_phase() {
    let frequency = 131_072.0; // 2¹⁷ Hz, which many times divide into whole periods
    let settings = [("voltage", 0.0), ("V_ac", 600.0), ("f_ac", frequency)];
    for start in [1.0, 1024.0, 1_048_576.0] {
        let begun = |time: f64| {
            let mut host = Host::initializing(Interface::CoSimulation, &settings);
            host.instance
                .setup_experiment(None, time, None)
                .expect("an experiment");
            host.instance.exit_initialization().expect("a start");
            host.time = time;
            host
        };
        let (mut late, mut early) = (begun(start), begun(0.0));
        // Times that a double holds at both starts.
        let step = 3.0 / 1_048_576.0;
        for k in 0..40 {
            for host in [&mut late, &mut early] {
                host.set("f_ac", frequency * (1.0 + 0.1 * f64::from(k % 3)))
                    .expect("legal");
                let before = host.get("supply_voltage");
                host.set("f_ac", frequency).expect("legal");
                assert!((host.get("supply_voltage") - before).abs() < 1e-11 * 600.0);
                host.step(step);
            }
            let [ours, theirs] = [&late, &early].map(|host| host.get("lambda"));
            assert!((ours - theirs).abs() < 1e-11, "{start}: {ours} {theirs}");
        }
    }
}
