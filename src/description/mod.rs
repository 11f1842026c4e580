//! `modelDescription.xml`, made from the table of variables.

pub mod guid;
mod schema;
pub mod terminals;

use schema::{
    BaseUnit, Boolean, Category, CoSimulation, DefaultExperiment, DisplayUnit, Enumeration,
    FmiModelDescription, Item, Items, LogCategories, ModelExchange, ModelStructure, ModelVariables,
    Number, Real, ScalarVariable, SimpleType, TypeDefinitions, UnitDefinitions, Unknown, Unknowns,
};
use serde::Serialize;

use crate::model::Model;
use crate::model::variables::{
    self, Access, Alias, Causality, Dependencies, Kind, Unit, Variability, Variable,
    value_reference,
};

/// Log categories with their meaning.
pub const LOG_CATEGORIES: [(&str, &str); 3] = [
    ("logEvents", "the actuator has collapsed"),
    ("logStatusWarning", "warnings"),
    ("logStatusError", "calls that were refused or discarded"),
];

/// The order that is declared. It is not the highest order that is served: OMSimulator asks for
/// one value of each output and reads as many as are declared, beyond the end of its array.
const OUTPUT_DERIVATIVE_ORDER: u32 = 1;

/// The text of the `modelDescription.xml` of a model.
#[must_use]
pub fn xml<M: Model>() -> String {
    let mut text = String::from("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n");
    let mut serializer = quick_xml::se::Serializer::new(&mut text);
    serializer.indent(' ', 2);
    // Attributes of plain numbers and texts: there is nothing that could fail,
    // and a test reads the result back.
    let written = description::<M>().serialize(serializer);
    debug_assert!(written.is_ok(), "{written:?}");
    text.push('\n');
    text
}

fn description<M: Model>() -> FmiModelDescription {
    FmiModelDescription {
        fmi_version: "2.0",
        model_name: M::IDENTIFIER,
        guid: M::GUID,
        description: M::DESCRIPTION,
        version: env!("CARGO_PKG_VERSION"),
        license: env!("CARGO_PKG_LICENSE"),
        generation_tool: concat!(env!("CARGO_PKG_NAME"), " ", env!("CARGO_PKG_VERSION")),
        variable_naming_convention: "flat",
        number_of_event_indicators: M::INDICATOR_COUNT,
        model_exchange: ModelExchange {
            model_identifier: M::IDENTIFIER,
            can_be_instantiated_only_once_per_process: false,
            can_not_use_memory_management_functions: true,
            can_get_and_set_fmu_state: true,
            can_serialize_fmu_state: true,
            provides_directional_derivative: true,
        },
        co_simulation: CoSimulation {
            model_identifier: M::IDENTIFIER,
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
            unit: unit_definitions::<M>(),
        },
        type_definitions: TypeDefinitions {
            simple_type: enumerations::<M>(),
        },
        log_categories: LogCategories {
            category: LOG_CATEGORIES
                .map(|(name, description)| Category { name, description })
                .into(),
        },
        // No tolerance: hosts would use it both for our integrator and for their own.
        default_experiment: DefaultExperiment {
            start_time: Number(0.0),
            stop_time: Number(M::EXPERIMENT.stop_time),
            step_size: Number(M::EXPERIMENT.step_size),
        },
        model_variables: ModelVariables {
            scalar_variable: M::VARIABLES
                .iter()
                .zip(0..)
                .map(scalar_variable)
                .chain(M::ALIASES.iter().map(alias::<M>))
                .collect(),
        },
        model_structure: model_structure::<M>(),
    }
}

/// The units that the variables of a model have, each once, in the order of the table.
fn unit_definitions<M: Model>() -> Vec<schema::Unit> {
    let mut units: Vec<&Unit> = Vec::new();
    for variable in M::VARIABLES {
        let unit = variable.unit;
        match units.iter_mut().find(|known| known.name == unit.name) {
            // An angle can be displayed in degrees, an angular frequency of the same name cannot.
            Some(known) if known.displayed.len() < unit.displayed.len() => *known = unit,
            Some(_) => {}
            None => units.push(unit),
        }
    }
    units.into_iter().map(unit_definition).collect()
}

fn unit_definition(unit: &Unit) -> schema::Unit {
    let exponent = |name: &str| {
        let found = unit.base.iter().find(|(base, _)| *base == name);
        found.map(|&(_, exponent)| exponent)
    };
    schema::Unit {
        name: unit.name,
        base_unit: BaseUnit {
            kg: exponent("kg"),
            m: exponent("m"),
            s: exponent("s"),
            ampere: exponent("A"),
            rad: exponent("rad"),
        },
        display_unit: unit
            .displayed
            .iter()
            .map(|displayed| DisplayUnit {
                name: displayed.name,
                factor: Number(displayed.factor),
            })
            .collect(),
    }
}

