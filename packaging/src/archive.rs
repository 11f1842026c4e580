//! The FMU as a zip file whose bytes depend on its entries alone.

use std::collections::BTreeMap;
use std::fs;
use std::io::{Cursor, Read, Write};
use std::path::Path;

use anyhow::{Context, Result, ensure};
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, DateTime, ZipArchive, ZipWriter};

/// Contents of the FMU: path inside the archive, with `/` between folders, to the file's bytes.
pub type Entries = BTreeMap<String, Vec<u8>>;

/// The last level of Deflate before `zip` turns to the crate `zopfli`, which saves 4 % and takes half a minute.
const LEVEL: i64 = 9;

/// Writes the entries to a zip file at `path`, reads that file back and compares.
///
/// # Errors
/// If the file cannot be written or read, or does not hold the entries bit for bit.
pub fn write(path: &Path, entries: &Entries) -> Result<()> {
    let write = || -> Result<()> {
        if let Some(folder) = path.parent() {
            fs::create_dir_all(folder)?;
        }
        fs::write(path, pack(entries)?)?;
        Ok(())
    };
    write().with_context(|| format!("cannot write {}", path.display()))?;
    let read_back = fs::read(path)
        .map_err(Into::into)
        .and_then(unpack)
        .with_context(|| format!("cannot read {} back", path.display()))?;
    ensure!(
        read_back == *entries,
        "{} differs from what was written to it",
        path.display()
    );
    Ok(())
}

/// The entries as a zip file: sorted by path, with the zip format's earliest date and without
/// the build machine's permissions.
fn pack(entries: &Entries) -> Result<Vec<u8>> {
    let options = SimpleFileOptions::default()
        .compression_method(CompressionMethod::Deflated)
        .compression_level(Some(LEVEL))
        .last_modified_time(DateTime::DEFAULT)
        .unix_permissions(0o644);
    let mut archive = ZipWriter::new(Cursor::new(Vec::new()));
    for (name, bytes) in entries {
        archive.start_file(name.as_str(), options)?;
        archive.write_all(bytes)?;
    }
    Ok(archive.finish()?.into_inner())
}

/// The entries of a zip file.
fn unpack(bytes: Vec<u8>) -> Result<Entries> {
    let mut archive = ZipArchive::new(Cursor::new(bytes))?;
    let mut entries = Entries::new();
    for index in 0..archive.len() {
        let mut file = archive.by_index(index)?;
        let mut contents = Vec::new();
        file.read_to_end(&mut contents)?;
        entries.insert(file.name().to_owned(), contents);
    }
    Ok(entries)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn entries(pairs: &[(&str, &[u8])]) -> Entries {
        pairs
            .iter()
            .map(|(name, bytes)| ((*name).to_owned(), bytes.to_vec()))
            .collect()
    }

    #[test]
    fn order_and_time_of_packing_do_not_show() -> Result<()> {
        let one = entries(&[
            ("modelDescription.xml", b"<x/>"),
            ("binaries/a.so", b"\x7fELF"),
        ]);
        let two = entries(&[
            ("binaries/a.so", b"\x7fELF"),
            ("modelDescription.xml", b"<x/>"),
        ]);
        let first = pack(&one)?;
        // The zip format counts time in steps of two seconds.
        std::thread::sleep(std::time::Duration::from_millis(2100));
        assert_eq!(first, pack(&two)?);
        Ok(())
    }

    #[test]
    fn written_file_is_read_back() -> Result<()> {
        let path = std::env::temp_dir().join(format!("archive-{}.fmu", std::process::id()));
        let long = vec![7; 300_000];
        let contents = entries(&[("documentation/index.html", &long), ("empty", b"")]);
        let outcome = write(&path, &contents).and_then(|()| unpack(fs::read(&path)?));
        fs::remove_file(&path)?;
        assert_eq!(outcome?, contents);
        Ok(())
    }

    #[test]
    fn damage_is_found() -> Result<()> {
        let contents = entries(&[("modelDescription.xml", b"<fmiModelDescription/>")]);
        let mut bytes = pack(&contents)?;
        // The local header has 30 bytes and the name, then the compressed data follow.
        bytes[30 + "modelDescription.xml".len() + 4] ^= 0x10;
        assert!(unpack(bytes).is_err());
        Ok(())
    }
}
