//! Terminals and their icons, as FMI 3.0 describes them and FMI 2.0.4 allows.

use anyhow::Result;
use dielectric_elastomer_actuator::description::terminals;
use dielectric_elastomer_actuator::model::Model;

use crate::archive::Entries;
use crate::icon;

/// The files of a model that has terminals.
///
/// # Errors
/// If an icon cannot be drawn, which would be a mistake here.
pub fn entries<M: Model>() -> Result<Entries> {
    let mut entries = Entries::new();
    let Some(text) = terminals::xml::<M>() else {
        return Ok(entries);
    };
    let place = |name: &str| format!("terminalsAndIcons/{name}");
    entries.insert(place("terminalsAndIcons.xml"), text.into());
    entries.insert(place("icon.png"), icon::png()?);
    for terminal in terminals::all::<M>() {
        let name = place(&format!("{}.png", terminal.name));
        entries.insert(name, icon::terminal(terminal.colour)?);
    }
    Ok(entries)
}

#[cfg(test)]
mod tests {
    use super::*;
    use dielectric_elastomer_actuator::nondimensional::Nondimensional;
    use dielectric_elastomer_actuator::si::Si;

    #[test]
    fn every_terminal_has_its_icon() -> Result<()> {
        assert!(entries::<Nondimensional>()?.is_empty());
        let entries = entries::<Si>()?;
        let text = String::from_utf8(entries["terminalsAndIcons/terminalsAndIcons.xml"].clone())?;
        let names = text.split("iconBaseName=\"").skip(1);
        let names: Vec<&str> = names
            .filter_map(|rest| Some(rest.split_once('"')?.0))
            .collect();
        assert_eq!(names, ["electrical", "electrical_imposed", "mechanical"]);
        for name in names.iter().chain(&["icon"]) {
            assert!(entries[&format!("terminalsAndIcons/{name}.png")].starts_with(b"\x89PNG"));
        }
        Ok(())
    }
}
