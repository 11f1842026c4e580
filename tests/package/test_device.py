"""The actuator in SI units: its units, its equilibrium, and what is fitted to volts and micrometres."""

import json
import math
from pathlib import Path

import numpy as np
import pytest

from dielectric_actuator import Actuator, UnknownName, device, frame, presets
from dielectric_actuator.identification import fit
from dielectric_actuator.plot import OVERVIEW, overview

FILM = {"gamma_s": 0.03, "tau_s": 0.01, "E_s": 0.02, "voltage": 0.0}
FILM_START = {name: value for name, value in FILM.items() if name != "voltage"}
STEP = 1e-7
TIME = STEP * np.arange(400)
SWITCHED = np.where(TIME % 8e-6 < 4e-6, 550.0, 200.0)


@pytest.fixture(scope="module")
def film():
    with Actuator("si") as film:
        yield film


def moved(film, output, voltage=SWITCHED, **changes):
    """What the SI FMU does under a voltage that is held from sample to sample."""
    found = film.run(
        {**FILM, **changes, "voltage": lambda time: float(voltage[round(time / STEP)])},
        stop_time=float(TIME[-1]),
        communication_step=STEP,
        outputs=[output],
        tolerance=1e-12,
    )
    return found[output]


def test_an_actuator_is_chosen_by_name():
    with Actuator() as plain, Actuator("si") as film:
        assert plain.units["phi"] == plain.units["time"] == "" and film.units["voltage"] == "V"
        assert film.units["time"] == "s" and film.units["lambda"] == ""
        film.start({})
        film.advance(1e-6)
        assert repr(film) == "<Actuator DielectricElastomerActuatorSI at time 1e-06 s>"
        assert repr(plain) == "<Actuator DielectricElastomerActuator at time 0>"
    assert repr(film) == "<Actuator DielectricElastomerActuatorSI, closed>"
    with pytest.raises(UnknownName, match="no actuator 'sii'; did you mean si"):
        Actuator("sii")


def test_variables_are_described_with_their_units(film):
    heading, row = film.describe("H").splitlines()
    assert heading.split() == ["name", "kind", "unit", "start", "limits", "meaning"]
    assert row.split()[:4] == ["H", "parameter", "m", "1e-5"] and "thickness of a layer" in row
    assert len(film.describe().splitlines()) == 1 + len(film.variables)
    with pytest.raises(UnknownName, match="did you mean thickness"):
        film.describe("thicknes")


@pytest.mark.parametrize("name", presets.names("si"))
def test_a_start_at_equilibrium_does_not_move(film, name):
    preset = presets.load(name)
    values = preset.start_values
    if values["voltage"] > film_threshold(film, values):
        with pytest.raises(ValueError, match=r"no equilibrium .* static pull-in voltage is .* V"):
            film.equilibrium(values)
        return
    film.start({**values, "V_ac": 0.0}, at_equilibrium=True)
    stretch = film.get("lambda")
    film.advance(preset.stop_time)
    assert film.get("lambda") == pytest.approx(stretch, abs=1e-12)


def film_threshold(film, values):
    film.start(values)
    return film.get("V_pull_in_static")


def test_a_series_resistance_begins_charged(film):
    values = {"voltage": 500.0, "R_s": 1e6}
    film.start(values, at_equilibrium=True)
    stretch, charge = film.get("lambda", "charge")
    assert charge == pytest.approx(film.get("capacitance") * 500.0, rel=1e-12)
    film.advance(1e-4)
    assert film.get("lambda", "charge") == pytest.approx([stretch, charge], rel=1e-9)
    for bad, message in (({"R_s": 1e6, "G_p": 1e-9}, "leak"), ({"source": 2}, "current")):
        with pytest.raises(ValueError, match=message):
            film.equilibrium(bad)


def test_the_charge_at_the_start_is_that_of_the_start_time(film):
    values = {"R_s": 1e4, "voltage": 500.0, "V_ac": 100.0, "f_ac": 2e4}
    start_time = 0.3 / values["f_ac"]
    film.start(values, at_equilibrium=True, start_time=start_time)
    charge, stretch, supply = film.get("charge", "lambda", "supply_voltage")
    assert supply == pytest.approx(500 + 100 * math.sin(2 * math.pi * 0.3))
    film.start({**values, "R_s": 0.0, "lambda_start": stretch}, start_time=start_time)
    assert charge == film.get("charge")


def test_the_scales_are_those_of_the_reference():
    """The paper's silicone in both units, worked out apart from the package."""
    reference = Path(__file__).resolve().parents[1] / "reference" / "device" / "A_si_dc_step.json"
    groups = json.loads(reference.read_text())["groups_nondimensional"]
    found, _ = device.nondimensional({"gamma_s": 0.02, "tau_s": 0.02, "E_s": 0.126})
    for name, key in {"gamma_s": "gamma", "tau_s": "tau", "E_s": "E", "c": "c"}.items():
        assert found[name] == pytest.approx(float(groups[key]), rel=1e-14)
    assert found["phi_scale"] * 600.0 == pytest.approx(float(groups["phi"]), rel=1e-10)


