//! The elements of `modelDescription.xml` that we use, named as in the schema
//! of FMI 2.0 (`fmi2ModelDescription.xsd`), in its order.

use serde::{Serialize, Serializer};

use crate::shortest::Shortest;

/// A real number, written with an exponent where it is very large or small.
pub struct Number(pub f64);

impl Serialize for Number {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(&Shortest(self.0))
    }
}

#[derive(Serialize)]
#[serde(rename = "fmiModelDescription")]
pub struct FmiModelDescription {
    #[serde(rename = "@fmiVersion")]
    pub fmi_version: &'static str,
    #[serde(rename = "@modelName")]
    pub model_name: &'static str,
    #[serde(rename = "@guid")]
    pub guid: &'static str,
    #[serde(rename = "@description")]
    pub description: &'static str,
    #[serde(rename = "@version")]
    pub version: &'static str,
    #[serde(rename = "@license")]
    pub license: &'static str,
    #[serde(rename = "@generationTool")]
    pub generation_tool: &'static str,
    #[serde(rename = "@variableNamingConvention")]
    pub variable_naming_convention: &'static str,
    #[serde(rename = "@numberOfEventIndicators")]
    pub number_of_event_indicators: usize,
    #[serde(rename = "ModelExchange")]
    pub model_exchange: ModelExchange,
    #[serde(rename = "CoSimulation")]
    pub co_simulation: CoSimulation,
    #[serde(rename = "UnitDefinitions")]
    pub unit_definitions: UnitDefinitions,
    #[serde(rename = "TypeDefinitions")]
    pub type_definitions: TypeDefinitions,
    #[serde(rename = "LogCategories")]
    pub log_categories: LogCategories,
    #[serde(rename = "DefaultExperiment")]
    pub default_experiment: DefaultExperiment,
    #[serde(rename = "ModelVariables")]
    pub model_variables: ModelVariables,
    #[serde(rename = "ModelStructure")]
    pub model_structure: ModelStructure,
}

#[derive(Serialize)]
pub struct ModelExchange {
    #[serde(rename = "@modelIdentifier")]
    pub model_identifier: &'static str,
    #[serde(rename = "@canBeInstantiatedOnlyOncePerProcess")]
    pub can_be_instantiated_only_once_per_process: bool,
    #[serde(rename = "@canNotUseMemoryManagementFunctions")]
    pub can_not_use_memory_management_functions: bool,
    #[serde(rename = "@canGetAndSetFMUstate")]
    pub can_get_and_set_fmu_state: bool,
    #[serde(rename = "@canSerializeFMUstate")]
    pub can_serialize_fmu_state: bool,
    #[serde(rename = "@providesDirectionalDerivative")]
    pub provides_directional_derivative: bool,
}

#[derive(Serialize)]
pub struct CoSimulation {
    #[serde(rename = "@modelIdentifier")]
    pub model_identifier: &'static str,
    #[serde(rename = "@canHandleVariableCommunicationStepSize")]
    pub can_handle_variable_communication_step_size: bool,
    #[serde(rename = "@canInterpolateInputs")]
    pub can_interpolate_inputs: bool,
    #[serde(rename = "@maxOutputDerivativeOrder")]
    pub max_output_derivative_order: u32,
    #[serde(rename = "@canRunAsynchronuously")]
    pub can_run_asynchronously: bool,
    #[serde(rename = "@canBeInstantiatedOnlyOncePerProcess")]
    pub can_be_instantiated_only_once_per_process: bool,
    #[serde(rename = "@canNotUseMemoryManagementFunctions")]
    pub can_not_use_memory_management_functions: bool,
    #[serde(rename = "@canGetAndSetFMUstate")]
    pub can_get_and_set_fmu_state: bool,
    #[serde(rename = "@canSerializeFMUstate")]
    pub can_serialize_fmu_state: bool,
    #[serde(rename = "@providesDirectionalDerivative")]
    pub provides_directional_derivative: bool,
}

#[derive(Serialize)]
pub struct UnitDefinitions {
    #[serde(rename = "Unit")]
    pub unit: Vec<Unit>,
}

#[derive(Serialize)]
pub struct Unit {
    #[serde(rename = "@name")]
    pub name: &'static str,
    #[serde(rename = "BaseUnit")]
    pub base_unit: BaseUnit,
    #[serde(rename = "DisplayUnit", skip_serializing_if = "Vec::is_empty")]
    pub display_unit: Vec<DisplayUnit>,
}

/// Exponents of the SI base units.
#[derive(Serialize)]
pub struct BaseUnit {
    #[serde(rename = "@kg", skip_serializing_if = "Option::is_none")]
    pub kg: Option<i32>,
    #[serde(rename = "@m", skip_serializing_if = "Option::is_none")]
    pub m: Option<i32>,
    #[serde(rename = "@s", skip_serializing_if = "Option::is_none")]
    pub s: Option<i32>,
    #[serde(rename = "@A", skip_serializing_if = "Option::is_none")]
    pub ampere: Option<i32>,
    #[serde(rename = "@rad", skip_serializing_if = "Option::is_none")]
    pub rad: Option<i32>,
}

