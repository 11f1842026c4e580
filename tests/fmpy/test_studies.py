"""The studies' own arithmetic, and the demonstration from end to end."""

import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import turning_points
from comparison import Comparison, Row

REPOSITORY = Path(__file__).resolve().parents[2]


def sampled(time):
    """λ = 1.2 − 0.2 cos t: turning points at the multiples of π."""
    response = np.zeros(len(time), dtype=[(name, float) for name in ("time", *turning_points.OUTPUTS)])
    response["time"] = time
    response["lambda"] = 1.2 - 0.2 * np.cos(time)
    response["lambda_dot"] = 0.2 * np.sin(time)
    response["lambda_ddot"] = 0.2 * np.cos(time)
    return response


def test_turning_points_lie_between_the_samples():
    times, stretches = turning_points.turning_points(sampled(np.arange(0, 10, 0.05)))
    assert times == pytest.approx(np.pi * np.arange(1, 4), abs=1e-10)
    assert stretches == pytest.approx([1.4, 1.0, 1.4], abs=1e-13)


def test_a_sample_on_a_turning_point_counts_once():
    time = np.linspace(0, 10, 201)
    response = sampled(time)
    response["lambda_dot"][np.abs(time - 5) < 2] = 0.0
    times, _ = turning_points.turning_points(response)
    assert len(times) == 2
    exact = sampled(np.array([0.0, np.pi - 0.1, np.pi, np.pi + 0.1]))
    exact["lambda_dot"][2] = 0.0
    assert turning_points.turning_points(exact)[0] == pytest.approx([np.pi], abs=1e-12)


def test_range_includes_the_ends_of_the_window():
    assert turning_points.stretch_range(sampled(np.linspace(1.0, 2.0, 20))) == pytest.approx(
        (1.2 - 0.2 * np.cos(1.0), 1.2 - 0.2 * np.cos(2.0))
    )


def test_no_period_without_two_turning_points():
    with pytest.raises(ValueError, match="no full period"):
        turning_points.period_and_overshoot(sampled(np.arange(0, 6, 0.1)))


@pytest.mark.parametrize(
    "printed, exact, misprinted",
    [("0.6899", 0.689848, True), ("0.6898", 0.689848, False), ("0.647", 0.6466, False), (None, 1.0, False)],
)
def test_misprints_are_told_from_rounding(printed, exact, misprinted):
    assert Row("phi^C", printed, exact, exact).misprinted is misprinted


def test_table_is_aligned_and_narrow():
    table = Comparison()
    table.heading("pull-in")
    table.add("phi^C", printed="0.6899", exact=0.689848, measured=0.6898481)
    table.add("period", exact=27.2447459678, measured=27.2447459679)
    text = table.text()
    assert max(map(len, text.splitlines())) <= 100
    first, second = (line for line in text.splitlines() if line.startswith(("  phi", "  period")))
    assert "0.6899*" in first and "+1.0e-07" in first
    assert [i for i, c in enumerate(first) if c == "."][1:] == [i for i, c in enumerate(second) if c == "."]


def test_runner_names_a_misspelt_variable(actuator):
    with pytest.raises(KeyError, match="no variable 'lamda'"):
        actuator.start({"lamda": 1.0})


def test_runner_passes_on_what_the_fmu_said(actuator):
    with pytest.raises(Exception) as refusal:
        actuator.start({"c": -1.0})
    assert any("c" in note and "-1" in note for note in refusal.value.__notes__)


def test_demonstration(fmu_path, tmp_path):
    done = subprocess.run(
        [sys.executable, str(REPOSITORY / "studies" / "demonstration.py"), "--fmu", fmu_path, "--output", tmp_path],
        capture_output=True,
        text=True,
        timeout=600,
    )
    assert done.returncode == 0, done.stderr
    pictures = sorted(path.name for path in tmp_path.iterdir())
    assert pictures == [
        "ac_response.png",
        "dc_with_prestress.png",
        "dc_without_prestress.png",
        "pull_in.png",
        "snap.png",
    ]
    assert all(str(tmp_path / name) in done.stdout for name in pictures)
    printed = [line for line in done.stdout.splitlines() if str(tmp_path) not in line]
    assert max(map(len, printed)) <= 100
    differences = [float(line.split()[-1]) for line in printed if re.search(r" [+-]\d\.\de[+-]\d\d$", line)]
    assert len(differences) == 14 * 2 + 13 * 3 + 1 + 3 * 4
    assert max(map(abs, differences)) <= 1e-9


def test_demonstration_without_an_fmu_says_what_to_do(tmp_path):
    done = subprocess.run(
        [sys.executable, str(REPOSITORY / "studies" / "demonstration.py"), "--fmu", tmp_path / "none.fmu"],
        capture_output=True,
        text=True,
    )
    assert done.returncode == 2
    assert "make fmu" in done.stderr and "Traceback" not in done.stderr
