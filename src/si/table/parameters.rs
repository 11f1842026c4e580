//! The parameters: what describes the actuator, its start and what is recorded.

use super::Row;
use crate::actuator::device::Source;
use crate::model::AtLimit;
use crate::model::variables::Variability::{Fixed, Tunable};
use crate::model::variables::rows::{ON_PULL_IN, real};
use crate::model::variables::{Enumeration, Kind, Meant, units};
use crate::si::OnBreakdown;

/// Rows of numbers: name and meaning; when it may be set, its limits and typical size, its start;
/// its unit and what to tell who has typed a value in another one; its place in the scene.
macro_rules! numbers {
    ($($name:ident $about:literal,
        $variability:ident [$min:literal, $max:literal, $nominal:literal] $($meant:ident $(from $smallest:literal)?)?, $start:literal,
        $unit:ident $hint:literal, ($($place:tt)+);)*) => {
        [$(told(
            Row::parameter(
                stringify!($name),
                $about,
                $variability,
                real($min, $max, $nominal),
                $start,
                |scene| scene.$($place)+,
                |scene, value| scene.$($place)+ = value,
            )
            $(.meant(meant!($meant $($smallest)?)))?
            .in_unit(&units::$unit),
            $hint,
        ),)*]
    };
}

/// Which numbers between the limits can be meant: `none from 1e-3` for 0 or more than that, `whole`.
macro_rules! meant {
    (none $smallest:literal) => {
        Meant::NoneOrFrom($smallest)
    };
    (whole) => {
        Meant::Whole
    };
}

const fn told(row: Row, hint: &'static str) -> Row {
    if hint.is_empty() {
        row
    } else {
        row.converted(hint)
    }
}

