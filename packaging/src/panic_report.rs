//! Takes the report of a panic out of a static library.
//!
//! The FMU catches panics and tells the host through its logger. What Rust does before that, the
//! message on standard error and the backtrace that reads debug information, would print
//! from a library that must not print, and it makes up half of the binary. Both are functions of
//! the standard library; here their symbols lose the definition, and functions that do nothing are linked
//! in their place.

use std::ops::Range;

use anyhow::{Context, Result};
use object::read::archive::ArchiveFile;
use object::read::coff::{CoffBigFile, CoffFile};
use object::read::elf::ElfFile64;
use object::{FileKind, Object, ObjectSymbol};

/// Functions that report a panic, by their demangled names. Both may return a zero, or nothing.
const REPORTERS: &[&str] = &[
    "std::panicking::default_hook",
    "<<std::sys::backtrace::BacktraceLock>::print::DisplayBacktrace as core::fmt::Display>::fmt",
];

/// Where an entry of a symbol table says in which section and at which offset the symbol is defined. Zeros
/// there mean that it is undefined.
const ELF: Range<usize> = 6..24;
const COFF: Range<usize> = 8..14;
const COFF_BIG: Range<usize> = 8..16;

/// Undefines the reporters in the members of a static library, ELF or COFF, and returns their symbols. In
/// other formats, and where the compiler has merged the functions, nothing is found.
///
/// # Errors
/// If the bytes are no static library.
pub fn undefine_reporters(archive: &mut [u8]) -> Result<Vec<String>> {
    let mut found = Vec::new();
    let bytes = &*archive;
    let members = ArchiveFile::parse(bytes)
        .context("the static library is damaged")?
        .members();
    for member in members {
        let data = member?.data(bytes)?;
        match FileKind::parse(data) {
            Ok(FileKind::Elf64) => {
                let file: ElfFile64 = ElfFile64::parse(data)?;
                let entries = file.symbols().map(|symbol| address(symbol.elf_symbol()));
                collect(&file, entries, &ELF, &mut found);
            }
            Ok(FileKind::Coff) => {
                let file: CoffFile = CoffFile::parse(data)?;
                let entries = file.symbols().map(|symbol| address(symbol.coff_symbol()));
                collect(&file, entries, &COFF, &mut found);
            }
            Ok(FileKind::CoffBig) => {
                let file: CoffBigFile = CoffBigFile::parse(data)?;
                let entries = file.symbols().map(|symbol| address(symbol.coff_symbol()));
                collect(&file, entries, &COFF_BIG, &mut found);
            }
            _ => {}
        }
    }
    let start = address(bytes);
    let mut names = Vec::new();
    for (entry, definition, name) in found {
        let place = entry - start;
        archive[place + definition.start..place + definition.end].fill(0);
        names.push(name);
    }
    Ok(names)
}

/// Collects the reporters that a file defines: address of the entry, where the definition is in it, name.
fn collect<'data>(
    file: &impl Object<'data>,
    entries: impl Iterator<Item = usize>,
    definition: &Range<usize>,
    found: &mut Vec<(usize, Range<usize>, String)>,
) {
    for (symbol, entry) in file.symbols().zip(entries) {
        let name = symbol.name().unwrap_or_default();
        if symbol.is_definition() && symbol.is_global() && is_reporter(name) {
            found.push((entry, definition.clone(), name.to_owned()));
        }
    }
}

/// Where something lies in memory.
fn address<T: ?Sized>(thing: &T) -> usize {
    std::ptr::from_ref(thing).addr()
}

/// C functions that stand for the undefined ones.
pub fn stand_ins(symbols: &[String]) -> String {
    symbols
        .iter()
        .map(|symbol| format!("int {symbol}(void) {{ return 0; }}\n"))
        .collect()
}

/// Whether a mangled name is that of a reporter.
fn is_reporter(mangled: &str) -> bool {
    rustc_demangle::try_demangle(mangled)
        .is_ok_and(|name| REPORTERS.contains(&format!("{name:#}").as_str()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reporters_are_known_by_name() {
        assert!(is_reporter(
            "_RNvNtCsjrHSEGnQ3l9_3std9panicking12default_hook"
        ));
        assert!(is_reporter(
            "_RNvXNvMNtNtCsjrHSEGnQ3l9_3std3sys9backtraceNtB5_13BacktraceLock5printNtB2_16DisplayBacktrace\
             NtNtCsgEmfK2I1SDS_4core3fmt7Display3fmt"
        ));
        assert!(is_reporter(
            "_ZN3std9panicking12default_hook17h0123456789abcdefE"
        ));
        assert!(!is_reporter(
            "_RNvNtCsjrHSEGnQ3l9_3std9panicking15panic_with_hook"
        ));
        assert!(!is_reporter("fmi2DoStep"));
    }

    #[test]
    fn stand_ins_are_c_functions() {
        let text = stand_ins(&["a".to_owned(), "b".to_owned()]);
        assert_eq!(
            text,
            "int a(void) { return 0; }\nint b(void) { return 0; }\n"
        );
    }
}
