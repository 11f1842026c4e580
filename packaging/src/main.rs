//! `cargo fmu`: builds the shared library for each platform, refuses a bad one, and packs the
//! FMU; `cargo fmu describe`: writes the checked-in `modelDescription/*.xml`.
#![forbid(unsafe_code)]

mod archive;
mod guide;
mod icon;
mod inspect;
mod library;
mod licences;
mod page;
mod panic_report;
mod platform;
mod presets;
mod terminals;
mod toolchain;
mod zig;

use std::fs;
use std::path::Path;
use std::process::ExitCode;

use anyhow::{Context, Result, ensure};
use cargo_metadata::camino::Utf8Path;
use cargo_metadata::{Metadata, MetadataCommand};
use clap::{Parser, Subcommand};
use dielectric_elastomer_actuator::description;
use dielectric_elastomer_actuator::fmi2::EXPORTED_NAMES;
use dielectric_elastomer_actuator::model::Model;
use dielectric_elastomer_actuator::nondimensional::Nondimensional;
use dielectric_elastomer_actuator::si::Si;

use archive::Entries;
use inspect::Binary;
use platform::{PLATFORMS, Platform};
use toolchain::{Toolchain, tool};
use zig::Zig;

/// An FMU that is shipped: a member of the workspace below `fmus`.
struct Fmu {
    /// The name of the FMU, of the binary in it and of the member's library.
    identifier: &'static str,
    /// What it does, for the head of its guide.
    about: &'static str,
    /// Writes its model description.
    xml: fn() -> String,
    /// Writes the table of its variables for the guide.
    variables: fn() -> String,
    /// Writes what describes its terminals, and their icons.
    terminals: fn() -> Result<Entries>,
}

impl Fmu {
    const fn of<M: Model>(about: &'static str) -> Fmu {
        Fmu {
            identifier: M::IDENTIFIER,
            about,
            xml: description::xml::<M>,
            variables: guide::variables::table::<M>,
            terminals: terminals::entries::<M>,
        }
    }

    /// The checked-in description, relative to the workspace.
    fn description(&self) -> String {
        format!("modelDescription/{}.xml", self.identifier)
    }
}

/// Every FMU that is shipped.
const FMUS: &[Fmu] = &[
    Fmu::of::<Nondimensional>(
        "This FMU computes how it moves in nondimensional quantities, from voltage and prestress to stretch, \
         with surface effects, pull-in and an alternating voltage built in.",
    ),
    Fmu::of::<Si>(
        "This FMU computes how it moves in SI units, from volts and newtons to coulombs and metres, with an \
         electrical and a mechanical port, losses, stiffening, pull-in, breakdown and an alternating voltage \
         built in.",
    ),
];

/// Build, check and pack the FMU
#[derive(Parser)]
#[command(name = "cargo fmu", bin_name = "cargo fmu")]
struct Arguments {
    /// What to do; `pack` if nothing is said
    #[command(subcommand)]
    verb: Option<Verb>,
    /// Build for every platform that can be built for here, not for 64-bit Linux only
    #[arg(long, global = true)]
    all: bool,
}

#[derive(Subcommand)]
enum Verb {
    /// Pack the FMU into target/fmu
    Pack,
    /// Write the description of each FMU into modelDescription
    Describe,
    /// Write the user's guide of each FMU to target/guide
    Guide,
    /// Build the library that carries the core into Python, in target/native
    Native,
    /// Write the live page to target/page
    Page,
}

fn main() -> ExitCode {
    let arguments = Arguments::parse();
    let outcome = match arguments.verb.unwrap_or(Verb::Pack) {
        Verb::Pack => pack(arguments.all),
        Verb::Describe => describe(),
        Verb::Guide => write_guide(),
        Verb::Native => native(arguments.all),
        Verb::Page => write_page(),
    };
    match outcome {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error:#}");
            ExitCode::FAILURE
        }
    }
}

/// The names that the library for Python exports.
const NATIVE_NAMES: &[&str] = &[
    "dea_known_names",
    "dea_scene_names",
    "dea_sensitivities",
    "dea_sweep",
];

