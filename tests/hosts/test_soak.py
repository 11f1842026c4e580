"""The packed library in a small host in C (host.c): memory over many loads and instances, and under valgrind's
checkers. SOAK=long runs ten times as much (make soak)."""

import os
import shutil
import subprocess
from pathlib import Path

import fmpy
import pytest

TIMES = 10 if os.environ.get("SOAK") == "long" else 1
KNOWN = f"--suppressions={Path(__file__).with_name('races.supp')}"


@pytest.fixture(scope="session")
def host(library, fmu, tmp_path_factory):
    """A function that runs the host, perhaps below other programs, and returns what it prints."""
    program = tmp_path_factory.mktemp("host") / "host"
    headers = Path(fmpy.__file__).parent / "c-code"
    flags = ["-std=c11", "-D_GNU_SOURCE", "-Wall", "-Wextra", "-Werror", "-g", "-O1", f"-I{headers}"]
    source = Path(__file__).parent / "host.c"
    subprocess.run([os.environ.get("CC", "cc"), *flags, source, "-o", program, "-ldl", "-lpthread"], check=True)
    guid = fmpy.read_model_description(str(fmu)).guid

    def run(what: str, count: int, below=()) -> list[list[int]]:
        command = [*below, program, library, guid, what, str(count)]
        # With this variable a panic, caught or not, costs memory at each load.
        environment = {**os.environ, "RUST_BACKTRACE": "1"}
        result = subprocess.run(command, capture_output=True, text=True, env=environment, check=False)
        assert result.returncode == 0, f"{what}: {result.returncode}\n{result.stderr[-4000:]}"
        return [[int(number) for number in line.split()] for line in result.stdout.splitlines()]

    return run


@pytest.mark.parametrize(("what", "count"), [("loads", 3_000), ("instances", 100_000)])
def test_memory_stays_flat(host, what, count):
    curve = host(what, count * TIMES)
    assert len(curve) == 10
    print(what, *(f"{done}: {resident} KiB" for done, resident in curve), sep="\n")
    # From the third sample on nothing grows; 64 KiB are 32 bytes of each of 2100 loads.
    assert curve[-1][1] - curve[2][1] <= 64, curve


@pytest.mark.parametrize(
    ("tool", "what", "count"),
    [
        (["memcheck", "--leak-check=full", "--errors-for-leak-kinds=definite,indirect,possible"], "scenes", 2),
        (["helgrind", KNOWN], "threads", 8),
        (["drd", KNOWN], "threads", 8),
        (["helgrind"], "later", 4),
        (["drd"], "later", 4),
    ],
    ids=["memory", "races", "races-drd", "races-later", "races-later-drd"],
)
def test_valgrind_finds_nothing(host, tool, what, count):
    if shutil.which("valgrind") is None:
        pytest.skip("valgrind is missing (Debian: apt install valgrind)")
    host(what, count * TIMES, below=["valgrind", "-q", "--error-exitcode=9", f"--tool={tool[0]}", *tool[1:]])
