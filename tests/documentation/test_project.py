"""What is said about the project as a whole is said in one way: citation, versions, lints."""

import re
import tomllib
from pathlib import Path

import pytest
import yaml

from linked import tree

REPOSITORY = Path(__file__).resolve().parents[2]
PAPER = "Nonlinear dynamics of miniaturized dielectric elastomer actuators with surface effects"
AUTHORS = ["Akhil Pratap Singh", "Gal Shmuel", "Atul Kumar Sharma"]
CRATES = [
    path
    for pattern in ("Cargo.toml", "*/Cargo.toml", "*/*/Cargo.toml")
    for path in REPOSITORY.glob(pattern)
    if "target" not in path.relative_to(REPOSITORY).parts
]


def manifest(path: Path) -> dict:
    return tomllib.loads(path.read_text())


def test_the_citation_names_this_version_and_the_paper_in_full():
    citation = yaml.safe_load((REPOSITORY / "CITATION.cff").read_text())
    assert re.fullmatch(r"1\.\d\.\d", citation["cff-version"])
    assert {"message", "title", "type", "authors", "license"} <= citation.keys()
    assert citation["version"] == manifest(REPOSITORY / "Cargo.toml")["workspace"]["package"]["version"]
    assert " OR ".join(citation["license"]) == manifest(REPOSITORY / "Cargo.toml")["workspace"]["package"]["license"]
    (paper,) = citation["references"]
    assert paper["title"] == PAPER
    assert [f"{author['given-names']} {author['family-names']}" for author in paper["authors"]] == AUTHORS


@pytest.mark.parametrize(
    "page", ["README.md", "ARCHITECTURE.md", "docs/paper.md", "docs/guide/0-model.md", "python/README.md"]
)
def test_the_pages_cite_the_paper_as_the_citation_does(page):
    text = re.sub(r"\s*\n(> )?\s*", " ", (REPOSITORY / page).read_text())
    assert PAPER in text
    assert f"{AUTHORS[0]}, {AUTHORS[1]} and {AUTHORS[2]}" in text


def test_every_member_takes_version_and_licence_from_the_workspace():
    workspace = manifest(REPOSITORY / "Cargo.toml")["workspace"]
    members = [path for pattern in (".", *workspace["members"]) for path in REPOSITORY.glob(f"{pattern}/Cargo.toml")]
    assert len(members) == 6
    for path in members:
        own = manifest(path)["package"]
        assert {key for key in workspace["package"] if own[key] != {"workspace": True}} == set(), path


@pytest.mark.parametrize("path", CRATES, ids=lambda path: str(path.parent.relative_to(REPOSITORY)))
def test_every_crate_has_the_lints_of_the_workspace(path):
    wanted = manifest(REPOSITORY / "Cargo.toml")["workspace"]["lints"]
    lints = manifest(path)["lints"]
    # The benchmark and the fuzzer are workspaces of their own and cannot refer to this one.
    assert lints == {"workspace": True} or lints == wanted


def test_packager_and_tests_share_one_build_of_the_actuator():
    def crates(*selection: str) -> set[str]:
        """Each crate with its features."""
        return {line.removesuffix(" (*)") for line in tree("--format", "{p} {f}", *selection).splitlines()}

    of_the_packager = crates("--package", "packaging", "--edges", "normal,build")
    assert len(of_the_packager) > 50
    assert of_the_packager <= crates("--workspace", "--edges", "normal,build,dev")


def test_the_tables_of_performance_are_those_of_the_newest_record(monkeypatch):
    monkeypatch.syspath_prepend(str(REPOSITORY / "benchmark"))
    from page import PAGE, renewed

    assert renewed(PAGE.read_text()) == PAGE.read_text()


def test_a_record_of_one_command_renews_its_tables_and_no_others(monkeypatch, tmp_path):
    monkeypatch.syspath_prepend(str(REPOSITORY / "benchmark"))
    from page import PAGE, newest, renewed

    for name in ("device.csv", "work_precision.csv"):
        folder = tmp_path / name
        folder.mkdir()
        (folder / name).write_bytes(newest(name).read_bytes())
        assert renewed(PAGE.read_text(), folder) == PAGE.read_text()
