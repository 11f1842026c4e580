"""The FMU in SI units: the nondimensional FMU scaled, both interfaces, refusals."""

import json
import zipfile
from pathlib import Path

import fmpy
import numpy as np
import pytest
from fmpy.validation import validate_fmu
from lxml import etree

from device_scenes import REFERENCE, device_scene
from dielectric_actuator import Actuator


def test_the_description_is_valid(si_path):
    assert validate_fmu(str(si_path)) == []


def test_terminals_follow_the_schema_of_fmi_3(si_path):
    """FMI 2.0.4 refers to it; each icon that is named is there, and each variable is described."""
    schema = etree.XMLSchema(etree.parse(Path(fmpy.__file__).parent / "schema" / "fmi3" / "fmi3TerminalsAndIcons.xsd"))
    with zipfile.ZipFile(si_path) as archive:
        root = etree.fromstring(archive.read("terminalsAndIcons/terminalsAndIcons.xml"))
        schema.assertValid(root)
        icons = [element.get("iconBaseName") for element in root.iter("TerminalGraphicalRepresentation")]
        assert len(icons) == 3
        for icon in [*icons, "icon"]:
            assert archive.read(f"terminalsAndIcons/{icon}.png").startswith(b"\x89PNG")
    described = {variable.name: variable for variable in fmpy.read_model_description(str(si_path)).modelVariables}
    members = [element.get("variableName") for element in root.iter("TerminalMemberVariable")]
    assert {described[name].causality for name in members} == {"input", "output"}
    assert len(members) == len(set(members)) > 10


def test_the_first_click_moves(si_path):
    """The default experiment: the paper's silicone after a step of the voltage, a few periods."""
    result = fmpy.simulate_fmu(str(si_path))
    stretch = result["lambda"]
    turns = np.count_nonzero(np.diff(np.sign(np.diff(stretch))))
    assert stretch.max() > 1.05 and turns >= 4
    assert result["charge"].max() > 0 and result["edge_displacement"].max() > 0


def test_both_units_give_one_trajectory(si_path, fmu_path):
    """The paper's silicone under 600 V, and the same in nondimensional quantities."""
    content = json.loads((REFERENCE / "A_si_dc_step.json").read_text())
    start = device_scene("A_si_dc_step").start
    groups, scales = content["groups_nondimensional"], content["scales_SI"]
    same = {"gamma_s": "gamma", "tau_s": "tau", "E_s": "E", "phi": "phi", "c": "c"}
    nondimensional = {name: float(groups[key]) for name, key in same.items()}
    with Actuator(si_path) as si, Actuator(fmu_path) as plain:
        si.start(start)
        plain.start(nondimensional)
        unit = float(scales["t0"])
        for _ in range(200):
            si.advance(3.7 * unit)
            plain.advance(3.7)
            assert si.get("lambda") == pytest.approx(plain.get("lambda"), abs=2e-12)


def test_model_exchange(si_path):
    start = device_scene("D_kv_step").start
    options = {"start_values": start, "stop_time": 2e-3, "output_interval": 1e-5, "output": ["lambda", "charge"]}
    by_host = fmpy.simulate_fmu(str(si_path), fmi_type="ModelExchange", relative_tolerance=1e-8, **options)
    own = fmpy.simulate_fmu(str(si_path), fmi_type="CoSimulation", **options)
    assert len(by_host) > 100
    ours = np.interp(by_host["time"], own["time"], own["lambda"])
    assert np.abs(by_host["lambda"] - ours).max() < 1e-4
    assert np.ptp(own["lambda"]) > 1e-3


def test_a_saved_state_goes_on_bit_for_bit(si_path):
    start = device_scene("B_rc_step").start
    with Actuator(si_path) as actuator:
        actuator.start(start)
        actuator.advance(1e-4)
        saved = actuator.save()
        ends = []
        for _ in range(2):
            actuator.restore(saved)
            for _ in range(10):
                actuator.advance(1.3e-5)
            ends.append(tuple(actuator.get(name) for name in ("lambda", "charge", "supply_current")))
        assert ends[0] == ends[1]


def test_every_preset_moves(si_path):
    """Inside the FMU and beside it, the same files; a material moves and does not break down."""
    with zipfile.ZipFile(si_path) as archive:
        inside = {
            Path(name).name: archive.read(name)
            for name in archive.namelist()
            if name.startswith("resources/presets/") and name.endswith(".ssv")
        }
    beside = {path.name: path.read_bytes() for path in (si_path.parent / "presets" / si_path.stem).glob("*.ssv")}
    assert inside == beside
    materials = 0
    for name, text in inside.items():
        root = etree.fromstring(text)
        values = {
            parameter.get("name"): float(parameter[0].get("value"))
            for parameter in root.iter("{*}Parameter")
            if parameter[0].get("value") not in ("true", "false")
        }
        with Actuator(si_path) as actuator:
            actuator.start(values)
            if "Source: " not in root.get("description"):
                continue
            assert "Not verified: " in root.get("description")
            materials += 1
            before, period = actuator.get("lambda"), 1.0 / actuator.get("frequency")
            actuator.advance(0.5 * period)
            assert actuator.get("lambda") - before > 0.005, name
            assert actuator.get("pulled_in") == actuator.get("broken_down") == 0, name
    assert materials >= 5


@pytest.mark.parametrize(
    ("name", "value"), [("H", 10.0), ("H", 0.0), ("mu", -1.0), ("rho", 1.1), ("R_s", -1.0), ("L", float("nan"))]
)
def test_a_wrong_power_of_ten_is_refused(si_path, name, value):
    with Actuator(si_path) as actuator, pytest.raises(Exception, match=name):
        actuator.start({name: value})
