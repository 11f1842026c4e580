"""Independent hosts run the packed FMU and get what FMPy gets, bit for bit."""

import math
import subprocess
import sys
from functools import cache
from pathlib import Path

import pytest

import run_in_host

HERE = Path(__file__).parent


@cache
def rows(host: str, fmu: Path) -> list[list[float]]:
    """λ and λ3 at each communication point as `host` gets them, in a process of its own."""
    command = [sys.executable, HERE / "run_in_host.py", host, fmu]
    run = subprocess.run(command, capture_output=True, text=True, timeout=600, check=False)
    assert run.returncode == 0, f"{host} ended with {run.returncode}:\n{run.stdout[-2000:]}\n{run.stderr[-2000:]}"
    lines = [line.split()[1:] for line in run.stdout.splitlines() if line.startswith("row")]
    return [[float(number) for number in line] for line in lines]


@pytest.mark.parametrize("host", [host for host in run_in_host.HOSTS if host != "fmpy"])
def test_another_host_gets_the_same_motion(host, fmu):
    if not run_in_host.is_there(host):
        pytest.skip(f"{host} is missing: it has no package for this platform (tests/hosts/requirements.txt)")
    expected, got = rows("fmpy", fmu), rows(host, fmu)
    assert len(got) == len(expected) == run_in_host.STEPS + 1
    # One reads only after the first step.
    first = 1 if math.isnan(got[0][0]) else 0
    assert got[first:] == expected[first:]
    assert len({row[0] for row in got}) > run_in_host.STEPS / 2, "it moves"
