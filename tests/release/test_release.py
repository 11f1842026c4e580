"""What `packaging/release.py` gathers: from the FMUs, the licences of the native library and the live page that are
built, with a stand-in of the wheel."""

import hashlib
import json
import os
import shutil
import subprocess
import sys
import zipfile
from pathlib import Path

import pytest
from cyclonedx.schema import SchemaVersion
from cyclonedx.validation.json import JsonStrictValidator

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "packaging"))

import release

import linked

WHEEL = f"dielectric_actuator-{release.workspace_version()}-py3-none-any.whl"
MEMBERS = {
    "DielectricElastomerActuator.fmu": "nondimensional-fmu",
    "DielectricElastomerActuatorSI.fmu": "si-fmu",
    "dielectric_actuator_native": "dielectric-actuator-native",
    release.PAGE: "page-core",
}
"""Each part that is shipped, with the member of the workspace that it is made of."""


@pytest.fixture
def target(tmp_path) -> Path:
    """A folder of what is built."""
    target = tmp_path / "target"
    for name in ("fmu", "page", "wheel"):
        (target / name).mkdir(parents=True)
    for name in release.FMUS:
        shutil.copyfile(release.TARGET / "fmu" / name, target / "fmu" / name)
    for name in ("index.html", "licences.txt"):
        shutil.copyfile(release.TARGET / "page" / name, target / "page" / name)
    with zipfile.ZipFile(target / "wheel" / WHEEL, "w") as wheel:
        for path in (release.TARGET / "native" / "documentation" / "licenses").iterdir():
            wheel.write(path, f"dielectric_actuator/data/native/licenses/{path.name}")
    return target


@pytest.fixture
def gather(target, tmp_path, monkeypatch):
    """A function that makes a release of the target and returns its folder."""
    monkeypatch.setattr(sys, "argv", ["release.py", "--output", str(tmp_path / "releases")])

    def gather(version: str = release.workspace_version()) -> Path:
        with monkeypatch.context() as patch:
            patch.setattr(release, "TARGET", target)
            assert release.main() == 0
        return tmp_path / "releases" / version

    return gather


@pytest.fixture
def bill(gather) -> str:
    return (gather() / release.BILL).read_text()


def parts_of(bill: str) -> dict[str, set[str]]:
    """What each part has in it."""
    return {entry["ref"]: set(entry.get("dependsOn", ())) for entry in json.loads(bill)["dependencies"]}


def test_the_bill_follows_the_schema(bill):
    assert JsonStrictValidator(SchemaVersion.V1_6).validate_str(bill) is None


def test_the_bill_lists_what_is_linked_in_and_nothing_that_only_builds(bill):
    components = {component["name"]: component for component in json.loads(bill)["components"]}
    assert {"fmi", "nalgebra", "serde", "libc", "quick-xml", "rayon", "rust-std", "llvm-libunwind", "FMPy"} <= set(
        components
    )
    assert not {"serde_derive", "bindgen", "proptest", "clap"} & set(components)
    crates = [component for component in components.values() if component.get("purl", "").startswith("pkg:cargo/")]
    assert len(crates) > 50
    for crate in crates:
        assert crate["licenses"] and len(crate["hashes"][0]["content"]) == 64
        assert crate["purl"].startswith(f"pkg:cargo/{crate['name']}@{crate['version'].partition('+')[0]}")


def test_the_bill_says_what_is_in_each_part(bill):
    parts = parts_of(bill)
    assert parts[f"dielectric-elastomer-actuator@{release.workspace_version()}"] == {*MEMBERS, "wheel"}
    page = parts.pop(release.PAGE)
    assert "llvm-libunwind" not in page
    assert parts["wheel"] >= {*MEMBERS, "pypi:FMPy"} - {release.PAGE}
    for name in MEMBERS.keys() - {release.PAGE}:
        assert "llvm-libunwind" in parts[name]
    # The page draws its plots with uPlot, and is in each FMU.
    for inside in (page, *(parts[fmu] for fmu in release.FMUS)):
        assert any(ref.startswith("npm:uplot@") for ref in inside)


