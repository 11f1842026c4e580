//! `zig`: C compiler, archiver and linker for every platform, with the headers and libraries
//! that each of them needs.

use std::env;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use anyhow::{Context, Result, ensure};

use crate::platform::Platform;

/// A zig that runs.
pub struct Zig {
    /// The command line that starts it: a program, then arguments.
    words: Vec<String>,
}

/// Programs that stand for zig's own, for tools that want a path without arguments.
pub struct Stand {
    /// C compiler for the platform.
    pub cc: PathBuf,
    /// Archiver.
    pub ar: PathBuf,
    /// Folder with a `dlltool` of the name that rustc looks for on the path. A flag with its place would get
    /// into the hashes of the symbols.
    pub path: PathBuf,
}

impl Zig {
    /// Finds zig: the environment variable `ZIG`, a command line split like a shell does, or
    /// the PyPI package `ziglang`.
    ///
    /// # Errors
    /// If zig does not tell its version.
    pub fn find() -> Result<Self> {
        let line = env::var("ZIG").unwrap_or_else(|_| "python3 -m ziglang".to_owned());
        let words = shlex::split(&line)
            .filter(|words| !words.is_empty())
            .with_context(|| format!("ZIG is set to `{line}`, which is no command line"))?;
        let zig = Self { words };
        let advice = || {
            format!(
                "cannot run the linker zig as `{line}`: install it, as `make fmu` does or by \
                 `python3 -m pip install ziglang`, or set the environment variable ZIG to the \
                 command line that starts it"
            )
        };
        let answer = zig.command().arg("version").output().with_context(advice)?;
        ensure!(answer.status.success(), "{}: {}", advice(), said(&answer));
        Ok(zig)
    }

    /// A command that starts zig.
    pub fn command(&self) -> Command {
        let mut command = Command::new(&self.words[0]);
        command.args(&self.words[1..]);
        command
    }

    /// A command that compiles or links C for the platform.
    pub fn cc(&self, platform: &Platform) -> Command {
        let mut command = self.command();
        command.args(["cc", "-target", platform.zig_target]);
        command
    }

    /// The folder of the libraries that zig links, with their licences.
    ///
    /// # Errors
    /// If zig does not tell.
    pub fn libraries(&self) -> Result<PathBuf> {
        let answer = self
            .command()
            .arg("env")
            .output()
            .context("cannot start zig")?;
        let text = String::from_utf8_lossy(&answer.stdout);
        let folder = text
            .lines()
            .find_map(|line| {
                line.trim()
                    .strip_prefix(".lib_dir = \"")?
                    .strip_suffix("\",")
            })
            .with_context(|| format!("zig tells no folder of libraries:\n{text}"))?;
        Ok(env::current_dir()?.join(folder))
    }

    /// Writes shell scripts into `folder` that start zig's programs for the platform.
    ///
    /// # Errors
    /// If the folder cannot be written to.
    pub fn stand_in(&self, platform: &Platform, folder: &Path) -> Result<Stand> {
        let zig = shlex::try_join(self.words.iter().map(String::as_str))
            .context("the command line of zig contains a NUL")?;
        let write = |name: &str, arguments: &str| -> Result<PathBuf> {
            let path = folder.join(name);
            let script = format!("#!/bin/sh\nexec {zig} {arguments} \"$@\"\n");
            // Cargo rebuilds what a newer file stands behind.
            if fs::read_to_string(&path).is_ok_and(|present| present == script) {
                return Ok(path);
            }
            fs::write(&path, script).with_context(|| format!("cannot write {}", path.display()))?;
            make_executable(&path)?;
            Ok(path)
        };
        fs::create_dir_all(folder)
            .with_context(|| format!("cannot make the folder {}", folder.display()))?;
        Ok(Stand {
            cc: write("zig-cc", &format!("cc -target {}", platform.zig_target))?,
            ar: write("zig-ar", "ar")?,
            path: write("x86_64-w64-mingw32-dlltool", "dlltool").map(|_| folder.to_owned())?,
        })
    }

    /// The folders that C headers of the platform come from.
    ///
    /// # Errors
    /// If zig does not list them.
    pub fn headers(&self, platform: &Platform, folder: &Path) -> Result<Vec<PathBuf>> {
        let empty = folder.join("empty.c");
        fs::write(&empty, "").with_context(|| format!("cannot write {}", empty.display()))?;
        let answer = self
            .cc(platform)
            .args(["-v", "-c", "-o"])
            .arg(folder.join("empty.o"))
            .arg(&empty)
            .output()
            .context("cannot start zig")?;
        let report = said(&answer);
        let here = env::current_dir().context("there is no current folder")?;
        let folders: Vec<PathBuf> = report
            .lines()
            .skip_while(|line| !line.starts_with("#include <...> search"))
            .skip(1)
            .take_while(|line| line.starts_with(' '))
            .map(|line| here.join(line.trim()))
            .collect();
        ensure!(
            !folders.is_empty(),
            "zig lists no folders of headers for {}:\n{report}",
            platform.zig_target
        );
        Ok(folders)
    }
}

#[cfg(unix)]
fn make_executable(path: &Path) -> Result<()> {
    use std::os::unix::fs::PermissionsExt;
    fs::set_permissions(path, fs::Permissions::from_mode(0o755))
        .with_context(|| format!("cannot make {} executable", path.display()))
}

#[cfg(not(unix))]
fn make_executable(_: &Path) -> Result<()> {
    anyhow::bail!("cross-compiling needs a shell: pack on Linux, macOS or in WSL")
}

/// What a command said on standard error.
pub fn said(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr)
        .trim_end()
        .to_owned()
}
