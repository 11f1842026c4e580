//! `modelDescription.xml`, made from the table of variables.

mod guid;
mod schema;

pub use guid::GUID;

use schema::*;
use serde::Serialize;

use crate::slave::DEFAULT_TOLERANCE;
use crate::variables::{
    Access, Causality, Kind, ON_PULL_IN, VARIABLES, Variability, Variable, value_reference,
};

/// The model identifier: name of the FMU and of the binary in it.
pub const MODEL_IDENTIFIER: &str = "DielectricElastomerActuator";

/// Log categories with their meaning.
pub const LOG_CATEGORIES: [(&str, &str); 3] = [
    ("logEvents", "the actuator has collapsed"),
    ("logStatusWarning", "warnings"),
    ("logStatusError", "calls that were refused or discarded"),
];

const TYPE_NAME: &str = "OnPullIn";
const UNIT: &str = "1";
const STOP_TIME: f64 = 100.0;
const STEP_SIZE: f64 = 0.1;

/// The text of `modelDescription.xml`.
#[must_use]
pub fn xml() -> String {
    let mut text = String::from("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n");
    let mut serializer = quick_xml::se::Serializer::new(&mut text);
    serializer.indent(' ', 2);
    // Attributes of plain numbers and texts: there is nothing that could fail,
    // and a test reads the result back.
    let written = description().serialize(serializer);
    debug_assert!(written.is_ok(), "{written:?}");
    text.push('\n');
    text
}

fn description() -> FmiModelDescription {
    FmiModelDescription {
        fmi_version: "2.0",
        model_name: MODEL_IDENTIFIER,
        guid: GUID,
        description: env!("CARGO_PKG_DESCRIPTION"),
        version: env!("CARGO_PKG_VERSION"),
        license: env!("CARGO_PKG_LICENSE"),
        generation_tool: concat!(env!("CARGO_PKG_NAME"), " ", env!("CARGO_PKG_VERSION")),
        variable_naming_convention: "flat",
        co_simulation: CoSimulation {
            model_identifier: MODEL_IDENTIFIER,
            can_handle_variable_communication_step_size: true,
            can_interpolate_inputs: true,
            can_not_use_memory_management_functions: true,
        },
        unit_definitions: UnitDefinitions {
            unit: vec![Unit {
                name: UNIT,
                base_unit: BaseUnit {},
            }],
        },
        type_definitions: TypeDefinitions {
            simple_type: vec![SimpleType {
                name: TYPE_NAME,
                enumeration: Items {
                    item: ON_PULL_IN
                        .iter()
                        .zip(1..)
                        .map(|(&(name, description), value)| Item {
                            name,
                            value,
                            description,
                        })
                        .collect(),
                },
            }],
        },
        log_categories: LogCategories {
            category: LOG_CATEGORIES
                .map(|(name, description)| Category { name, description })
                .into(),
        },
        default_experiment: DefaultExperiment {
            start_time: Number(0.0),
            stop_time: Number(STOP_TIME),
            tolerance: Number(DEFAULT_TOLERANCE),
            step_size: Number(STEP_SIZE),
        },
        model_variables: ModelVariables {
            scalar_variable: VARIABLES.iter().zip(0..).map(scalar_variable).collect(),
        },
        model_structure: model_structure(),
    }
}

fn scalar_variable((variable, value_reference): (&Variable, u32)) -> ScalarVariable {
    let start = variable.start;
    let (mut real, mut boolean, mut enumeration) = (None, None, None);
    match variable.kind {
        Kind::Real { min, max, nominal } => {
            real = Some(Real {
                unit: UNIT,
                min: Number(min),
                max: Number(max),
                nominal: Number(nominal),
                start: start.map(Number),
            });
        }
        Kind::Boolean => {
            boolean = Some(Boolean {
                start: start.map(|value| value == 1.0),
            })
        }
        Kind::Enumeration => {
            enumeration = Some(Enumeration {
                declared_type: TYPE_NAME,
                min: 1,
                max: ON_PULL_IN.len(),
                start: start.map(|value| value as usize),
            });
        }
    }
    ScalarVariable {
        name: variable.name,
        value_reference,
        description: variable.description,
        causality: match variable.causality {
            Causality::Input => "input",
            Causality::Parameter => "parameter",
            Causality::Output => "output",
            Causality::Local => "local",
        },
        variability: match variable.variability {
            Variability::Fixed => "fixed",
            Variability::Tunable => "tunable",
            Variability::Discrete => "discrete",
            Variability::Continuous => "continuous",
        },
        // The standard gives inputs none.
        initial: match variable.access {
            Access::Input { .. } => None,
            Access::Setting { .. } => Some("exact"),
            Access::Result { .. } => Some("calculated"),
        },
        real,
        boolean,
        enumeration,
    }
}

/// The outputs follow from the state alone, so that no step has an algebraic
/// loop through them; at the start they follow from the start values.
fn model_structure() -> ModelStructure {
    let unknown = |name: &str, from: &[&str]| Unknown {
        index: index(name),
        dependencies: from
            .iter()
            .map(|name| index(name).to_string())
            .collect::<Vec<_>>()
            .join(" "),
    };
    let outputs = || {
        VARIABLES
            .iter()
            .filter(|variable| variable.causality == Causality::Output)
    };
    let from = |variable: &Variable| match variable.access {
        Access::Result { from, .. } => from,
        _ => &[],
    };
    ModelStructure {
        outputs: Unknowns {
            unknown: outputs().map(|v| unknown(v.name, &[])).collect(),
        },
        initial_unknowns: Unknowns {
            unknown: outputs().map(|v| unknown(v.name, from(v))).collect(),
        },
    }
}

/// Place of a variable in the list, counted from 1.
fn index(name: &str) -> u32 {
    value_reference(name).map_or(0, |reference| reference + 1)
}
