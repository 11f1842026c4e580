//! Holds the sources against the import law, which stands as a table in ARCHITECTURE.md.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

/// What the files of one room may import.
struct Room {
    rooms: Vec<String>,
    crates: Vec<String>,
}

/// The table of ARCHITECTURE.md, by room: the names in backticks of its first three columns.
fn law() -> BTreeMap<String, Room> {
    let text = read(&root().join("ARCHITECTURE.md"));
    let mut rows = text
        .lines()
        .skip_while(|line| !line.starts_with("| Room | may import | crates |"))
        .skip(2)
        .take_while(|line| line.starts_with('|'));
    let law: BTreeMap<String, Room> = rows
        .by_ref()
        .map(|line| {
            let cells: Vec<Vec<String>> = line.split('|').map(names).collect();
            let [_, room, rooms, crates, ..] = cells.as_slice() else {
                panic!("a row of the table has too few cells: {line}");
            };
            let room = room.first().expect("a room in backticks").clone();
            let (rooms, crates) = (rooms.clone(), crates.clone());
            (room, Room { rooms, crates })
        })
        .collect();
    assert!(!law.is_empty(), "ARCHITECTURE.md has no table of the rooms");
    law
}

/// What stands in backticks.
fn names(cell: &str) -> Vec<String> {
    cell.split('`')
        .skip(1)
        .step_by(2)
        .map(str::to_owned)
        .collect()
}

/// The crates on which the library depends, as they are written in Rust.
fn dependencies() -> Vec<String> {
    read(&root().join("Cargo.toml"))
        .lines()
        .skip_while(|line| *line != "[dependencies]")
        .skip(1)
        .take_while(|line| !line.starts_with('['))
        .filter_map(|line| line.split_once(" = "))
        .map(|(name, _)| name.replace('-', "_"))
        .collect()
}

/// Longest file that is still read in one go.
const LINES: usize = 450;

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

fn read(path: &Path) -> String {
    fs::read_to_string(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

fn sources() -> Vec<PathBuf> {
    files(&root().join("src"))
}

fn files(path: &Path) -> Vec<PathBuf> {
    if path.is_file() {
        return vec![path.to_owned()];
    }
    let entries = fs::read_dir(path).expect("a folder of the sources");
    entries
        .flat_map(|entry| files(&entry.expect("an entry").path()))
        .collect()
}

/// The room of a file: its folder or file below `src`.
fn room(file: &Path) -> String {
    let below = file
        .strip_prefix(root().join("src"))
        .expect("a source file");
    let first = below.components().next().expect("a name").as_os_str();
    first.to_string_lossy().trim_end_matches(".rs").to_owned()
}

/// A line without its comment.
fn code(line: &str) -> &str {
    line.split("//").next().unwrap_or_default()
}

/// The names that follow `crate::` in a line of code.
fn imported(code: &str) -> impl Iterator<Item = &str> {
    code.split("crate::").skip(1).map(|found| {
        let end = found.find(|c: char| !c.is_alphanumeric() && c != '_');
        &found[..end.unwrap_or(found.len())]
    })
}

#[test]
fn each_room_imports_only_what_it_may() {
    let (law, dependencies) = (law(), dependencies());
    for file in sources() {
        let room = room(&file);
        if room == "lib" {
            continue;
        }
        let Room { rooms, crates } = law
            .get(&room)
            .unwrap_or_else(|| panic!("the table in ARCHITECTURE.md has no row for src/{room}"));
        for (number, line) in read(&file).lines().enumerate() {
            let place = format!("{}:{}", file.display(), number + 1);
            let code = code(line);
            for name in imported(code) {
                assert!(
                    !name.is_empty(),
                    "{place}: one import a line; no group is read here"
                );
                // Macros stand at the root of the crate, in no room.
                let is_room = law.contains_key(name);
                let allowed = !is_room || name == room || rooms.iter().any(|room| room == name);
                assert!(allowed, "{place}: {room} may not import {name}");
            }
            for name in &dependencies {
                let allowed = !code.contains(&format!("{name}::")) || crates.contains(name);
                assert!(allowed, "{place}: {room} may not use the crate {name}");
            }
        }
    }
}

#[test]
fn the_table_of_rooms_names_what_there_is() {
    let (law, dependencies) = (law(), dependencies());
    let rooms: Vec<String> = sources().iter().map(|file| room(file)).collect();
    for (name, row) in &law {
        assert!(rooms.contains(name), "there is no room src/{name}");
        for imported in &row.rooms {
            let known = law.contains_key(imported);
            assert!(
                known,
                "the row of {name} names {imported}, which has no row"
            );
        }
        for imported in &row.crates {
            let known = dependencies.contains(imported);
            assert!(
                known,
                "the row of {name} names {imported}, not a dependency"
            );
        }
    }
}

/// Paths in backticks, of files and folders of the sources.
#[test]
fn what_the_architecture_names_is_there() {
    let text = read(&root().join("ARCHITECTURE.md"));
    for path in text.lines().flat_map(names) {
        let exists = !path.contains('/') || root().join(&path).exists();
        assert!(exists, "ARCHITECTURE.md names {path}, which is not there");
    }
}

#[test]
fn unsafe_code_stands_in_fmi2_only() {
    for file in sources() {
        let text = read(&file);
        let is_unsafe = text.lines().map(code).any(|line| {
            // The attributes name `unsafe_code`, which is another word.
            line.split(|c: char| !c.is_alphanumeric() && c != '_')
                .any(|word| word == "unsafe")
        });
        assert!(
            room(&file) == "fmi2" || !is_unsafe,
            "{} has unsafe code",
            file.display()
        );
    }
}

#[test]
fn files_stay_readable() {
    for file in sources() {
        let lines = read(&file).lines().count();
        assert!(lines <= LINES, "{} has {lines} lines", file.display());
    }
}
