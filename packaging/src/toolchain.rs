//! Finds a Rust compiler with a standard library for a platform.

use std::env;
use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, Result, ensure};
use object::BinaryFormat;

use crate::debian::Unpacked;
use crate::platform::Platform;
use crate::zig::said;

/// A Rust compiler that can serve a platform.
pub struct Toolchain {
    /// The compiler.
    pub rustc: OsString,
    /// Flags for cargo before the verb's own.
    pub flags: &'static [&'static str],
    /// Environment of cargo.
    pub environment: Vec<(&'static str, OsString)>,
}

impl Toolchain {
    /// The compiler of the environment variable `RUSTC`, or the usual one, if it has the standard library
    /// for the platform.
    fn own(platform: &Platform) -> Result<Option<Self>> {
        let rustc = env::var_os("RUSTC").unwrap_or_else(|| "rustc".into());
        let arguments = ["--print", "target-libdir", "--target", platform.triple];
        let answer = Command::new(&rustc)
            .args(arguments)
            .output()
            .with_context(|| format!("cannot start {}", rustc.display()))?;
        let folder = String::from_utf8_lossy(&answer.stdout);
        Ok(Path::new(folder.trim()).is_dir().then_some(Self {
            rustc,
            flags: &[],
            environment: Vec::new(),
        }))
    }

    /// Debian's compiler, unpacked into `shelf`, which builds the standard library from its sources.
    fn debian(version: &str, shelf: &Path) -> Result<Self> {
        let packages = Unpacked::get(&["rustc-web", "rust-web-src"], shelf)?;
        let rustc = packages.file("usr/bin/rustc");
        let libraries = packages.libraries();
        let answer = Command::new(&rustc)
            .arg("--version")
            .env("LD_LIBRARY_PATH", &libraries)
            .output()
            .with_context(|| format!("cannot start {}", rustc.display()))?;
        ensure!(
            answer.status.success(),
            "{} does not run: {}",
            rustc.display(),
            said(&answer)
        );
        let found = String::from_utf8_lossy(&answer.stdout);
        ensure!(
            found.split(' ').nth(1).map(numbers) >= Some(numbers(version)),
            "Debian's is {}, but {version} is needed",
            found.trim()
        );
        Ok(Self {
            rustc: rustc.into(),
            // Without the feature `backtrace`, which a library has no use for.
            flags: &["-Zbuild-std=std,panic_unwind", "-Zbuild-std-features="],
            environment: vec![
                ("LD_LIBRARY_PATH", libraries.into()),
                ("RUSTC_BOOTSTRAP", "1".into()),
            ],
        })
    }

    /// A compiler for the platform: the user's own; or that with a target that rustup adds to it; or,
    /// on Debian, one from its packages, unpacked into `shelf`.
    ///
    /// # Errors
    /// If there is none: what was tried, why it failed, and how to get one.
    pub fn find(platform: &Platform, version: &str, shelf: &Path) -> Result<Self> {
        ensure!(
            platform.format != BinaryFormat::MachO || cfg!(target_os = "macos"),
            "Apple's linker and libraries are needed: run this on macOS"
        );
        if let Some(own) = Self::own(platform)? {
            return Ok(own);
        }
        let rustup = match add(platform) {
            Ok(()) => match Self::own(platform)? {
                Some(own) => return Ok(own),
                None => "rustup added the target to another toolchain than rustc's".to_owned(),
            },
            Err(error) => format!("{error:#}"),
        };
        Self::debian(version, shelf).map_err(|error| {
            anyhow::anyhow!(
                "Rust's standard library for {0} is missing: {rustup}; nor could Debian's packages be \
                 used: {error:#}. Get it by `rustup target add {0}`",
                platform.triple
            )
        })
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
        let output = self
            .command()
            .args(arguments)
            .output()
            .context("cannot start rustc")?;
        ensure!(output.status.success(), "rustc failed: {}", said(&output));
        String::from_utf8(output.stdout).context("rustc answered no text")
    }

    /// A command that starts this compiler.
    fn command(&self) -> Command {
        let mut command = Command::new(&self.rustc);
        command.envs(self.environment.iter().cloned());
        command
    }
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

/// The numbers of a version, for comparison.
fn numbers(version: &str) -> Vec<u32> {
    version
        .split(['.', '-', '+'])
        .map_while(|part| part.parse().ok())
        .collect()
}

/// The folder where unpacked packages are kept.
pub fn shelf(target: &Path) -> PathBuf {
    target.join("debian")
}

#[cfg(test)]
mod tests {
    use super::numbers;

    #[test]
    fn versions_compare_by_number() {
        assert!(numbers("1.96.0") > numbers("1.89"));
        assert!(numbers("1.100.0") > numbers("1.96.1"));
        assert!(numbers("1.85.0") < numbers("1.89"));
    }
}