@pytest.mark.parametrize("part", MEMBERS)
def test_the_bill_lists_the_crates_of_cargos_tree(bill, part):
    """`cargo metadata` lists what any member of the workspace asks for: `fmi` and five times as many for the page."""
    with zipfile.ZipFile(release.TARGET / "fmu" / release.FMUS[0]) as fmu:
        folders = {name.split("/")[1] for name in fmu.namelist() if name.startswith("binaries/")}
    if part == release.NATIVE:
        folders = {path.name for path in (release.TARGET / "native").iterdir()} & linked.TRIPLES.keys()
    triples = ["wasm32-unknown-unknown"] if part == release.PAGE else [linked.TRIPLES[name] for name in sorted(folders)]
    listed = {ref for ref in parts_of(bill)[part] if ref.startswith("cargo:")}
    assert listed == {f"cargo:{name}@{version}" for name, version in linked.crates(MEMBERS[part], triples)}
    assert any(ref.startswith("cargo:fmi@") for ref in listed) == (part != release.PAGE)


def test_what_windows_adds_is_in_the_bill(target, gather):
    fmu = target / "fmu" / release.FMUS[0]
    with zipfile.ZipFile(fmu) as opened:
        there = "documentation/licenses/mingw-w64.txt" in opened.namelist()
    assert ("mingw-w64" in parts_of((gather() / release.BILL).read_text())[fmu.name]) == there
    if not there:
        with zipfile.ZipFile(fmu, "a") as opened:
            opened.writestr("documentation/licenses/mingw-w64.txt", "")
    assert "mingw-w64" in parts_of((gather() / release.BILL).read_text())[fmu.name]


def test_the_bill_is_the_same_each_time(bill, gather):
    assert (gather() / release.BILL).read_text() == bill
    assert "timestamp" not in bill
    one, other = (json.loads(release.bill_of_materials(version, {})) for version in ("1.2.3", "1.2.4"))
    assert one["serialNumber"] != other["serialNumber"]


@pytest.mark.parametrize("missing", [f"wheel/{WHEEL}", *(f"fmu/{name}" for name in release.FMUS)])
def test_a_release_needs_every_fmu_and_the_wheel(target, tmp_path, monkeypatch, capsys, missing):
    (target / missing).unlink()
    monkeypatch.setattr(release, "TARGET", target)
    monkeypatch.setattr(sys, "argv", ["release.py", "--output", str(tmp_path / "releases")])
    assert release.main() == 1 and f"not built: {target / missing}; run make release" in capsys.readouterr().err
    assert not (tmp_path / "releases").exists()


def test_a_list_that_names_nothing_is_refused(target):
    """Such as that of an FMU that was packed before the list had its name."""
    with pytest.raises(ValueError, match=r" has no page/documentation/licenses/license\.txt,.*run make release"):
        release.inside(target / "wheel" / WHEEL, "page/documentation/licenses/")
    with pytest.raises(ValueError, match="names no crate"):
        release.crates("nothing")


def test_a_release_is_a_folder_with_sums(target, gather):
    folder = gather()
    names = sorted(path.name for path in folder.iterdir())
    assert names == sorted([release.BILL, release.SUMS, WHEEL, *release.FMUS, release.PAGE])
    sums = dict(reversed(line.split("  ")) for line in (folder / release.SUMS).read_text().splitlines())
    assert sums == {
        name: hashlib.sha256((folder / name).read_bytes()).hexdigest() for name in names if name != release.SUMS
    }
    first = {path.name: path.read_bytes() for path in folder.iterdir()}
    assert {path.name: path.read_bytes() for path in gather().iterdir()} == first


def test_the_bill_of_a_release_without_the_page_has_no_page(target, gather):
    (target / "page" / "index.html").unlink()
    folder = gather()
    assert release.PAGE not in {path.name for path in folder.iterdir()}
    assert release.PAGE not in (folder / release.BILL).read_text()


def test_a_page_that_cannot_be_made_fails_the_packing():
    """It is left out only where NODE is unset. Without PROJECT_PYTHON nothing is packed if this goes wrong."""
    environment = {name: value for name, value in os.environ.items() if name not in ("NODE_MODULES", "PROJECT_PYTHON")}
    done = subprocess.run(
        ["cargo", "fmu"], cwd=release.PROJECT, env={**environment, "NODE": "node"}, capture_output=True, text=True,
        timeout=600, check=False,
    )  # fmt: skip
    assert done.returncode == 1
    assert "cannot make the live page" in done.stderr and "has no NODE_MODULES; run `make`" in done.stderr


def test_two_builds_of_the_wheel_are_equal():
    def build() -> bytes:
        done = subprocess.run(["make", "pack-wheel"], cwd=release.PROJECT, capture_output=True, text=True, timeout=600)
        assert done.returncode == 0, done.stderr
        (wheel,) = (release.TARGET / "wheel").glob("*.whl")
        return wheel.read_bytes()

    assert build() == build()
