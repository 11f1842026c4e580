//! Derivatives of outputs with respect to time, and directional derivatives.

use super::*;

/// A point away from all symmetries: what the tests below set.
const SETTINGS: [(&str, f64); 9] = [
    ("phi", 0.35),
    ("S", 0.4),
    ("c", 7.0),
    ("gamma_s", 0.05),
    ("tau_s", 0.03),
    ("E_s", 0.2),
    ("phi_ac", 0.25),
    ("omega_ac", 0.8),
    ("phase_ac", 0.6),
];

fn directional(host: &Host, unknown: &str, known: &[&str], changes: &[f64]) -> f64 {
    let knowns: Vec<u32> = known.iter().map(|name| reference(name)).collect();
    let mut value = f64::NAN;
    let status = unsafe {
        fmi2GetDirectionalDerivative(
            host.component,
            &reference(unknown),
            1,
            knowns.as_ptr(),
            knowns.len(),
            changes.as_ptr(),
            &mut value,
        )
    };
    assert_eq!(status, OK, "{}", host.last_line());
    value
}

/// An instance at this time in the phase "initialization" or "stepping".
fn started(time: f64, phase: &str) -> Host {
    let host = Host::new();
    unsafe {
        assert_eq!(
            fmi2SetupExperiment(host.component, 0, 0.0, time, 0, 0.0),
            OK
        );
        assert_eq!(fmi2EnterInitializationMode(host.component), OK);
    }
    for (name, value) in SETTINGS {
        assert_eq!(host.set(name, value), OK);
    }
    assert_eq!(host.set("lambda_start", 1.2), OK);
    assert_eq!(host.set("lambda_dot_start", 0.15), OK);
    if phase != "initialization" {
        assert_eq!(unsafe { fmi2ExitInitializationMode(host.component) }, OK);
    }
    host
}

/// Against the derivatives of Eq. 16 by hand.
#[test]
fn directional_derivatives_are_those_of_the_equation() {
    let host = started(0.0, "stepping");
    assert_eq!(host.step(0.0, 3.3), OK);
    let (x, v, a) = (
        host.get("lambda"),
        host.get("lambda_dot"),
        host.get("lambda_ddot"),
    );
    let [_, _, c, gamma, tau, elasticity, amplitude, omega, phase] =
        SETTINGS.map(|(_, value)| value);
    let (voltage, (sine, cosine)) = (host.get("phi_total"), (omega * 3.3 + phase).sin_cos());
    let mass = c + 2.0 * x.powi(-6);
    let by_voltage = 2.0 * voltage * x.powi(3) / mass;
    let surface = gamma
        + tau * (6.0 * x * x - 1.0)
        + 0.5 * elasticity * (15.0 * x.powi(4) - 12.0 * x * x + 1.0);
    let by_stretch = (12.0 * a * x.powi(-7) - 42.0 * v * v * x.powi(-8) - 1.0 - 5.0 * x.powi(-6)
        + 3.0 * voltage * voltage * x * x
        - 2.0 * surface)
        / mass;
    let expected = [
        ("lambda_ddot", "S", 1.0 / mass),
        ("lambda_ddot", "phi", by_voltage),
        ("lambda_ddot", "c", -a / mass),
        ("lambda_ddot", "gamma_s", -2.0 * x / mass),
        ("lambda_ddot", "tau_s", -2.0 * (2.0 * x.powi(3) - x) / mass),
        (
            "lambda_ddot",
            "E_s",
            -x * (x * x - 1.0) * (3.0 * x * x - 1.0) / mass,
        ),
        ("lambda_ddot", "phi_ac", by_voltage * sine),
        // The phase runs on: what follows changes, the present does not.
        ("lambda_ddot", "omega_ac", 0.0),
        ("lambda_ddot", "phase_ac", by_voltage * amplitude * cosine),
        ("lambda_ddot", "lambda_dot", 12.0 * v * x.powi(-7) / mass),
        ("lambda_ddot", "lambda", by_stretch),
        ("lambda_ddot", "lambda_start", 0.0),
        ("lambda_ddot", "lambda_max", 0.0),
        ("lambda_dot", "lambda_dot", 1.0),
        ("lambda_dot", "lambda", 0.0),
        ("lambda", "lambda", 1.0),
        ("lambda", "phi", 0.0),
        ("lambda3", "lambda", -2.0 * x.powi(-3)),
        ("lambda3_dot", "lambda", 6.0 * v * x.powi(-4)),
        ("lambda3_dot", "lambda_dot", -2.0 * x.powi(-3)),
        ("phi_total", "phi", 1.0),
        ("electric_field", "phi_ac", sine * x * x),
        ("electric_field", "lambda", 2.0 * voltage * x),
    ];
    for (unknown, known, value) in expected {
        let found = directional(&host, unknown, &[known], &[1.0]);
        let allowed = 1e-14 * value.abs().max(0.1);
        assert!(
            (found - value).abs() <= allowed,
            "{unknown} by {known}: {found}, not {value}"
        );
        // Exact in small changes too, and nothing else but their multiple.
        let small = directional(&host, unknown, &[known], &[1e-200]);
        assert!((small - value * 1e-200).abs() <= allowed * 1e-200);
    }
    let together = directional(
        &host,
        "lambda_ddot",
        &["S", "lambda", "S"],
        &[2.0, -3.0, 0.5],
    );
    assert!((together - (2.5 / mass - 3.0 * by_stretch)).abs() < 1e-14);
}

