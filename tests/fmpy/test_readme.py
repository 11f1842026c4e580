"""The README's code runs as printed, and its commands exist."""

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

REPOSITORY = Path(__file__).resolve().parents[2]


def blocks(language: str) -> list[str]:
    """The README's code blocks of one language."""
    readme = REPOSITORY / "README.md"
    text = readme.read_text(encoding="utf-8") if readme.is_file() else ""
    return re.findall(rf"^```{language}\n(.*?)^```", text, flags=re.MULTILINE | re.DOTALL)


def test_the_readme_has_code():
    assert blocks("python") and blocks("sh")


@pytest.mark.parametrize("code", blocks("python"), ids=lambda code: code.strip().partition("\n")[0][:40])
def test_python_block_runs(code, fmu_path, tmp_path):
    """In a folder of links to the repository's content, so that what the block writes is not left behind."""
    for entry in REPOSITORY.iterdir():
        if entry.name not in (".git", "target"):
            (tmp_path / entry.name).symlink_to(entry)
    packed = tmp_path / "target" / "fmu"
    packed.mkdir(parents=True)
    (packed / fmu_path.name).symlink_to(fmu_path)
    done = subprocess.run(
        [sys.executable, "-W", "error::DeprecationWarning", "-c", code],
        cwd=tmp_path,
        env={**os.environ, "MPLBACKEND": "Agg"},
        capture_output=True,
        text=True,
        timeout=120,
    )
    assert done.returncode == 0, f"{done.stdout}\n{done.stderr}"


def test_shell_blocks_use_make_targets_that_exist():
    makefile = (REPOSITORY / "Makefile").read_text(encoding="utf-8")
    targets = set(re.findall(r"^([a-z][a-z0-9-]*)\s*:(?!=)", makefile, flags=re.MULTILINE))
    commands = [line.split("#")[0].split() for block in blocks("sh") for line in block.splitlines()]
    used = [word for words in commands if words[:1] == ["make"] for word in words[1:] if re.match(r"[a-z]", word)]
    assert used, "the README shows make commands"
    assert set(used) <= targets
