//! Reads a built shared library of any platform and says why it must not be shipped.

use std::collections::BTreeSet;
use std::fmt;

use anyhow::{Context, Result};
use object::read::elf::ElfFile64;
use object::{Architecture, BinaryFormat, File, NameOrOrdinal, Object};

use crate::platform::Platform;

/// What a shared library offers to the program that loads it, and demands from the system.
pub struct Binary {
    /// Format of the file.
    pub format: BinaryFormat,
    /// Machine that the code is for.
    pub architecture: Architecture,
    /// Names of the dynamic symbols that it defines.
    pub exported: BTreeSet<String>,
    /// Libraries that are loaded with it.
    pub libraries: BTreeSet<String>,
    /// Symbol versions that it demands from those libraries, such as `GLIBC_2.14`.
    pub versions: BTreeSet<String>,
    /// Size of the file in bytes.
    pub size: usize,
}

impl Binary {
    /// Reads an ELF, PE or Mach-O file.
    ///
    /// # Errors
    /// If the bytes are something else, or damaged.
    pub fn read(bytes: &[u8]) -> Result<Self> {
        let file = File::parse(bytes).context("the binary is no shared library")?;
        let mut exported = BTreeSet::new();
        for export in file.exports()? {
            exported.insert(match export?.name() {
                // Mach-O puts an underscore before the names of C.
                NameOrOrdinal::Name([b'_', name @ ..]) if file.format() == BinaryFormat::MachO => {
                    text(name)
                }
                NameOrOrdinal::Name(name) => text(name),
                NameOrOrdinal::Ordinal(ordinal) => format!("#{ordinal}"),
            });
        }
        let mut libraries = BTreeSet::new();
        for library in file.import_libraries()? {
            libraries.insert(text(library?.name()));
        }
        Ok(Self {
            format: file.format(),
            architecture: file.architecture(),
            exported,
            libraries,
            versions: match &file {
                File::Elf64(file) => demanded_versions(file)?,
                _ => BTreeSet::new(),
            },
            size: bytes.len(),
        })
    }

    /// The newest glibc that the library demands, if it demands any.
    pub fn newest_glibc(&self) -> Option<Version> {
        self.versions.iter().filter_map(|name| glibc(name)).max()
    }

    /// Every reason not to ship the library, each as a sentence; none if it is good.
    pub fn faults(&self, platform: &Platform, names: &[&str]) -> Vec<String> {
        let mut faults = Vec::new();
        let found = (self.format, self.architecture);
        let wanted = (platform.format, platform.architecture);
        if found != wanted {
            faults.push(format!(
                "it is {:?} for {:?}, {} needs {:?} for {:?}",
                found.0, found.1, platform.folder, wanted.0, wanted.1
            ));
        }
        let expected: BTreeSet<String> = names.iter().map(|name| (*name).to_owned()).collect();
        for name in expected.difference(&self.exported) {
            faults.push(format!("it does not export {name}, which it should"));
        }
        for name in self.exported.difference(&expected) {
            faults.push(format!("it exports {name}, which it should not"));
        }
        for library in &self.libraries {
            if !platform
                .libraries
                .iter()
                .any(|allowed| matches(allowed, library))
            {
                faults.push(format!(
                    "it needs {library}; allowed are only {}",
                    platform.libraries.join(", ")
                ));
            }
        }
        let limit = platform.newest_glibc.unwrap_or("none");
        for version in &self.versions {
            if glibc(version).is_none_or(|needed| Some(needed) > Version::parse(limit)) {
                faults.push(format!(
                    "it needs {version}; the newest allowed is GLIBC_{limit}"
                ));
            }
        }
        faults
    }
}

/// Whether a library is an allowed one; a `*` at the end stands for anything. Case does not count, as
/// on Windows; elsewhere no two libraries of the system differ in case only.
fn matches(allowed: &str, library: &str) -> bool {
    let library = library.to_ascii_lowercase();
    let allowed = allowed.to_ascii_lowercase();
    match allowed.strip_suffix('*') {
        Some(start) => library.starts_with(start),
        None => library == allowed,
    }
}

/// A version number, ordered by its parts: 2.2.5 < 2.14 < 2.17.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Version(Vec<u32>);

impl Version {
    /// The version in a text like `2.2.5`; nothing if a part is no number.
    fn parse(text: &str) -> Option<Self> {
        text.split('.')
            .map(|part| part.parse().ok())
            .collect::<Option<_>>()
            .map(Self)
    }
}

impl fmt::Display for Version {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let parts: Vec<String> = self.0.iter().map(u32::to_string).collect();
        formatter.write_str(&parts.join("."))
    }
}

/// The glibc that a symbol version stands for; nothing for one that names no release,
/// such as `GCC_3.0`, `GLIBC_PRIVATE` or `GLIBC_ABI_DT_RELR`.
fn glibc(symbol_version: &str) -> Option<Version> {
    Version::parse(symbol_version.strip_prefix("GLIBC_")?)
}

