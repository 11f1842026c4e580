"""The FMU as users call it: fmpy.simulate_fmu and FMPy's bare instance API."""

import numpy as np
import pytest
from fmpy import simulate_fmu
from fmpy.fmi1 import FMICallException
from fmpy.fmi2 import fmi2Discard, fmi2LastSuccessfulTime, fmi2Terminated

import allowed_errors as allowed
import references

REFERENCE_SET = {"gamma_s": 0.05, "tau_s": 0.05, "E_s": 0.2}


def test_nothing_but_start_values(fmu_path):
    result = simulate_fmu(str(fmu_path), start_values={**REFERENCE_SET, "phi": 0.6}, stop_time=500, output_interval=25)
    reference = references.trajectory("case_a")
    assert result.dtype.names == ("time", "lambda", "lambda3", "collapsed")
    assert result["time"] == pytest.approx(reference["t"])
    assert np.abs(result["lambda"] - reference["lam"]).max() <= allowed.TRAJECTORY_DEFAULT


def test_no_arguments_at_all(fmu_path):
    """The default scene has no voltage: the actuator stays at rest."""
    result = simulate_fmu(str(fmu_path))
    assert len(result) > 1
    assert (result["lambda"] == 1).all() and not result["collapsed"].any()


def test_input_signal_with_a_jump(fmu_path):
    """Constant pieces of input: the Hamiltonian is constant on each and jumps by the change of its own terms."""
    switch = 13.0
    signals = np.array(
        [(0.0, 0.6, 0.0), (switch, 0.6, 0.0), (switch, 0.3, 0.2), (60.0, 0.3, 0.2)],
        dtype=[("time", float), ("phi", float), ("S", float)],
    )
    result = simulate_fmu(
        str(fmu_path),
        start_values=REFERENCE_SET,
        input=signals,
        stop_time=60.0,
        output_interval=0.5,
        relative_tolerance=allowed.TOLERANCE,
        output=["lambda", "hamiltonian", "phi_total"],
    )
    before, after = result[result["time"] <= switch], result[result["time"] > switch]
    assert before["phi_total"] == pytest.approx(0.6) and after["phi_total"] == pytest.approx(0.3)
    assert np.abs(before["hamiltonian"]).max() <= allowed.ENERGY
    stretch = before["lambda"][-1]
    jump = (0.6**2 - 0.3**2) * (stretch**4 - 1) - 4 * 0.2 * (stretch - 1)
    assert abs(jump) > 0.01, "the pieces differ"
    assert np.abs(after["hamiltonian"] - jump).max() <= allowed.ENERGY


def test_tunable_parameter_as_an_input_column(fmu_path):
    signals = np.array(
        [(0.0, 0.6, 0.0), (10.0, 0.6, 0.0), (10.0, 0.6, 0.1), (20.0, 0.6, 0.1)],
        dtype=[("time", float), ("phi", float), ("gamma_s", float)],
    )
    names = ["lambda", "lambda_dot", "lambda_ddot", "gamma_s"]
    result = simulate_fmu(str(fmu_path), input=signals, stop_time=20.0, output_interval=1.0, output=names)
    assert result["gamma_s"][[5, -1]].tolist() == [0.0, 0.1]
    # Eq. 16, whose terms are of order 1
    x, v, a, gamma = (result[name] for name in names)
    residual = (100 + 2 * x**-6) * a - 6 * x**-7 * v**2 + x - x**-5 - 0.6**2 * x**3 + 2 * gamma * x
    assert np.abs(residual).max() <= 1e-14


def test_output_interval_that_does_not_divide_the_stop_time(fmu_path, actuator):
    scene = {**REFERENCE_SET, "phi": 0.6}
    result = simulate_fmu(
        str(fmu_path), start_values=scene, stop_time=10.0, output_interval=0.7, relative_tolerance=allowed.TOLERANCE
    )
    assert len(result) == 16 and result["time"][-1] == 10.0
    at_once = actuator.run(scene, stop_time=10.0, communication_step=10.0, tolerance=allowed.TOLERANCE)
    assert result["lambda"][-1] == pytest.approx(at_once["lambda"][-1], abs=allowed.SAME_MOTION)
    stepped = actuator.run(scene, stop_time=10.0, communication_step=0.7, tolerance=allowed.TOLERANCE)
    assert result["lambda"] == pytest.approx(stepped["lambda"], abs=allowed.SAME_MOTION)


def test_stop_time_reached_by_steps_with_rounding(fmu_path):
    """0.1 added a thousand times is not 100: FMPy's last step must not be refused at a stop time that is defined."""
    result = simulate_fmu(
        str(fmu_path), start_values={"phi": 0.6}, stop_time=100.0, output_interval=0.1, set_stop_time=True
    )
    assert result["time"][-1] == pytest.approx(100.0)


def test_start_time_other_than_zero(fmu_path):
    """Only the drive knows the time: without it a shifted run is the same run."""
    shifted = simulate_fmu(
        str(fmu_path), start_values={"phi": 0.6}, start_time=1000.0, stop_time=1050.0, output_interval=0.5
    )
    plain = simulate_fmu(str(fmu_path), start_values={"phi": 0.6}, stop_time=50.0, output_interval=0.5)
    assert shifted["time"][[0, -1]].tolist() == [1000.0, 1050.0]
    assert shifted["lambda"] == pytest.approx(plain["lambda"], abs=1e-9)


