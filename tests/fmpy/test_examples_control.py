"""The control example: its curve, its linearization, and what its loops achieve."""

import math
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import controllers
import loop
import pages
from quasi_static import squared_voltages

REPOSITORY = Path(__file__).resolve().parents[2]
EXAMPLE = REPOSITORY / "examples" / "control"


def test_the_quasi_static_voltage_holds_the_stretch(actuator):
    stretches = np.array([1.02, 1.08, 1.15])
    for stretch, squared in zip(stretches, squared_voltages(actuator, loop.SCENE, stretches)):
        actuator.start({**loop.SCENE, "lambda_start": stretch, "phi": math.sqrt(squared)})
        actuator.advance(100.0)
        # the voltage is rounded, the equilibrium stable
        assert actuator.get("lambda") == pytest.approx(stretch, abs=1e-13)


def test_looking_ahead_leaves_no_trace(actuator):
    def run(look):
        actuator.start({**loop.SCENE, "phi": 0.4})
        stretches = []
        for k in range(20):
            if look and k % 3 == 0:
                with actuator.looking_ahead():
                    actuator.set({"phi": 0.9, "S": 0.5})
                    actuator.advance(25.0)
            actuator.advance(1.7)
            stretches.append(actuator.get("lambda"))
        return stretches

    assert run(look=True) == run(look=False)


def test_the_predicted_influence_of_the_plan_is_that_of_the_motion(actuator):
    """Against central differences of whole runs; the derivatives are frozen over a sample, hence the tolerance."""
    period, count, change = 0.25, 24, 1e-5  # change of φ²
    predictive = controllers.Predictive(actuator, loop.SCENE, lambda time: 1.0, period)
    plan = (0.4 + 0.2 * np.sin(np.arange(count) / 4)) ** 2
    measured = controllers.Measured(0.0, 1.02, 0.003, 1.0)
    predictive._start(measured)
    stretches, influences = predictive._linearized(plan)

    def final(plan):
        actuator.start({**loop.SCENE, "lambda_start": measured.stretch, "lambda_dot_start": measured.rate})
        for squared in plan:
            actuator.set({"phi": math.sqrt(squared)})
            actuator.advance(period)
        return actuator.get("lambda")

    assert final(plan) == pytest.approx(stretches[-1], abs=1e-12)
    unit = np.eye(count)
    differences = [(final(plan + change * row) - final(plan - change * row)) / (2 * change) for row in unit]
    assert influences[-1] == pytest.approx(differences, abs=0.02 * max(differences))


def test_the_loops_do_what_the_page_says(fmu_path, tmp_path):
    options = ["--fmu", fmu_path, "--output", tmp_path, "--periods", "2"]
    done = subprocess.run(
        [sys.executable, EXAMPLE / "control.py", *options], capture_output=True, text=True, timeout=300
    )
    assert done.returncode == 0, done.stderr
    rows = [line.split() for line in done.stdout.splitlines() if line[:1] in "12"]
    deviations = {(float(row[0]), row[1]): float(row[-2]) for row in rows}
    assert set(deviations) == {(period, name) for period in (1.0, 2.0) for name in ("PID", "predictive")}
    for period, cells in pages.table(EXAMPLE / "README.md", "Sampling period").items():
        if period in "12":
            found = [deviations[float(period), name] for name in ("PID", "predictive")]
            assert found == pytest.approx([float(cell) for cell in cells[:2]], rel=0.1)
    ends = dict(line.split(": ") for line in done.stdout.splitlines() if line.startswith("target beyond the fold"))
    assert len(ends) == 3
    for name, end in ends.items():
        assert end.startswith("pulled in" if "without" in name else "largest stretch 1.1"), name
    assert sorted(path.name for path in tmp_path.iterdir()) == ["near_pull_in.png", "sampling.png", "tracking.png"]
