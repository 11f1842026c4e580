//! The states, their derivatives, and what both ports give.

use super::Row;
use crate::model::variables::Causality::{Local, Output};
use crate::model::variables::rows::{depends, formula, positive, real, unlimited};
use crate::model::variables::{Dependencies, Terminal, units};

/// The electrical port at a source of voltage.
pub(super) static ELECTRICAL: Terminal = Terminal {
    name: "electrical",
    description: "electrical port where source is voltage: the voltage in, the current into the actuator out; positive current charges the actuator at a positive voltage",
    place: [-100.0, 50.0],
    colour: [0, 0, 255],
};

/// The electrical port at a source of current or charge.
pub(super) static ELECTRICAL_IMPOSED: Terminal = Terminal {
    name: "electrical_imposed",
    description: "electrical port where source is current or charge: one of them in, the voltage at the terminals out",
    place: [-100.0, -50.0],
    colour: [0, 0, 255],
};

/// The mechanical port.
pub(super) static MECHANICAL: Terminal = Terminal {
    name: "mechanical",
    description: "pairs of opposite edges, both directions alike: force in, positive outwards; their distance and its derivatives out",
    place: [100.0, 0.0],
    colour: [0, 127, 0],
};

/// Of accelerations: all but what only leads to breakdown, and an imposed current, which moves the
/// charge first.
const FORCED: Dependencies = depends(
    &[
        "voltage",
        "charge_imposed",
        "force",
        "lambda",
        "lambda_dot",
        "charge_state",
        "xi1",
        "xi2",
        "xi3",
    ],
    &[
        "voltage",
        "charge_imposed",
        "force",
        "mu",
        "rho",
        "eps_r",
        "H",
        "L",
        "n_layers",
        "gamma_s",
        "tau_s",
        "E_s",
        "n_surfaces",
        "J_m",
        "kappa2",
        "kappa3",
        "k1",
        "k2",
        "k3",
        "m_load",
        "k_load",
        "l_load",
        "b",
        "eta",
        "mu_1",
        "J_1",
        "mu_2",
        "J_2",
        "mu_3",
        "J_3",
        "R_s",
        "V_ac",
        "f_ac",
        "phase_ac",
        "lambda_start",
        "lambda_dot_start",
        "charge_start",
        "xi1_start",
        "xi2_start",
        "xi3_start",
        "source_number",
        "source",
    ],
);

/// Of charge, membrane voltage and field.
pub(super) const CHARGED: Dependencies = depends(
    &["voltage", "charge_imposed", "lambda", "charge_state"],
    &[
        "voltage",
        "charge_imposed",
        "eps_r",
        "H",
        "L",
        "n_layers",
        "k1",
        "k2",
        "k3",
        "R_s",
        "V_ac",
        "f_ac",
        "phase_ac",
        "lambda_start",
        "charge_start",
        "source_number",
        "source",
    ],
);

/// Of current and power, and of the voltage at the terminals.
const SUPPLIED: Dependencies = depends(
    &[
        "voltage",
        "current",
        "charge_imposed",
        "lambda",
        "lambda_dot",
        "charge_state",
    ],
    &[
        "voltage",
        "current",
        "charge_imposed",
        "eps_r",
        "H",
        "L",
        "n_layers",
        "k1",
        "k2",
        "k3",
        "R_s",
        "G_p",
        "sigma",
        "E_conduction",
        "V_ac",
        "f_ac",
        "phase_ac",
        "lambda_start",
        "lambda_dot_start",
        "charge_start",
        "source_number",
        "source",
    ],
);

