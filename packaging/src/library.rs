//! Compiles the Rust crate and links the shared library that is shipped.
//!
//! Rust compiles a static library, `zig cc` links it. Rust's own `cdylib` would need the
//! build machine's glibc and libgcc_s, and would export a symbol that the crate `fmi-sys`
//! leaves behind. Here the glibc is chosen by the platform's row, the unwinder is linked in,
//! and the exported symbols are named one by one.

use std::collections::BTreeSet;
use std::env;
use std::ffi::OsString;
use std::fs;
use std::io::BufReader;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use anyhow::{Context, Result, ensure};
use cargo_metadata::camino::Utf8PathBuf;
use cargo_metadata::{Message, Metadata, MetadataCommand, Package};
use object::BinaryFormat;

use crate::panic_report;
use crate::platform::{PLATFORMS, Platform};
use crate::toolchain::Toolchain;
use crate::zig::{Stand, Zig, said};

/// Compiles the member of the workspace whose library is named `identifier` for the platform, and
/// returns the path of the static library. What the compilation needs besides lies in `folder`.
///
/// # Errors
/// If cargo cannot be started or fails; its own messages went to standard error.
pub fn compile(
    project: &Metadata,
    identifier: &str,
    toolchain: &Toolchain,
    zig: &Zig,
    platform: &Platform,
    folder: &Path,
) -> Result<Utf8PathBuf> {
    let package = member(project, identifier)?;
    let stand = zig.stand_in(platform, folder)?;
    let mut cargo = Command::new(env::var_os("CARGO").unwrap_or_else(|| "cargo".into()))
        .current_dir(&project.workspace_root)
        .arg("rustc")
        .args(["--release", "--locked", "--lib"])
        .args(["--crate-type", "staticlib"])
        .args(["--package", package.name.as_str()])
        .args(["--target", platform.triple])
        .args(["--message-format", "json-render-diagnostics"])
        .env("RUSTC", &toolchain.rustc)
        .envs(c_environment(zig, platform, &stand, folder)?)
        // This replaces RUSTFLAGS, so that the binary does not depend on them.
        .env(
            "CARGO_ENCODED_RUSTFLAGS",
            flags(project, toolchain, platform)?,
        )
        .stdout(Stdio::piped())
        .spawn()
        .context("cannot start cargo")?;
    let messages = cargo.stdout.take().context("cargo has no output")?;
    let mut library = None;
    for message in Message::parse_stream(BufReader::new(messages)) {
        if let Message::CompilerArtifact(artifact) = message.context("cannot read from cargo")?
            && artifact.package_id == package.id
        {
            library = artifact
                .filenames
                .into_iter()
                .find(|file| file.extension() == Some("a"))
                .or(library);
        }
    }
    let status = cargo.wait().context("cargo was lost")?;
    ensure!(
        status.success(),
        "cargo could not compile the library for {} ({status}); see its messages above",
        platform.triple
    );
    library.context("cargo reported no static library")
}