#[derive(Serialize)]
pub struct DisplayUnit {
    #[serde(rename = "@name")]
    pub name: &'static str,
    #[serde(rename = "@factor")]
    pub factor: Number,
}

#[derive(Serialize)]
pub struct TypeDefinitions {
    #[serde(rename = "SimpleType")]
    pub simple_type: Vec<SimpleType>,
}

#[derive(Serialize)]
pub struct SimpleType {
    #[serde(rename = "@name")]
    pub name: &'static str,
    #[serde(rename = "Enumeration")]
    pub enumeration: Items,
}

#[derive(Serialize)]
pub struct Items {
    #[serde(rename = "Item")]
    pub item: Vec<Item>,
}

#[derive(Serialize)]
pub struct Item {
    #[serde(rename = "@name")]
    pub name: &'static str,
    #[serde(rename = "@value")]
    pub value: i32,
    #[serde(rename = "@description")]
    pub description: &'static str,
}

#[derive(Serialize)]
pub struct LogCategories {
    #[serde(rename = "Category")]
    pub category: Vec<Category>,
}

#[derive(Serialize)]
pub struct Category {
    #[serde(rename = "@name")]
    pub name: &'static str,
    #[serde(rename = "@description")]
    pub description: &'static str,
}

#[derive(Serialize)]
pub struct DefaultExperiment {
    #[serde(rename = "@startTime")]
    pub start_time: Number,
    #[serde(rename = "@stopTime")]
    pub stop_time: Number,
    #[serde(rename = "@stepSize")]
    pub step_size: Number,
}

#[derive(Serialize)]
pub struct ModelVariables {
    #[serde(rename = "ScalarVariable")]
    pub scalar_variable: Vec<ScalarVariable>,
}

#[derive(Serialize)]
pub struct ScalarVariable {
    #[serde(rename = "@name")]
    pub name: &'static str,
    #[serde(rename = "@valueReference")]
    pub value_reference: u32,
    #[serde(rename = "@description")]
    pub description: &'static str,
    #[serde(rename = "@causality")]
    pub causality: &'static str,
    #[serde(rename = "@variability")]
    pub variability: &'static str,
    #[serde(rename = "@initial", skip_serializing_if = "Option::is_none")]
    pub initial: Option<&'static str>,
    #[serde(rename = "Real", skip_serializing_if = "Option::is_none")]
    pub real: Option<Real>,
    #[serde(rename = "Boolean", skip_serializing_if = "Option::is_none")]
    pub boolean: Option<Boolean>,
    #[serde(rename = "Enumeration", skip_serializing_if = "Option::is_none")]
    pub enumeration: Option<Enumeration>,
}

#[derive(Serialize)]
pub struct Real {
    #[serde(rename = "@unit")]
    pub unit: &'static str,
    #[serde(rename = "@displayUnit", skip_serializing_if = "Option::is_none")]
    pub display_unit: Option<&'static str>,
    #[serde(rename = "@min", skip_serializing_if = "Option::is_none")]
    pub min: Option<Number>,
    #[serde(rename = "@max", skip_serializing_if = "Option::is_none")]
    pub max: Option<Number>,
    #[serde(rename = "@nominal")]
    pub nominal: Number,
    #[serde(rename = "@start", skip_serializing_if = "Option::is_none")]
    pub start: Option<Number>,
    #[serde(rename = "@derivative", skip_serializing_if = "Option::is_none")]
    pub derivative: Option<u32>,
    #[serde(rename = "@reinit", skip_serializing_if = "Option::is_none")]
    pub reinit: Option<bool>,
}

#[derive(Serialize)]
pub struct Boolean {
    #[serde(rename = "@start", skip_serializing_if = "Option::is_none")]
    pub start: Option<bool>,
}

#[derive(Serialize)]
pub struct Enumeration {
    #[serde(rename = "@declaredType")]
    pub declared_type: &'static str,
    #[serde(rename = "@min")]
    pub min: usize,
    #[serde(rename = "@max")]
    pub max: usize,
    #[serde(rename = "@start", skip_serializing_if = "Option::is_none")]
    pub start: Option<usize>,
}

#[derive(Serialize)]
pub struct ModelStructure {
    #[serde(rename = "Outputs")]
    pub outputs: Unknowns,
    #[serde(rename = "Derivatives")]
    pub derivatives: Unknowns,
    #[serde(rename = "InitialUnknowns")]
    pub initial_unknowns: Unknowns,
}

#[derive(Serialize)]
pub struct Unknowns {
    #[serde(rename = "Unknown")]
    pub unknown: Vec<Unknown>,
}

#[derive(Serialize)]
pub struct Unknown {
    #[serde(rename = "@index")]
    pub index: u32,
    #[serde(rename = "@dependencies")]
    pub dependencies: String,
}
