//! Programs from Debian's packages, unpacked into a folder of the build: nothing is installed
//! and no rights are needed.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, Result, bail, ensure};

use crate::zig::said;

/// A folder with the unpacked packages, laid out like `/`.
pub struct Unpacked {
    root: PathBuf,
}

impl Unpacked {
    /// Unpacks the packages and what they need beyond what is installed, into a folder of
    /// `shelf` that is named after the first; once, as long as that folder stays.
    ///
    /// # Errors
    /// If there is no apt, or it does not know or get the packages.
    pub fn get(packages: &[&str], shelf: &Path) -> Result<Self> {
        let root = shelf.join(packages[0]);
        if root.is_dir() {
            return Ok(Self { root });
        }
        let apt = Apt::new(shelf)?;
        let wanted = apt.wanted(packages)?;
        let parcels = shelf.join("parcels");
        let unfinished = shelf.join("unfinished");
        for folder in [&parcels, &unfinished] {
            if folder.exists() {
                fs::remove_dir_all(folder)?;
            }
            fs::create_dir_all(folder)?;
        }
        eprintln!(
            "unpacking {} of Debian into {}",
            wanted.join(" "),
            root.display()
        );
        run(apt.command("download").args(&wanted).current_dir(&parcels))?;
        for parcel in fs::read_dir(&parcels)? {
            run(Command::new("dpkg")
                .arg("-x")
                .arg(parcel?.path())
                .arg(&unfinished))?;
        }
        fs::remove_dir_all(&parcels)?;
        fs::rename(&unfinished, &root)
            .with_context(|| format!("cannot make {}", root.display()))?;
        Ok(Self { root })
    }

    /// Where a file is that Debian has at `/` + `path`: among the unpacked ones, or installed.
    pub fn file(&self, path: &str) -> PathBuf {
        let unpacked = self.root.join(path);
        if unpacked.exists() {
            unpacked
        } else {
            Path::new("/").join(path)
        }
    }

    /// The folder of the unpacked shared libraries.
    pub fn libraries(&self) -> PathBuf {
        self.root.join("usr/lib/x86_64-linux-gnu")
    }

    /// The folder itself.
    pub fn root(&self) -> &Path {
        &self.root
    }
}

/// Debian's package manager with package lists of its own, as new as the mirror has them.
struct Apt {
    state: PathBuf,
}

impl Apt {
    fn new(shelf: &Path) -> Result<Self> {
        for program in ["apt-get", "dpkg"] {
            if Command::new(program).arg("--version").output().is_err() {
                bail!("this system has no {program}");
            }
        }
        let apt = Self {
            state: shelf.join("apt"),
        };
        fs::create_dir_all(apt.state.join("lists/partial"))?;
        fs::create_dir_all(apt.state.join("cache/archives/partial"))?;
        run(&mut apt.command("update"))?;
        Ok(apt)
    }

    fn command(&self, verb: &str) -> Command {
        let mut command = Command::new("apt-get");
        let set =
            |name: &str, folder: &str| format!("-o{name}={}", self.state.join(folder).display());
        command
            .args([
                set("Dir::State::lists", "lists"),
                set("Dir::Cache", "cache"),
            ])
            .args([
                "-oDebug::NoLocking=1",
                "-oAPT::Sandbox::User=root",
                "-qq",
                verb,
            ]);
        command
    }

    /// The packages with what they need and the system lacks, each as `name=version`.
    fn wanted(&self, packages: &[&str]) -> Result<Vec<String>> {
        let listing = run(self
            .command("install")
            .args(["--print-uris", "--yes", "--no-install-recommends"])
            .args(packages))?;
        Ok(listing.lines().filter_map(parcel).collect())
    }
}

/// Package and version of a line of `apt-get install --print-uris`:
/// `'ADDRESS' NAME_VERSION_ARCHITECTURE.deb SIZE HASH`.
fn parcel(line: &str) -> Option<String> {
    let file = line.strip_prefix('\'')?.split(' ').nth(1)?;
    let mut parts = file.strip_suffix(".deb")?.split('_');
    let (name, version) = (parts.next()?, parts.next()?);
    Some(format!("{name}={}", version.replace("%3a", ":")))
}

/// What a command says on standard output; an error with what it said on the other if it fails.
fn run(command: &mut Command) -> Result<String> {
    let name = command.get_program().display().to_string();
    let output = command
        .output()
        .with_context(|| format!("cannot start {name}"))?;
    ensure!(output.status.success(), "{name} failed: {}", said(&output));
    Ok(String::from_utf8_lossy(&output.stdout).into_owned())
}

#[cfg(test)]
mod tests {
    use super::parcel;

    #[test]
    fn a_listed_package_gives_name_and_version() {
        let line = "'http://mirror/pool/main/q/qemu-user_7.2.deb' qemu-user_1%3a7.2+b3_amd64.deb 12 SHA256:0";
        assert_eq!(parcel(line).as_deref(), Some("qemu-user=1:7.2+b3"));
        assert_eq!(parcel("0 upgraded, 2 newly installed"), None);
    }
}
