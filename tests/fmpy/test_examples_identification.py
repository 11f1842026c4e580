"""The identification example: what it prints is what its page shows, and its command line does the same."""

import re
import subprocess
import sys
from pathlib import Path

import pytest

from dielectric_actuator import command, presets

EXAMPLE = Path(__file__).resolve().parents[2] / "examples" / "identification"


@pytest.fixture(scope="module")
def done(fmu_path, tmp_path_factory):
    """What the example prints, and the folder that it writes to."""
    folder = tmp_path_factory.mktemp("identification")
    words = [sys.executable, EXAMPLE / "identify.py", "--output", folder]
    return subprocess.run(words, capture_output=True, text=True, check=True, timeout=600).stdout, folder


@pytest.mark.xdist_group("identification")
def test_the_tables_of_the_page_are_those_that_are_printed(done):
    rows = re.findall(r"^\| \w+_\w+ .*\|$", (EXAMPLE / "README.md").read_text(), flags=re.MULTILINE)
    assert len(rows) == 9
    # the last digit may differ from one processor to another
    for row, printed in zip(rows, re.findall(r"^\| \w+_\w+ .*\|$", done[0], flags=re.MULTILINE), strict=True):
        for one, other in zip(row.split("|")[1:-1], printed.split("|")[1:-1], strict=True):
            if re.search(r"\d", one):
                assert float(one) == pytest.approx(float(other), abs=2e-6, rel=1e-2)
            else:
                assert one.strip() == other.strip()
    assert "the motion is exactly the same along gamma_s +1, tau_s +1, phi_scale +0.0077" in done[0]


@pytest.mark.xdist_group("identification")
def test_the_picture_and_the_preset_are_written(done):
    folder = done[1]
    assert (folder / "identification.png").stat().st_size > 20_000
    assert presets.load(folder / "identified.json").start_values["phi"] == pytest.approx(0.5, abs=1e-3)


def test_the_commands_of_the_page_find_the_same(done, monkeypatch, tmp_path, capsys):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "record.csv").write_text((done[1] / "switched.csv").read_text())
    (block,) = re.findall(r"^```sh\ndielectric-actuator (.*?)^```", (EXAMPLE / "README.md").read_text(), re.M | re.S)
    for line in block.replace("\\\n", " ").split("dielectric-actuator "):
        assert command.main(line.split()) == 0, capsys.readouterr().err
    found = presets.load("identified.json").start_values
    assert [found[name] for name in ("gamma_s", "tau_s", "E_s")] == pytest.approx([0.0502, 0.0301, 0.0995], abs=2e-4)
