//! Presets: start values as parameter values of SSP (`.ssv`), inside and beside the FMU.

use std::fs;
use std::path::Path;
use std::process::Command;

use anyhow::{Context, Result, ensure};
use cargo_metadata::Metadata;

use crate::archive::Entries;
use crate::toolchain::tool;
use crate::zig::said;

/// What the Python package, which holds the presets, is asked for.
const PROGRAM: &str =
    "import sys; from dielectric_actuator import presets; presets.save_all(sys.argv[1])";

/// Lets the Python package write the presets of every FMU beside the FMUs, and returns those of one by the
/// names of their files.
///
/// # Errors
/// If the Python of the project is not known or cannot run the package, or there is no preset.
pub fn read(project: &Metadata, identifier: &str) -> Result<Entries> {
    let python = tool("PROJECT_PYTHON")?;
    let beside = project.workspace_root.join("target/fmu/presets");
    let folder = beside.join(identifier);
    if folder.exists() {
        // of presets that are gone
        fs::remove_dir_all(&folder).with_context(|| format!("cannot remove {folder}"))?;
    }
    let written = Command::new(&python)
        .env("PYTHONPATH", project.workspace_root.join("python"))
        .env("PYTHONDONTWRITEBYTECODE", "1")
        .args(["-c", PROGRAM, beside.as_str()])
        .output()
        .with_context(|| format!("cannot start {}", python.display()))?;
    ensure!(
        written.status.success(),
        "the presets could not be written:\n{}",
        said(&written)
    );
    let mut presets = Entries::new();
    let mut read = |folder: &Path| -> Result<()> {
        for entry in fs::read_dir(folder)? {
            let entry = entry?;
            let name = entry.file_name().to_string_lossy().into_owned();
            presets.insert(name, fs::read(entry.path())?);
        }
        Ok(())
    };
    read(folder.as_std_path()).with_context(|| format!("cannot read {folder}"))?;
    ensure!(!presets.is_empty(), "no preset in {folder}");
    Ok(presets)
}

/// Where the presets are inside the FMU: among its resources.
pub fn inside(presets: &Entries) -> Entries {
    presets
        .iter()
        .map(|(name, bytes)| (format!("resources/presets/{name}"), bytes.clone()))
        .collect()
}
