"""The instructions that the packed library takes for a host's hot calls, counted under valgrind.

Unlike times they depend neither on the load nor on the speed of the machine. valgrind offers AVX2 at most, so that
the library takes the same way on every processor that has it. `bounds.json` holds the instructions a call; a change
that takes more than `ALLOWED` of them fails, and `make bless` writes new bounds.
"""

import functools
import json
import os
import re
import shlex
import shutil
import subprocess
import sys
import zipfile
from pathlib import Path

import fmpy
import pytest

from dielectric_actuator import packed_fmu

HERE = Path(__file__).parent
BOUNDS = HERE / "bounds.json"
ALLOWED = 1.02
"""Ratio to the bound; it leaves room for another C library."""
ZIG = shlex.split(os.environ.get("ZIG", f"{shlex.quote(sys.executable)} -m ziglang"))

COUNTS = {
    "step": 5000,
    "step_ac": 2000,
    "set_step_get": 2000,
    "long_step_dc": 200,
    "long_step_ac": 40,
    "get": 2000,
    "get_threshold": 500,
    "save_restore": 200,
    "device_get": 500,
}
"""Calls of each pattern of patterns.c."""

STRETCHES = {
    "step": 1.000018090755,
    "step_ac": 1.003298526346,
    "set_step_get": 0.995172574399,
    "long_step_dc": 1.008931749768,
    "long_step_ac": 1.183111133744,
}
"""Where that many calls end, after ten more; the others stay at 1. From DOP853 at a relative tolerance of 1e-13, which
integrated Eq. 16. The FMU is asked for 1e-9 and differs by 5e-11 at most."""


@pytest.fixture(scope="session")
def instructions(tmp_path_factory):
    """A function that counts the instructions of one call of a pattern."""
    if shutil.which("valgrind") is None:
        pytest.skip("no instructions are counted: valgrind is missing (Debian: apt install valgrind)")
    processor = Path("/proc/cpuinfo")
    if not processor.exists() or not {"avx2", "fma"} <= set(processor.read_text().split()):
        pytest.skip("no instructions are counted: the bounds are those of AVX2, which this processor lacks")
    folder = tmp_path_factory.mktemp("patterns")
    program = folder / "patterns"
    headers = Path(fmpy.__file__).parent / "c-code"
    flags = ["-target", "x86_64-linux-gnu.2.17", "-O2", "-Wall", "-Wextra", "-Werror", f"-I{headers}"]
    subprocess.run([*ZIG, "cc", *flags, HERE / "patterns.c", "-o", program, "-ldl"], check=True)

    @functools.cache
    def unpacked(model: str) -> tuple[str, str, list[str]]:
        fmu = packed_fmu(model)
        library = f"binaries/linux64/{fmu.stem}.so"
        with zipfile.ZipFile(fmu) as archive:
            archive.extract(library, folder)
        description = fmpy.read_model_description(str(fmu))
        references = [f"{variable.name}={variable.valueReference}" for variable in description.modelVariables]
        return f"./{library}", description.guid, references

    def count(pattern: str) -> float:
        calls = COUNTS[pattern]
        library, guid, references = unpacked("si" if pattern.startswith("device_") else "nondimensional")
        valgrind = ["valgrind", "--tool=callgrind", "--toggle-collect=measured", "--callgrind-out-file=out"]
        command = [*valgrind, "./patterns", library, guid, pattern, str(calls), *references]
        # Paths of one length: a longer one moves the heap, and copies of memory take other instructions.
        done = subprocess.run(command, cwd=folder, capture_output=True, text=True, timeout=600, check=False)
        assert done.returncode == 0, done.stderr
        assert float(done.stdout) == pytest.approx(STRETCHES.get(pattern, 1.0), rel=1e-9, abs=0)
        (collected,) = re.findall(r"Collected : (\d+)", done.stderr)
        assert int(collected) > 10 * calls, "callgrind has not found the function `measured`"
        return round(int(collected) / calls, 1)

    return count


@pytest.mark.parametrize("pattern", COUNTS)
def test_a_call_takes_no_more_instructions_than_its_bound(instructions, pattern, request):
    counted = instructions(pattern)
    bounds = json.loads(BOUNDS.read_text()) if BOUNDS.exists() else {}
    if request.config.getoption("--bless"):
        print(f"{pattern}: {bounds.get(pattern)} before, {counted} now")
        BOUNDS.write_text(json.dumps({**bounds, pattern: counted}, indent=2) + "\n")
        return
    assert counted <= ALLOWED * bounds[pattern], (
        f"{counted} instructions a call, {counted / bounds[pattern] - 1:+.1%} against the bound {bounds[pattern]}; "
        "if that is meant to be, `make bless` writes new bounds"
    )
