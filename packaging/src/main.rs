//! `cargo fmu`: builds the shared library for each platform, refuses a bad one, and packs the
//! FMU; `cargo fmu describe`: writes the checked-in `modelDescription.xml`.

mod archive;
mod inspect;
mod library;
mod platform;

use std::fs;
use std::path::Path;
use std::process::ExitCode;

use anyhow::{Context, Result, bail, ensure};
use cargo_metadata::{Metadata, MetadataCommand};
use clap::{Parser, Subcommand};
use dielectric_elastomer_actuator::abi::EXPORTED_NAMES;
use dielectric_elastomer_actuator::description::{self, MODEL_IDENTIFIER};

use archive::Entries;
use inspect::Binary;
use library::Linker;
use platform::{PLATFORMS, Platform};

/// The checked-in description, relative to the workspace.
const DESCRIPTION: &str = "modelDescription/modelDescription.xml";

/// Files that are packed as they are: path in the FMU, path in the workspace.
const ATTACHMENTS: &[(&str, &str)] = &[
    (
        "documentation/index.html",
        "packaging/documentation/index.html",
    ),
    (
        "documentation/licenses/LICENSE-APACHE.txt",
        "LICENSE-APACHE",
    ),
    ("documentation/licenses/LICENSE-MIT.txt", "LICENSE-MIT"),
];

/// Build, check and pack the FMU
#[derive(Parser)]
#[command(name = "cargo fmu", bin_name = "cargo fmu")]
struct Arguments {
    /// What to do; `pack` if nothing is said
    #[command(subcommand)]
    verb: Option<Verb>,
}

#[derive(Subcommand)]
enum Verb {
    /// Pack the FMU into target/fmu
    Pack,
    /// Write modelDescription/modelDescription.xml
    Describe {
        /// Write nothing, fail if the checked-in file differs
        #[arg(long)]
        check: bool,
    },
}

fn main() -> ExitCode {
    let arguments = Arguments::parse();
    let outcome = match arguments.verb.unwrap_or(Verb::Pack) {
        Verb::Pack => pack(),
        Verb::Describe { check } => describe(check),
    };
    match outcome {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error:#}");
            ExitCode::FAILURE
        }
    }
}

/// Packs the FMU of every platform and prints what was packed.
fn pack() -> Result<()> {
    let project = project()?;
    // Known to be there before the long compilation.
    let linker = Linker::find()?;
    let folder = project.workspace_root.join("target/fmu");
    let mut entries = Entries::new();
    entries.insert("modelDescription.xml".into(), description::xml().into());
    for (name, source) in ATTACHMENTS {
        let source = project.workspace_root.join(source);
        let bytes = fs::read(&source).with_context(|| format!("cannot read {source}"))?;
        entries.insert((*name).into(), bytes);
    }
    let mut report = String::new();
    for platform in PLATFORMS {
        let file = format!("{MODEL_IDENTIFIER}.{}", platform.extension);
        let shared = folder.join(platform.folder).join(&file);
        let bytes = build(&project, &linker, platform, shared.as_std_path())?;
        report += &check(&bytes, platform).with_context(|| format!("{shared} is refused"))?;
        entries.insert(format!("binaries/{}/{file}", platform.folder), bytes);
    }
    let path = folder.join(format!("{MODEL_IDENTIFIER}.fmu"));
    archive::write(path.as_std_path(), &entries)?;
    let size = fs::metadata(&path).map_or(0, |metadata| metadata.len());
    println!("{path}: {}, {} files", kibibytes(size), entries.len());
    print!("{report}");
    Ok(())
}

/// Builds the shared library of a platform and returns its bytes.
fn build(
    project: &Metadata,
    linker: &Linker,
    platform: &Platform,
    shared: &Path,
) -> Result<Vec<u8>> {
    let archive = library::compile(project, platform)?;
    linker.link(archive.as_std_path(), shared, platform, EXPORTED_NAMES)?;
    fs::read(shared).with_context(|| format!("cannot read {}", shared.display()))
}

/// The report on a shared library, a line each; an error with every fault if it has one.
fn check(bytes: &[u8], platform: &Platform) -> Result<String> {
    let binary = Binary::read(bytes)?;
    let faults = binary.faults(platform, EXPORTED_NAMES);
    ensure!(faults.is_empty(), "{}", faults.join(";\n  "));
    let glibc = binary
        .newest_glibc()
        .map_or_else(|| "none".to_owned(), |version| version.to_string());
    let libraries: Vec<&str> = binary.libraries.iter().map(String::as_str).collect();
    Ok(format!(
        "  {}: {}, {} names exported, newest glibc needed {glibc}, libraries needed {}\n",
        platform.folder,
        kibibytes(binary.size as u64),
        binary.exported.len(),
        libraries.join(" ")
    ))
}

/// Writes the description to its place in the workspace, or compares the two.
fn describe(check: bool) -> Result<()> {
    let path = project()?.workspace_root.join(DESCRIPTION);
    let text = description::xml();
    if !check {
        if let Some(folder) = path.parent() {
            fs::create_dir_all(folder).with_context(|| format!("cannot make {folder}"))?;
        }
        fs::write(&path, text).with_context(|| format!("cannot write {path}"))?;
        println!("{path} is written");
        return Ok(());
    }
    let present = fs::read_to_string(&path)
        .with_context(|| format!("cannot read {path}; run `cargo fmu describe`"))?;
    if let Some(line) = first_difference(&present, &text) {
        bail!(
            "{path} differs from the variable table, first in line {line}; run `cargo fmu describe`"
        );
    }
    println!("{path} is up to date");
    Ok(())
}

/// Number of the first line, from 1, in which two texts differ.
fn first_difference(one: &str, other: &str) -> Option<usize> {
    if one == other {
        return None;
    }
    let equal = one
        .split('\n')
        .zip(other.split('\n'))
        .take_while(|(left, right)| left == right);
    Some(equal.count() + 1)
}

/// The workspace that the current folder belongs to.
fn project() -> Result<Metadata> {
    MetadataCommand::new()
        .no_deps()
        .exec()
        .context("cannot read the workspace; run this inside the checkout")
}

fn kibibytes(bytes: u64) -> String {
    format!("{} KiB", bytes.div_ceil(1024))
}

#[cfg(test)]
mod tests {
    use super::first_difference;

    #[test]
    fn first_difference_counts_lines_from_one() {
        assert_eq!(first_difference("a\nb\n", "a\nb\n"), None);
        assert_eq!(first_difference("a\nb\n", "a\nc\n"), Some(2));
        assert_eq!(first_difference("a\n", "a\nb\n"), Some(2));
        assert_eq!(first_difference("", "a\n"), Some(1));
    }
}
