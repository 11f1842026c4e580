"""Ensembles and sensitivities of the installed package, against the FMU and against SciPy."""

import itertools
import math
import os

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from dielectric_actuator import Collapse, UnknownName, ensemble, grid, native, sensitivities

SURFACE_EFFECTS = {"gamma_s": 0.05, "tau_s": 0.05, "E_s": 0.2}


def test_the_names_are_those_of_the_fmu(actuator):
    own = {"phi_scale", "time_scale"}
    assert set(native.scene_names()) <= set(actuator.variables)
    assert set(native.known_names()) - own <= set(actuator.variables) and own < set(native.known_names())


def test_an_ensemble_is_what_the_fmu_does_scene_by_scene(actuator):
    scenes = {
        **grid(phi=[0.0, 0.62, 0.75], phi_ac=[0.0, 0.3], omega_ac=[0.11, 0.1438]),
        "S": 0.1,
        "E_s": np.repeat([0.0, 0.2, 0.0], 4),
    }
    found = ensemble(scenes, stop_time=150.0, workers=2)
    assert len(found) == 12 and 0 < found["pulled_in"].sum() < 12
    for number, row in enumerate(found):
        scene = {name: float(np.broadcast_to(column, 12)[number]) for name, column in scenes.items()}
        actuator.start({**scene, "record_extremes": True})
        actuator.advance(150.0)
        names = ["lambda", "lambda_lowest", "lambda_highest", "lambda3_lowest", "lambda3_highest"]
        assert [row[name] for name in names] == pytest.approx(actuator.get(*names), rel=1e-8)
        assert row["pulled_in"] == bool(actuator.get("pulled_in"))
        assert row["pull_in_time"] == pytest.approx(actuator.get("pull_in_time"), rel=1e-8)


def test_an_ensemble_does_not_depend_on_the_number_of_threads():
    scenes = {"phi_ac": 0.3, "omega_ac": np.linspace(0.05, 0.3, 500), **SURFACE_EFFECTS}
    reports = []
    one = ensemble(scenes, stop_time=100.0, workers=1)
    two = ensemble(scenes, stop_time=100.0, workers=2, progress=lambda *report: reports.append(report))
    assert one.tobytes() == two.tobytes() and reports[-1] == (500, 500)


@pytest.mark.parametrize("scenes, message", [
    ({"phi": [0.1, 0.2, math.nan]}, "phi in row 3 is nan; it must be a number from"),
    ({"phi": [0.1], "c": [100.0, -1.0]}, "c in row 2 is -1; it must be a number from 0.001"),
    ({"phi": [0.1, 1e6]}, "phi in row 2 is 1e"),
    ({"phi": [[0.1]]}, "dimensions"),
    ({"lambda_start": [1.0, 0.85], "lambda_min": 0.9}, "lambda_start in row 2 is 0.85; it must lie between"),
])  # fmt: skip
def test_a_bad_value_of_an_ensemble_is_named_by_row_and_column(scenes, message):
    with pytest.raises(ValueError, match=message):
        ensemble(scenes, stop_time=1.0)


@pytest.mark.parametrize("workers", [-1, 1.5])
def test_a_number_of_workers_is_whole_and_not_below_0(workers):
    with pytest.raises(ValueError, match=f"workers is {workers}"):
        ensemble({"phi": [0.1]}, stop_time=1.0, workers=workers)


def test_an_ensemble_is_followed_in_parts_that_can_be_stopped():
    # seconds of work, of which an interruption waits for a part only
    scenes = {"phi_ac": 0.3, "omega_ac": np.linspace(0.05, 0.3, 20_000)}
    done = []

    def interrupt(so_far, count):
        done.append(so_far / count)
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        ensemble(scenes, stop_time=3000.0, progress=interrupt)
    assert done[0] <= 256 * (os.cpu_count() or 1) / 20_000


@pytest.mark.parametrize("arguments, message", [
    (([], []), "time has no rows"),
    (([0.0, 1.0], [0.1]), "voltage has the shape"),
])  # fmt: skip
def test_bad_series_are_refused(arguments, message):
    with pytest.raises(ValueError, match=message):
        sensitivities({}, *arguments)


@pytest.mark.parametrize("options, message", [
    ({"tolerance": 0.0}, "tolerance is 0; it must be from 1e-14"),
    ({"at": [[0.5]]}, "at has 2 dimensions"),
    ({"at": [0.5, math.inf]}, "at in row 2 is inf"),
    ({"at": [0.5, 0.4]}, "at in row 2 is 0.4; it must"),
])  # fmt: skip
def test_bad_options_of_sensitivities_are_refused(options, message):
    with pytest.raises(ValueError, match=message):
        sensitivities({}, [0.0, 1.0], [0.1, 0.1], **options)


def test_an_unknown_column_gets_a_suggestion():
    with pytest.raises(UnknownName, match="no variable 'omega'; did you mean omega_ac"):
        ensemble({"omega": [1.0]}, stop_time=1.0)


