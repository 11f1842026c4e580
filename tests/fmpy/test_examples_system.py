"""The system example: its FMUs, its SSP in FMPy, and the order that each derivative gains."""

import re
import subprocess
import sys
import textwrap
import zipfile
from pathlib import Path

import numpy as np
import pytest
from fmpy.validation import validate_fmu

import pack
import pages
from dielectric_actuator import Actuator

REPOSITORY = Path(__file__).resolve().parents[2]
EXAMPLE = REPOSITORY / "examples" / "system"


@pytest.fixture(scope="module")
def linear(tmp_path_factory):
    """The packed supply and controller by name."""
    folder = tmp_path_factory.mktemp("linear")
    return {model: pack.pack_linear(EXAMPLE / f"{model}.c", folder) for model in ("supply", "controller")}


def test_the_linear_fmus_are_valid(linear):
    assert {model: validate_fmu(str(path)) for model, path in linear.items()} == {"supply": [], "controller": []}


@pytest.mark.parametrize("steps", [[10.0], [0.1] * 100, [0.3, 6.7, 3.0]], ids=["one", "small", "uneven"])
def test_the_supply_is_exact_under_a_ramp(linear, steps):
    """v' = (a + b t − v)/T from rest, and the derivatives of v, in closed form."""
    a, b, constant = 0.5, 0.03, 2.0
    with Actuator(linear["supply"]) as supply:
        supply.start({"time_constant": constant})
        supply.set({"command": a})
        supply.set_input_derivatives({"command": [b]})
        for step in steps:
            supply.advance(step)
        time = supply.time
        decay = (b * constant - a) * np.exp(-time / constant)
        assert supply.get("voltage") == pytest.approx(a + b * (time - constant) + decay, abs=1e-14)
        derivatives = [b - decay / constant, decay / constant**2, -decay / constant**3]
        assert supply.output_derivatives("voltage", 3) == pytest.approx(derivatives, abs=1e-14)


def test_the_controller_settles_where_its_equations_say(linear):
    """Under a constant stretch the filter's rate dies and the integral grows on."""
    with Actuator(linear["controller"]) as controller:
        controller.start({"target": 1.1, "stretch": 1.05, "P": 2.0, "I": 0.5, "D": 3.0, "command_start": 0.3})
        assert controller.get("command") == pytest.approx(0.3 + 2.0 * 0.05 - 3.0 * 0.05 / 0.5, abs=1e-15)
        controller.advance(40.0)
        assert controller.get("command") == pytest.approx(0.3 + 2.0 * 0.05 + 0.5 * 0.05 * 40, abs=1e-13)


def test_the_program_of_the_page_runs(fmu_path, tmp_path, monkeypatch):
    folder = tmp_path / "target" / "examples" / "system"
    pack.pack_system(fmu_path, folder)
    page = (EXAMPLE / "README.md").read_text()
    (code,) = re.findall(r"^ *```python\n(.*?)^ *```", page, flags=re.MULTILINE | re.DOTALL)
    monkeypatch.chdir(tmp_path)
    values = {}
    exec(compile(textwrap.dedent(code), "README.md", "exec"), values)
    assert values["result"]["leader.lambda"][-1] == pytest.approx(1.05, abs=0.005)


def test_the_positioning_converges_as_its_page_says(fmu_path, tmp_path):
    options = ["--fmu", fmu_path, "--output", tmp_path]
    done = subprocess.run(
        [sys.executable, EXAMPLE / "positioning.py", *options], capture_output=True, text=True, timeout=300
    )
    assert done.returncode == 0, done.stderr
    written = pages.table(EXAMPLE / "README.md", "Communication step")
    rows = {line[:20].strip(): line[20:].split() for line in done.stdout.splitlines() if line[:20].strip() in written}
    assert list(rows) == list(written)
    for name, errors in rows.items():
        expected = [float(error.replace("diverges", "inf")) for error in written[name]]
        # two digits are written
        assert list(map(float, errors)) == pytest.approx(expected, rel=0.06), name
    for (name, errors), order in zip(rows.items(), (1, 1, 2, 3, 4)):
        # halved steps from 0.5 to 0.0625
        halved = np.log2(np.array(errors[2:6], dtype=float))
        assert (halved[0] - halved[-1]) / 3 == pytest.approx(order, abs=0.25), name
    assert float(rows["up to the second"][1]) < float(rows["held"][-1])
    assert {"coupling_error.png", "positioning.ssp", "response.png"} < {path.name for path in tmp_path.iterdir()}
    with zipfile.ZipFile(tmp_path / "positioning.ssp") as ssp:
        assert "resources/DielectricElastomerActuator.fmu" in ssp.namelist()
