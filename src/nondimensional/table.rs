//! The variables of the nondimensional actuator.

use super::Nondimensional;
use crate::arithmetic::double_double::DoubleDouble;
use crate::arithmetic::number::Number;
use crate::model::AtLimit;
use crate::model::variables::rows::{
    ON_PULL_IN, UNDECLARED, depends, extremes, formula, positive, real, unlimited, value,
};
use crate::model::variables::{
    Alias, Causality, Derivatives, Kind, Variability, Variable, checked, units,
};
use crate::nondimensional::view::Quantities;

use Causality::{Local, Output};
use Variability::{Fixed, Tunable};

type Row = Variable<Nondimensional>;

const EXTREMES: [Row; 4] = extremes();

const VOLTS: &str = "it is nondimensional: volts*sqrt(eps/mu)/H";
const FORCE: &str = "it is nondimensional: force/(mu*H*L)";
const SURFACE: &str = "it is nondimensional: newtons per metre over mu*H";
const FREQUENCY: &str = "it is nondimensional: radians per second*H*sqrt(rho/(12*mu))";
const RATE: &str = "it is nondimensional: rate per second*H*sqrt(rho/(12*mu))";

/// What changes at events only.
const AT_EVENTS: Option<Derivatives<Nondimensional>> = Some(Derivatives {
    along: |sample| sample.stretch().same(0.0),
    from_now_on: |sample| sample.stretch().same(0.0),
});

