//! Compiles the Rust crate and links the shared library that is shipped.
//!
//! Rust compiles a static library, `zig cc` links it. Rust's own `cdylib` would need the
//! build machine's glibc and libgcc_s, and would export a symbol that the crate `fmi-sys`
//! leaves behind. Here the glibc is chosen by the platform's row, the unwinder is linked in,
//! and a version script names the exported symbols one by one.

use std::collections::BTreeSet;
use std::env;
use std::ffi::{OsStr, OsString};
use std::fs;
use std::io::BufReader;
use std::path::Path;
use std::process::{Command, Output, Stdio};

use anyhow::{Context, Result, ensure};
use cargo_metadata::camino::Utf8PathBuf;
use cargo_metadata::{Message, Metadata, MetadataCommand, Package};

use crate::platform::Platform;

/// Compiles the root package for the platform and returns the path of the static library.
///
/// # Errors
/// If cargo cannot be started or fails; its own messages went to standard error.
pub fn compile(project: &Metadata, platform: &Platform) -> Result<Utf8PathBuf> {
    let package = root_package(project)?;
    let mut cargo = Command::new(program("CARGO", "cargo"))
        .current_dir(&project.workspace_root)
        .args(["rustc", "--release", "--locked", "--lib"])
        .args(["--crate-type", "staticlib"])
        .args(["--package", package.name.as_str()])
        .args(["--target", platform.triple])
        .args(["--message-format", "json-render-diagnostics"])
        // This replaces RUSTFLAGS, so that the binary does not depend on them.
        .env("CARGO_ENCODED_RUSTFLAGS", remappings(project, platform)?)
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

/// The linker `zig cc`, which brings the libraries to link against for every target.
pub struct Linker {
    /// The command line that starts zig: a program, then arguments.
    zig: Vec<String>,
}

impl Linker {
    /// Finds zig: the environment variable `ZIG`, a command line split like a shell does, or
    /// the PyPI package `ziglang`.
    ///
    /// # Errors
    /// If zig does not tell its version.
    pub fn find() -> Result<Self> {
        let line = env::var("ZIG").unwrap_or_else(|_| "python3 -m ziglang".to_owned());
        let zig = shlex::split(&line)
            .filter(|words| !words.is_empty())
            .with_context(|| format!("ZIG is set to `{line}`, which is no command line"))?;
        let linker = Self { zig };
        let advice = || {
            format!(
                "cannot run the linker zig as `{line}`: install it, as `make fmu` does or by \
                 `python3 -m pip install ziglang`, or set the environment variable ZIG to the \
                 command line that starts it"
            )
        };
        let answer = linker
            .command()
            .arg("version")
            .output()
            .with_context(advice)?;
        ensure!(answer.status.success(), "{}: {}", advice(), said(&answer));
        Ok(linker)
    }

    /// Links a static library to a shared library at `output` that exports exactly `names`.
    ///
    /// # Errors
    /// If the folder of `output` cannot be written to, or zig refuses to link.
    pub fn link(
        &self,
        input: &Path,
        output: &Path,
        platform: &Platform,
        names: &[&str],
    ) -> Result<()> {
        let exports = output.with_extension("exports");
        if let Some(folder) = output.parent() {
            fs::create_dir_all(folder)
                .with_context(|| format!("cannot make the folder {}", folder.display()))?;
        }
        fs::write(&exports, version_script(names))
            .with_context(|| format!("cannot write {}", exports.display()))?;
        let mut script = OsString::from("-Wl,--version-script=");
        script.push(&exports);
        let linked = self
            .command()
            .args(["cc", "-target", platform.zig_target, "-shared", "-s", "-o"])
            .arg(output)
            // Nothing refers to the exported functions; this takes them out of the archive.
            .args(names.iter().map(|name| format!("-Wl,-u,{name}")))
            .arg(input)
            .arg("-lunwind")
            .arg(script)
            // A missing name is for the inspection to report, with the others.
            .args(["-Wl,--undefined-version", "-Wl,--gc-sections"])
            .args(["-Wl,-z,defs", "-Wl,--build-id=none"])
            .output()
            .context("cannot start zig")?;
        ensure!(
            linked.status.success(),
            "`{} cc` could not link {}:\n{}",
            self.zig.join(" "),
            output.display(),
            said(&linked)
        );
        Ok(())
    }

    fn command(&self) -> Command {
        let mut command = Command::new(&self.zig[0]);
        command.args(&self.zig[1..]);
        command
    }
}

/// The linker's version script: the names are global, all else is local.
fn version_script(names: &[&str]) -> String {
    let global: String = names.iter().map(|name| format!(" {name};")).collect();
    format!("{{ global:{global} local: *; }};\n")
}

/// What a command said on standard error.
fn said(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr)
        .trim_end()
        .to_owned()
}

/// The package that the FMU is made from, at the root of the workspace.
fn root_package(project: &Metadata) -> Result<&Package> {
    project
        .root_package()
        .context("the workspace has no package at its root")
}

/// Compiler flags, one per `\x1f`, that take the build machine's paths out of the binary:
/// those of the workspace, the build folder, the dependencies and the standard library.
fn remappings(project: &Metadata, platform: &Platform) -> Result<String> {
    // Dependencies count, hence not the metadata at hand.
    let resolved = MetadataCommand::new()
        .manifest_path(project.workspace_root.join("Cargo.toml"))
        .other_options(["--locked", "--filter-platform", platform.triple].map(String::from))
        .exec()
        .context("cannot resolve the dependencies")?;
    let mut replaced: Vec<(String, String)> = resolved
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
    let rustc = program("RUSTC", "rustc");
    let sysroot = answer(&rustc, &["--print", "sysroot"])?;
    let verbose = answer(&rustc, &["--version", "--verbose"])?;
    let commit = verbose
        .lines()
        .find_map(|line| line.strip_prefix("commit-hash: "))
        .unwrap_or("unknown");
    replaced.push((
        format!("{}/lib/rustlib/src/rust", sysroot.trim_end()),
        format!("/rustc/{commit}"),
    ));
    let flags: Vec<String> = replaced
        .into_iter()
        .map(|(path, name)| format!("--remap-path-prefix={path}={name}"))
        .collect();
    Ok(flags.join("\x1f"))
}

/// The program that an environment variable names, or the usual one.
fn program(variable: &str, usual: &str) -> OsString {
    env::var_os(variable).unwrap_or_else(|| usual.into())
}

/// What a program says on standard output.
fn answer(program: &OsStr, arguments: &[&str]) -> Result<String> {
    let name = program.display();
    let output = Command::new(program)
        .args(arguments)
        .output()
        .with_context(|| format!("cannot start {name}"))?;
    ensure!(output.status.success(), "{name} failed: {}", said(&output));
    String::from_utf8(output.stdout).with_context(|| format!("{name} answered no text"))
}