/// The results that have derivatives.
pub(super) const PORTS: [Row; 26] = [
    Row::result(
        "lambda",
        "in-plane stretch",
        Output,
        real(1e-3, 1e6, 1.0),
        formula!(stretch),
        depends(&["lambda"], &["lambda_start"]),
    ),
    Row::result(
        "lambda_dot",
        "rate of lambda",
        Local,
        unlimited(1e5),
        formula!(stretch_rate),
        depends(&["lambda_dot"], &["lambda_dot_start"]),
    )
    .in_unit(&units::PER_SECOND)
    .derivative_of("lambda"),
    Row::result(
        "lambda_ddot",
        "second derivative of lambda",
        Local,
        unlimited(1e10),
        formula!(stretch_acceleration),
        FORCED,
    )
    .in_unit(&units::PER_SECOND_SQUARED)
    .derivative_of("lambda_dot"),
    Row::result(
        "charge_state",
        "charge as a state, where it is one: with R_s > 0 or an imposed current; else charge_start",
        Local,
        unlimited(1e-11),
        formula!(charge_state),
        depends(&["charge_state"], &["charge_start"]),
    )
    .in_unit(&units::COULOMB),
    Row::result(
        "charge_state_dot",
        "rate of charge_state",
        Local,
        unlimited(1e-5),
        formula!(charge_state_rate),
        SUPPLIED,
    )
    .in_unit(&units::AMPERE)
    .derivative_of("charge_state"),
    Row::result(
        "xi1",
        "stretch of the dashpot of Maxwell branch 1",
        Local,
        real(0.0, 1e6, 1.0),
        formula!(dashpot_1),
        depends(&["xi1"], &["xi1_start"]),
    ),
    Row::result(
        "xi1_dot",
        "rate of xi1",
        Local,
        unlimited(1.0),
        formula!(dashpot_1_rate),
        depends(&["lambda", "xi1"], &["lambda_start", "xi1_start", "mu_1", "tau_1", "J_1"]),
    )
    .in_unit(&units::PER_SECOND)
    .derivative_of("xi1"),
    Row::result(
        "xi2",
        "stretch of the dashpot of Maxwell branch 2",
        Local,
        real(0.0, 1e6, 1.0),
        formula!(dashpot_2),
        depends(&["xi2"], &["xi2_start"]),
    ),
    Row::result(
        "xi2_dot",
        "rate of xi2",
        Local,
        unlimited(1.0),
        formula!(dashpot_2_rate),
        depends(&["lambda", "xi2"], &["lambda_start", "xi2_start", "mu_2", "tau_2", "J_2"]),
    )
    .in_unit(&units::PER_SECOND)
    .derivative_of("xi2"),
    Row::result(
        "xi3",
        "stretch of the dashpot of Maxwell branch 3",
        Local,
        real(0.0, 1e6, 1.0),
        formula!(dashpot_3),
        depends(&["xi3"], &["xi3_start"]),
    ),
    Row::result(
        "xi3_dot",
        "rate of xi3",
        Local,
        unlimited(1.0),
        formula!(dashpot_3_rate),
        depends(&["lambda", "xi3"], &["lambda_start", "xi3_start", "mu_3", "tau_3", "J_3"]),
    )
    .in_unit(&units::PER_SECOND)
    .derivative_of("xi3"),
    Row::result(
        "lambda3",
        "thickness stretch, 1/lambda^2",
        Output,
        real(1e-12, 1e6, 1.0),
        formula!(thickness_stretch),
        depends(&["lambda"], &["lambda_start"]),
    ),
    Row::result(
        "lambda3_dot",
        "rate of lambda3",
        Local,
        unlimited(1e5),
        formula!(thickness_stretch_rate),
        depends(
            &["lambda", "lambda_dot"],
            &["lambda_start", "lambda_dot_start"],
        ),
    )
    .in_unit(&units::PER_SECOND),
    Row::result(
        "edge_distance",
        "distance of opposite edges, L*lambda: the work conjugate of force in each of two directions",
        Output,
        real(0.0, 1e6, 1e-4),
        formula!(edge_distance),
        depends(&["lambda"], &["lambda_start", "L"]),
    )
    .in_unit(&units::METRE)
    .member(&MECHANICAL, "distance"),
    Row::result(
        "edge_displacement",
        "by how much the distance of opposite edges has grown, L*(lambda - 1)",
        Output,
        unlimited(1e-5),
        formula!(edge_displacement),
        depends(&["lambda"], &["lambda_start", "L"]),
    )
    .in_unit(&units::METRE)
    .member(&MECHANICAL, "displacement"),
    Row::result(
        "edge_velocity",
        "rate of edge_distance, positive outwards",
        Output,
        unlimited(1.0),
        formula!(edge_velocity),
        depends(&["lambda_dot"], &["lambda_dot_start", "L"]),
    )
    .in_unit(&units::METRE_PER_SECOND)
    .member(&MECHANICAL, "velocity"),
    Row::result(
        "edge_acceleration",
        "second derivative of edge_distance",
        Output,
        unlimited(1e6),
        formula!(edge_acceleration),
        FORCED,
    )
    .in_unit(&units::METRE_PER_SECOND_SQUARED)
    .member(&MECHANICAL, "acceleration"),
    Row::result(
        "thickness",
        "thickness of the whole stack",
        Output,
        positive(1e-5),
        formula!(thickness),
        depends(&["lambda"], &["lambda_start", "H", "n_layers"]),
    )
    .in_unit(&units::METRE),
    Row::result(
        "charge",
        "charge on the electrodes",
        Output,
        unlimited(1e-11),
        formula!(charge),
        CHARGED,
    )
    .in_unit(&units::COULOMB)
    .member(&ELECTRICAL, "charge"),
    Row::result(
        "supply_current",
        "current from the source into the actuator: of charging and of leaks",
        Output,
        unlimited(1e-5),
        formula!(supply_current),
        SUPPLIED,
    )
    .in_unit(&units::AMPERE)
    .flow(&ELECTRICAL, "current"),
    Row::result(
        "capacitance",
        "capacitance at the present stretch",
        Output,
        positive(1e-13),
        formula!(capacitance),
        depends(&["lambda"], &["lambda_start", "L", "H", "n_layers", "eps_r", "k1", "k2", "k3"]),
    )
    .in_unit(&units::FARAD)
    .member(&ELECTRICAL, "capacitance"),
    Row::result(
        "membrane_voltage",
        "voltage at the membrane, behind the series resistance",
        Output,
        unlimited(1e3),
        formula!(membrane_voltage),
        CHARGED,
    )
    .in_unit(&units::VOLT)
    .member(&ELECTRICAL, "membrane_voltage"),
    Row::result(
        "supply_voltage",
        "voltage at the terminals, the built-in one included",
        Output,
        unlimited(1e3),
        formula!(supply_voltage),
        SUPPLIED,
    )
    .in_unit(&units::VOLT)
    .member(&ELECTRICAL_IMPOSED, "voltage"),
    Row::result(
        "electric_field",
        "true electric field in the material, membrane_voltage*lambda^2/H",
        Output,
        unlimited(1e8),
        formula!(electric_field),
        CHARGED,
    )
    .in_unit(&units::VOLT_PER_METRE),
    Row::result(
        "electrical_power",
        "power that the source supplies, supply_voltage*supply_current",
        Output,
        unlimited(1e-2),
        formula!(electrical_power),
        SUPPLIED,
    )
    .in_unit(&units::WATT),
    Row::result(
        "mechanical_power",
        "power that force supplies on both pairs of edges, 2*force*edge_velocity",
        Output,
        unlimited(1e-2),
        formula!(mechanical_power),
        depends(&["force", "lambda_dot"], &["force", "lambda_dot_start", "L"]),
    )
    .in_unit(&units::WATT),
];
