"""The FMU in SI units against every reference scene, exact periods and published numbers (docs/validation.md)."""

import re
from pathlib import Path

import numpy as np
import pytest

import validation
from device_scenes import SCENES
from dielectric_actuator import Actuator

PAGE = Path(__file__).resolve().parents[2] / "docs" / "validation.md"


@pytest.fixture(scope="module")
def device(si_path):
    with Actuator(si_path) as actuator:
        yield actuator


@pytest.mark.parametrize("name", SCENES)
def test_scenes_to_nine_digits_and_energy_to_ten(device, name):
    """Measured: 1.4e-11, of the balance 2.6e-12; 3.4e-10 where the turn is next to the locking stretch."""
    errors = validation.errors(device, name, 1e-10)
    assert validation.largest_of(*errors) < (1e-9 if name == "G_gent_snap" else 2e-10), errors
    assert errors.balance < 3e-11, errors


def test_errors_follow_the_tolerance(device):
    """Measured: 1.4e-12."""
    for name in SCENES:
        if name != "G_gent_snap":
            errors = validation.errors(device, name, 1e-12)
            assert validation.largest_of(*errors) < 2e-11, (name, errors)


def test_a_turn_next_to_the_locking_stretch_costs_digits(device):
    """Twelve bounces there make the last digits chance, whatever the tolerance: the median of some runs counts."""
    tolerances = (5e-13, 8e-13, 1e-12, 1.2e-12, 2e-12)
    errors = [validation.largest_of(*validation.errors(device, "G_gent_snap", tolerance)) for tolerance in tolerances]
    assert np.median(errors) < 2e-10, errors


def test_periods(device):
    found = list(validation.periods(device))
    assert len(found) == 6
    for name, end, turn in found:
        # Measured: 3.3e-15 (1.4e-13 next to the locking stretch) and 2.2e-16. The first grows with the square of the
        # error of the period.
        assert end < (1e-11 if name == "G_gent_snap" else 2e-13) and turn < 5e-15, name


def test_published_numbers(device):
    rows = list(validation.published(device))
    assert len(rows) == 13
    # A series without its next term, and a number of 12 digits; of the others 4.4e-15 is measured.
    allowed = {"creep of a small step after τ, to φ²": 2e-5, "least thickness stretch": 1e-12}
    assert allowed.keys() <= {row.what for row in rows}
    for row in rows:
        assert row.difference() < allowed.get(row.what, 5e-14), row
        # the page quotes the source and the first digits
        assert row.source in PAGE.read_text(), row.source
        if re.fullmatch(r"\d\.\d+", row.published):
            digits = len(row.published.partition(".")[2])
            assert f"{row.found:.{digits}f}" == row.published, row