/// The enumerations that the variables of a model have, each once, in the order of the table.
fn enumerations<M: Model>() -> Vec<SimpleType> {
    let mut types: Vec<&variables::Enumeration> = Vec::new();
    for variable in M::VARIABLES {
        if let Kind::Enumeration(enumeration) = variable.kind
            && types.iter().all(|known| known.name != enumeration.name)
        {
            types.push(enumeration);
        }
    }
    let items = |enumeration: &variables::Enumeration| {
        let numbered = enumeration.items.iter().zip(1..);
        numbered
            .map(|(&(name, description), value)| Item {
                name,
                value,
                description,
            })
            .collect()
    };
    let simple_type = |enumeration: &variables::Enumeration| SimpleType {
        name: enumeration.name,
        enumeration: Items {
            item: items(enumeration),
        },
    };
    types.into_iter().map(simple_type).collect()
}

fn scalar_variable<M: Model>((variable, value_reference): (&Variable<M>, u32)) -> ScalarVariable {
    let start = variable.start;
    let (mut real, mut boolean, mut enumeration) = (None, None, None);
    match variable.kind {
        Kind::Real { min, max, nominal } => {
            real = Some(Real {
                unit: variable.unit.name,
                display_unit: variable.unit.displayed.first().map(|unit| unit.name),
                min: min.is_finite().then_some(Number(min)),
                max: max.is_finite().then_some(Number(max)),
                nominal: Number(nominal),
                start: start.map(Number),
                derivative: variable.derivative_of.map(index::<M>),
                // A collapse sets the states.
                reinit: M::STATES.contains(&value_reference).then_some(true),
            });
        }
        Kind::Boolean => {
            boolean = Some(Boolean {
                start: start.map(|value| value == 1.0),
            })
        }
        Kind::Enumeration(of) => {
            enumeration = Some(Enumeration {
                declared_type: of.name,
                min: 1,
                max: of.items.len(),
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

/// A further name of a variable: a local of the same value reference and type.
fn alias<M: Model>(alias: &Alias) -> ScalarVariable {
    let reference = value_reference::<M>(alias.of).unwrap_or_default();
    let mut variable = scalar_variable::<M>((row(&reference), reference));
    variable.name = alias.name;
    variable.description = alias.description;
    variable.causality = "local";
    if let Some(real) = &mut variable.real {
        // The state is listed by its own name.
        (real.derivative, real.reinit) = (None, None);
    }
    variable
}

/// The outputs follow from the states alone, so that no step has an algebraic
/// loop through them.
fn model_structure<M: Model>() -> ModelStructure {
    let mut initial: Vec<&Variable<M>> = outputs().collect();
    initial.extend(M::STATES.iter().chain(M::DERIVATIVES).map(row));
    initial.sort_by_key(|variable| index::<M>(variable.name));
    initial.dedup_by_key(|variable| variable.name);
    ModelStructure {
        outputs: unknowns(outputs::<M>(), |from| from.now),
        derivatives: unknowns::<M>(M::DERIVATIVES.iter().map(row), |from| from.now),
        initial_unknowns: unknowns::<M>(initial.into_iter(), |from| from.at_start),
    }
}

fn outputs<M: Model>() -> impl Iterator<Item = &'static Variable<M>> {
    M::VARIABLES
        .iter()
        .filter(|variable| variable.causality == Causality::Output)
}

fn row<M: Model>(reference: &u32) -> &'static Variable<M> {
    &M::VARIABLES[*reference as usize]
}

/// The variables with those of their dependencies that `pick` chooses.
fn unknowns<M: Model>(
    variables: impl Iterator<Item = &'static Variable<M>>,
    pick: fn(Dependencies) -> &'static [&'static str],
) -> Unknowns {
    let unknown = |variable: &Variable<M>| {
        let from = match variable.access {
            Access::Result { dependencies, .. } => pick(dependencies),
            _ => &[],
        };
        let mut places: Vec<u32> = from.iter().map(|name| index::<M>(name)).collect();
        places.sort_unstable();
        let places: Vec<String> = places.iter().map(u32::to_string).collect();
        Unknown {
            index: index::<M>(variable.name),
            dependencies: places.join(" "),
        }
    };
    Unknowns {
        unknown: variables.map(unknown).collect(),
    }
}

/// Place of a variable in the list, counted from 1.
fn index<M: Model>(name: &str) -> u32 {
    value_reference::<M>(name).map_or(0, |reference| reference + 1)
}
