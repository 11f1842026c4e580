//! Presets: start values as parameter values of SSP (`.ssv`), inside and beside the FMU.

use std::fs;
use std::path::Path;

use anyhow::{Context, Result};
use cargo_metadata::Metadata;

use crate::archive::Entries;

/// The presets of an FMU by the names of their files; none where it has no folder of them.
///
/// # Errors
/// If the folder cannot be read.
pub fn read(project: &Metadata, identifier: &str) -> Result<Entries> {
    let folder = project
        .workspace_root
        .join(format!("fmus/{identifier}/presets"));
    let mut presets = Entries::new();
    if !folder.is_dir() {
        return Ok(presets);
    }
    let mut read = || -> Result<()> {
        for entry in fs::read_dir(&folder)? {
            let entry = entry?;
            let name = entry.file_name().to_string_lossy().into_owned();
            presets.insert(name, fs::read(entry.path())?);
        }
        Ok(())
    };
    read().with_context(|| format!("cannot read {folder}"))?;
    Ok(presets)
}

/// Where the presets are inside the FMU: among its resources.
pub fn inside(presets: &Entries) -> Entries {
    presets
        .iter()
        .map(|(name, bytes)| (format!("resources/presets/{name}"), bytes.clone()))
        .collect()
}

/// Writes the presets to a folder beside the FMU.
///
/// # Errors
/// If the folder cannot be written to.
pub fn write(presets: &Entries, folder: &Path) -> Result<()> {
    if presets.is_empty() {
        return Ok(());
    }
    fs::create_dir_all(folder).with_context(|| format!("cannot make {}", folder.display()))?;
    for (name, bytes) in presets {
        let path = folder.join(name);
        fs::write(&path, bytes).with_context(|| format!("cannot write {}", path.display()))?;
    }
    Ok(())
}
