//! The licences of what is linked into the binaries: our own, those of the crates, of Rust's standard
//! library and of the libraries that the linker adds.

use std::collections::{BTreeMap, BTreeSet};
use std::env;
use std::fs;
use std::path::PathBuf;
use std::process::Command;

use anyhow::{Context, Result, ensure};
use cargo_metadata::semver::Version;
use cargo_metadata::{Metadata, Package};
use object::BinaryFormat;

use crate::archive::Entries;
use crate::library;
use crate::platform::Platform;
use crate::toolchain::Toolchain;
use crate::zig::{Zig, said};

/// Folder in the FMU.
const FOLDER: &str = "documentation/licenses";

/// What FMI 2.0 has a reader open first. `packaging/release.py` reads the crates from it.
const LIST: &str = "license.txt";

/// Beginnings, in upper case, of the names of files that hold a licence.
const NAMES: &[&str] = &[
    "LICENSE",
    "LICENCE",
    "COPYING",
    "COPYRIGHT",
    "NOTICE",
    "UNLICENSE",
];

/// Adds the licences of what is linked into the binaries of a package.
///
/// # Errors
/// If a licence that must be there cannot be read, or a crate names none.
pub fn add(
    entries: &mut Entries,
    project: &Metadata,
    toolchain: &Toolchain,
    zig: &Zig,
    platforms: &[&Platform],
    package: &Package,
) -> Result<()> {
    let rust = toolchain
        .sysroot()?
        .join("share/doc/rust/COPYRIGHT-library.html");
    let libraries = zig.libraries()?;
    let mut files = vec![
        (
            "LICENSE-APACHE.txt",
            project.workspace_root.join("LICENSE-APACHE").into(),
        ),
        (
            "LICENSE-MIT.txt",
            project.workspace_root.join("LICENSE-MIT").into(),
        ),
        (
            "llvm-libunwind.txt",
            libraries.join("libunwind/LICENSE.TXT"),
        ),
        ("rust-standard-library.html", rust),
    ];
    if platforms
        .iter()
        .any(|platform| platform.format == BinaryFormat::Pe)
    {
        files.push(("mingw-w64.txt", libraries.join("libc/mingw/COPYING")));
    }
    for (name, path) in &files {
        let bytes = fs::read(path).with_context(|| format!("cannot read {}", path.display()))?;
        entries.insert(format!("{FOLDER}/{name}"), bytes);
    }
    let others: Vec<&str> = files.iter().skip(2).map(|(name, _)| *name).collect();
    let heading = format!(
        "MIT (LICENSE-MIT.txt) or Apache-2.0 (LICENSE-APACHE.txt), at your choice.\n\n\
         Linked into the binaries: {}, which are files beside this one, and these crates.",
        others.join(", ")
    );
    let linked = linked(project, platforms, package.name.as_str())?;
    entries.insert(
        format!("{FOLDER}/{LIST}"),
        listed(&heading, &linked)?.into(),
    );
    Ok(())
}

/// What the live page has to say of the crates in its WebAssembly, and of our own licences.
///
/// # Errors
/// If cargo does not tell which they are, or a licence cannot be read.
pub fn of_the_page(project: &Metadata, browser: &Platform, package: &str) -> Result<String> {
    let linked = linked(project, &[browser], package)?;
    let mut text = String::from(
        "The page and the actuator in it: MIT or Apache-2.0, at your choice. Rust's standard \
         library, of which parts are in the WebAssembly: the same.\n\n",
    );
    let ours = project.workspace_root.join("LICENSE-MIT");
    text += &fs::read_to_string(&ours).with_context(|| format!("cannot read {ours}"))?;
    text += "\n";
    text += &listed(
        "Crates that are linked into the WebAssembly, with their licences.",
        &linked,
    )?;
    Ok(text)
}

/// Packages by name and version.
type Linked = BTreeMap<(String, Version), Package>;

