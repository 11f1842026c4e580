"""What these tests share: the packed FMU, unpacked."""

import sys
import zipfile
from pathlib import Path

import pytest

REPOSITORY = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(REPOSITORY / "studies"))

from actuator_fmu import DEFAULT_FMU  # noqa: E402


@pytest.fixture(scope="session")
def fmu() -> Path:
    """The packed FMU; a test that needs it fails where there is none."""
    if not DEFAULT_FMU.is_file():
        pytest.fail(f"no FMU at {DEFAULT_FMU}: build and pack it first (make fmu)", pytrace=False)
    return DEFAULT_FMU


@pytest.fixture(scope="session")
def library(fmu, tmp_path_factory) -> Path:
    """The shared library in the packed FMU."""
    folder = tmp_path_factory.mktemp("fmu")
    with zipfile.ZipFile(fmu) as archive:
        return Path(archive.extract("binaries/linux64/DielectricElastomerActuator.so", folder))