/// The numbers.
pub(super) const NUMBERS: [Row; 50] = numbers! {
    mu "shear modulus; of a Yeoh material 2*C10",
        Tunable [1e3, 1e9, 1e6], 303e3, PASCAL "0.3 MPa are 0.3e6", (device.shear_modulus);
    rho "density",
        Tunable [200.0, 2e4, 1e3], 1100.0, KILOGRAM_PER_CUBIC_METRE "1.1 g/cm3 are 1100", (device.density);
    eps_r "relative permittivity at lambda = 1",
        Tunable [1.0, 1e4, 1.0], 2.8, ONE "", (device.relative_permittivity);
    H "thickness of a layer before deformation",
        Tunable [1e-8, 5e-3, 1e-5], 10e-6, METRE "10 um are 10e-6", (device.thickness);
    L "side of the sheet before deformation",
        Tunable [1e-6, 1.0, 1e-3], 100e-6, METRE "20 mm are 20e-3", (device.side);
    n_layers "number of layers, mechanically in series across the thickness, electrically in parallel",
        Tunable [1.0, 1e5, 1.0] whole, 1.0, ONE "", (device.layers);
    gamma_s "surface energy density",
        Tunable [0.0, 15.0, 0.1], 0.02, NEWTON_PER_METRE "20 mN/m are 0.02", (device.surface_energy);
    tau_s "surface tension",
        Tunable [0.0, 15.0, 0.1], 0.02, NEWTON_PER_METRE "20 mN/m are 0.02", (device.surface_tension);
    E_s "surface elasticity",
        Tunable [0.0, 100.0, 0.1], 0.126, NEWTON_PER_METRE "", (device.surface_elasticity);
    n_surfaces "number of surfaces that carry surface energy: 2 outer faces, or up to 2 for each layer",
        Tunable [0.0, 2e5, 1.0], 2.0, ONE "", (device.surfaces);
    J_m "limit of the Gent law; 0 for none",
        Tunable [0.0, 1e6, 100.0] none from 1e-3, 0.0, ONE "", (stiffening[0]);
    kappa2 "C20/C10 of the Yeoh law; 0 for none",
        Tunable [-10.0, 10.0, 0.1], 0.0, ONE "", (stiffening[1]);
    kappa3 "C30/C10 of the Yeoh law; 0 for none",
        Tunable [-10.0, 10.0, 0.1], 0.0, ONE "", (stiffening[2]);
    k1 "coefficient of (lambda - 1)^1 of the permittivity over that at lambda = 1",
        Tunable [-10.0, 10.0, 0.1], 0.0, ONE "", (device.permittivity_terms[0]);
    k2 "coefficient of (lambda - 1)^2 of the permittivity over that at lambda = 1",
        Tunable [-10.0, 10.0, 0.1], 0.0, ONE "", (device.permittivity_terms[1]);
    k3 "coefficient of (lambda - 1)^3 of the permittivity over that at lambda = 1",
        Tunable [-10.0, 10.0, 0.1], 0.0, ONE "", (device.permittivity_terms[2]);
    m_load "reduced load mass on opposite edges, in each direction: half of two equal ones; with one edge held, the moved mass and a quarter of the sheet",
        Tunable [0.0, 100.0, 1e-3], 0.0, KILOGRAM "5 g are 5e-3", (device.load_mass);
    k_load "stiffness of a spring between opposite edges, in each direction",
        Tunable [0.0, 1e9, 100.0], 0.0, NEWTON_PER_METRE "0.2 N/mm are 200", (device.load_spring);
    l_load "length at which the spring is relaxed; 0 for L",
        Tunable [0.0, 2.0, 1e-3] none from 1e-7, 0.0, METRE "20 mm are 20e-3", (device.load_spring_length);
    b "dashpot between opposite edges, in each direction",
        Tunable [0.0, 1e6, 1e-2], 0.0, NEWTON_SECOND_PER_METRE "", (device.linear_damping);
    eta "viscosity beside the elastic stress (Kelvin-Voigt); right at one frequency only",
        Tunable [0.0, 1e9, 1.0], 0.0, PASCAL_SECOND "", (device.viscosity);
    mu_1 "modulus of Maxwell branch 1; 0 for none",
        Tunable [0.0, 1e9, 1e5] none from 100.0, 0.0, PASCAL "26 kPa are 26e3", (device.branch_moduli[0]);
    tau_1 "relaxation time of Maxwell branch 1",
        Tunable [1e-9, 1e9, 1.0], 1.0, SECOND "3 ms are 3e-3", (device.branch_times[0]);
    J_1 "limit of the Gent spring of Maxwell branch 1; 0 for a neo-Hookean one",
        Tunable [0.0, 1e6, 100.0] none from 1e-3, 0.0, ONE "", (device.branch_limits[0]);
    mu_2 "modulus of Maxwell branch 2; 0 for none",
        Tunable [0.0, 1e9, 1e5] none from 100.0, 0.0, PASCAL "26 kPa are 26e3", (device.branch_moduli[1]);
    tau_2 "relaxation time of Maxwell branch 2",
        Tunable [1e-9, 1e9, 1.0], 1.0, SECOND "3 ms are 3e-3", (device.branch_times[1]);
    J_2 "limit of the Gent spring of Maxwell branch 2; 0 for a neo-Hookean one",
        Tunable [0.0, 1e6, 100.0] none from 1e-3, 0.0, ONE "", (device.branch_limits[1]);
    mu_3 "modulus of Maxwell branch 3; 0 for none",
        Tunable [0.0, 1e9, 1e5] none from 100.0, 0.0, PASCAL "26 kPa are 26e3", (device.branch_moduli[2]);
    tau_3 "relaxation time of Maxwell branch 3",
        Tunable [1e-9, 1e9, 1.0], 1.0, SECOND "3 ms are 3e-3", (device.branch_times[2]);
    J_3 "limit of the Gent spring of Maxwell branch 3; 0 for a neo-Hookean one",
        Tunable [0.0, 1e6, 100.0] none from 1e-3, 0.0, ONE "", (device.branch_limits[2]);
    R_s "resistance between source and membrane; 0 for an ideal source",
        Tunable [0.0, 1e15, 1e5] none from 1e-3, 0.0, OHM "100 kOhm are 100e3", (device.series_resistance);
    G_p "fixed conductance beside the membrane",
        Tunable [0.0, 1e-2, 1e-9], 0.0, SIEMENS "1 GOhm is 1e-9", (device.parallel_conductance);
    sigma "conductivity of the material at a weak field",
        Tunable [0.0, 1e-2, 1e-12], 0.0, SIEMENS_PER_METRE "", (device.conductivity);
    E_conduction "true field over which the conductivity grows by e; 0 for a constant one",
        Tunable [0.0, 1e12, 1e7] none from 1e4, 0.0, VOLT_PER_METRE "40 V/um are 40e6", (device.conduction_field);
    E_breakdown "true field of breakdown at lambda = 1; 0 for none",
        Tunable [0.0, 1e12, 1e8] none from 1e5, 0.0, VOLT_PER_METRE "80 V/um are 80e6", (device.breakdown_field);
    n_breakdown "exponent of the breakdown field E_breakdown*lambda^n_breakdown",
        Tunable [-10.0, 10.0, 1.0], 0.0, ONE "", (device.breakdown_exponent);
    V_ac "amplitude of the built-in voltage V_ac*sin(2*pi*f_ac*t + phase_ac), added to voltage",
        Tunable [-2e5, 2e5, 1e3], 0.0, VOLT "4 kV are 4000", (alternating[0]);
    phase_ac "phase of the built-in voltage: at t = 0, as long as f_ac is not changed on the way",
        Tunable [-10.0, 10.0, 1.0], 0.0, ANGLE "degrees*pi/180", (alternating[2]);
    lambda_start "stretch at the start time",
        Fixed [1e-2, 1e3, 1.0], 1.0, ONE "", (start.motion.position);
    lambda_dot_start "rate of the stretch at the start time",
        Fixed [-1e9, 1e9, 1e5], 0.0, PER_SECOND "", (start.motion.rate);
    charge_start "charge at the start time, before an ideal source sets another",
        Fixed [-1e-2, 1e-2, 1e-9], 0.0, COULOMB "1 nC is 1e-9", (start.charge);
    xi1_start "stretch of the dashpot of Maxwell branch 1 at the start time",
        Fixed [1e-2, 1e3, 1.0], 1.0, ONE "", (start.dashpots[0]);
    xi2_start "stretch of the dashpot of Maxwell branch 2 at the start time",
        Fixed [1e-2, 1e3, 1.0], 1.0, ONE "", (start.dashpots[1]);
    xi3_start "stretch of the dashpot of Maxwell branch 3 at the start time",
        Fixed [1e-2, 1e3, 1.0], 1.0, ONE "", (start.dashpots[2]);
    lambda_min "stretch at which the contracting actuator has collapsed",
        Fixed [1e-2, 0.99, 0.1], 0.05, ONE "", (limits.lower);
    lambda_max "stretch at which the expanding actuator has been pulled in",
        Fixed [1.01, 1e3, 10.0], 10.0, ONE "", (limits.upper);
    source_number "source for hosts that set numbers only: 0 leaves it to source, 1 is voltage, 2 current, 3 charge",
        Fixed [0.0, 3.0, 1.0] whole, 0.0, ONE "", (source_number);
    terminate_on_pull_in "on_pull_in for hosts that set numbers only: 0 leaves it to on_pull_in, 1 is terminate",
        Fixed [0.0, 1.0, 1.0] whole, 0.0, ONE "", (terminate_on_pull_in);
    on_breakdown_number "on_breakdown for hosts that set numbers only: 0 leaves it to on_breakdown, 1 is flag, 2 hold, 3 terminate",
        Fixed [0.0, 3.0, 1.0] whole, 0.0, ONE "", (on_breakdown_number);
    extremes_window "number of the window over which extremes are recorded: a changed value starts them anew at the present time; not 0, they are recorded whatever record_extremes is",
        Tunable [0.0, 1e9, 1.0], 0.0, ONE "", (extremes_window);
};

