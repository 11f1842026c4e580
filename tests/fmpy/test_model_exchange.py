"""Model exchange: SUNDIALS' CVODE, through FMPy, integrates the actuator's equation and locates its collapse; a
check of the co-simulation by an integrator that shares nothing with it."""

import numpy as np
import pytest
from fmpy import simulate_fmu

import allowed_errors as allowed

REFERENCE_SET = {"gamma_s": 0.05, "tau_s": 0.05, "E_s": 0.2}
SCENES = {
    "voltage step": {**REFERENCE_SET, "phi": 0.6},
    "voltage step under prestress": {**REFERENCE_SET, "phi": 0.5, "S": 0.5},
    "alternating voltage": {**REFERENCE_SET, "phi_ac": 0.3, "omega_ac": 0.1438},
    "thin and moving at the start": {"c": 2.0, "phi": 0.3, "lambda_start": 1.3, "lambda_dot_start": -0.4},
}


def run(fmu_path, kind, scene, tolerance, stop_time=100.0, **more):
    return simulate_fmu(
        str(fmu_path),
        fmi_type=kind,
        start_values=scene,
        stop_time=stop_time,
        output_interval=0.5,
        relative_tolerance=tolerance,
        output=["lambda", "lambda3", "lambda_dot", "hamiltonian", "pulled_in", "pull_in_time"],
        **more,
    )


@pytest.mark.parametrize("scene", SCENES.values(), ids=SCENES)
def test_cvode_comes_to_the_motion_of_the_co_simulation(fmu_path, scene):
    ours = run(fmu_path, "CoSimulation", scene, allowed.TOLERANCE)
    errors = []
    for tolerance in (1e-6, 1e-8, 1e-10):
        theirs = run(fmu_path, "ModelExchange", scene, tolerance)
        assert theirs["time"] == pytest.approx(ours["time"])
        errors.append(max(np.abs(theirs[name] - ours[name]).max() for name in ("lambda", "lambda_dot")))
    assert errors[0] > 10 * errors[1] > 100 * errors[2] > 0, errors
    assert errors[2] <= allowed.CVODE, errors


def test_cvode_locates_the_collapse_and_goes_on_at_the_limit(fmu_path):
    scene = {"phi": 0.7}
    ours = run(fmu_path, "CoSimulation", scene, allowed.TOLERANCE)
    theirs = run(fmu_path, "ModelExchange", scene, 1e-10)
    assert theirs["pull_in_time"][-1] == pytest.approx(ours["pull_in_time"][-1], abs=allowed.CVODE_EVENT)
    before, after = theirs[~theirs["pulled_in"]], theirs[theirs["pulled_in"]]
    assert len(before) > 50 and len(after) > 50
    # FMPy records the instant of the event twice: the state that CVODE came to, then the one after the event
    assert (after["lambda"] == 10.0).all() and (after["lambda_dot"] == 0.0).all()
    assert before["lambda"][-1] == pytest.approx(10.0, rel=1e-9)
    assert theirs["time"][-1] == 100.0


def test_a_collapse_that_terminates_ends_the_run(fmu_path):
    scene = {"phi": 0.7, "on_pull_in": 2}
    ours = run(fmu_path, "CoSimulation", scene, allowed.TOLERANCE)
    theirs = run(fmu_path, "ModelExchange", scene, 1e-10)
    assert theirs["time"][-1] == pytest.approx(ours["time"][-1], abs=allowed.CVODE_EVENT)
    assert theirs["lambda"][-1] == pytest.approx(10.0, rel=1e-9)
    assert theirs["pulled_in"][-1] and not theirs["pulled_in"][:-1].any()
    assert theirs["pull_in_time"][-1] == theirs["time"][-1]


def test_inputs_and_tunable_parameters_change_at_events(fmu_path):
    signals = np.array(
        [(0.0, 0.6, 0.0), (13.0, 0.6, 0.0), (13.0, 0.3, 0.1), (40.0, 0.3, 0.1)],
        dtype=[("time", float), ("phi", float), ("gamma_s", float)],
    )
    ours = run(fmu_path, "CoSimulation", {}, allowed.TOLERANCE, 40.0, input=signals)
    theirs = run(fmu_path, "ModelExchange", {}, 1e-10, 40.0, input=signals, record_events=False)
    assert np.abs(ours["lambda"] - theirs["lambda"]).max() <= allowed.CVODE


def test_no_arguments_at_all(fmu_path):
    """FMPy takes co-simulation where it has the choice; forward Euler is the other solver that it has."""
    assert simulate_fmu(str(fmu_path), fmi_type="ModelExchange")["lambda"][-1] == 1.0
    assert simulate_fmu(str(fmu_path), fmi_type="ModelExchange", solver="Euler")["lambda"][-1] == 1.0


def test_a_varying_input_at_default_settings(fmu_path):
    """CVODE, at the tolerance that FMPy gives it where the description names none."""
    time = np.linspace(0.0, 100.0, 101)
    signals = np.array(
        [(t, 0.3 + 0.2 * np.sin(0.2 * t), 0.1) for t in time], dtype=[("time", float), ("phi", float), ("S", float)]
    )
    theirs = simulate_fmu(str(fmu_path), fmi_type="ModelExchange", input=signals, stop_time=100.0)
    exact = run(fmu_path, "ModelExchange", {}, 1e-9, input=signals)
    assert theirs["time"][-1] == 100.0
    assert np.ptp(exact["lambda"]) > 0.5
    # FMPy's own default is 1e-5 in each step.
    assert abs(theirs["lambda"][-1] - exact["lambda"][-1]) < 0.05


def test_extremes_are_recorded(fmu_path):
    names = ["lambda_lowest", "lambda_highest", "lambda3_lowest", "lambda3_highest"]
    scene = {**SCENES["alternating voltage"], "record_extremes": True}
    ours, theirs = (
        simulate_fmu(
            str(fmu_path), fmi_type=kind, start_values=scene, stop_time=100.0, relative_tolerance=1e-8, output=names
        )
        for kind in ("CoSimulation", "ModelExchange")
    )
    for name in names:
        assert ours[name][-1] > 0.5
        assert theirs[name][-1] == pytest.approx(ours[name][-1], abs=1e-6), name


def test_extremes_start_anew_at_an_event(fmu_path):
    window = np.array(
        [(0.0, 1.0), (88.0, 1.0), (88.0, 2.0), (100.0, 2.0)], dtype=[("time", float), ("extremes_window", float)]
    )
    scene = SCENES["alternating voltage"]
    ours, theirs = (
        simulate_fmu(
            str(fmu_path),
            fmi_type=kind,
            start_values=scene,
            stop_time=100.0,
            output_interval=0.1,
            relative_tolerance=1e-9,
            input=window,
            output=["lambda", "lambda_lowest", "lambda_highest"],
            record_events=False,
        )
        for kind in ("CoSimulation", "ModelExchange")
    )
    inside = ours["lambda"][ours["time"] > 87.99]
    for result in (ours, theirs):
        assert result["lambda_highest"][-1] == pytest.approx(inside.max(), abs=1e-5)
        assert result["lambda_lowest"][-1] == pytest.approx(inside.min(), abs=1e-5)
    assert ours["lambda_highest"][-1] < ours["lambda"].max() - 1e-2