TIMES = np.array([0.0, 3.3, 11.9, 27.1, 40.0, 58.3])
RAMPS_TIME, RAMPS = np.array([0.0, 10.0, 30.0, 60.0]), np.array([0.5, 0.2, 0.6, 0.1])
VALUES = {
    "c": 90.0, "gamma_s": 0.05, "tau_s": 0.03, "E_s": 0.1, "S": 0.2, "phi_scale": 0.9, "time_scale": 1.2,
    "lambda_start": 1.04, "lambda_dot_start": 0.003,
}  # fmt: skip


def independent(values):
    """Stretch and its derivatives at `TIMES` by SciPy: Eq. 16 and its variational equations, derived by complex
    steps, which have no error of differences."""
    names = list(values)
    size = len(names)

    def acceleration(time, stretch, rate, v):
        # in the measured time, t̄ = s·t
        voltage = v["phi_scale"] * np.interp(time, RAMPS_TIME, RAMPS)
        surface = (
            v["gamma_s"] * stretch
            + v["tau_s"] * (2 * stretch**3 - stretch)
            + 0.5 * v["E_s"] * stretch * (stretch**2 - 1) * (3 * stretch**2 - 1)
        )
        scale = v["time_scale"]
        bar = rate / scale
        force = 6 * bar**2 / stretch**7 - stretch + stretch**-5 + v["S"] + voltage**2 * stretch**3 - 2 * surface
        return scale**2 * force / (v["c"] + 2 * stretch**-6)

    def right(time, state):
        x, v, y, w = state[0], state[1], state[2 : 2 + size], state[2 + size :]
        tiny = 1e-30
        by_stretch = acceleration(time, x + 1j * tiny, v, values).imag / tiny
        by_rate = acceleration(time, x, v + 1j * tiny, values).imag / tiny
        by_known = [acceleration(time, x, v, {**values, name: values[name] + 1j * tiny}).imag / tiny for name in names]
        return np.concatenate([[v, acceleration(time, x, v, values)], w, by_stretch * y + by_rate * w + by_known])

    start = np.zeros(2 + 2 * size)
    start[0], start[1] = values["lambda_start"], values["time_scale"] * values["lambda_dot_start"]
    start[2 + names.index("lambda_start")] = 1.0
    start[2 + size + names.index("lambda_dot_start")] = values["time_scale"]
    start[2 + size + names.index("time_scale")] = values["lambda_dot_start"]
    found = [start]
    for begin, end in itertools.pairwise(RAMPS_TIME):
        inside = TIMES[(begin < TIMES) & (end >= TIMES)]
        options = {"method": "DOP853", "rtol": 1e-12, "atol": 1e-14}
        solution = solve_ivp(right, (begin, end), start, t_eval=np.union1d(inside, [end]), **options)
        found += [solution.y[:, k] for k, time in enumerate(solution.t) if time in inside]
        start = solution.y[:, -1]
    return np.array(found)[:, 0], np.array(found)[:, 2 : 2 + size], names


def test_sensitivities_are_those_of_an_independent_solver():
    stretch, slopes = sensitivities(VALUES, RAMPS_TIME, RAMPS, at=TIMES, tolerance=1e-12)
    expected, expected_slopes, names = independent(VALUES)
    np.testing.assert_allclose(stretch, expected, rtol=1e-10)
    order = [native.known_names().index(name) for name in names]
    scale = np.abs(expected_slopes).max(axis=0)
    np.testing.assert_array_less(np.abs(slopes[:, order] - expected_slopes) / scale, 1e-9)


def test_a_held_voltage_is_what_the_fmu_follows(actuator):
    time = np.arange(0.0, 60.0, 0.75)
    voltage = np.where(time < 30, 0.5, 0.3 + 0.005 * time)
    stretch, _ = sensitivities({"gamma_s": 0.05}, time, voltage, interpolation="hold")
    response = actuator.run(
        {"gamma_s": 0.05, "phi": lambda now: float(voltage[np.searchsorted(time, now + 1e-9) - 1])},
        stop_time=float(time[-1]),
        communication_step=0.75,
    )
    np.testing.assert_allclose(stretch, response["lambda"], rtol=1e-8)


def test_a_collapse_is_told_with_its_time():
    with pytest.raises(Collapse, match="pulled in at time") as collapse:
        sensitivities({}, [0.0, 80.0], [0.7, 0.7])
    assert collapse.value.time == pytest.approx(38.6058, abs=1e-3)


@pytest.mark.parametrize("time, at, message", [
    ([0.0, 2.0, 1.0], None, "time in row 3 is 1 after 2"),
    ([0.0, 1.0, math.nan], None, "time in row 3 is nan"),
    ([0.0, 1.0, 2.0], [0.5, 0.4], "at in row 2 is 0.4; it must not go back"),
    ([0.0, 1.0, 2.0], [-0.5], "at in row 1 is -0.5"),
    ([0.0, 1.0, 2.0], [math.nan], "at in row 1 is nan"),
])  # fmt: skip
def test_bad_times_are_named_by_their_row(time, at, message):
    with pytest.raises(ValueError, match=message):
        sensitivities({}, time, [0.1, 0.1, 0.1], at=at)


def test_a_way_that_is_too_long_is_given_up():
    with pytest.raises(RuntimeError, match="the integration could not go on"):
        sensitivities({}, [0.0, 1e12], [0.3, 0.3])
