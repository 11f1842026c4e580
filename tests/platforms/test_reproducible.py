"""Two builds of the same sources, in different folders, give the same FMUs, native library and page byte for byte."""

import os
import shutil
import subprocess
import zipfile
from pathlib import Path

import pytest

from conftest import MODELS, REPOSITORY, packed

# Both FMUs are compiled anew for every platform: ten minutes, and more where the machine is busy.
pytestmark = pytest.mark.timeout(3600)


@pytest.fixture(scope="module")
def elsewhere(tmp_path_factory):
    """Another folder, in which the same was built from the same sources."""
    listed = subprocess.run(
        ["git", "ls-files", "--cached", "--others", "--exclude-standard", "-z"],
        cwd=REPOSITORY, capture_output=True, check=True,
    )  # fmt: skip
    elsewhere = tmp_path_factory.mktemp("build") / "another folder"
    for name in filter(None, os.fsdecode(listed.stdout).split("\0")):
        source, copy = REPOSITORY / name, elsewhere / name
        if source.is_file():
            copy.parent.mkdir(parents=True, exist_ok=True)
            shutil.copyfile(source, copy)
    with zipfile.ZipFile(packed(MODELS[0])) as fmu:
        platforms = {name.split("/")[1] for name in fmu.namelist() if name.startswith("binaries/")}
    arguments = ["--all"] if platforms != {"linux64"} else []
    subprocess.run(["cargo", "fmu", *arguments], cwd=elsewhere, check=True)
    subprocess.run(["cargo", "fmu", "native", *arguments], cwd=elsewhere, check=True)
    return elsewhere


def test_the_native_libraries_are_the_same(elsewhere):
    built = sorted((REPOSITORY / "target" / "native").glob("*/dielectric_actuator_native.*"))
    libraries = [path.relative_to(REPOSITORY) for path in built if path.suffix in (".so", ".dll", ".dylib")]
    assert libraries
    assert [path for path in libraries if (elsewhere / path).read_bytes() != (REPOSITORY / path).read_bytes()] == []


@pytest.mark.parametrize("model", MODELS)
def test_the_fmu_is_the_same(elsewhere, model):
    fmu = packed(model)
    again = elsewhere / fmu.relative_to(REPOSITORY)
    with zipfile.ZipFile(fmu) as one, zipfile.ZipFile(again) as other:
        assert one.namelist() == other.namelist()
        different = [name for name in one.namelist() if one.read(name) != other.read(name)]
    assert not different
    assert fmu.read_bytes() == again.read_bytes()


def test_the_live_page_is_the_same(elsewhere):
    page = Path("target", "page", "index.html")
    assert (elsewhere / page).read_bytes() == (REPOSITORY / page).read_bytes()