/// The frequency of the built-in voltage.
pub(super) const FREQUENCY: Row = Row::parameter(
    "f_ac",
    "frequency of the built-in voltage; changed on the way, the phase runs on from where it is",
    Tunable,
    real(0.0, 1e9, 1e3),
    0.0,
    |scene| scene.alternating[1],
    |scene, value| scene.alternating[1] = value,
)
.from_now_on(|scene, value| scene.retune(value))
.in_unit(&units::HERTZ);

/// What the source imposes.
static SOURCE: Enumeration = Enumeration {
    name: "Source",
    items: &[
        ("voltage", "the supply voltage, input voltage"),
        ("current", "the current into the actuator, input current"),
        (
            "charge",
            "the charge on the electrodes, input charge_imposed",
        ),
    ],
};

/// What happens at breakdown.
static ON_BREAKDOWN: Enumeration = Enumeration {
    name: "OnBreakdown",
    items: &[
        ("flag", "broken_down becomes true and the motion goes on"),
        ("hold", "the actuator stays where it is and steps go on"),
        (
            "terminate",
            "the step ends there and the host is asked to terminate",
        ),
    ],
};

/// The choices.
pub(super) const CHOICES: [Row; 5] = [
    Row::parameter(
        "source",
        "what the source imposes",
        Fixed,
        Kind::Enumeration(&SOURCE),
        1.0,
        |scene| match scene.device.source {
            Source::Voltage => 1.0,
            Source::Current => 2.0,
            Source::Charge => 3.0,
        },
        |scene, value| {
            scene.device.source = match value {
                2.0 => Source::Current,
                3.0 => Source::Charge,
                _ => Source::Voltage,
            };
        },
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
    Row::parameter(
        "on_breakdown",
        "what happens where the true field reaches breakdown",
        Fixed,
        Kind::Enumeration(&ON_BREAKDOWN),
        1.0,
        |scene| match scene.on_breakdown {
            OnBreakdown::Flag => 1.0,
            OnBreakdown::Hold => 2.0,
            OnBreakdown::Terminate => 3.0,
        },
        |scene, value| {
            scene.on_breakdown = match value {
                2.0 => OnBreakdown::Hold,
                3.0 => OnBreakdown::Terminate,
                _ => OnBreakdown::Flag,
            };
        },
    ),
    Row::parameter(
        "record_extremes",
        "whether the extremes of lambda are recorded",
        Fixed,
        Kind::Boolean,
        0.0,
        |scene| f64::from(u8::from(scene.record_extremes)),
        |scene, value| scene.record_extremes = value != 0.0,
    ),
    Row::parameter(
        "record_energy",
        "whether energies lost and supplied are summed up in co-simulation",
        Fixed,
        Kind::Boolean,
        0.0,
        |scene| f64::from(u8::from(scene.record_energy)),
        |scene, value| scene.record_energy = value != 0.0,
    ),
];