#[test]
fn during_initialization_start_values_are_known_and_states_are_not() {
    let host = started(0.0, "initialization");
    assert_eq!(directional(&host, "lambda", &["lambda_start"], &[1.0]), 1.0);
    let by_start = directional(&host, "lambda3", &["lambda_start"], &[1.0]);
    assert!((by_start + 2.0 / 1.2_f64.powi(3)).abs() < 1e-15);
    assert_eq!(
        directional(&host, "lambda_dot", &["lambda_dot_start"], &[1.0]),
        1.0
    );
    let mut value = 7.0;
    let refused = |unknown: &str, known: &str, change: f64, value: &mut f64| unsafe {
        let (unknown, known) = (reference(unknown), reference(known));
        fmi2GetDirectionalDerivative(host.component, &unknown, 1, &known, 1, &change, value)
    };
    for (unknown, known, change, message) in [
        (
            "lambda",
            "lambda",
            1.0,
            "derivatives with respect to lambda are not offered",
        ),
        (
            "lambda",
            "on_pull_in",
            1.0,
            "derivatives with respect to on_pull_in are not offered",
        ),
        (
            "lambda",
            "phi_total",
            1.0,
            "derivatives with respect to phi_total are not offered",
        ),
        (
            "pull_in_margin",
            "phi",
            1.0,
            "pull_in_margin has no directional derivative",
        ),
        ("lambda", "phi", f64::NAN, "the derivative NaN of phi"),
    ] {
        assert_eq!(
            refused(unknown, known, change, &mut value),
            ERROR,
            "{unknown} by {known}"
        );
        assert!(host.last_line().contains(message), "{}", host.last_line());
    }
    assert_eq!(value, 7.0);
    // Before the start the phase at t = 0 is what stays.
    let late = started(1.5, "initialization");
    let expected = 0.25 * 1.5 * (0.8_f64 * 1.5 + 0.6).cos();
    let slope = directional(&late, "phi_total", &["omega_ac"], &[1.0]);
    assert!((slope - expected).abs() < 1e-15);
}

/// A host that linearizes asks for those of every output.
#[test]
fn what_changes_at_events_only_has_derivatives_of_zero() {
    let host = started(0.0, "stepping");
    for unknown in ["collapsed", "pulled_in"] {
        for known in ["phi", "lambda", "c"] {
            assert_eq!(directional(&host, unknown, &[known], &[1.0]), 0.0);
        }
    }
    assert_eq!(host.step(0.0, 0.5), OK);
    for order in 1..=5 {
        assert_eq!(output_derivative(&host, "collapsed", order), 0.0);
    }
}

