"""The guide's programs run, and each message that it quotes really comes out."""

import json
import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

REPOSITORY = Path(__file__).resolve().parents[2]
GUIDE = REPOSITORY / "docs" / "guide"
SHARED = re.compile(r"^def ", flags=re.MULTILINE)
"""A block that only defines functions belongs to those after it."""


def programs() -> list:
    """Each python block with the block of text below it, if there is one, and what it builds on."""
    found = []
    for page in sorted(GUIDE.glob("*.md")):
        blocks = re.findall(r"^```(python|text)\n(.*?)^```", page.read_text(), flags=re.MULTILINE | re.DOTALL)
        shared = ""
        for position, (language, code) in enumerate(blocks):
            if language == "text":
                continue
            following = blocks[position + 1] if position + 1 < len(blocks) else ("", "")
            quoted = following[1] if following[0] == "text" else None
            found.append(pytest.param(shared + code, quoted, id=f"{page.stem}-{len(found)}"))
            if SHARED.search(code) and "\nfor " not in code and "while " not in code:
                shared = code + "\n"
    return found


def pattern(line: str) -> str:
    """A quoted line as a regular expression; an ellipsis stands for anything."""
    return ".*".join(re.escape(part) for part in line.split("…"))


RUNNER = """
import json, os, sys, traceback
import fmpy, fmpy.fmi2

for number, code in enumerate(json.load(open("programs.json"))):
    os.makedirs(f"{number}", exist_ok=True)
    child = os.fork()
    if child:
        _, status = os.waitpid(child, 0)
        print(number, os.waitstatus_to_exitcode(status))
        continue
    os.chdir(f"{number}")
    for path in sys.argv[1:]:
        os.symlink(path, os.path.basename(path))
    output = os.open("output", os.O_WRONLY | os.O_CREAT)
    os.dup2(output, 1), os.dup2(output, 2)
    failed = 0
    try:
        exec(compile(code, "program", "exec"), {"__name__": "__main__"})
    except BaseException:
        traceback.print_exc()
        failed = 1
    sys.stdout.flush()
    os._exit(failed)
"""
"""Runs each program in a process and a folder of its own; a fork spares each the start of Python and FMPy."""


@pytest.fixture(scope="module")
def outcomes(fmu_path, si_path, tmp_path_factory):
    """Exit code and output of every program, in their order."""
    folder = tmp_path_factory.mktemp("guide")
    (folder / "programs.json").write_text(json.dumps([program.values[0] for program in programs()]))
    done = subprocess.run(
        [sys.executable, "-u", "-W", "error::DeprecationWarning", "-c", RUNNER, fmu_path.resolve(), si_path.resolve()],
        cwd=folder,
        env={**os.environ, "TMPDIR": str(folder)},
        capture_output=True,
        text=True,
        timeout=600,
    )
    assert done.returncode == 0, done.stderr
    codes = [int(line.split()[1]) for line in done.stdout.splitlines()]
    return [(code, (folder / str(number) / "output").read_text()) for number, code in enumerate(codes)]


@pytest.mark.xdist_group("guide")
@pytest.mark.parametrize(
    "number, quoted",
    [pytest.param(number, program.values[1], id=program.id) for number, program in enumerate(programs())],
)
def test_program_runs_and_says_what_is_quoted(number, quoted, outcomes):
    code, output = outcomes[number]
    if quoted is None:
        assert code == 0, output
    else:
        for line in quoted.splitlines():
            assert re.search(f"^{pattern(line)}$", output, flags=re.MULTILINE), output


def test_every_message_of_the_troubleshooting_page_is_tried():
    text = (GUIDE / "7-troubleshooting.md").read_text()
    quoted = sum(parameter.values[1] is not None for parameter in programs() if "troubleshooting" in parameter.id)
    assert quoted == text.count("```text") >= 15


def test_links_between_pages_lead_somewhere():
    pages = {page.name: page.read_text() for page in GUIDE.glob("*.md")}
    for name, text in pages.items():
        for target in re.findall(r"\]\((?!https://)([^)#]+\.md)", text):
            assert target in pages, f"{name} links to {target}"
