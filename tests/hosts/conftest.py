"""What these tests share: the packed FMU, unpacked."""

import zipfile
from pathlib import Path

import pytest

from dielectric_actuator import packed_fmu


@pytest.fixture(scope="session")
def fmu() -> Path:
    """The packed FMU; a test that needs it fails where there is none."""
    path = packed_fmu()
    if not path.is_file():
        pytest.fail(f"no FMU at {path}: build and pack it first (make fmu)", pytrace=False)
    return path


@pytest.fixture(scope="session")
def library(fmu, tmp_path_factory) -> Path:
    """The shared library in the packed FMU."""
    folder = tmp_path_factory.mktemp("fmu")
    with zipfile.ZipFile(fmu) as archive:
        return Path(archive.extract("binaries/linux64/DielectricElastomerActuator.so", folder))
