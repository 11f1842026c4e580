//! Takes the report of a panic out of a static library.
//!
//! The FMU catches panics and tells the host through its logger. What Rust does before that, the
//! message on standard error and the backtrace that reads debug information, would print
//! from a library that must not print, and it makes up half of the binary. Both are functions of
//! the standard library; here their symbols lose the definition, and functions that do nothing are linked
//! in their place.

use anyhow::{Context, Result};
use object::read::archive::ArchiveFile;
use object::read::elf::ElfFile64;
use object::{Object, ObjectSymbol, elf};

/// Functions that report a panic, by their demangled names. Both may return a zero, or nothing.
const REPORTERS: &[&str] = &[
    "std::panicking::default_hook",
    "<<std::sys::backtrace::BacktraceLock>::print::DisplayBacktrace as core::fmt::Display>::fmt",
];

/// Bytes of an ELF symbol of 64 bits: name 4, info 1, other 1, section 2, value 8, size 8.
const SYMBOL: usize = 24;

/// Undefines the reporters in the ELF members of a static library and returns their symbols. In other
/// formats nothing is found.
///
/// # Errors
/// If the bytes are no static library.
pub fn undefine_reporters(archive: &mut [u8]) -> Result<Vec<String>> {
    let mut found = Vec::new();
    let mut places = Vec::new();
    let bytes = &*archive;
    for member in ArchiveFile::parse(bytes)
        .context("the static library is damaged")?
        .members()
    {
        let data = member?.data(bytes)?;
        let Ok(file) = ElfFile64::<object::Endianness>::parse(data) else {
            continue;
        };
        for symbol in file.symbols() {
            let name = symbol.name().unwrap_or_default();
            if symbol.is_definition() && symbol.is_global() && is_reporter(name) {
                let entry = std::ptr::from_ref(symbol.elf_symbol()).addr() - bytes.as_ptr().addr();
                places.push(entry);
                found.push(name.to_owned());
            }
        }
    }
    for place in places {
        let symbol = &mut archive[place..place + SYMBOL];
        symbol[4..].fill(0);
        symbol[4] = elf::STB_GLOBAL.0 << 4;
    }
    Ok(found)
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
