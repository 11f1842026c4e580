"""What `packaging/release.py` gathers, from stand-ins of what is built."""

import hashlib
import json
import subprocess
import sys
from pathlib import Path

import pytest
from cyclonedx.schema import SchemaVersion
from cyclonedx.validation.json import JsonStrictValidator

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "packaging"))

import release


@pytest.fixture(scope="module")
def bill() -> str:
    return release.bill_of_materials(release.cargo_metadata(), "1.2.3")


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
    parts = {entry["ref"]: set(entry.get("dependsOn", ())) for entry in json.loads(bill)["dependencies"]}
    fmus = {"DielectricElastomerActuator.fmu", "DielectricElastomerActuatorSI.fmu"}
    assert parts["dielectric-elastomer-actuator@1.2.3"] == {
        *fmus, "dielectric_actuator_native", "dielectric_elastomer_actuator.html", "wheel"
    }  # fmt: skip
    assert fmus | {"dielectric_actuator_native", "pypi:FMPy"} <= parts["wheel"]

    def crates(part):
        return {ref.partition("@")[0].partition(":")[2] for ref in parts[part] if ref.startswith("cargo:")}

    for fmu in fmus:
        assert {"fmi", "nalgebra"} <= crates(fmu) and "rayon" not in crates(fmu) and "llvm-libunwind" in parts[fmu]
    assert {"rayon", "nalgebra"} <= crates("dielectric_actuator_native")
    page = parts["dielectric_elastomer_actuator.html"]
    assert any(ref.startswith("npm:uplot@") for ref in page) and "llvm-libunwind" not in page
    assert "nalgebra" in crates("dielectric_elastomer_actuator.html")


def test_the_bill_is_the_same_each_time(bill):
    assert release.bill_of_materials(release.cargo_metadata(), "1.2.3") == bill
    assert "timestamp" not in bill
    other = json.loads(release.bill_of_materials(release.cargo_metadata(), "1.2.4"))
    assert other["serialNumber"] != json.loads(bill)["serialNumber"]


def test_a_release_is_a_folder_with_sums(tmp_path, monkeypatch, capsys):
    version = release.workspace_version()
    target = tmp_path / "target"
    wheel = target / "wheel" / f"dielectric_actuator-{version}-py3-none-any.whl"
    monkeypatch.setattr(release, "TARGET", target)
    monkeypatch.setattr(sys, "argv", ["release.py", "--output", str(tmp_path / "releases")])
    assert release.main() == 1 and f"not built: {wheel}" in capsys.readouterr().err

    page = target / "page" / "index.html"
    for path in (wheel, target / "fmu" / "DielectricElastomerActuator.fmu", page):
        path.parent.mkdir(parents=True)
        path.write_bytes(path.name.encode())
    assert release.main() == 0
    folder = tmp_path / "releases" / version
    names = sorted(path.name for path in folder.iterdir())
    assert names == sorted([release.BILL, release.SUMS, wheel.name, "DielectricElastomerActuator.fmu",
                            "dielectric_elastomer_actuator.html"])  # fmt: skip
    sums = dict(reversed(line.split("  ")) for line in (folder / release.SUMS).read_text().splitlines())
    assert sums == {
        name: hashlib.sha256((folder / name).read_bytes()).hexdigest() for name in names if name != release.SUMS
    }
    first = {path.name: path.read_bytes() for path in folder.iterdir()}
    page.unlink()
    page.write_bytes(first["dielectric_elastomer_actuator.html"])
    assert release.main() == 0
    assert {path.name: path.read_bytes() for path in folder.iterdir()} == first


def test_two_builds_of_the_wheel_are_equal():
    def build() -> bytes:
        done = subprocess.run(["make", "pack-wheel"], cwd=release.PROJECT, capture_output=True, text=True, timeout=600)
        assert done.returncode == 0, done.stderr
        (wheel,) = (release.TARGET / "wheel").glob("*.whl")
        return wheel.read_bytes()

    assert build() == build()