@pytest.mark.parametrize("name", device.NAMES)
def test_sensitivities_are_those_of_the_fmu(film, name):
    """Against central differences of the SI FMU, which knows nothing of them; two steps tell their error."""
    start = {**{known: device.limits()[known][0] for known in device.NAMES}, **FILM_START}
    start |= {"force": 2e-6, "lambda_start": 1.01, "lambda_dot_start": 1e3}
    stretch, slopes = device.sensitivities(start, TIME, SWITCHED, interpolation="hold", tolerance=1e-12)
    assert stretch == pytest.approx(moved(film, "lambda", **start), abs=1e-9)
    step = 1e-4 * (start[name] or device.TYPICAL[name])

    def difference(step):
        ends = [moved(film, "lambda", **{**start, name: start[name] + sign * step}) for sign in (1, -1)]
        return (ends[0] - ends[1]) / (2 * step)

    # Richardson: the error of the second order is taken off
    expected = (4 * difference(step / 2) - difference(step)) / 3
    size = np.abs(expected).max()
    assert slopes[:, device.NAMES.index(name)] == pytest.approx(expected, abs=1e-6 * size)


@pytest.mark.parametrize("observed", ["lambda", "thickness", "edge_distance", "edge_displacement"])
def test_parameters_are_found_in_si_units_from_what_is_measured(film, observed):
    true = {"mu": 2.7e5, "gamma_s": 0.03, "tau_s": 0.01}
    measured = moved(film, observed, **true)
    free = {"mu": 3.03e5, "gamma_s": 0.0, "tau_s": 0.0}
    found = fit(
        TIME, SWITCHED, measured, free=list(free), start={**free, "E_s": FILM["E_s"]}, model="si", observed=observed,
        interpolation="hold",
    )  # fmt: skip
    assert not found.redundancies
    for name, value in true.items():
        assert found.values[name] == pytest.approx(value, rel=1e-6)
    assert found.residual < 1e-8 * np.abs(measured).max()
    preset = found.preset("Found", 400.0)
    assert preset.model == "si" and preset.start_values["voltage"] == 400.0
    response = film.run(preset.start_values, stop_time=preset.stop_time, communication_step=preset.communication_step)
    assert np.ptp(response["lambda"]) > 0.01


def test_uncertainties_are_in_the_units_of_the_parameters(film):
    noise = 2e-9
    measured = moved(film, "thickness") + np.random.default_rng(5).normal(0, noise, len(TIME))
    found = fit(
        TIME, SWITCHED, measured, free=["mu", "rho"], start={**FILM_START, "mu": 3.2e5}, model="si",
        observed="thickness", interpolation="hold",
    )  # fmt: skip
    assert found.residual == pytest.approx(noise, rel=0.2)
    for name, true in (("mu", 303e3), ("rho", 1100.0)):
        assert abs(found.values[name] - true) < 4 * found.uncertainties[name] < 0.01 * true


def test_what_no_motion_can_tell_apart_is_said(film):
    """Modulus, density and permittivity in one proportion give the same motion, were it not for the surfaces."""
    plain = {"gamma_s": 0.0, "tau_s": 0.0, "E_s": 0.0}
    measured = moved(film, "lambda", **plain)
    found = fit(TIME, SWITCHED, measured, free=["mu", "rho", "eps_r"], start=plain, model="si", interpolation="hold")
    (direction,) = found.redundancies
    relative = {name: change / found.values[name] for name, change in direction.items()}
    assert relative["mu"] == pytest.approx(relative["rho"], rel=1e-6)
    assert relative["mu"] == pytest.approx(relative["eps_r"], rel=1e-6)
    assert all(math.isinf(value) for value in found.uncertainties.values())


def test_names_and_values_out_of_range_are_said():
    good = np.arange(4.0)
    with pytest.raises(UnknownName, match="no measured quantity 'thicknes'; did you mean thickness"):
        fit(good, good, good, free=["mu"], model="si", observed="thicknes")
    with pytest.raises(UnknownName, match="no parameter 'phi_scale'"):
        fit(good, good, good, free=["phi_scale"], model="si")
    with pytest.raises(ValueError, match=r"H is 10; it must be a number from .* to 0\.0"):
        device.nondimensional({"H": 10.0})


def test_a_table_has_units(film):
    table = frame(film.run({}, stop_time=1e-6, communication_step=1e-7, outputs=["lambda", "charge"]), film.units)
    assert table.attrs["units"] == {"time": "s", "lambda": "", "charge": "C"} and len(table) == 11


def test_plots_have_units(film):
    preset = presets.load("silicone_swing")
    response = film.run(
        preset.start_values, stop_time=preset.stop_time, communication_step=preset.communication_step, outputs=OVERVIEW
    )
    figure = overview(response, units=film.units)
    labels = {axes.get_xlabel() for axes in figure.axes} | {axes.get_ylabel() for axes in figure.axes}
    assert any(label.endswith("(µs)") for label in labels) and "pull-in margin  (V)" in labels
    assert r"stretch rate  $\mathrm{d}\lambda/\mathrm{d}t$  ($10^{3}$/s)" in labels
