//! `modelDescription.xml`, made from the table of variables.

mod guid;
mod schema;

pub use guid::GUID;

use schema::{
    BaseUnit, Boolean, Category, CoSimulation, DefaultExperiment, DisplayUnit, Enumeration,
    FmiModelDescription, Item, Items, LogCategories, ModelExchange, ModelStructure, ModelVariables,
    Number, Real, ScalarVariable, SimpleType, TypeDefinitions, UnitDefinitions, Unknown, Unknowns,
};
use serde::Serialize;

use crate::slave::{DEFAULT_TOLERANCE, INDICATOR_COUNT};
use crate::variables::{
    Access, Causality, DERIVATIVES, Dependencies, Kind, ON_PULL_IN, STATES, Unit, VARIABLES,
    Variability, Variable, value_reference,
};

/// The model identifier: name of the FMU and of the binary in it.
pub const MODEL_IDENTIFIER: &str = "DielectricElastomerActuator";

/// Log categories with their meaning.
pub const LOG_CATEGORIES: [(&str, &str); 3] = [
    ("logEvents", "the actuator has collapsed"),
    ("logStatusWarning", "warnings"),
    ("logStatusError", "calls that were refused or discarded"),
];

/// Declared, not the highest that is served: a master that asks for one value of
/// each output reads as many as the declared order, so that it reads too far.
const OUTPUT_DERIVATIVE_ORDER: u32 = 1;

const TYPE_NAME: &str = "OnPullIn";
const NUMBER: &str = "1";
const RADIAN: &str = "rad";
const DEGREE: &str = "deg";
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
        number_of_event_indicators: INDICATOR_COUNT,
        model_exchange: ModelExchange {
            model_identifier: MODEL_IDENTIFIER,
            can_be_instantiated_only_once_per_process: false,
            can_not_use_memory_management_functions: true,
            can_get_and_set_fmu_state: true,
            can_serialize_fmu_state: true,
            provides_directional_derivative: true,
        },
        co_simulation: CoSimulation {
            model_identifier: MODEL_IDENTIFIER,
            can_handle_variable_communication_step_size: true,
            can_interpolate_inputs: true,
            max_output_derivative_order: OUTPUT_DERIVATIVE_ORDER,
            can_run_asynchronously: false,
            can_be_instantiated_only_once_per_process: false,
            can_not_use_memory_management_functions: true,
            can_get_and_set_fmu_state: true,
            can_serialize_fmu_state: true,
            provides_directional_derivative: true,
        },
        unit_definitions: UnitDefinitions {
            unit: vec![
                schema::Unit {
                    name: NUMBER,
                    base_unit: BaseUnit { rad: None },
                    display_unit: None,
                },
                schema::Unit {
                    name: RADIAN,
                    base_unit: BaseUnit { rad: Some(1) },
                    display_unit: Some(DisplayUnit {
                        name: DEGREE,
                        factor: Number(1.0_f64.to_degrees()),
                    }),
                },
            ],
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
                unit: match variable.unit {
                    Unit::One => NUMBER,
                    Unit::Angle | Unit::AngularFrequency => RADIAN,
                },
                display_unit: (variable.unit == Unit::Angle).then_some(DEGREE),
                min: Number(min),
                max: Number(max),
                nominal: Number(nominal),
                start: start.map(Number),
                derivative: variable.derivative_of.map(index),
                // A collapse sets the states.
                reinit: STATES.contains(&value_reference).then_some(true),
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

/// The outputs follow from the states alone, so that no step has an algebraic
/// loop through them.
fn model_structure() -> ModelStructure {
    let mut initial: Vec<&Variable> = outputs().collect();
    initial.extend(STATES.iter().chain(&DERIVATIVES).map(row));
    initial.sort_by_key(|variable| index(variable.name));
    initial.dedup_by_key(|variable| variable.name);
    ModelStructure {
        outputs: unknowns(outputs(), |from| from.now),
        derivatives: unknowns(DERIVATIVES.iter().map(row), |from| from.now),
        initial_unknowns: unknowns(initial.into_iter(), |from| from.at_start),
    }
}

fn outputs() -> impl Iterator<Item = &'static Variable> {
    VARIABLES
        .iter()
        .filter(|variable| variable.causality == Causality::Output)
}

fn row(reference: &u32) -> &'static Variable {
    &VARIABLES[*reference as usize]
}

/// The variables with those of their dependencies that `pick` chooses.
fn unknowns(
    variables: impl Iterator<Item = &'static Variable>,
    pick: fn(Dependencies) -> &'static [&'static str],
) -> Unknowns {
    let unknown = |variable: &Variable| {
        let from = match variable.access {
            Access::Result { dependencies, .. } => pick(dependencies),
            _ => &[],
        };
        let mut places: Vec<u32> = from.iter().map(|name| index(name)).collect();
        places.sort_unstable();
        let places: Vec<String> = places.iter().map(u32::to_string).collect();
        Unknown {
            index: index(variable.name),
            dependencies: places.join(" "),
        }
    };
    Unknowns {
        unknown: variables.map(unknown).collect(),
    }
}

/// Place of a variable in the list, counted from 1.
fn index(name: &str) -> u32 {
    value_reference(name).map_or(0, |reference| reference + 1)
}
