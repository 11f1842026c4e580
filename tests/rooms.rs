//! The import law: which module may know which, as ARCHITECTURE.md draws it.

use std::fs;
use std::path::{Path, PathBuf};

/// Room, the rooms of ours it may import, the foreign crates it may import.
const LAW: &[(&str, &[&str], &[&str])] = &[
    ("solver", &[], &["fearless_simd", "nalgebra", "serde"]),
    ("actuator", &["solver"], &["fearless_simd", "serde"]),
    ("pull_in", &["actuator", "solver"], &[]),
    ("scene", &["actuator", "model", "solver"], &["serde"]),
    ("model", &["solver", "variables"], &["serde"]),
    ("shortest", &[], &[]),
    (
        "variables",
        &["actuator", "model", "shortest", "solver"],
        &[],
    ),
    (
        "view",
        &[
            "actuator",
            "model",
            "nondimensional",
            "pull_in",
            "scene",
            "solver",
        ],
        &[],
    ),
    (
        "nondimensional",
        &[
            "description",
            "model",
            "scene",
            "shortest",
            "slave",
            "solver",
            "variables",
            "view",
        ],
        &["serde"],
    ),
    (
        "sweep",
        &["actuator", "scene", "solver"],
        &["fearless_simd"],
    ),
    ("sensitivity", &["actuator", "scene", "solver"], &[]),
    (
        "slave",
        &["actuator", "model", "shortest", "solver", "variables"],
        &["postcard", "serde"],
    ),
    (
        "description",
        &["model", "shortest", "variables"],
        &["quick_xml", "serde"],
    ),
    (
        "abi",
        &["description", "model", "nondimensional", "slave"],
        &["crc", "fmi", "libc"],
    ),
];

/// Longest file that is still read in one go.
const LINES: usize = 450;

fn sources(path: &Path) -> Vec<PathBuf> {
    if path.is_file() {
        return vec![path.to_owned()];
    }
    let entries = fs::read_dir(path).expect("a folder of the sources");
    entries
        .flat_map(|entry| sources(&entry.expect("an entry").path()))
        .collect()
}

/// The room of a file: its folder or file below `src`.
fn room(file: &Path) -> String {
    let below = file.strip_prefix(root()).expect("a source file");
    let first = below.components().next().expect("a name").as_os_str();
    first.to_string_lossy().trim_end_matches(".rs").to_owned()
}

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("src")
}

#[test]
fn each_room_imports_only_what_it_may() {
    let foreign = [
        "fmi",
        "libc",
        "nalgebra",
        "postcard",
        "crc",
        "quick_xml",
        "serde",
        "fearless_simd",
    ];
    for file in sources(&root()) {
        let room = room(&file);
        if room == "lib" {
            continue;
        }
        let &(_, ours, crates) = LAW
            .iter()
            .find(|(name, ..)| *name == room)
            .unwrap_or_else(|| panic!("the law has no row for src/{room}"));
        let text = fs::read_to_string(&file).expect("a text");
        for (number, line) in text.lines().enumerate() {
            let code = line.split("//").next().unwrap_or_default();
            for found in code.split("crate::").skip(1) {
                let name: String = found
                    .chars()
                    .take_while(|c| c.is_alphanumeric() || *c == '_')
                    .collect();
                // Macros stand at the root of the crate, in no room.
                let is_room = LAW.iter().any(|(room, ..)| *room == name);
                let allowed = !is_room || name == room || ours.contains(&name.as_str());
                assert!(
                    allowed,
                    "{}:{}: {room} may not import {name}",
                    file.display(),
                    number + 1
                );
            }
            for name in foreign {
                let used = code.contains(&format!("{name}::"));
                let allowed = !used || crates.contains(&name);
                assert!(
                    allowed,
                    "{}:{}: {room} may not use {name}",
                    file.display(),
                    number + 1
                );
            }
        }
    }
}

#[test]
fn unsafe_code_stands_in_the_abi_only() {
    for file in sources(&root()) {
        let text = fs::read_to_string(&file).expect("a text");
        assert!(
            room(&file) == "abi" || !text.contains("unsafe {"),
            "{} has unsafe code",
            file.display()
        );
    }
}

#[test]
fn files_stay_readable() {
    for file in sources(&root()) {
        let lines = fs::read_to_string(&file).expect("a text").lines().count();
        assert!(lines <= LINES, "{} has {lines} lines", file.display());
    }
}
