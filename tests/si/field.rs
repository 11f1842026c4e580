//! What follows from the field: the leak and breakdown.

use super::host::Host;

/// A film without surface effects and without a constant voltage.
const BARE: [(&str, f64); 5] = [
    ("rho", 1000.0),
    ("gamma_s", 0.0),
    ("tau_s", 0.0),
    ("E_s", 0.0),
    ("voltage", 0.0),
];

/// A leak that grows with the field bends where the voltage changes its sign: the steps see it.
#[test]
fn an_exponential_leak_through_0_keeps_the_tolerance() {
    let period = 0.34076e-3;
    let leaky = [
        ("H", 20e-6),
        ("L", 6e-3),
        ("mu", 170e3),
        ("n_layers", 1.0),
        ("eps_r", 4.0),
        ("V_ac", 800.0),
        ("f_ac", 3825.0),
        ("R_s", 2.25e6),
        ("sigma", 7.6e-10),
        ("E_conduction", 1.45e7),
    ];
    let settings = [&BARE[..], &leaky].concat();
    let mut exact = Host::begun_with(1e-13, &settings);
    let mut hosts =
        [1e-8, 1e-10].map(|tolerance| (tolerance, Host::begun_with(tolerance, &settings)));
    let mut largest = 0.0_f64;
    for _ in 0..200 {
        // Steps whose ends do not fall together.
        for _ in 0..7 {
            exact.step(period / 140.0);
        }
        let charge = exact.get("charge");
        largest = largest.max(charge.abs());
        for (tolerance, host) in &mut hosts {
            host.step(period / 20.0);
            let error = (host.get("charge") - charge).abs() / largest;
            assert!(error < 20.0 * *tolerance, "{tolerance:e}: {error:e}");
        }
    }
}

/// The field is largest a moment after the start, between the first two points at which a step is looked at.
#[test]
fn a_breakdown_at_the_begin_of_a_step_is_not_missed() {
    let damped = [
        ("H", 50e-6),
        ("L", 20e-3),
        ("mu", 300e3),
        ("eps_r", 3.0),
        ("V_ac", 1500.0),
        ("eta", 30.0),
        ("force", -0.1),
    ];
    for (frequency, lead) in [(1e3, 0.01), (3e3, 0.03), (6e3, 0.05), (14e3, 0.05)] {
        let driven = [
            ("f_ac", frequency),
            ("phase_ac", std::f64::consts::FRAC_PI_2 - lead),
        ];
        let mut settings = [&BARE[..], &damped, &driven].concat();
        let peak = lead / std::f64::consts::TAU / frequency;
        let mut host = Host::begun(&settings);
        let before = host.get("electric_field");
        host.step(peak);
        let field = host.get("electric_field");
        settings.push(("E_breakdown", 0.5 * (field + before)));
        let mut host = Host::begun(&settings);
        host.step(10.0 / frequency);
        let time = host.get("breakdown_time");
        assert!(time < peak, "{frequency}: {time:e} {peak:e}");
    }
}