/// The versions in the table of demands (`.gnu.version_r`), which the loader checks as a whole,
/// whether or not a symbol refers to an entry.
fn demanded_versions(file: &ElfFile64) -> Result<BTreeSet<String>> {
    let mut versions = BTreeSet::new();
    let endian = file.endian();
    let sections = file.elf_section_table();
    let Some((mut demands, strings)) = sections
        .gnu_verneed(endian, file.data())?
        .map(|(demands, link)| -> Result<_> {
            Ok((demands, sections.strings(endian, file.data(), link)?))
        })
        .transpose()?
    else {
        return Ok(versions);
    };
    while let Some((_, mut entries)) = demands.next()? {
        while let Some(entry) = entries.next()? {
            versions.insert(text(entry.name(endian, strings)?));
        }
    }
    Ok(versions)
}

/// A name of the binary, readable even if it is not UTF-8.
fn text(name: &[u8]) -> String {
    String::from_utf8_lossy(name).into_owned()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::platform::PLATFORMS;

    const NAMES: &[&str] = &["fmi2DoStep", "fmi2GetReal"];

    fn good() -> Binary {
        let set = |names: &[&str]| names.iter().map(|name| (*name).to_owned()).collect();
        Binary {
            format: BinaryFormat::Elf,
            architecture: Architecture::X86_64,
            exported: set(NAMES),
            libraries: set(&["libc.so.6", "libm.so.6"]),
            versions: set(&["GLIBC_2.2.5", "GLIBC_2.14", "GLIBC_2.17"]),
            size: 0,
        }
    }

    /// The one fault of a binary that is good but for `change`.
    fn fault(change: impl FnOnce(&mut Binary)) -> String {
        let mut binary = good();
        change(&mut binary);
        let faults = binary.faults(&PLATFORMS[0], NAMES);
        assert_eq!(faults.len(), 1, "{faults:?}");
        faults[0].clone()
    }

    #[test]
    fn good_binary_passes() {
        assert!(good().faults(&PLATFORMS[0], NAMES).is_empty());
        assert_eq!(good().newest_glibc(), Version::parse("2.17"));
    }

    #[test]
    fn each_fault_names_the_culprit() {
        let missing = fault(|binary| _ = binary.exported.remove("fmi2DoStep"));
        assert!(missing.starts_with("it does not export fmi2DoStep,"));
        let stray = fault(|binary| _ = binary.exported.insert("callback_log".into()));
        assert!(stray.starts_with("it exports callback_log,"));
        let library = fault(|binary| _ = binary.libraries.insert("libgcc_s.so.1".into()));
        assert!(library.starts_with("it needs libgcc_s.so.1;"));
        for version in ["GLIBC_2.17.1", "GLIBC_2.34", "GLIBC_PRIVATE", "GCC_3.0"] {
            let newer = fault(|binary| _ = binary.versions.insert(version.into()));
            assert!(newer.starts_with(&format!("it needs {version};")));
        }
        let machine = fault(|binary| binary.architecture = Architecture::Aarch64);
        assert!(machine.starts_with("it is Elf for Aarch64, linux64 needs Elf for X86_64"));
        let format = fault(|binary| binary.format = BinaryFormat::Pe);
        assert!(format.starts_with("it is Pe for X86_64, linux64 needs"));
    }

    #[test]
    fn each_platform_has_libraries_of_its_own() {
        let windows = &PLATFORMS[1];
        let mut binary = good();
        binary.format = BinaryFormat::Pe;
        binary.versions.clear();
        binary.libraries = ["kernel32.dll", "api-ms-win-crt-heap-l1-1-0.dll"]
            .map(str::to_owned)
            .into();
        assert!(binary.faults(windows, NAMES).is_empty());
        binary.libraries.insert("libgcc_s_seh-1.dll".to_owned());
        let faults = binary.faults(windows, NAMES);
        assert!(faults.len() == 1 && faults[0].starts_with("it needs libgcc_s_seh-1.dll;"));
    }

    #[test]
    fn versions_are_compared_by_number() {
        let version = |text| Version::parse(text).expect("a version");
        assert!(version("2.2.5") < version("2.14"));
        assert!(version("2.9") < version("2.17"));
        assert!(version("2.17") < version("2.17.1"));
        assert_eq!(version("2.2.5").to_string(), "2.2.5");
        assert_eq!(glibc("GLIBC_ABI_DT_RELR"), None);
    }

    /// This test program is linked as Rust does it by default: against libgcc_s and the
    /// glibc of the machine. It must be refused for at least that library.
    #[cfg(all(target_os = "linux", target_env = "gnu", target_arch = "x86_64"))]
    #[test]
    fn a_default_rust_binary_is_refused() -> Result<()> {
        let binary = Binary::read(&std::fs::read(std::env::current_exe()?)?)?;
        assert!(binary.libraries.contains("libc.so.6"));
        assert!(binary.versions.iter().any(|name| glibc(name).is_some()));
        let faults = binary.faults(&PLATFORMS[0], NAMES);
        assert!(faults.iter().any(|fault| fault.contains("libgcc_s")));
        Ok(())
    }

    #[test]
    fn other_files_are_refused() {
        assert!(Binary::read(b"<fmiModelDescription/>").is_err());
    }
}