def run(instance, scene, reference_of, steps=100, step=0.37):
    """A bare run after `reset` or instantiation: λ and dλ/dt at each communication point."""
    instance.setupExperiment(startTime=0.0)
    instance.setReal([reference_of[name] for name in scene], list(scene.values()))
    instance.enterInitializationMode()
    instance.exitInitializationMode()
    rows = []
    for k in range(steps):
        instance.doStep(k * step, step)
        rows.append(instance.getReal([reference_of["lambda"], reference_of["lambda_dot"]]))
    return rows


@pytest.mark.parametrize(
    "between",
    [{}, {"phi": 1.0}, {"phi": 0.2, "phi_ac": 0.3, "omega_ac": 0.1471, "c": 7.0, "lambda_start": 1.2}],
    ids=["straight away", "after a collapse", "after another scene"],
)
def test_reset_gives_the_same_run_bit_for_bit(instantiate, reference_of, between):
    instance = instantiate()
    scene = {**REFERENCE_SET, "phi": 0.6, "S": 0.5}
    first = run(instance, scene, reference_of)
    instance.reset()
    if between:
        run(instance, between, reference_of)
        instance.reset()
    assert run(instance, scene, reference_of) == first
    assert run(instantiate(), scene, reference_of) == first


def test_reset_restores_every_start_value(instantiate, reference_of, description):
    instance = instantiate()
    declared = {v.name: float(v.start) for v in description.modelVariables if v.start is not None and v.type == "Real"}
    run(instance, {"phi": 0.3, "gamma_s": 0.1, "c": 7.0, "lambda_start": 1.2, "lambda_max": 5.0}, reference_of)
    instance.reset()
    instance.setupExperiment(startTime=0.0)
    instance.enterInitializationMode()
    assert instance.getReal([reference_of[name] for name in declared]) == list(declared.values())


def test_two_instances_at_once_do_not_disturb_each_other(instantiate, reference_of):
    scenes = [{**REFERENCE_SET, "phi": 0.6}, {"phi": 0.646, "c": 50.0, "phi_ac": 0.01, "omega_ac": 0.3}]
    alone = [run(instantiate(), scene, reference_of) for scene in scenes]

    pair = [instantiate(), instantiate()]
    for instance, scene in zip(pair, scenes):
        instance.setupExperiment(startTime=0.0)
        instance.setReal([reference_of[name] for name in scene], list(scene.values()))
        instance.enterInitializationMode()
        instance.exitInitializationMode()
    together = [[], []]
    for k in range(100):
        for instance, rows in zip(pair, together):
            instance.doStep(k * 0.37, 0.37)
            rows.append(instance.getReal([reference_of["lambda"], reference_of["lambda_dot"]]))
    assert together == alone


def test_hold_runs_to_the_stop_time(fmu_path):
    result = simulate_fmu(str(fmu_path), start_values={"phi": 0.7}, stop_time=60.0, output_interval=0.5)
    assert result["time"][-1] == 60.0
    assert result["collapsed"][-1] == 1.0 and result["lambda"][-1] == 10.0
    assert result["collapsed"][0] == 0.0


def test_terminate_ends_the_run_at_the_collapse(fmu_path, instantiate, reference_of):
    result = simulate_fmu(
        str(fmu_path),
        start_values={"phi": 0.7, "on_pull_in": 2},
        stop_time=60.0,
        output_interval=0.5,
        relative_tolerance=allowed.TOLERANCE,
        output=["lambda", "pulled_in", "pull_in_time"],
    )
    ended = result["time"][-1]
    assert ended == result["pull_in_time"][-1] and result["pulled_in"][-1]
    assert result["lambda"][-1] == pytest.approx(10.0, rel=1e-12)

    instance = instantiate()
    instance.setupExperiment(startTime=0.0, tolerance=allowed.TOLERANCE)
    instance.setReal([reference_of["phi"]], [0.7])
    instance.setInteger([reference_of["on_pull_in"]], [2])
    instance.enterInitializationMode()
    instance.exitInitializationMode()
    with pytest.raises(FMICallException) as refusal:
        instance.doStep(0.0, 60.0)
    assert refusal.value.status == fmi2Discard
    assert instance.getBooleanStatus(fmi2Terminated) is True
    assert instance.getRealStatus(fmi2LastSuccessfulTime) == pytest.approx(ended, abs=allowed.ESCAPE)
    with pytest.raises(FMICallException):
        instance.doStep(ended, 1.0)


def test_a_step_that_is_too_much_work_ends_the_run(fmu_path):
    """FMPy asks for a step that was discarded again, for ever if it is not told to end."""
    result = simulate_fmu(
        str(fmu_path),
        start_values={"phi_ac": 0.3, "omega_ac": 1000.0},
        stop_time=2e9,
        output_interval=1e9,
    )
    assert 0.0 < result["time"][-1] < 1e9
    assert 0.5 < result["lambda"][-1] < 2.0


def test_many_load_and_unload_cycles(fmu_path):
    """simulate_fmu loads and unloads the library at each call."""
    values = {simulate_fmu(str(fmu_path), start_values={"phi": 0.6}, stop_time=1.0)["lambda"][-1] for _ in range(30)}
    assert len(values) == 1