/// All variables, in the order of their value references.
pub static VARIABLES: [Row; COUNT] = checked([
    Row::input(
        "phi",
        "nondimensional voltage, phi*sqrt(eps/mu)/H",
        real(-10.0, 10.0, 1.0),
        |view| view.voltage(),
        |scene| &mut scene.drive.voltage,
    )
    .converted(VOLTS),
    Row::input(
        "S",
        "nondimensional prestress, P/(mu*H*L)",
        real(-100.0, 100.0, 1.0),
        |view| view.prestress(),
        |scene| &mut scene.drive.prestress,
    )
    .converted(FORCE),
    Row::parameter(
        "c",
        "squared ratio of side to thickness, L^2/H^2",
        Tunable,
        real(1e-3, 1e12, 100.0),
        100.0,
        |scene| scene.parameters.aspect,
        |scene, value| scene.parameters.aspect = value,
    )
    .converted("it is a ratio of squares: L^2/H^2"),
    Row::parameter(
        "gamma_s",
        "surface energy density over mu*H",
        Tunable,
        real(0.0, 100.0, 0.1),
        0.0,
        |scene| scene.parameters.surface_energy,
        |scene, value| scene.parameters.surface_energy = value,
    )
    .converted(SURFACE),
    Row::parameter(
        "tau_s",
        "surface tension over mu*H",
        Tunable,
        real(0.0, 100.0, 0.1),
        0.0,
        |scene| scene.parameters.surface_tension,
        |scene, value| scene.parameters.surface_tension = value,
    )
    .converted(SURFACE),
    Row::parameter(
        "E_s",
        "surface elasticity over mu*H",
        Tunable,
        real(0.0, 100.0, 0.1),
        0.0,
        |scene| scene.parameters.surface_elasticity,
        |scene, value| scene.parameters.surface_elasticity = value,
    )
    .converted(SURFACE),
    Row::parameter(
        "lambda_start",
        "stretch at the start time",
        Fixed,
        real(1e-3, 1e6, 1.0),
        1.0,
        |scene| scene.start.position,
        |scene, value| scene.start.position = value,
    ),
    Row::parameter(
        "lambda_dot_start",
        "stretch rate at the start time",
        Fixed,
        real(-1e3, 1e3, 0.1),
        0.0,
        |scene| scene.start.rate,
        |scene, value| scene.start.rate = value,
    )
    .converted(RATE),
    Row::parameter(
        "phi_ac",
        "amplitude of the built-in voltage phi_ac*sin(omega_ac*t + phase_ac), added to phi",
        Tunable,
        real(-10.0, 10.0, 1.0),
        0.0,
        |scene| scene.drive.harmonic.amplitude,
        |scene, value| scene.drive.harmonic.amplitude = value,
    )
    .converted(VOLTS),
    Row::parameter(
        "omega_ac",
        "angular frequency of the built-in voltage, radians per unit of time; changed on the way, the phase runs on from where it is",
        Tunable,
        real(0.0, 1e3, 0.1),
        0.0,
        |scene| scene.drive.harmonic.frequency,
        |scene, value| scene.drive.harmonic.frequency = value,
    )
    .from_now_on(|scene, value| scene.drive.retune(DoubleDouble::new(value)))
    .converted(FREQUENCY)
    .in_unit(&units::ANGULAR_FREQUENCY),
    Row::parameter(
        "phase_ac",
        "phase of the built-in voltage, radians: at t = 0, as long as omega_ac is not changed on the way",
        Tunable,
        real(-10.0, 10.0, 1.0),
        0.0,
        |scene| scene.drive.harmonic.phase,
        |scene, value| scene.drive.harmonic.phase = value,
    )
    .converted("it is in radians: degrees*pi/180")
    .in_unit(&units::ANGLE),
    Row::parameter(
        "lambda_min",
        "stretch at which the contracting actuator has collapsed",
        Fixed,
        real(1e-3, 0.9, 0.1),
        0.05,
        |scene| scene.limits.lower,
        |scene, value| scene.limits.lower = value,
    ),
    Row::parameter(
        "lambda_max",
        "stretch at which the expanding actuator has been pulled in",
        Fixed,
        real(1.1, 1e6, 10.0),
        10.0,
        |scene| scene.limits.upper,
        |scene, value| scene.limits.upper = value,
    ),
    Row::parameter(
        "on_pull_in",
        "what happens at lambda_min or lambda_max",
        Fixed,
        Kind::Enumeration(&ON_PULL_IN),
        1.0,
        |scene| scene.on_pull_in.item(),
        |scene, value| scene.on_pull_in = AtLimit::of_item(value),
    ),
    Row::result(
        "lambda",
        "in-plane stretch",
        Output,
        real(1e-3, 1e6, 1.0),
        formula!(stretch),
        depends(&["lambda"], &["lambda_start"]),
    ),
    Row::result(
        "lambda3",
        "thickness stretch, 1/lambda^2",
        Output,
        real(1e-12, 1e6, 1.0),
        formula!(thickness_stretch),
        depends(&["lambda"], &["lambda_start"]),
    ),
    Row::result(
        "pulled_in",
        "whether the stretch has reached lambda_min or lambda_max; the output collapsed is the same as a number",
        Local,
        Kind::Boolean,
        (
            |view| f64::from(u8::from(view.collapse.is_some())),
            AT_EVENTS,
        ),
        depends(&[], &[]),
    ),
    Row::result(
        "lambda_dot",
        "rate of lambda",
        Local,
        unlimited(0.1),
        formula!(stretch_rate),
        depends(&["lambda_dot"], &["lambda_dot_start"]),
    )
    .derivative_of("lambda"),
    Row::result(
        "lambda3_dot",
        "rate of lambda3",
        Local,
        unlimited(0.1),
        formula!(thickness_stretch_rate),
        depends(
            &["lambda", "lambda_dot"],
            &["lambda_start", "lambda_dot_start"],
        ),
    ),
    Row::result(
        "lambda_ddot",
        "second derivative of lambda by the equation of motion",
        Local,
        unlimited(0.01),
        formula!(stretch_acceleration),
        depends(
            &["phi", "S", "lambda", "lambda_dot"],
            &[
                "phi",
                "S",
                "c",
                "gamma_s",
                "tau_s",
                "E_s",
                "lambda_start",
                "lambda_dot_start",
                "phi_ac",
                "omega_ac",
                "phase_ac",
            ],
        ),
    )
    .derivative_of("lambda_dot"),
    Row::result(
        "phi_total",
        "phi with the built-in voltage added",
        Local,
        real(-20.0, 20.0, 1.0),
        formula!(total_voltage),
        depends(&["phi"], &["phi", "phi_ac", "omega_ac", "phase_ac"]),
    ),
    Row::result(
        "electric_field",
        "true electric field, phi_total*lambda^2",
        Local,
        real(-2e13, 2e13, 1.0),
        formula!(electric_field),
        depends(
            &["phi", "lambda"],
            &["phi", "lambda_start", "phi_ac", "omega_ac", "phase_ac"],
        ),
    ),
    Row::result(
        "hamiltonian",
        "Hamiltonian, constant while phi and S are; 0 at rest at lambda = 1",
        Local,
        unlimited(1.0),
        value(|view| view.energy()),
        UNDECLARED,
    ),
    Row::result(
        "phi_pull_in",
        "dynamic pull-in voltage from rest at lambda = 1 for the present S; +inf, which JSON cannot hold, where there is none",
        Local,
        positive(1.0),
        value(|view| {
            view.dynamic_threshold()
                .map_or(f64::INFINITY, |t| t.voltage)
        }),
        UNDECLARED,
    )
    .or_infinite(),
    Row::result(
        "lambda3_pull_in",
        "thickness stretch at the dynamic pull-in voltage; 0 where there is none",
        Local,
        real(0.0, 1e6, 1.0),
        value(|view| {
            view.dynamic_threshold()
                .map_or(0.0, |t| t.thickness_stretch)
        }),
        UNDECLARED,
    ),
    Row::result(
        "phi_pull_in_static",
        "static pull-in voltage for the present S; +inf, which JSON cannot hold, where there is none",
        Local,
        positive(1.0),
        value(|view| view.static_threshold().map_or(f64::INFINITY, |t| t.voltage)),
        UNDECLARED,
    )
    .or_infinite(),
    Row::result(
        "lambda3_pull_in_static",
        "thickness stretch at the static pull-in voltage; 0 where there is none",
        Local,
        real(0.0, 1e6, 1.0),
        value(|view| view.static_threshold().map_or(0.0, |t| t.thickness_stretch)),
        UNDECLARED,
    ),
    Row::result(
        "pull_in_margin",
        "by how much the voltage may grow until dynamic pull-in; negative beyond, +inf, which JSON cannot hold, where there is none",
        Local,
        unlimited(1.0),
        value(|view| view.pull_in_margin()),
        UNDECLARED,
    )
    .or_infinite(),
    Row::result(
        "pull_in_time",
        "time at which pulled_in became true; +inf, which JSON cannot hold, until then",
        Local,
        unlimited(1.0),
        value(|view| view.collapse.map_or(f64::INFINITY, |c| c.time.value())),
        UNDECLARED,
    )
    .or_infinite(),
    Row::parameter(
        "record_extremes",
        "whether the extremes of lambda and lambda3 are recorded",
        Fixed,
        Kind::Boolean,
        0.0,
        |scene| f64::from(u8::from(scene.record_extremes)),
        |scene, value| scene.record_extremes = value != 0.0,
    ),
    EXTREMES[0],
    EXTREMES[1],
    EXTREMES[2],
    EXTREMES[3],
    Row::result(
        "collapsed",
        "pulled_in as a number: 1 once the stretch has reached lambda_min or lambda_max, 0 before",
        Output,
        real(0.0, 1.0, 1.0),
        (
            |view| f64::from(u8::from(view.collapse.is_some())),
            AT_EVENTS,
        ),
        depends(&[], &[]),
    )
    .at_events(),
    Row::parameter(
        "terminate_on_pull_in",
        "on_pull_in for hosts that set numbers only: 0 leaves it to on_pull_in, 1 is terminate",
        Fixed,
        real(0.0, 1.0, 1.0),
        0.0,
        |scene| scene.terminate_on_pull_in,
        |scene, value| scene.terminate_on_pull_in = value,
    ),
    Row::parameter(
        "extremes_window",
        "number of the window over which extremes are recorded: a changed value starts them anew at the present time; not 0, they are recorded whatever record_extremes is",
        Tunable,
        real(0.0, 1e9, 1.0),
        0.0,
        |scene| scene.extremes_window,
        |scene, value| scene.extremes_window = value,
    ),
]);

const COUNT: usize = 37;

/// Further names.
pub static ALIASES: [Alias; 1] = [Alias {
    name: "stretch",
    description: "lambda by a name that is no keyword of Python, for queries and attributes",
    of: "lambda",
}];