/// The crates of others that are linked into a package for the platforms: normal dependencies, no compile-time ones.
/// Cargo's tree tells which; its metadata has the features that any member of the workspace asks for.
fn linked(project: &Metadata, platforms: &[&Platform], package: &str) -> Result<Linked> {
    let mut linked = Linked::new();
    for platform in platforms {
        let answer = Command::new(env::var_os("CARGO").unwrap_or_else(|| "cargo".into()))
            .current_dir(&project.workspace_root)
            .args(["tree", "--locked", "--package", package])
            .args(["--target", platform.triple])
            .args(["--edges", "normal,no-proc-macro"])
            .args(["--prefix", "none", "--format", "{p}"])
            .output()
            .context("cannot start cargo")?;
        ensure!(answer.status.success(), "cargo tree: {}", said(&answer));
        let tree = String::from_utf8(answer.stdout).context("cargo answered no text")?;
        // Lines such as "serde v1.0.228 (*)".
        let inside: BTreeSet<(&str, &str)> = tree
            .lines()
            .filter_map(|line| {
                let mut words = line.split(' ');
                Some((words.next()?, words.next()?.strip_prefix('v')?))
            })
            .collect();
        linked.extend(
            library::resolve(project, platform)?
                .packages
                .into_iter()
                .filter(|one| one.source.is_some())
                .filter(|one| inside.contains(&(one.name.as_str(), &*one.version.to_string())))
                .map(|one| ((one.name.to_string(), one.version.clone()), one)),
        );
    }
    ensure!(
        !linked.is_empty(),
        "cargo tree lists no crate that is linked into {package}"
    );
    Ok(linked)
}

/// The packages with their licences, then the texts, each once.
fn listed(heading: &str, linked: &Linked) -> Result<String> {
    let mut list = format!("{heading}\n\n");
    let mut texts: BTreeMap<String, Vec<String>> = BTreeMap::new();
    for ((name, version), package) in linked {
        let terms = package.license.as_deref();
        let mut files = licence_files(package)?;
        // Where MIT may be chosen, it is; the others' long text would be there ten times.
        let is_of = |file: &PathBuf, name: &str| {
            let file = file.file_name().unwrap_or_default().to_string_lossy();
            file.to_uppercase().contains(name)
        };
        if terms.is_some_and(|terms| terms.contains(" OR "))
            && files.iter().any(|file| is_of(file, "MIT"))
        {
            files.retain(|file| !is_of(file, "APACHE"));
        }
        ensure!(
            terms.is_some() || !files.is_empty(),
            "the crate {name} {version} names no licence"
        );
        list += &format!("{name} {version}: {}\n", terms.unwrap_or("see below"));
        for file in files {
            let text = fs::read_to_string(&file)
                .with_context(|| format!("cannot read {}", file.display()))?;
            let text = text.replace("\r\n", "\n").trim().to_owned();
            texts
                .entry(text)
                .or_default()
                .push(format!("{name} {version}"));
        }
    }
    for (text, names) in texts {
        let line = "=".repeat(80);
        list += &format!("\n{line}\n{}\n{line}\n\n{text}\n", names.join(", "));
    }
    Ok(list)
}

/// The files of a crate that hold a licence, by name.
fn licence_files(package: &Package) -> Result<Vec<PathBuf>> {
    let folder = package
        .manifest_path
        .parent()
        .context("a package has a folder")?;
    let mut files = Vec::new();
    for entry in fs::read_dir(folder).with_context(|| format!("cannot list {folder}"))? {
        let path = entry?.path();
        let name = path
            .file_name()
            .unwrap_or_default()
            .to_string_lossy()
            .to_uppercase();
        if path.is_file() && NAMES.iter().any(|start| name.starts_with(start)) {
            files.push(path);
        }
    }
    files.sort();
    Ok(files)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::platform::PLATFORMS;
    use crate::{page, project};

    fn names(platforms: &[&Platform], package: &str) -> Result<BTreeSet<String>> {
        let linked = linked(&project()?, platforms, package)?;
        Ok(linked.into_keys().map(|(name, _)| name).collect())
    }

    #[test]
    fn what_another_package_or_platform_asks_for_is_not_linked() -> Result<()> {
        let page = names(&[&page::BROWSER], page::PACKAGE)?;
        let linux = names(&[&PLATFORMS[0]], "nondimensional-fmu")?;
        let both = names(&[&PLATFORMS[0], &PLATFORMS[1]], "nondimensional-fmu")?;
        let native = names(&[&PLATFORMS[0]], "dielectric-actuator-native")?;
        assert!(page.contains("nalgebra") && !page.contains("fmi") && !page.contains("libc"));
        assert!(linux.contains("fmi") && !linux.contains("rayon") && native.contains("rayon"));
        assert!(page.is_subset(&linux) && linux.is_subset(&both) && linux != both);
        for built_with in ["serde_derive", "bindgen", "proptest", "clap", "page-core"] {
            assert!(!both.contains(built_with), "{built_with}");
        }
        Ok(())
    }
}
