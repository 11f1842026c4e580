"""What the FMPy tests share: the packed FMU, and the package's `Actuator` that they drive it with."""

from pathlib import Path

import fmpy
import pytest

from dielectric_actuator import Actuator, packed_fmu
from dielectric_actuator.fmu import instantiate as load


def pytest_addoption(parser):
    parser.addoption("--fmu", type=Path, default=packed_fmu(), help="the packed FMU to test (default: %(default)s)")


@pytest.fixture(scope="session")
def fmu_path(request) -> Path:
    """The packed FMU; a test that needs it fails where there is none."""
    return there(request.config.getoption("--fmu"))


@pytest.fixture(scope="session")
def si_path(fmu_path) -> Path:
    """The packed FMU in SI units, which lies beside the other."""
    return there(fmu_path.with_name("DielectricElastomerActuatorSI.fmu"))


def there(path: Path) -> Path:
    if not path.is_file():
        pytest.fail(f"no FMU at {path}: build and pack it first (make fmu)", pytrace=False)
    return path


@pytest.fixture(scope="session")
def description(fmu_path):
    """FMPy's reading of the model description."""
    return fmpy.read_model_description(str(fmu_path))


@pytest.fixture(scope="session")
def session_actuator(fmu_path):
    with Actuator(fmu_path) as actuator:
        yield actuator


@pytest.fixture
def actuator(session_actuator) -> Actuator:
    """The runner; `start` resets it, so that tests do not see each other."""
    return session_actuator


@pytest.fixture(scope="session")
def unpacked(fmu_path, tmp_path_factory) -> str:
    """A folder with the unpacked FMU."""
    return fmpy.extract(str(fmu_path), unzipdir=str(tmp_path_factory.mktemp("fmu")))


@pytest.fixture
def instantiate(unpacked, description):
    """A function that makes a bare FMPy instance, its log messages in the attribute `log`; freed after the test."""
    made = []

    def make():
        log = []
        instance = load(unpacked, description, log)
        instance.log = log
        made.append(instance)
        return instance

    yield make
    for instance in made:
        instance.freeInstance()


@pytest.fixture(scope="session")
def reference_of(description):
    """Value reference by variable name."""
    return {variable.name: variable.valueReference for variable in description.modelVariables}