/// The declared dependencies are those that there are, no more and no fewer.
#[test]
fn dependencies_are_those_declared() {
    use dielectric_elastomer_actuator::model::variables::Access;
    for (phase, state_is_known) in [("initialization", false), ("stepping", true)] {
        let host = started(1.5, phase);
        for unknown in &VARIABLES {
            let Access::Result {
                derivatives: Some(_),
                dependencies,
                ..
            } = unknown.access
            else {
                continue;
            };
            let declared = if state_is_known {
                dependencies.now
            } else {
                dependencies.at_start
            };
            for (place, known) in VARIABLES.iter().enumerate() {
                let input = matches!(known.access, Access::Input { .. });
                let state = Nondimensional::STATES.contains(&(place as u32));
                let real = known.start.is_some()
                    && known.name != "on_pull_in"
                    && known.name != "record_extremes";
                let is_known = if state_is_known { input || state } else { real };
                if is_known {
                    let slope = directional(&host, unknown.name, &[known.name], &[1.0]);
                    let depends = declared.contains(&known.name);
                    assert_eq!(
                        slope != 0.0,
                        depends,
                        "{} by {}: {slope}",
                        unknown.name,
                        known.name
                    );
                }
            }
        }
    }
}

fn output_derivative(host: &Host, name: &str, order: i32) -> f64 {
    let mut value = f64::NAN;
    let status = unsafe {
        fmi2GetRealOutputDerivatives(host.component, &reference(name), 1, &order, &mut value)
    };
    assert_eq!(status, OK, "{}", host.last_line());
    value
}

/// The Taylor polynomial of order 5 leaves an error of order 6, with the built-in
/// voltage and a voltage that is a polynomial.
#[test]
fn output_derivatives_are_those_of_the_motion_to_come() {
    let error = |output: &str, step: f64| {
        let host = started(0.0, "stepping");
        assert_eq!(host.step(0.0, 2.0), OK);
        let (orders, values) = ([1, 2, 3], [0.1, -0.2, 0.15]);
        unsafe {
            let (c, phi) = (host.component, [0; 3]);
            fmi2SetRealInputDerivatives(c, phi.as_ptr(), 3, orders.as_ptr(), values.as_ptr());
        }
        assert_eq!(
            output_derivative(&host, "lambda", 1),
            host.get("lambda_dot")
        );
        let curvature = output_derivative(&host, "lambda", 2);
        assert!((curvature - host.get("lambda_ddot")).abs() < 1e-15);
        let slope = output_derivative(&host, "lambda3", 1);
        assert!((slope - host.get("lambda3_dot")).abs() < 1e-15);
        let (mut taylor, mut power) = (host.get(output), 1.0);
        for order in 1..=5 {
            power *= step / f64::from(order);
            taylor += power * output_derivative(&host, output, order);
        }
        assert_eq!(host.step(2.0, step), OK);
        (host.get(output) - taylor).abs()
    };
    for output in ["lambda", "lambda3"] {
        let [coarse, fine] = [0.4, 0.2].map(|step| error(output, step));
        let order = (coarse / fine).log2();
        assert!(
            (order - 6.0).abs() < 0.4,
            "{output}: {coarse} and {fine}, order {order}"
        );
        assert!(fine < 1e-6, "{output}: {fine}");
    }
}

#[test]
fn output_derivatives_of_a_held_actuator_vanish_and_bad_ones_are_refused() {
    let host = Host::in_phase("stepping");
    assert_eq!(host.set("phi", 0.7), OK);
    assert_eq!(host.step(0.0, 60.0), OK);
    for order in 1..=5 {
        assert_eq!(output_derivative(&host, "lambda", order), 0.0);
        assert_eq!(output_derivative(&host, "lambda3", order), 0.0);
    }
    assert_eq!(directional(&host, "lambda", &["lambda_max"], &[1.0]), 1.0);
    let mut value = 7.0;
    for (name, order, message) in [
        ("lambda", 0, "no derivative of lambda of order 0"),
        ("lambda", 6, "orders 1 to 5"),
        ("lambda_dot", 1, "lambda_dot is not a real output"),
        ("pulled_in", 1, "pulled_in is not a real output"),
    ] {
        let c = host.component;
        let status =
            unsafe { fmi2GetRealOutputDerivatives(c, &reference(name), 1, &order, &mut value) };
        assert_eq!(status, ERROR);
        assert!(host.last_line().contains(message), "{}", host.last_line());
    }
    assert_eq!(value, 7.0);
}
