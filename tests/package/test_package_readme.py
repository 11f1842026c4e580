"""The package's README: its programs and commands run as printed, and its first lines in a new environment."""

import os
import re
import subprocess
import sys
import time
from pathlib import Path

import pytest

REPOSITORY = Path(__file__).resolve().parents[2]
README = (REPOSITORY / "python" / "README.md").read_text(encoding="utf-8")


def blocks(language: str) -> list[str]:
    """The code blocks of one language."""
    return re.findall(rf"^```{language}\n(.*?)^```", README, flags=re.MULTILINE | re.DOTALL)


@pytest.mark.parametrize("code", blocks("python"))
def test_program_runs(code, tmp_path):
    words = [sys.executable, "-W", "error::DeprecationWarning", "-c", code]
    done = subprocess.run(words, cwd=tmp_path, capture_output=True, text=True, timeout=600)
    assert done.returncode == 0 and done.stdout, done.stderr


def test_commands_run(tmp_path):
    _, commands = blocks("sh")
    for line in commands.splitlines():
        name, *words = line.split()
        program = Path(sys.executable).parent / name
        done = subprocess.run([program, *words], cwd=tmp_path, capture_output=True, text=True, timeout=600)
        assert done.returncode == 0, f"{line}\n{done.stderr}"
    written = ["film.png", "map.csv", "pull_in.csv", "pull_in.png", "step.ssv"]
    assert sorted(path.name for path in tmp_path.iterdir()) == written


def test_python_alone_is_enough(tmp_path, capsys):
    """From the wheel to the plot in an environment that has nothing, where no compiler is on the path."""
    (wheel,) = (REPOSITORY / "target" / "wheel").glob("*.whl")
    (tmp_path / wheel.name).symlink_to(wheel)
    quick_start, _ = blocks("sh")
    empty = tmp_path / "path"
    empty.mkdir()
    # What is not imported need not be compiled, which takes half of the time.
    environment = {**os.environ, "PATH": str(empty), "PIP_COMPILE": "0"}
    environment.pop("PYTHONPATH", None)
    begin = time.monotonic()
    for line in quick_start.splitlines():
        words = [word.strip("'") for word in line.split()]
        words[0] = words[0].replace("python3", getattr(sys, "_base_executable", sys.executable))
        words[0] = str(tmp_path / words[0])
        done = subprocess.run(words, cwd=tmp_path, env=environment, capture_output=True, text=True, timeout=600)
        assert done.returncode == 0, f"{line}\n{done.stdout}{done.stderr}"
        with capsys.disabled():
            print(f"\n{time.monotonic() - begin:6.1f} s  $ {line}\n{done.stdout.strip().splitlines()[-1:]}", end="")
    assert (tmp_path / "out.png").read_bytes().startswith(b"\x89PNG")
