//! The live page: one HTML file in which the actuator runs as WebAssembly, put together from `page`.

use std::env;
use std::fs;
use std::process::{Command, Stdio};

use anyhow::{Context, Result, ensure};
use cargo_metadata::Metadata;
use cargo_metadata::camino::Utf8PathBuf;
use object::{Architecture, BinaryFormat};

use crate::library;
use crate::licences;
use crate::platform::Platform;
use crate::toolchain::{Toolchain, tool};
use crate::zig::said;

/// Name of the page in the FMU, below `documentation`.
pub const NAME: &str = "actuator.html";

/// The package that becomes the WebAssembly.
pub const PACKAGE: &str = "page-core";

/// What a browser is to the compiler. It gets no binary of its own in the FMU.
pub const BROWSER: Platform = Platform {
    folder: "",
    triple: "wasm32-unknown-unknown",
    zig_target: "wasm32-freestanding",
    extension: "wasm",
    format: BinaryFormat::Wasm,
    architecture: Architecture::Wasm32,
    linked: &[],
    libraries: &[],
    newest_glibc: None,
};

/// Lets the compiler use vectors, which browsers have had since 2023: without them each operation becomes one for
/// each lane, which takes twice the time to compile.
const VECTORS: &str = "\x1f-Ctarget-feature=+simd128";

/// The page as HTML. It is left in `target/page` too.
///
/// # Errors
/// If the compiler, node or what npm fetches for it is missing, or one of them fails: which, and what to do.
pub fn html(project: &Metadata) -> Result<String> {
    let node = tool("NODE")?;
    let modules = tool("NODE_MODULES")?;
    let toolchain = Toolchain::find(&BROWSER)?;
    let folder = project.target_directory.join("page");
    fs::create_dir_all(&folder).with_context(|| format!("cannot make {folder}"))?;
    let core = compile(project, &toolchain)?;
    let notices = folder.join("licences.txt");
    fs::write(&notices, licences::of_the_page(project, &BROWSER, PACKAGE)?)
        .with_context(|| format!("cannot write {notices}"))?;
    let output = folder.join("index.html");
    let built = Command::new(node)
        .env("NODE_MODULES", modules)
        .arg(project.workspace_root.join("page/build.mjs"))
        .args([&core, &notices, &output])
        .output()
        .context("cannot start node")?;
    ensure!(
        built.status.success(),
        "page/build.mjs failed:\n{}",
        said(&built)
    );
    fs::read_to_string(&output).with_context(|| format!("cannot read {output}"))
}

/// Compiles the actuator to WebAssembly and returns the path of the file.
fn compile(project: &Metadata, toolchain: &Toolchain) -> Result<Utf8PathBuf> {
    let mut flags = library::flags(project, toolchain, &BROWSER)?;
    flags.push_str(VECTORS);
    let status = Command::new(env::var_os("CARGO").unwrap_or_else(|| "cargo".into()))
        .current_dir(&project.workspace_root)
        .args(["build", "--locked", "--quiet", "--profile", "page"])
        .args(["--package", PACKAGE, "--target", BROWSER.triple])
        .env("RUSTC", &toolchain.rustc)
        .env("CARGO_ENCODED_RUSTFLAGS", flags)
        .stdout(Stdio::null())
        .status()
        .context("cannot start cargo")?;
    ensure!(
        status.success(),
        "cargo could not compile {PACKAGE} for {} ({status}); see its messages above",
        BROWSER.triple
    );
    let folder = project.target_directory.join(BROWSER.triple);
    Ok(folder.join("page/page_core.wasm"))
}
