//! The platforms that the FMU carries a binary for, one row each.

use object::Architecture;

/// A platform, and what its binary may demand from the system it is loaded on.
pub struct Platform {
    /// FMI's name of the platform, the folder below `binaries/`.
    pub folder: &'static str,
    /// Target triple of the Rust compiler.
    pub triple: &'static str,
    /// Target of the linker `zig cc`; its suffix is the glibc to link against.
    pub zig_target: &'static str,
    /// File name extension of a shared library.
    pub extension: &'static str,
    /// Machine that the binary must be for.
    pub architecture: Architecture,
    /// Libraries that the binary may need; each is part of the C library.
    pub libraries: &'static [&'static str],
    /// Newest glibc that the binary may need.
    pub newest_glibc: &'static str,
}

/// Every platform of the packed FMU.
pub const PLATFORMS: &[Platform] = &[Platform {
    folder: "linux64",
    triple: "x86_64-unknown-linux-gnu",
    // glibc 2.17 is the oldest that Rust's standard library supports.
    zig_target: "x86_64-linux-gnu.2.17",
    extension: "so",
    architecture: Architecture::X86_64,
    libraries: &[
        "ld-linux-x86-64.so.2",
        "libc.so.6",
        "libdl.so.2",
        "libm.so.6",
        "libpthread.so.0",
        "librt.so.1",
    ],
    newest_glibc: "2.17",
}];
