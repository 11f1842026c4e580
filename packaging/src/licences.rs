//! The licences of what is linked into the binaries: our own, those of the crates, of Rust's standard
//! library and of the libraries that the linker adds.

use std::collections::{BTreeMap, BTreeSet};
use std::env;
use std::fs;
use std::path::PathBuf;
use std::process::Command;

use anyhow::{Context, Result, ensure};
use cargo_metadata::semver::Version;
use cargo_metadata::{DependencyKind, Metadata, Package, PackageId};
use object::BinaryFormat;

use crate::archive::Entries;
use crate::library;
use crate::platform::Platform;
use crate::toolchain::Toolchain;
use crate::zig::{Zig, said};

/// Folder in the FMU.
const FOLDER: &str = "documentation/licenses";

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
    for (name, path) in files {
        let bytes = fs::read(&path).with_context(|| format!("cannot read {}", path.display()))?;
        entries.insert(format!("{FOLDER}/{name}"), bytes);
    }
    entries.insert(
        format!("{FOLDER}/crates.txt"),
        crates(project, platforms, package)?.into(),
    );
    Ok(())
}

/// Every linked crate with its version and licence, then the texts, each once.
fn crates(project: &Metadata, platforms: &[&Platform], package: &Package) -> Result<String> {
    let mut linked = Linked::new();
    for platform in platforms {
        let resolved = library::resolve(project, platform)?;
        for package in linked_packages(&resolved, package)? {
            linked.insert(
                (package.name.to_string(), package.version.clone()),
                package.clone(),
            );
        }
    }
    listed(
        "Crates that are linked into the binaries, with their licences.",
        &linked,
    )
}

/// What the live page has to say of the crates in its WebAssembly, and of our own licences.
///
/// # Errors
/// If cargo does not tell which they are, or a licence cannot be read.
pub fn of_the_page(project: &Metadata, browser: &Platform, package: &str) -> Result<String> {
    let answer = Command::new(env::var_os("CARGO").unwrap_or_else(|| "cargo".into()))
        .current_dir(&project.workspace_root)
        .args(["tree", "--locked", "--package", package])
        .args(["--target", browser.triple])
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
    let resolved = library::resolve(project, browser)?;
    let linked: Linked = resolved
        .packages
        .iter()
        .filter(|one| one.source.is_some())
        .filter(|one| inside.contains(&(one.name.as_str(), &*one.version.to_string())))
        .map(|one| ((one.name.to_string(), one.version.clone()), one.clone()))
        .collect();
    ensure!(
        !linked.is_empty(),
        "{package} is linked with nothing: {tree}"
    );
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

/// The packages below `root` that are linked: normal dependencies, no compile-time ones.
fn linked_packages<'a>(resolved: &'a Metadata, root: &Package) -> Result<Vec<&'a Package>> {
    let packages: BTreeMap<&PackageId, &Package> = resolved
        .packages
        .iter()
        .map(|package| (&package.id, package))
        .collect();
    let graph = resolved
        .resolve
        .as_ref()
        .context("cargo resolved nothing")?;
    let mut seen = BTreeSet::new();
    let mut ahead = vec![&root.id];
    while let Some(id) = ahead.pop() {
        let compile_time = packages[id]
            .targets
            .iter()
            .any(|target| target.is_proc_macro());
        if compile_time || !seen.insert(id) {
            continue;
        }
        let node = graph.nodes.iter().find(|node| &node.id == id);
        for dependency in node.into_iter().flat_map(|node| &node.deps) {
            let normal = |kind: &cargo_metadata::DepKindInfo| kind.kind == DependencyKind::Normal;
            if dependency.dep_kinds.iter().any(normal) {
                ahead.push(&dependency.pkg);
            }
        }
    }
    seen.remove(&root.id);
    Ok(seen.into_iter().map(|id| packages[id]).collect())
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
