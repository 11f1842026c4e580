"""The code in README.md and docs/*.md runs as printed, its commands exist, and its links lead somewhere."""

import os
import re
import shlex
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

REPOSITORY = Path(__file__).resolve().parents[2]
README = REPOSITORY / "README.md"
PAGES = [README, *sorted((REPOSITORY / "docs").glob("*.md"))]
LINKED_PAGES = [*PAGES, *(REPOSITORY / name for name in ("ARCHITECTURE.md", "CONTRIBUTING.md", "CHANGELOG.md"))]


def blocks(page: Path, language: str) -> list[str]:
    """A page's code blocks of one language."""
    text = page.read_text(encoding="utf-8")
    return re.findall(rf"^```{language}\n(.*?)^```", text, flags=re.MULTILINE | re.DOTALL)


def commands() -> list[list[str]]:
    """The words of each command in the pages."""
    lines = [line for page in PAGES for block in blocks(page, "sh") for line in block.splitlines()]
    return [words for line in lines if (words := shlex.split(line, comments=True))]


def in_checkout(arguments: list, fmu_path: Path, folder: Path) -> subprocess.CompletedProcess:
    """Runs in a folder of links to the repository's content, so that what is written is not left behind."""
    for entry in REPOSITORY.iterdir():
        if entry.name not in (".git", "target"):
            (folder / entry.name).symlink_to(entry)
    packed = folder / "target" / "fmu"
    packed.mkdir(parents=True)
    (packed / fmu_path.name).symlink_to(fmu_path)
    done = subprocess.run(
        arguments,
        cwd=folder,
        env={**os.environ, "MPLBACKEND": "Agg"},
        capture_output=True,
        text=True,
        timeout=600,
    )
    assert done.returncode == 0, f"{done.stdout}\n{done.stderr}"
    return done


@pytest.mark.parametrize(
    "code",
    [pytest.param(code, id=f"{page.stem}-{k}") for page in PAGES for k, code in enumerate(blocks(page, "python"))],
)
def test_python_block_runs(code, fmu_path, tmp_path):
    in_checkout([sys.executable, "-W", "error::DeprecationWarning", "-c", code], fmu_path, tmp_path)
    for name in re.findall(r'savefig\("(.*)"\)', code):
        assert (tmp_path / name).is_file()


@pytest.mark.parametrize(
    "words", [words for words in commands() if words[0] == "dielectric-actuator"], ids=lambda words: " ".join(words)
)
def test_package_command_runs(words, fmu_path, tmp_path):
    in_checkout([Path(sys.executable).parent / words[0], *words[1:]], fmu_path, tmp_path)


@pytest.mark.parametrize(
    "words", [words for words in commands() if words[0] == ".venv/bin/python"], ids=lambda words: " ".join(words)
)
def test_python_command_runs(words, fmu_path, si_path, tmp_path):
    assert in_checkout([sys.executable, *words[1:]], fmu_path, tmp_path).stdout


def test_every_command_is_of_a_known_kind():
    used = {words[0] for words in commands()}
    assert {"make", "pip", "dielectric-actuator", ".venv/bin/python"} == used


def test_make_targets_exist():
    makefile = (REPOSITORY / "Makefile").read_text(encoding="utf-8")
    targets = set(re.findall(r"^([a-z][a-z0-9-]*)\s*:(?!=)", makefile, flags=re.MULTILINE))
    used = [word for words in commands() if words[0] == "make" for word in words[1:] if re.match(r"[a-z]", word)]
    assert {"run", "test"} <= set(used) <= targets


def test_the_wheel_has_the_present_version():
    version = tomllib.loads((REPOSITORY / "Cargo.toml").read_text())["workspace"]["package"]["version"]
    wheels = re.findall(r"dielectric_actuator-(\d[^-]*)-py3", README.read_text(encoding="utf-8"))
    assert wheels and set(wheels) == {version}


@pytest.mark.parametrize("page", LINKED_PAGES, ids=lambda page: page.name)
def test_links_lead_somewhere(page):
    text = page.read_text(encoding="utf-8")
    for target in re.findall(r"\]\((?!https?://)([^)#\s]+)", text):
        assert (page.parent / target).exists(), f"{page.name} links to {target}"


def test_the_readme_is_short():
    assert blocks(README, "python") and len(README.read_text(encoding="utf-8").splitlines()) <= 200
