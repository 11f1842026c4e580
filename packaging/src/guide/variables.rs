//! The table of variables of a model, from the variables themselves.

use dielectric_elastomer_actuator::model::Model;
use dielectric_elastomer_actuator::model::variables::{Causality, Enumeration, Kind, Variable};

use super::markdown::escaped;

/// The table as HTML.
pub fn table<M: Model>() -> String {
    let rows: String = M::VARIABLES
        .iter()
        .map(row)
        .chain(M::ALIASES.iter().map(|alias| {
            format!(
                "<tr><td><code>{}</code></td><td>further name of <code>{}</code></td>\
                 <td></td><td></td><td></td><td>{}</td></tr>\n",
                alias.name,
                alias.of,
                escaped(alias.description)
            )
        }))
        .collect();
    format!(
        "<div class=\"wide\" tabindex=\"0\"><table class=\"variables\">\n<thead><tr><th>Name</th><th>Kind</th>\
         <th>Unit</th><th>Start</th><th>Allowed</th><th>Meaning</th></tr></thead>\n<tbody>\n{rows}</tbody>\n\
         </table></div>\n"
    )
}

fn row<M: Model>(variable: &Variable<M>) -> String {
    let kind = variable.role();
    let set = matches!(variable.causality, Causality::Parameter | Causality::Input);
    let allowed = match variable.kind {
        Kind::Real { min, max, .. } if min == f64::MIN && max == f64::MAX => String::new(),
        Kind::Real { min, max, .. } if max == f64::MAX => format!("from {}", number(min)),
        Kind::Real { min, max, .. } => format!("{} to {}", number(min), number(max)),
        Kind::Boolean => "true, false".to_owned(),
        Kind::Enumeration(enumeration) => listed(enumeration, |number, name, _| {
            format!("{number}: <code>{name}</code>")
        }),
    };
    let mut meaning = escaped(variable.description);
    if let Kind::Enumeration(enumeration) = variable.kind {
        meaning += ":<br>";
        meaning += &listed(enumeration, |number, _, text| {
            format!("{number}: {}", escaped(text))
        });
    }
    let (unit, allowed) = match variable.kind {
        Kind::Real { .. } => (variable.unit.name, allowed),
        _ => ("", allowed),
    };
    let start = match (variable.kind, variable.start) {
        (_, None) => String::new(),
        (Kind::Boolean, Some(value)) => (value != 0.0).to_string(),
        (_, Some(value)) => number(value),
    };
    // A result lies in its range; nobody may set it.
    let allowed = if set { allowed } else { String::new() };
    format!(
        "<tr><td><code>{}</code></td><td>{kind}</td><td>{unit}</td><td>{start}</td><td>{allowed}</td>\
         <td>{meaning}</td></tr>\n",
        variable.name,
    )
}

/// The items of an enumeration, a line each, of its number, name and meaning.
fn listed(enumeration: &Enumeration, line: impl Fn(usize, &str, &str) -> String) -> String {
    let lines: Vec<String> = (1..)
        .zip(enumeration.items)
        .map(|(number, (name, meaning))| line(number, name, meaning))
        .collect();
    lines.join("<br>")
}

/// A number as people write it: powers of ten where it is long.
fn number(value: f64) -> String {
    let plain = value.to_string();
    let text = if plain.len() <= 6 {
        plain
    } else {
        format!("{value:e}")
    };
    text.replace('-', "−")
}

#[cfg(test)]
mod tests {
    use super::*;
    use dielectric_elastomer_actuator::nondimensional::Nondimensional;
    use dielectric_elastomer_actuator::si::Si;

    fn table_with_every_variable<M: Model>() -> String {
        let table = table::<M>();
        for variable in M::VARIABLES {
            let cell = format!("<code>{}</code></td>", variable.name);
            assert!(table.contains(&cell), "{}", variable.name);
        }
        assert!(table.contains("true, false") && table.contains("1: <code>hold</code>"));
        table
    }

    #[test]
    fn every_variable_is_there_with_what_may_be_set() {
        let table = table_with_every_variable::<Nondimensional>();
        assert!(table.contains("<td>rad</td>"));
        assert!(table.contains("<code>stretch</code></td><td>further name of <code>lambda</code>"));
        let table = table_with_every_variable::<Si>();
        assert!(table.contains("<td>V/m</td>") && table.contains("3: <code>charge</code>"));
        assert!(!table.contains("<code>phi</code>"));
    }
}
