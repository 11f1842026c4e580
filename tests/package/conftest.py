"""What the tests of the installed package share."""

import pytest

from dielectric_actuator import Actuator


@pytest.fixture(scope="module")
def actuator():
    """One loaded actuator for the tests of a file."""
    with Actuator() as actuator:
        yield actuator
