"""What other hosts do where the FMU asks them to end the simulation: the table of docs/guide/3-pull-in.md."""

import subprocess
import sys
from pathlib import Path

import pytest

import run_in_host

ERRORS = {
    "fmpy": "FMICallException: fmi2DoStep failed with status 2 (discard)",
    "fmi": "RuntimeError: Error: Discard",
    "fmuloader": "Fmi2Error: fmi2DoStep returned ERROR (3)",
    "libcosimpy": "CosimExecution.step() gave False",
    "fmu_manipulation_toolbox": "FMICallException: fmi2DoStep failed with status 3 (error)",
    "pathsim_fmi": "FMICallException: fmi2DoStep failed with status 2 (discard)",
    "cofmupy": "FMICallException: fmi2DoStep failed with status 2 (discard)",
}
"""How a host that takes the discarded step for an error ends."""


def run(host: str, fmu: Path) -> subprocess.CompletedProcess:
    if not run_in_host.is_there(host):
        pytest.skip(f"{host} is missing: it has no package for this platform (tests/hosts/requirements.txt)")
    command = [sys.executable, Path(run_in_host.__file__), host, fmu, "terminate"]
    return subprocess.run(command, capture_output=True, text=True, timeout=600, check=False)


@pytest.mark.parametrize("host", ERRORS)
def test_a_host_that_takes_it_for_an_error(host, fmu):
    ended = run(host, fmu)
    assert ended.returncode == 1
    assert ERRORS[host] in ended.stderr.splitlines()[-1]


def test_ecos_goes_on_at_the_limit(fmu):
    ended = run("ecospy", fmu)
    assert ended.returncode == 0, ended.stderr
    rows = [line.split() for line in ended.stdout.splitlines() if line.startswith("row")]
    assert len(rows) == run_in_host.COLLAPSE_STEPS + 1
    assert rows[-1] == ["row", "10.0", "0.01"]


def test_every_host_is_in_the_table():
    assert {*ERRORS, "ecospy"} == {*run_in_host.HOSTS}
