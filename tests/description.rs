//! The generated model description.

use dielectric_elastomer_actuator::description;
use dielectric_elastomer_actuator::model::Model;
use dielectric_elastomer_actuator::nondimensional::{
    ALIASES, Nondimensional, VARIABLES, value_reference,
};
use fmi::fmi2::schema::Fmi2ModelDescription;

fn checked_in(path: &str) -> String {
    let path = format!("{}/{path}", env!("CARGO_MANIFEST_DIR"));
    std::fs::read_to_string(path).expect("the file is checked in")
}

#[test]
fn the_checked_in_description_is_the_generated_one() {
    assert!(
        checked_in("modelDescription/DielectricElastomerActuator.xml")
            == description::xml::<Nondimensional>(),
        "modelDescription.xml differs from the table; run `cargo fmu describe`"
    );
}

/// Read back by the reader of the crate `fmi`, which knows nothing of our writer.
#[test]
fn an_independent_reader_finds_every_variable() {
    let text = description::xml::<Nondimensional>();
    let read: Fmi2ModelDescription = fmi::schema::deserialize(&text).expect("a valid description");
    assert_eq!(read.guid, Nondimensional::GUID);
    let names: Vec<&str> = read
        .model_variables
        .variables
        .iter()
        .map(|v| v.name.as_str())
        .collect();
    let further = ALIASES.iter().map(|alias| alias.name);
    let ours: Vec<&str> = VARIABLES.iter().map(|v| v.name).chain(further).collect();
    assert_eq!(names, ours);
    for variable in &read.model_variables.variables {
        assert_eq!(
            value_reference(&variable.name),
            Some(variable.value_reference)
        );
    }
}

/// The README's table of variables has one row for each, with its start value.
#[test]
fn the_readme_lists_every_variable() {
    let readme = checked_in("README.md");
    for variable in &VARIABLES {
        let row = readme
            .lines()
            .find(|line| {
                let first = line.split(" | ").next().unwrap_or_default();
                line.starts_with("| `") && first.contains(&format!("`{}`", variable.name))
            })
            .unwrap_or_else(|| panic!("README.md has no row for {}", variable.name));
        if let Some(start) = variable.start {
            let cell = format!("| {start} |");
            assert!(
                row.contains(&cell),
                "README.md does not give {cell} for {}",
                variable.name
            );
        }
    }
}