/// Packs each FMU, of one platform or of every one that can be built for, and prints what was packed.
fn pack(all: bool) -> Result<()> {
    let project = project()?;
    // Known to be there before the long compilation.
    let zig = Zig::find()?;
    let count = if all { PLATFORMS.len() } else { 1 };
    let (built, missing) = toolchains(&PLATFORMS[..count])?;
    let platforms: Vec<&Platform> = built.iter().map(|(platform, _)| *platform).collect();
    let mut shared = Entries::new();
    shared.insert("model.png".into(), icon::png()?);
    let without_page = match tool("NODE") {
        Ok(_) => {
            let page = page::html(&project)
                .context("cannot make the live page; to pack without it, leave NODE unset")?;
            shared.insert(format!("documentation/{}", page::NAME), page.into());
            String::new()
        }
        Err(error) => format!("  documentation/{}: not packed. {error:#}\n", page::NAME),
    };
    let with_page = without_page.is_empty();
    let core = library::root_package(&project)?;
    licences::add(&mut shared, &project, &built[0].1, &zig, &platforms, core)?;
    for fmu in FMUS {
        let mut entries = shared.clone();
        let guide = guide::html(project.workspace_root.as_std_path(), fmu, with_page)?;
        entries.insert("documentation/index.html".into(), guide.into());
        pack_one(fmu, entries, &project, &zig, &built)?;
    }
    print!("{missing}{without_page}");
    Ok(())
}

/// Packs one FMU with what all of them share, and prints what was packed.
fn pack_one(
    fmu: &Fmu,
    mut entries: Entries,
    project: &Metadata,
    zig: &Zig,
    built: &[(&Platform, Toolchain)],
) -> Result<()> {
    let folder = project.workspace_root.join("target/fmu");
    entries.insert("modelDescription.xml".into(), (fmu.xml)().into());
    entries.extend((fmu.terminals)()?);
    let presets = presets::read(project, fmu.identifier)?;
    entries.extend(presets::inside(&presets));
    let library = Library {
        identifier: fmu.identifier,
        names: EXPORTED_NAMES,
    };
    let mut report = String::new();
    for (platform, toolchain) in built {
        let file = library.file(platform);
        let place = folder.join(platform.folder);
        let bytes = library.build(project, toolchain, zig, platform, place.as_std_path())?;
        report += &check(&bytes, platform, EXPORTED_NAMES)
            .with_context(|| format!("{place}/{file} is refused"))?;
        entries.insert(format!("binaries/{}/{file}", platform.folder), bytes);
    }
    let path = folder.join(format!("{}.fmu", fmu.identifier));
    archive::write(path.as_std_path(), &entries)?;
    let size = fs::metadata(&path).map_or(0, |metadata| metadata.len());
    println!("{path}: {}, {} files", kibibytes(size), entries.len());
    print!("{report}");
    Ok(())
}

/// The platforms that can be built for, each with its compiler, and a line on each of the others.
fn toolchains(platforms: &[Platform]) -> Result<(Vec<(&Platform, Toolchain)>, String)> {
    let mut built = Vec::new();
    let mut missing = String::new();
    for platform in platforms {
        match Toolchain::find(platform) {
            Ok(toolchain) => built.push((platform, toolchain)),
            Err(error) => missing += &format!("  {}: not packed. {error:#}\n", platform.folder),
        }
    }
    ensure!(
        !built.is_empty(),
        "there is no platform to build for:\n{missing}"
    );
    Ok((built, missing))
}

/// A shared library that is built for many platforms.
struct Library<'a> {
    /// What it is called, and the library of the workspace that it is made of.
    identifier: &'a str,
    /// What it exports.
    names: &'a [&'a str],
}

impl Library<'_> {
    /// Builds the library for a platform in `folder` and returns its bytes.
    fn build(
        &self,
        project: &Metadata,
        toolchain: &Toolchain,
        zig: &Zig,
        platform: &Platform,
        folder: &Path,
    ) -> Result<Vec<u8>> {
        fs::create_dir_all(folder).with_context(|| format!("cannot make {}", folder.display()))?;
        let shared = folder.join(self.file(platform));
        // One place for every library of a platform, or cargo would compile the same crates anew for each.
        let besides = project
            .target_directory
            .join("zig")
            .join(platform.folder)
            .into_std_path_buf();
        let archive =
            library::compile(project, self.identifier, toolchain, zig, platform, &besides)?;
        library::link(zig, archive.as_std_path(), &shared, platform, self.names)?;
        fs::read(&shared).with_context(|| format!("cannot read {}", shared.display()))
    }

    /// What its file is called on a platform.
    fn file(&self, platform: &Platform) -> String {
        format!("{}.{}", self.identifier, platform.extension)
    }
}

