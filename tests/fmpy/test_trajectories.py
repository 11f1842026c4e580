"""Trajectories against multiprecision at very different communication steps."""

import allowed_errors as allowed
import pytest
import references


def distance(actuator, name: str, communication_step: float, tolerance: float | None) -> float:
    """Largest error of λ and dλ/dt over the reference times, each reached by a last, shorter step if need be."""
    reference = references.trajectory(name)
    actuator.start(references.TRAJECTORY_SCENES[name], tolerance=tolerance)
    worst = 0.0
    for previous, row in zip(reference, reference[1:]):
        whole_steps = int((row["t"] - previous["t"]) / communication_step + 1e-9)
        for _ in range(whole_steps):
            actuator.advance(communication_step)
        remainder = row["t"] - previous["t"] - whole_steps * communication_step
        if remainder > 1e-9:
            actuator.advance(remainder)
        stretch, rate = actuator.get("lambda", "lambda_dot")
        worst = max(worst, abs(stretch - row["lam"]), abs(rate - row["v"]))
    assert actuator.time == pytest.approx(reference["t"][-1], rel=1e-12)
    return worst


@pytest.mark.parametrize("communication_step", [0.01, 0.37, 1.0, 25.0])
@pytest.mark.parametrize("name", references.TRAJECTORY_SCENES)
def test_trajectory(actuator, name, communication_step):
    assert distance(actuator, name, communication_step, allowed.TOLERANCE) <= allowed.TRAJECTORY


@pytest.mark.parametrize("name", ["case_a", "case_b"])
def test_trajectory_at_the_default_tolerance(actuator, name):
    assert distance(actuator, name, 0.37, None) <= allowed.TRAJECTORY_DEFAULT


def test_one_step_over_the_whole_span(actuator):
    for name in references.TRAJECTORY_SCENES:
        last = references.trajectory(name)[-1]
        actuator.start(references.TRAJECTORY_SCENES[name], tolerance=allowed.TOLERANCE)
        actuator.advance(last["t"])
        assert abs(actuator.get("lambda") - last["lam"]) <= allowed.TRAJECTORY