/// Links a static library to a shared library at `output` that exports exactly `names`.
///
/// # Errors
/// If the folder of `output` cannot be written to, or zig refuses to link.
pub fn link(
    zig: &Zig,
    input: &Path,
    output: &Path,
    platform: &Platform,
    names: &[&str],
) -> Result<()> {
    let beside = |extension: &str, contents: &[u8]| -> Result<PathBuf> {
        let path = output.with_extension(extension);
        fs::write(&path, contents).with_context(|| format!("cannot write {}", path.display()))?;
        Ok(path)
    };
    let mut archive =
        fs::read(input).with_context(|| format!("cannot read {}", input.display()))?;
    let reporters = panic_report::undefine_reporters(&mut archive)?;
    let stand_ins = beside("c", panic_report::stand_ins(&reporters).as_bytes())?;
    let mut linker = match platform.format {
        BinaryFormat::MachO => Command::new("cc"),
        _ => zig.cc(platform),
    };
    linker.args(["-shared", "-O2", "-o"]).arg(output);
    match platform.format {
        BinaryFormat::Pe => {
            linker.arg(beside("def", definitions(names).as_bytes())?);
            linker.args(["-s", "-Wl,--gc-sections"]);
        }
        BinaryFormat::MachO => {
            let list: String = names.iter().map(|name| format!("_{name}\n")).collect();
            linker.arg("-exported_symbols_list");
            linker.arg(beside("exports", list.as_bytes())?);
            linker.args(["-arch", "x86_64", "-Wl,-dead_strip", "-Wl,-x"]);
        }
        _ => {
            let mut script = OsString::from("-Wl,--version-script=");
            script.push(beside("exports", version_script(names).as_bytes())?);
            // A missing name is for the inspection to report, with the others.
            linker
                .arg(script)
                .args(["-Wl,--undefined-version", "-Wl,-z,defs"]);
            linker.args(["-s", "-Wl,--gc-sections", "-Wl,--build-id=none"]);
            // glibc and musl have read this table of symbols for long, the older one need not be there too.
            linker.arg("-Wl,--hash-style=gnu");
            // Nothing refers to the exported functions; this takes them out of the archive.
            linker.args(names.iter().map(|name| format!("-Wl,-u,{name}")));
        }
    }
    let archive = beside("a", &archive)?;
    let linked = linker
        .arg(stand_ins)
        .arg(&archive)
        .args(platform.linked.iter().map(|name| format!("-l{name}")))
        .output()
        .context("cannot start the linker")?;
    fs::remove_file(&archive).context("cannot remove the static library")?;
    ensure!(
        linked.status.success(),
        "the linker could not make {}:\n{}",
        output.display(),
        said(&linked)
    );
    Ok(())
}

/// The linker's version script: the names are global, all else is local.
fn version_script(names: &[&str]) -> String {
    let global: String = names.iter().map(|name| format!(" {name};")).collect();
    format!("{{ global:{global} local: *; }};\n")
}

/// Windows' module definition: the names to export.
fn definitions(names: &[&str]) -> String {
    let exports: String = names.iter().map(|name| format!("    {name}\n")).collect();
    format!("EXPORTS\n{exports}")
}

/// The member of the workspace whose library has this name.
pub fn member<'a>(project: &'a Metadata, identifier: &str) -> Result<&'a Package> {
    let has_library = |package: &&Package| {
        let mut targets = package.targets.iter();
        targets.any(|target| target.name == identifier)
    };
    project
        .packages
        .iter()
        .find(has_library)
        .with_context(|| format!("no member of the workspace has a library {identifier}"))
}

/// The package at the root of the workspace, of which every FMU is made.
pub fn root_package(project: &Metadata) -> Result<&Package> {
    project
        .root_package()
        .context("the workspace has no package at its root")
}

/// What the build scripts of dependencies need to handle C for the platform: programs and headers.
fn c_environment(
    zig: &Zig,
    platform: &Platform,
    stand: &Stand,
    folder: &Path,
) -> Result<Vec<(String, OsString)>> {
    let triple = platform.triple.replace('-', "_");
    let usual = env::var_os("PATH").unwrap_or_default();
    let folders = std::iter::once(stand.path.clone()).chain(env::split_paths(&usual));
    let mut variables = vec![
        ("PATH".to_owned(), env::join_paths(folders)?),
        (format!("CC_{triple}"), (&stand.cc).into()),
        (format!("AR_{triple}"), (&stand.ar).into()),
        // zig has the target from its own command line and knows it by another name.
        ("CRATE_CC_NO_DEFAULTS".to_owned(), "1".into()),
    ];
    // bindgen itself watches the variable of the platform it runs on: one that came and went would make
    // cargo compile it, and all that is behind it, anew for each library.
    for headed in [platform, &PLATFORMS[0]] {
        let place = folder.with_file_name(headed.folder);
        fs::create_dir_all(&place).with_context(|| format!("cannot make {}", place.display()))?;
        let headers = clang_arguments(&zig.headers(headed, &place)?)?;
        let triple = headed.triple.replace('-', "_");
        variables.push((format!("BINDGEN_EXTRA_CLANG_ARGS_{triple}"), headers.into()));
    }
    Ok(variables)
}

