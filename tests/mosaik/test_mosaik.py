"""mosaik-fmi runs the packed FMU in co-simulation and in model exchange, and gets what FMPy gets."""

import shutil
import subprocess
import sys
from pathlib import Path

import pytest

import run_in_host
from dielectric_actuator import packed_fmu

PACKAGES = Path(sys.prefix) / "mosaik"
"""mosaik-fmi and fmipp, where `make test-mosaik` puts them."""


@pytest.mark.parametrize("kind", ["cs", "me"])
def test_the_motion_is_that_of_fmpy(kind, tmp_path):
    shutil.copy(packed_fmu(), tmp_path)
    script = Path(__file__).parent / "run_in_mosaik.py"
    command = [sys.executable, script, PACKAGES, tmp_path, kind]
    run = subprocess.run(command, capture_output=True, text=True, timeout=600, check=False)
    assert run.returncode == 0, f"ended with {run.returncode}:\n{run.stdout[-2000:]}\n{run.stderr[-2000:]}"
    got = [[float(word) for word in line.split()[1:]] for line in run.stdout.splitlines() if line.startswith("row")]
    expected = run_in_host.with_fmpy(packed_fmu())[1:]
    assert len(got) == run_in_host.STEPS
    # fmipp passes its time resolution, 1e-9, as the tolerance.
    for here, there in zip(got, expected):
        assert here == pytest.approx(there, abs=1e-9)
