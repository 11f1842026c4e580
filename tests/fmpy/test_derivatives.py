"""Directional derivatives and derivatives of outputs, through FMPy."""

import numpy as np
import pytest
from fmpy import simulate_fmu

SCENE = {"gamma_s": 0.05, "tau_s": 0.03, "E_s": 0.2, "phi": 0.4, "phi_ac": 0.2, "omega_ac": 0.3, "phase_ac": 0.5}


@pytest.fixture
def instance(instantiate, reference_of):
    instance = instantiate()
    instance.setupExperiment(startTime=0.0, tolerance=1e-12)
    instance.setReal([reference_of[name] for name in SCENE], list(SCENE.values()))
    instance.enterInitializationMode()
    instance.exitInitializationMode()
    instance.doStep(0.0, 7.0)
    return instance


def test_directional_derivatives_are_those_of_changed_values(instance, reference_of):
    """By central differences of what is read after a parameter or an input is changed: λ'' to 1e-9 of itself."""
    unknown = [reference_of["lambda_ddot"]]
    for name in ("phi", "S", "c", "gamma_s", "tau_s", "E_s", "phi_ac", "omega_ac", "phase_ac"):
        known = [reference_of[name]]
        value, change = instance.getReal(known)[0], 1e-4
        around = []
        for step in (2, 1, -1, -2):
            # Set about 1, since parameters may not be negative.
            instance.setReal(known, [value + 1.0 + step * change])
            around += instance.getReal(unknown)
        instance.setReal(known, [value + 1.0])
        difference = (-around[0] + 8 * around[1] - 8 * around[2] + around[3]) / (12 * change)
        exact = instance.getDirectionalDerivative(unknown, known, [1.0])[0]
        assert exact == pytest.approx(difference, rel=1e-7, abs=1e-11), name
        instance.setReal(known, [value])


def test_the_whole_jacobian_at_once(instance, reference_of):
    unknowns = [reference_of[name] for name in ("lambda", "lambda3", "lambda_dot", "lambda_ddot")]
    knowns = [reference_of[name] for name in ("phi", "S", "lambda", "lambda_dot")]
    columns = [instance.getDirectionalDerivative(unknowns, [known], [1.0]) for known in knowns]
    weights = [0.3, -2.0, 0.7, 11.0]
    together = instance.getDirectionalDerivative(unknowns, knowns, weights)
    assert together == pytest.approx(np.array(columns).T @ weights, rel=1e-14)
    stretch = instance.getReal([reference_of["lambda"]])[0]
    assert np.array(columns).T[:3] == pytest.approx(
        np.array([[0, 0, 1, 0], [0, 0, -2 / stretch**3, 0], [0, 0, 0, 1]]), rel=1e-15
    )


def test_output_derivatives_continue_the_motion(instance, reference_of):
    outputs = [reference_of["lambda"], reference_of["lambda3"]]
    assert instance.getRealOutputDerivatives(outputs, [1, 1]) == pytest.approx(
        instance.getReal([reference_of["lambda_dot"], reference_of["lambda3_dot"]]), rel=1e-14
    )
    now, step = instance.getReal(outputs), 0.5
    orders = [instance.getRealOutputDerivatives(outputs, [order] * 2) for order in range(1, 6)]
    factors = np.cumprod([step / order for order in range(1, 6)])
    predicted = now + factors @ np.array(orders)
    instance.doStep(7.0, step)
    assert instance.getReal(outputs) == pytest.approx(predicted, abs=1e-7)


def test_display_units(fmu_path):
    """A phase may be given in degrees."""
    scene = {"phi_ac": 0.3, "omega_ac": 0.2}
    results = [
        simulate_fmu(str(fmu_path), start_values={**scene, "phase_ac": phase}, stop_time=20.0)["lambda"]
        for phase in ((90.0, "deg"), np.pi / 2)
    ]
    assert results[0] == pytest.approx(results[1], abs=1e-12)
    assert np.ptp(results[0]) > 1e-3