/// What leads clang to folders of headers and no others, as bindgen reads it: split like a shell does.
fn clang_arguments(folders: &[PathBuf]) -> Result<String> {
    let mut words = vec!["-nostdinc"];
    for folder in folders {
        let unreadable = || {
            format!(
                "the folder of headers {} is no Unicode, which bindgen needs; move the checkout and its .venv",
                folder.display()
            )
        };
        words.extend(["-isystem", folder.to_str().with_context(unreadable)?]);
    }
    shlex::try_join(words).context("a folder of headers has a NUL in its name")
}

/// Compiler flags, one per `\x1f`, that take the build machine's paths out of the binary: those of the
/// workspace, the build folder, the dependencies and the standard library.
///
/// # Errors
/// If cargo cannot resolve the dependencies, or the compiler does not tell where it is.
pub fn flags(project: &Metadata, toolchain: &Toolchain, platform: &Platform) -> Result<String> {
    let mut replaced: Vec<(String, String)> = resolve(project, platform)?
        .packages
        .iter()
        .filter(|package| package.source.is_some())
        .filter_map(|package| package.manifest_path.parent()?.parent())
        .collect::<BTreeSet<_>>()
        .into_iter()
        .map(|folder| (folder.to_string(), "dependencies".to_owned()))
        .collect();
    // The compiler takes the last that fits: the build folder may lie in the workspace.
    replaced.push((project.workspace_root.to_string(), ".".to_owned()));
    replaced.push((project.target_directory.to_string(), "target".to_owned()));
    // Without sources at hand the compiler itself names the standard library's files this way.
    let sysroot = toolchain.sysroot()?;
    let verbose = toolchain.answer(&["--version", "--verbose"])?;
    let commit = verbose
        .lines()
        .find_map(|line| line.strip_prefix("commit-hash: "))
        .unwrap_or("unknown");
    replaced.push((
        format!("{}/lib/rustlib/src/rust", sysroot.display()),
        format!("/rustc/{commit}"),
    ));
    let mut flags: Vec<String> = replaced
        .into_iter()
        .map(|(path, name)| format!("--remap-path-prefix={path}={name}"))
        .collect();
    // Between the baseline and AVX2, `fearless_simd` knows one more level, which gives the same bits. AVX-512
    // gains 5 to 8 % in a single motion, whose steps fill registers of four numbers, and takes 25 kB; ensembles
    // ask for it.
    for level in ["sse4_2", "avx512"] {
        flags.push(format!("--cfg=disable_dispatch_{level}"));
    }
    Ok(flags.join("\x1f"))
}

/// The workspace with its dependencies for the platform.
///
/// # Errors
/// If cargo cannot resolve them.
pub fn resolve(project: &Metadata, platform: &Platform) -> Result<Metadata> {
    MetadataCommand::new()
        .manifest_path(project.workspace_root.join("Cargo.toml"))
        .other_options(["--locked", "--filter-platform", platform.triple].map(String::from))
        .exec()
        .context("cannot resolve the dependencies")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_folder_of_headers_may_have_a_space() -> Result<()> {
        let text = clang_arguments(&["/plain/c++11".into(), "/a folder/it's".into()])?;
        let words = shlex::split(&text).context("no shell would split it")?;
        assert_eq!(
            words,
            [
                "-nostdinc",
                "-isystem",
                "/plain/c++11",
                "-isystem",
                "/a folder/it's"
            ]
        );
        Ok(())
    }
}
