//! The platforms that the FMU carries a binary for, one row each.

use object::{Architecture, BinaryFormat};

/// A platform, and what its binary may demand from the system it is loaded on.
#[derive(Debug)]
pub struct Platform {
    /// Name of the folder below `binaries/`: FMI 2.0's where it has one, else, as 2.0.4 says, the tuple of
    /// FMI 3.0.
    pub folder: &'static str,
    /// Target triple of the Rust compiler.
    pub triple: &'static str,
    /// Target of `zig cc`; its suffix is the glibc to link against.
    pub zig_target: &'static str,
    /// File name extension of a shared library.
    pub extension: &'static str,
    /// Format that the binary must have.
    pub format: BinaryFormat,
    /// Machine that the binary must be for.
    pub architecture: Architecture,
    /// Libraries that Rust's standard library is linked against, beside the C library; the unwinder is
    /// linked in.
    pub linked: &'static [&'static str],
    /// Libraries that the binary may need, each part of every such system; a `*` at the end
    /// stands for anything. Windows ignores case here.
    pub libraries: &'static [&'static str],
    /// Newest glibc that the binary may need, on Linux.
    pub newest_glibc: Option<&'static str>,
}

/// The oldest glibc that Rust's standard library supports.
const GLIBC: Option<&str> = Some("2.17");

/// Every platform of the packed FMU; the first is the one that every build has.
pub const PLATFORMS: &[Platform] = &[
    Platform {
        folder: "linux64",
        triple: "x86_64-unknown-linux-gnu",
        zig_target: "x86_64-linux-gnu.2.17",
        extension: "so",
        format: BinaryFormat::Elf,
        architecture: Architecture::X86_64,
        linked: &["unwind"],
        libraries: &[
            "ld-linux-x86-64.so.2",
            "libc.so.6",
            "libdl.so.2",
            "libm.so.6",
            "libpthread.so.0",
            "librt.so.1",
        ],
        newest_glibc: GLIBC,
    },
    Platform {
        folder: "win64",
        // Not `windows-gnu`, which has no section for each function: the linker could drop none.
        triple: "x86_64-pc-windows-gnullvm",
        zig_target: "x86_64-windows-gnu",
        extension: "dll",
        format: BinaryFormat::Pe,
        architecture: Architecture::X86_64,
        linked: &["unwind", "ws2_32", "userenv"],
        // Part of Windows 10 and later, which Rust's standard library needs anyway.
        libraries: &[
            "KERNEL32.dll",
            "ntdll.dll",
            "bcryptprimitives.dll",
            "USERENV.dll",
            "WS2_32.dll",
            "api-ms-win-core-synch-l1-2-0.dll",
            "api-ms-win-crt-*",
        ],
        newest_glibc: None,
    },
    Platform {
        folder: "aarch64-linux",
        triple: "aarch64-unknown-linux-gnu",
        zig_target: "aarch64-linux-gnu.2.17",
        extension: "so",
        format: BinaryFormat::Elf,
        architecture: Architecture::Aarch64,
        linked: &["unwind"],
        libraries: &[
            "ld-linux-aarch64.so.1",
            "libc.so.6",
            "libdl.so.2",
            "libm.so.6",
            "libpthread.so.0",
            "librt.so.1",
        ],
        newest_glibc: GLIBC,
    },
    Platform {
        folder: "darwin64",
        triple: "x86_64-apple-darwin",
        zig_target: "x86_64-macos.11.0",
        extension: "dylib",
        format: BinaryFormat::MachO,
        architecture: Architecture::X86_64,
        linked: &[],
        libraries: &["/usr/lib/libSystem.B.dylib"],
        newest_glibc: None,
    },
];