/// Builds the library that carries the core into Python, and prints what was built.
fn native(all: bool) -> Result<()> {
    let project = project()?;
    let zig = Zig::find()?;
    let library = Library {
        identifier: "dielectric_actuator_native",
        names: NATIVE_NAMES,
    };
    let folder = project.workspace_root.join("target/native");
    let count = if all { PLATFORMS.len() } else { 1 };
    let (built, missing) = toolchains(&PLATFORMS[..count])?;
    if folder.exists() {
        // of platforms that are not built for, whose licences would not be there
        fs::remove_dir_all(&folder).with_context(|| format!("cannot remove {folder}"))?;
    }
    println!("{folder}:");
    for (platform, toolchain) in &built {
        let place = folder.join(platform.folder);
        let bytes = library.build(&project, toolchain, &zig, platform, place.as_std_path())?;
        let report = check(&bytes, platform, NATIVE_NAMES)
            .with_context(|| format!("{place}/{} is refused", library.file(platform)))?;
        print!("{report}");
    }
    let mut licences = Entries::new();
    let platforms: Vec<&Platform> = built.iter().map(|(platform, _)| *platform).collect();
    let package = library::member(&project, library.identifier)?;
    licences::add(
        &mut licences,
        &project,
        &built[0].1,
        &zig,
        &platforms,
        package,
    )?;
    for (name, bytes) in licences {
        write(&folder.join(name), bytes)?;
    }
    print!("{missing}");
    Ok(())
}

/// Writes the user's guide of each FMU, with the live page beside it where there is one.
fn write_guide() -> Result<()> {
    let project = project()?;
    let page = fs::read(project.target_directory.join("page/index.html")).ok();
    for fmu in FMUS {
        let folder = project.target_directory.join("guide").join(fmu.identifier);
        let path = folder.join("index.html");
        let text = guide::html(project.workspace_root.as_std_path(), fmu, page.is_some())?;
        write(&path, text)?;
        if let Some(page) = &page {
            write(&folder.join(page::NAME), page)?;
        }
        println!("{path}");
    }
    Ok(())
}

/// Writes the live page.
fn write_page() -> Result<()> {
    let project = project()?;
    let size = page::html(&project)?.len() as u64;
    println!(
        "{}: {}",
        project.target_directory.join("page/index.html"),
        kibibytes(size)
    );
    Ok(())
}

/// The report on a shared library, a line each; an error with every fault if it has one.
fn check(bytes: &[u8], platform: &Platform, names: &[&str]) -> Result<String> {
    let binary = Binary::read(bytes)?;
    let faults = binary.faults(platform, names);
    ensure!(faults.is_empty(), "{}", faults.join(";\n  "));
    let glibc = binary
        .newest_glibc()
        .map_or_else(|| "none".to_owned(), |version| version.to_string());
    let libraries: Vec<&str> = binary.libraries.iter().map(String::as_str).collect();
    Ok(format!(
        "  {}: {}, {} names exported, newest glibc needed: {glibc}, libraries needed: {}\n",
        platform.folder,
        kibibytes(binary.size as u64),
        binary.exported.len(),
        libraries.join(" ")
    ))
}

/// Writes each description to its place in the workspace.
fn describe() -> Result<()> {
    let root = project()?.workspace_root;
    for fmu in FMUS {
        write(&root.join(fmu.description()), (fmu.xml)())?;
        println!("{} is written", fmu.description());
    }
    Ok(())
}

/// Writes a file, and the folder that it is in.
fn write(path: &Utf8Path, contents: impl AsRef<[u8]>) -> Result<()> {
    if let Some(folder) = path.parent() {
        fs::create_dir_all(folder).with_context(|| format!("cannot make {folder}"))?;
    }
    fs::write(path, contents).with_context(|| format!("cannot write {path}"))
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
    use super::*;

    #[test]
    fn what_cannot_be_written_is_named() {
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/Cargo.toml/folder/file");
        let error = write(Utf8Path::new(path), "").expect_err("a file is no folder");
        assert!(error.to_string().contains("/Cargo.toml/folder"), "{error}");
    }
}
