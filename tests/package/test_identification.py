"""Fits of data from the FMU, which the native library has no part in."""

import math

import numpy as np
import pytest

from dielectric_actuator import Actuator, UnknownName, measured, presets
from dielectric_actuator.identification import fit

TRUE = {"gamma_s": 0.05, "tau_s": 0.03, "E_s": 0.1}
GUESS = {"gamma_s": 0.02, "tau_s": 0.02, "E_s": 0.05}
TIME = np.arange(0.0, 300.0, 0.5)
SWITCHED = np.where(TIME % 80 < 40, 0.5, 0.25)
NOISE = 1e-3


def response(voltage, scene):
    """What the FMU does under a voltage that is held from sample to sample."""
    with Actuator() as actuator:
        found = actuator.run(
            {**scene, "phi": lambda time: float(voltage[round(time / 0.5)])},
            stop_time=float(TIME[-1]),
            communication_step=0.5,
        )
    return found["lambda"]


@pytest.fixture(scope="module")
def switched():
    return response(SWITCHED, TRUE)


def test_without_noise_the_parameters_are_found(switched):
    found = fit(TIME, SWITCHED, switched, free=list(TRUE), start=GUESS, interpolation="hold")
    assert [found.values[name] for name in TRUE] == pytest.approx(list(TRUE.values()), abs=1e-7)
    assert found.residual < 1e-8 and not found.redundancies


def test_uncertainties_are_those_of_repeated_experiments(switched):
    generator = np.random.default_rng(7)
    deviations = []
    for _ in range(60):
        data = switched + generator.normal(0, NOISE, len(TIME))
        found = fit(TIME, SWITCHED, data, free=list(TRUE), start=TRUE, interpolation="hold")
        deviations.append([(found.values[name] - TRUE[name]) / found.uncertainties[name] for name in TRUE])
    # of 60 standard normal numbers: 1 ± 0.09, and 0 ± 0.13
    assert np.std(deviations, axis=0) == pytest.approx(1.0, abs=0.3)
    assert np.mean(deviations, axis=0) == pytest.approx(0.0, abs=0.4)


def test_scales_of_volts_and_seconds_are_found(switched):
    volts, seconds = 900.0, 1e-5
    found = fit(
        TIME * seconds, SWITCHED * volts, switched,
        free=["gamma_s", "tau_s", "phi_scale", "time_scale"],
        start={**GUESS, "E_s": 0.1, "phi_scale": 1 / 950, "time_scale": 1.01e5},
        interpolation="hold",
    )  # fmt: skip
    assert found.values["phi_scale"] == pytest.approx(1 / volts, rel=1e-6)
    assert found.values["time_scale"] == pytest.approx(1 / seconds, rel=1e-6)


def test_the_exact_redundancy_is_said():
    """(γ, τ, φ²) moves as (γ − τ, 0, φ² − 4τ): under a constant voltage no data can tell its size from γ and τ."""
    voltage = np.full_like(TIME, 0.55)
    data = response(voltage, TRUE) + np.random.default_rng(3).normal(0, NOISE, len(TIME))
    free = ["gamma_s", "tau_s", "phi_scale"]
    found = fit(TIME, voltage, data, free=free, start=TRUE, interpolation="hold")
    (direction,) = found.redundancies
    assert direction["gamma_s"] == pytest.approx(direction["tau_s"], rel=1e-6)
    by_scale = 2 * found.values["phi_scale"] * 0.55**2
    assert by_scale * direction["phi_scale"] == pytest.approx(4 * direction["tau_s"], rel=1e-6)
    assert all(math.isinf(found.uncertainties[name]) for name in free)
    assert "cannot be told apart" in found.table()
    # with the voltage known, or switched, they can
    known = fit(TIME, voltage, data, free=["gamma_s", "tau_s"], start=TRUE, interpolation="hold")
    assert not known.redundancies and known.uncertainties["tau_s"] < 0.1


def test_a_fit_becomes_a_preset(switched, tmp_path):
    found = fit(TIME, SWITCHED, switched, free=list(TRUE), start=GUESS, interpolation="hold")
    path = found.preset("Found", 0.5).save(tmp_path / "found.json")
    loaded = presets.load(path)
    with Actuator() as actuator:
        actuator.start(loaded.start_values)
        assert actuator.get("gamma_s", "phi") == pytest.approx([0.05, 0.5], abs=1e-7)


def test_bad_data_are_named_by_row_and_column():
    good = [0.0, 1.0, 2.0, 3.0]
    for time, stretch, message in [
        ([0.0, 1.0, 1.0, 3.0], good, "time in row 3 is 1 after 1; it must increase"),
        (good, [1.0, 1.0, math.nan, 1.0], "stretch in row 3 is nan"),
        (good, [1.0, 1.0], "stretch has the shape"),
    ]:
        with pytest.raises(ValueError, match=message):
            fit(time, good, stretch, free=["c"])
    with pytest.raises(UnknownName, match="did you mean gamma_s"):
        fit(good, good, good, free=["gama_s"])
    with pytest.raises(ValueError, match="2 rows cannot determine 2 parameters"):
        fit(good[:2], good[:2], good[:2], free=["c", "S"])


@pytest.mark.parametrize("free, message", [(["c", "c"], "c is free twice"), ([], "no parameter is free")])
def test_the_free_parameters_are_named_once(free, message):
    with pytest.raises(ValueError, match=message):
        fit([0.0, 1.0, 2.0], [0.1, 0.1, 0.1], [1.0, 1.0, 1.0], free=free)


def test_bad_files_are_named_by_row_and_column(tmp_path):
    path = tmp_path / "data.csv"
    path.write_text("time, voltage,strech\n0,0.1,1\n0.5,,1\n")
    with pytest.raises(UnknownName, match=r"data.csv: 'stretch'; did you mean strech"):
        measured.read(path, ["time", "stretch"])
    with pytest.raises(ValueError, match="voltage in row 2 is 'missing'"):
        measured.read(path, ["time", "voltage"])
    assert measured.read(path, ["time"])["time"].tolist() == [0.0, 0.5]
