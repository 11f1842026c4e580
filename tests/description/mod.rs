//! The generated model description.

use dielectric_elastomer_actuator::description;
use dielectric_elastomer_actuator::model::Model;
use dielectric_elastomer_actuator::model::variables::{self, Causality, Kind, Variable};
use dielectric_elastomer_actuator::nondimensional::{ALIASES, Nondimensional, VARIABLES};
use dielectric_elastomer_actuator::si::Si;
use fmi::fmi2::schema::Fmi2ModelDescription;

fn checked_in(path: &str) -> String {
    let path = format!("{}/{path}", env!("CARGO_MANIFEST_DIR"));
    std::fs::read_to_string(path).expect("the file is checked in")
}

#[test]
fn the_checked_in_description_is_the_generated_one() {
    for (identifier, text) in [
        (
            Nondimensional::IDENTIFIER,
            description::xml::<Nondimensional>(),
        ),
        (Si::IDENTIFIER, description::xml::<Si>()),
    ] {
        assert!(
            checked_in(&format!("modelDescription/{identifier}.xml")) == text,
            "{identifier}.xml differs from the table; run `cargo fmu describe`"
        );
    }
}

/// Every variable and further name of a model, with its unit, read back by the reader of the crate
/// `fmi`, which knows nothing of our writer.
fn an_independent_reader_finds_every_variable<M: Model>() {
    let text = description::xml::<M>();
    let read: Fmi2ModelDescription = fmi::schema::deserialize(&text).expect("a valid description");
    assert_eq!(read.guid, M::GUID);
    let names: Vec<&str> = read
        .model_variables
        .variables
        .iter()
        .map(|v| v.name.as_str())
        .collect();
    let further = M::ALIASES.iter().map(|alias| alias.name);
    let ours: Vec<&str> = M::VARIABLES.iter().map(|v| v.name).chain(further).collect();
    assert_eq!(names, ours);
    for variable in &read.model_variables.variables {
        assert_eq!(
            variables::value_reference::<M>(&variable.name),
            Some(variable.value_reference)
        );
    }
    for variable in M::VARIABLES {
        let unit = format!("<Unit name=\"{}\">", variable.unit.name);
        assert!(
            text.contains(&unit),
            "{} of {}",
            variable.unit.name,
            variable.name
        );
    }
}

#[test]
fn an_independent_reader_finds_every_nondimensional_variable() {
    an_independent_reader_finds_every_variable::<Nondimensional>();
}

#[test]
fn an_independent_reader_finds_every_variable_in_si_units() {
    an_independent_reader_finds_every_variable::<Si>();
}

/// On a difference the message shows the table that the README must have.
#[test]
fn the_readme_lists_the_variables_as_the_table_does() {
    let readme = checked_in("README.md");
    let (_, rest) = readme
        .split_once("| Name | Kind | Start | Meaning |\n|---|---|---|---|\n")
        .expect("the head of the table");
    let (rows, _) = rest.split_once("\n\n").expect("an end of the table");
    let wanted: Vec<String> = VARIABLES
        .iter()
        .map(row)
        .chain(
            ALIASES
                .iter()
                .map(|alias| format!("| `{}` | | | further name of `{}` |", alias.name, alias.of)),
        )
        .collect();
    let wanted = wanted.join("\n");
    assert!(
        rows == wanted,
        "the table in README.md is to be\n\n{wanted}\n"
    );
}

/// A variable as a row in Markdown.
fn row<M: Model>(variable: &Variable<M>) -> String {
    let kind = variable.role();
    let (of_type, start) = match (variable.kind, variable.start) {
        (Kind::Real { .. }, start) => ("", start.map(|start| start.to_string())),
        (Kind::Boolean, start) => (", Boolean", start.map(|start| (start != 0.0).to_string())),
        (Kind::Enumeration(_), start) => (", enumeration", start.map(|start| start.to_string())),
    };
    format!(
        "| `{}` | {kind}{of_type} | {} | {} |",
        variable.name,
        start.unwrap_or_default(),
        variable.description.replace('*', "\\*")
    )
}

fn infinite_values_are_described<M: Model>() {
    for variable in M::VARIABLES {
        let said = variable.description.contains("+inf");
        assert_eq!(variable.may_be_infinite, said, "{}", variable.name);
    }
}

/// A host is handed +inf by no other variable.
#[test]
fn a_variable_that_may_be_infinite_says_so() {
    infinite_values_are_described::<Nondimensional>();
    infinite_values_are_described::<Si>();
}

/// Each member is a variable of the description with a causality of a port, once; the units of force and
/// motion are those of a work.
#[test]
fn terminals_name_variables_of_the_table() {
    assert!(description::terminals::xml::<Nondimensional>().is_none());
    let text = description::terminals::xml::<Si>().expect("terminals");
    let attribute = |line: &str, name: &str| {
        let (_, rest) = line.split_once(&format!(" {name}=\"")).expect(name);
        rest.split_once('"').expect("an end").0.to_owned()
    };
    let mut names = Vec::new();
    for line in text.lines() {
        if line.trim_start().starts_with("<TerminalMemberVariable") {
            let name = attribute(line, "variableName");
            let row = Si::VARIABLES.iter().find(|row| row.name == name);
            let row = row.unwrap_or_else(|| panic!("no variable {name}"));
            assert!(matches!(
                row.causality,
                Causality::Input | Causality::Output
            ));
            let flows = attribute(line, "variableKind") == "inflow";
            assert_eq!(flows, matches!(row.unit.name, "N" | "A"), "{name}");
            assert!(!names.contains(&name), "{name}");
            names.push(name);
        }
    }
    for name in ["voltage", "supply_current", "force", "edge_velocity"] {
        assert!(names.iter().any(|known| known == name), "{name}");
    }
    assert_eq!(text.matches("<Terminal ").count(), 3);
}
