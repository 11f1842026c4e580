"""The lag example: what it prints is what it teaches."""

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from fmpy import simulate_fmu

import pages

REPOSITORY = Path(__file__).resolve().parents[2]


def test_each_derivative_gains_an_order_and_the_collapse_is_located(fmu_path, tmp_path):
    done = subprocess.run(
        [sys.executable, REPOSITORY / "examples" / "lag" / "lag.py", "--fmu", fmu_path, "--output", tmp_path],
        capture_output=True,
        text=True,
        timeout=600,
    )
    assert done.returncode == 0, done.stderr
    rows = [line.split() for line in done.stdout.splitlines() if line[:1].isdigit()]
    count, *errors = np.array(rows, dtype=float).T
    assert len(errors) == 4 and len(count) == 8
    slopes = [-np.polyfit(np.log(count[2:]), np.log(error[2:]), 1)[0] for error in errors]
    assert slopes == pytest.approx([1, 2, 3, 4], abs=0.15)
    written = pages.table(REPOSITORY / "docs" / "guide" / "2-inputs-and-steps.md", "Steps in a period")
    assert list(written) == ["8", "32", "128", "1024"]
    for steps, cells in written.items():
        # the last digit may differ where a processor rounds otherwise
        measured = [error[list(count).index(int(steps))] for error in errors]
        assert list(map(float, cells)) == pytest.approx(measured, rel=0.11)
    last = done.stdout.split("pulled_in first true at ")[1].split()
    assert float(last[0].rstrip(",")) == 42 and last[2].rstrip(",") == last[-2]
    assert sorted(path.name for path in tmp_path.iterdir()) == ["inputs.png", "pull_in.png"]


def test_fmpys_own_flag_for_input_derivatives_is_broken(fmu_path):
    """When this fails, FMPy has mended it: say so in the lag example and in the guide."""
    signal = np.array([(0.0, 0.0, 0.0), (10.0, 0.1, 0.0)], dtype=[(name, float) for name in ("time", "phi", "S")])
    with pytest.raises(ValueError):
        simulate_fmu(str(fmu_path), input=signal, stop_time=10.0, set_input_derivatives=True)
