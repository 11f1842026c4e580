//! Finds a Rust compiler with a standard library for a platform, and the other tools.

use std::env;
use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, Result, ensure};
use object::BinaryFormat;

use crate::platform::Platform;
use crate::zig::said;

/// A Rust compiler that has the standard library for a platform.
pub struct Toolchain {
    /// The compiler.
    pub rustc: OsString,
}

impl Toolchain {
    /// The compiler of the environment variable `RUSTC`, or the usual one; a standard library that it lacks
    /// is added by rustup.
    ///
    /// # Errors
    /// If the platform cannot be built for: why, and what to do.
    pub fn find(platform: &Platform) -> Result<Self> {
        ensure!(
            platform.format != BinaryFormat::MachO || cfg!(target_os = "macos"),
            "Apple's linker and libraries are needed: run this on macOS"
        );
        let toolchain = Self {
            rustc: env::var_os("RUSTC").unwrap_or_else(|| "rustc".into()),
        };
        if !toolchain.serves(platform)? {
            add(platform).with_context(|| {
                format!(
                    "Rust has no standard library for {0}, and rustup, which could add it \
                     (`rustup target add {0}`), did not",
                    platform.triple
                )
            })?;
            ensure!(
                toolchain.serves(platform)?,
                "rustup added {} to another toolchain than that of {}",
                platform.triple,
                toolchain.rustc.display()
            );
        }
        Ok(toolchain)
    }

    /// Whether it has the standard library for the platform.
    fn serves(&self, platform: &Platform) -> Result<bool> {
        let arguments = ["--print", "target-libdir", "--target", platform.triple];
        Ok(Path::new(self.answer(&arguments)?.trim_end()).is_dir())
    }

    /// The folder that it is installed in.
    ///
    /// # Errors
    /// If it does not tell.
    pub fn sysroot(&self) -> Result<PathBuf> {
        Ok(PathBuf::from(
            self.answer(&["--print", "sysroot"])?.trim_end(),
        ))
    }

    /// What the compiler says on standard output.
    ///
    /// # Errors
    /// If it cannot be started or fails.
    pub fn answer(&self, arguments: &[&str]) -> Result<String> {
        let output = Command::new(&self.rustc)
            .args(arguments)
            .output()
            .with_context(|| format!("cannot start {}", self.rustc.display()))?;
        ensure!(output.status.success(), "rustc failed: {}", said(&output));
        String::from_utf8(output.stdout).context("rustc answered no text")
    }
}

/// Where a tool is, which the Makefile says in the environment.
///
/// # Errors
/// If it says nothing: what to do.
pub fn tool(name: &str) -> Result<OsString> {
    env::var_os(name)
        .filter(|place| !place.is_empty())
        .with_context(|| {
            format!("the environment has no {name}; run `make`, or eval \"$(make -s env)\" first")
        })
}

/// Lets rustup add the platform's target to the toolchain in use.
fn add(platform: &Platform) -> Result<()> {
    eprintln!("rustup target add {}", platform.triple);
    let answer = Command::new("rustup")
        .args(["target", "add", platform.triple])
        .output()
        .context("there is no rustup")?;
    ensure!(answer.status.success(), "rustup: {}", said(&answer));
    Ok(())
}
